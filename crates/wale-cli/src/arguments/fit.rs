//! Arguments of `wale fit`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::Results;

/// `wale fit`
#[derive(Debug, Args)]
pub struct Fit {
    /// Fabric file; several are of one yarn, which is fitted to all of them at once
    #[arg(required = true, value_name = "FABRIC")]
    pub fabrics: Vec<PathBuf>,
    #[allow(missing_docs)]
    #[command(flatten)]
    pub results: Results,
    /// Only read the fabric file and its tables, and say how they were understood
    #[arg(long)]
    pub read_only: bool,
    /// Fit the thin shell alone, though the fabric file says how the yarns lie
    #[arg(long)]
    pub shell_only: bool,
    /// Law of the thin shell's stress
    #[arg(long, value_enum, default_value_t = Law::Quadratic)]
    pub law: Law,
    /// How the yarn is fitted
    #[arg(long, value_enum, default_value_t = Way::Gradients)]
    pub way: Way,
    /// Only take a first look at the yarn, in a tenth of the time
    #[arg(long)]
    pub quick: bool,
    /// Seed of the swarm
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Leave a part of the yarn's model out, to see what it is for
    #[arg(long, value_enum, value_name = "PART")]
    pub without: Vec<Part>,
    /// Fit the yarn to the bending stiffnesses of the shell, too
    #[arg(long)]
    pub with_bending: bool,
    /// Fit the yarn again without each of its parts and by other ways, and report what each is for; the swarm takes minutes
    #[arg(long, conflicts_with_all = ["without", "with_bending", "shell_only", "read_only", "ask", "answer", "tell"])]
    pub ablations: bool,
    #[command(flatten)]
    pub elsewhere: Elsewhere,
}

/// A fit whose questions are answered elsewhere.
#[derive(Debug, Args)]
#[group(multiple = false)]
pub struct Elsewhere {
    /// Print the questions that the fit of the yarn asks now, as JSON lines, and end; none when it is done
    #[arg(long)]
    pub ask: bool,
    /// Answer questions, JSON lines of standard input, and print the answers
    #[arg(long)]
    pub answer: bool,
    /// Take answers, JSON lines of a file or of standard input (`-`)
    #[arg(long, value_name = "FILE")]
    pub tell: Option<PathBuf>,
}

/// Laws of a thin shell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Law {
    /// St. Venant–Kirchhoff's with terms of area: the paper's
    Quadratic,
    /// With four numbers more, for a fabric that becomes stiffer as it is stretched
    Stiffening,
}

/// Ways to fit a yarn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Way {
    /// Least squares with exact derivatives, from the best of many places
    Gradients,
    /// A swarm of 64 particles in 10 steps, then COBYLA: the paper's way
    Swarm,
    /// COBYLA from the middle of the bounds
    Local,
}

/// Parts of the yarn's model that can be left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Part {
    /// Yarns of one stiffness instead of two
    Phases,
    /// Yarns at rest as they were registered
    RestShapes,
    /// Nothing holds the yarns where they stick to each other
    Holding,
}
