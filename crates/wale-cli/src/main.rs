//! The program `wale`: arguments, progress, exit codes. No physics.

use std::process::ExitCode;

use clap::Parser;

mod arguments;
mod commands;
mod exit;
mod machine;
mod output;
mod progress;
mod signals;

use arguments::{Arguments, Command};

fn main() -> ExitCode {
    // A wrong command line ends here, with code 2.
    let arguments = Arguments::parse();
    exit::guard(|| match &arguments.command {
        Command::Version(arguments) => commands::version::version(arguments),
        _ => unreachable!(),
    })
}
