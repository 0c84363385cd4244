//! `wale version`: what this program is and what it runs on.

use wale::record::Environment;

use crate::arguments::Version;
use crate::exit::Failure;
use crate::{machine, output, say};

/// Prints it.
pub fn version(arguments: &Version) -> Result<(), Failure> {
    let environment = Environment::here(machine::use_threads(None)?);
    if arguments.json {
        return output::json(&environment);
    }
    say!("wale {}", environment.version)?;
    say!("{} on {}, {} threads, {}", environment.os, environment.architecture, environment.threads, environment.cpu)?;
    say!("built with {}", environment.features.join(", "))?;
    say!("run folder format {}", environment.format)
}
