//! Arguments of `wale bench`.

use clap::{Args, ValueEnum};

use super::Manner;

/// `wale bench`
#[derive(Debug, Args)]
pub struct Bench {
    /// What to measure
    #[arg(value_enum, default_value_t = Subject::Swatch)]
    pub subject: Subject,
    /// Nodes of the largest swatch
    #[arg(long, default_value_t = 50_000, value_parser = clap::value_parser!(u32).range(1000..=10_000_000))]
    pub nodes: u32,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
    #[allow(missing_docs)]
    #[command(flatten)]
    pub manner: Manner,
}

/// What to measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Subject {
    /// A garter swatch falling on a sphere, at three sizes
    Swatch,
    /// Garter, lace and other patterns side by side
    Patterns,
    /// How long 100,000 loops take to lay out: of every named pattern, written instructions, a machine's program, a weave
    Layout,
    /// Factors against conjugate gradients, at the sizes around which one takes over from the other
    Solver,
}
