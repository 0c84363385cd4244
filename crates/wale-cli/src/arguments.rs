//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

pub mod bench;
pub mod fit;
pub mod lab;
pub mod products;
mod quantities;
pub mod register;
pub mod scenes;

pub use bench::{Bench, Subject};
pub use products::{Export, Format, FrameChoice, Plot, Render, Up, View};
pub use scenes::{Check, Manner, New, Preset, Relax, Resume, Run};

/// Yarn-level simulation of knitted cloth: from a stitch chart to moving fabric.
///
/// Begin with `wale new swatch.toml`, look at it with `wale check swatch.toml`, and run it with
/// `wale run swatch.toml`.
#[derive(Debug, Parser)]
#[command(
    name = "wale",
    version,
    max_term_width = 100,
    after_help = "Exit codes: 0 done · 2 usage · 3 bad input · 4 too large for the machine · 5 did not converge · \
                  6 disk · 70 a bug · 130 Ctrl-C · 143 SIGTERM"
)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Write a scene file to begin from
    New(New),
    /// Check a scene, a chart or a draft without running it; print yarn, mass, density, flaws, memory and time
    Check(Check),
    /// Run a scene into a run folder
    Run(Run),
    /// Go on with a run that was stopped or killed, to the same bits
    Resume(Resume),
    /// Bring a repeat of the fabric to rest, lying flat, and print its size
    Relax(Relax),
    /// Fit a thin shell and a yarn to the measured curves of a fabric file; write its card, curves and a report
    Fit(fit::Fit),
    /// Write a page on which yarns are laid over photographs of a swatch, to make a yarn tile
    Register(register::Register),
    /// Do a virtual textile test on a fabric, by shell, tile or yarns: KES, FAST, cantilever, drape, curl, …
    Lab(lab::Lab),
    /// Count loops, nodes and yarn of a scene, a chart, a draft or a run
    Inspect(Inspect),
    /// Draw frames of a run as PNG pictures
    Render(Render),
    /// Plot forces, sizes and energies of a run
    Plot(Plot),
    /// Write a run as one HTML page to turn in the hand
    View(View),
    /// Write a run in a format that other programs read
    Export(Export),
    /// Measure speed and memory on this machine
    Bench(Bench),
    /// List the stitch patterns that wale knows by name, or show one of them
    Patterns(Patterns),
    /// Print the JSON Schema of scene files
    Schema,
    /// Print version, features and machine
    Version(Version),
}

/// Where the results of a fabric go, and how they are told.
#[derive(Clone, Debug, Default, Args)]
pub struct Results {
    /// Folder for what is written; left out, beside the file and named after it
    #[arg(long, value_name = "FOLDER")]
    pub out: Option<PathBuf>,
    /// Overwrite what is in that folder, answers of a fit that was stopped included
    #[arg(long)]
    pub force: bool,
    /// Print JSON, in SI units
    #[arg(long)]
    pub json: bool,
    /// Threads; all cores if left out. Results do not depend on it
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
}

/// `wale patterns`
#[derive(Debug, Args)]
pub struct Patterns {
    /// A pattern to show: its chart and how it is worked; all are listed if not given
    pub name: Option<String>,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
    /// Draw the pattern, or each of them, into a folder; large repeats take minutes
    #[arg(long, value_name = "FOLDER")]
    pub pictures: Option<PathBuf>,
}

/// `wale inspect`
#[derive(Debug, Args)]
pub struct Inspect {
    /// Stitches that a float may pass before it is mentioned
    #[arg(long, value_name = "STITCHES", default_value_t = 5)]
    pub longest_float: u32,
    /// Scene file or run folder, or instructions (.knit, .txt), knitout (.k), an image (.png) or a draft (.wif) without a scene
    pub path: PathBuf,
    /// Yarn of what is given without a scene; worsted-wool if left out
    #[arg(long, value_enum, value_name = "PRESET")]
    pub yarn: Option<Preset>,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
}

/// `wale version`
#[derive(Debug, Args)]
pub struct Version {
    /// Print JSON
    #[arg(long)]
    pub json: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_sound() {
        use clap::CommandFactory;
        Arguments::command().debug_assert();
    }
}
