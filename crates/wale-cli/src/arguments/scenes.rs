//! Arguments of what begins with a scene: `wale new`, `check`, `run`, `resume` and `relax`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use wale::scene::dimensions::{Force, Length};
use wale::scene::schema::PresetName;

use super::quantities::positive;
use crate::machine::parse_size;

/// `wale new`
#[derive(Debug, Args)]
pub struct New {
    /// File to write
    pub file: PathBuf,
    /// Yarn, and a fabric of it
    #[arg(long, value_enum, default_value_t = Preset::WorstedWool)]
    pub preset: Preset,
    /// Overwrite an existing file
    #[arg(long)]
    pub force: bool,
}

/// Yarns that wale knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Preset {
    /// Ne 30 cotton, as in T-shirts
    FineCottonJersey,
    /// Worsted-weight wool, as in hand-knit sweaters
    WorstedWool,
    /// Thick, soft hand-knit acrylic
    ThickAcrylic,
}

impl Preset {
    /// Its name, as scenes and the command line have it.
    #[must_use]
    pub fn name(self) -> &'static str {
        PresetName::from(self).name()
    }
}

impl From<Preset> for PresetName {
    fn from(preset: Preset) -> Self {
        match preset {
            Preset::FineCottonJersey => Self::FineCottonJersey,
            Preset::WorstedWool => Self::WorstedWool,
            Preset::ThickAcrylic => Self::ThickAcrylic,
        }
    }
}

/// Limits that `check`, `run` and `relax` share.
#[derive(Debug, Args)]
pub struct Limits {
    /// Most memory to use, such as `4GB`; what is free if not given
    #[arg(long, value_name = "SIZE", value_parser = parse_size)]
    pub max_memory: Option<u64>,
}

/// How a run is gone about.
#[derive(Debug, Args)]
pub struct Manner {
    /// Number of threads; all processors if not given. Results do not depend on it
    #[arg(long, short = 'j', value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Print errors only
    #[arg(long, short)]
    pub quiet: bool,
}

/// `wale check`
#[derive(Debug, Args)]
pub struct Check {
    /// Stitches that a float may pass before it is mentioned
    #[arg(long, value_name = "STITCHES", default_value_t = 5)]
    pub longest_float: u32,
    /// Scene file, or instructions (.knit, .txt), knitout (.k), an image (.png) or a draft (.wif) without a scene; with --topology
    /// a run folder, too
    pub scene: PathBuf,
    /// Yarn of what is given without a scene; worsted-wool if left out
    #[arg(long, value_enum, value_name = "PRESET")]
    pub yarn: Option<Preset>,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
    /// Print the scene with every default written out
    #[arg(long)]
    pub resolved: bool,
    /// Check where the yarns go: of a scene in its layout, of a run folder from its first frame to its last
    #[arg(long)]
    pub topology: bool,
    #[allow(missing_docs)]
    #[command(flatten)]
    pub limits: Limits,
}

/// `wale run`
#[derive(Debug, Args)]
pub struct Run {
    /// Scene file
    pub scene: PathBuf,
    /// Run folder; the scene's name with `.run` if not given
    #[arg(long, short, value_name = "FOLDER")]
    pub out: Option<PathBuf>,
    /// Delete the run that the folder holds
    #[arg(long)]
    pub force: bool,
    /// Simulated time of the run in seconds, in place of the scene's
    #[arg(long, value_name = "SECONDS", value_parser = parse_duration)]
    pub duration: Option<f64>,
    #[allow(missing_docs)]
    #[command(flatten)]
    pub manner: Manner,
    #[allow(missing_docs)]
    #[command(flatten)]
    pub limits: Limits,
}

/// `wale resume`
#[derive(Debug, Args)]
pub struct Resume {
    /// Run folder
    pub run: PathBuf,
    /// Go on although the program or the input files have changed
    #[arg(long)]
    pub allow_changed: bool,
    #[allow(missing_docs)]
    #[command(flatten)]
    pub manner: Manner,
    #[allow(missing_docs)]
    #[command(flatten)]
    pub limits: Limits,
}

/// `wale relax`
#[derive(Debug, Args)]
pub struct Relax {
    /// Scene file
    pub scene: PathBuf,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
    /// Starts from different small disturbances; equilibria need not be unique
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub starts: u16,
    /// How often what has come to rest lowest is shaken gently and relaxed again, to find what lies lower yet
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u16).range(0..=1000))]
    pub shakes: u16,
    /// Stiffness of the table under the fabric, in bending stiffness over loop length cubed; left out, that with which the
    /// card's proportions were fitted
    #[arg(long, value_parser = parse_bed)]
    pub bed: Option<f64>,
    /// As the fabric comes off its needles, held by the friction of its yarn, instead of as it is when nothing rubs: lace keeps its
    /// width so
    #[arg(long, conflicts_with_all = ["starts", "shakes"])]
    pub off_needles: bool,
    /// Distance of neighbouring needles, such as "3.6 mm"; left out, that of the wales as they are laid out
    #[arg(long, value_name = "LENGTH", requires = "off_needles", value_parser = positive::<Length>)]
    pub needle_pitch: Option<f64>,
    /// How hard each wale is pulled on the needles, such as "5 mN"; left out, 30 times bending stiffness over loop length squared
    #[arg(long, value_name = "FORCE", requires = "off_needles", value_parser = positive::<Force>)]
    pub take_down: Option<f64>,
}

fn parse_bed(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|bed| (0.0..=1e9).contains(bed))
        .ok_or_else(|| format!("`{text}` is not a number of 0 or more"))
}

fn parse_duration(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|seconds| (0.0..=1e6).contains(seconds))
        .ok_or_else(|| format!("`{text}` is not a number of seconds, 0 or more"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_are_read() {
        assert_eq!(parse_duration("0.25"), Ok(0.25));
        for bad in ["", "-1", "NaN", "inf", "1 s", "1e300"] {
            assert!(parse_duration(bad).is_err(), "{bad}");
        }
    }
}
