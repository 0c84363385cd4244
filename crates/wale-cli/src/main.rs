//! The program `wale`: arguments, progress, exit codes. No physics.

use std::process::ExitCode;

use clap::Parser;

mod arguments;
mod bench;
mod commands;
mod estimate;
mod exit;
mod machine;
mod observe;
mod opened;
mod output;
mod products;
mod progress;
mod run_loop;
mod signals;

use arguments::{Arguments, Command};

fn main() -> ExitCode {
    // A wrong command line ends here, with code 2.
    let arguments = Arguments::parse();
    exit::guard(|| match &arguments.command {
        Command::New(arguments) => commands::new::new(arguments),
        Command::Check(arguments) => commands::check::check(arguments),
        Command::Run(arguments) => commands::run::run(arguments),
        Command::Resume(arguments) => commands::resume::resume(arguments),
        Command::Relax(arguments) => commands::relax::relax(arguments),
        Command::Fit(arguments) => commands::fit::fit(arguments),
        Command::Register(arguments) => commands::register::register(arguments),
        Command::Lab(arguments) => commands::lab::lab(arguments),
        Command::Inspect(arguments) => commands::inspect::inspect(arguments),
        Command::Render(arguments) => commands::render::render(arguments),
        Command::Plot(arguments) => commands::plot::plot(arguments),
        Command::View(arguments) => commands::view::view(arguments),
        Command::Export(arguments) => commands::export::export(arguments),
        Command::Bench(arguments) => commands::bench::bench(arguments),
        Command::Patterns(arguments) => commands::patterns::patterns(arguments),
        Command::Schema => commands::schema::schema(),
        Command::Version(arguments) => commands::version::version(arguments),
    })
}
