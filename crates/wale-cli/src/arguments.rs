//! The command line.

use std::path::{Path, PathBuf};

use clap::{Args, Parser, Subcommand, ValueEnum};

use crate::machine::parse_size;

pub mod fit;
pub mod lab;
pub mod register;

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
    /// Check a scene without running it; print sizes, memory and time
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
    /// Do a virtual textile test on the thin shell of a fabric: KES, FAST, cantilever, drape, …
    Lab(lab::Lab),
    /// Count loops, nodes and yarn of a scene or a run
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

/// `wale patterns`
#[derive(Debug, Args)]
pub struct Patterns {
    /// A pattern to show: its chart and how it is worked; all are listed if not given
    pub name: Option<String>,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
    /// Draw the pattern, or each of the library, into a folder; large repeats take minutes
    #[arg(long, value_name = "FOLDER")]
    pub pictures: Option<PathBuf>,
}

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
    /// Scene file, or with --topology a run folder
    pub scene: PathBuf,
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
    /// Stiffness of the table under the fabric, in bending stiffness over loop length cubed; left out, that with which the
    /// card's proportions were fitted
    #[arg(long, value_parser = parse_bed)]
    pub bed: Option<f64>,
}

/// `wale inspect`
#[derive(Debug, Args)]
pub struct Inspect {
    /// Stitches that a float may pass before it is mentioned
    #[arg(long, value_name = "STITCHES", default_value_t = 5)]
    pub longest_float: u32,
    /// Scene file or run folder
    pub path: PathBuf,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
}

/// `wale render`
#[derive(Debug, Args)]
pub struct Render {
    /// Run folder, or a periodic tile of yarns (`.pyp`)
    pub run: PathBuf,
    /// PNG file, or folder for several frames; inside the run folder, or beside the tile, if not given
    #[arg(long, short, value_name = "PATH")]
    pub out: Option<PathBuf>,
    /// Frames to draw: `last`, `all`, a number, or a range such as `10..20`
    #[arg(long, default_value = "last")]
    pub frames: FrameChoice,
    /// Side to look from: front, back, left, right, top, bottom, three-quarter, three-quarter-back
    #[arg(long, default_value = "three-quarter")]
    pub view: wale::picture::View,
    /// What yarns are coloured by: yarn, stretch, sliding, curvature
    #[arg(long, default_value = "yarn")]
    pub color: wale::picture::ColorMode,
    /// Size in pixels, such as `1600x1200`
    #[arg(long, value_name = "WxH", value_parser = parse_picture_size)]
    pub size: Option<[u32; 2]>,
}

impl Render {
    /// The picture that is drawn of a run if nothing else is said.
    #[must_use]
    pub fn of(run: &Path) -> Self {
        Self {
            run: run.to_owned(),
            out: None,
            frames: FrameChoice::Last,
            view: wale::picture::View::ThreeQuarter,
            color: wale::picture::ColorMode::default(),
            size: None,
        }
    }
}

/// `wale plot`
#[derive(Debug, Args)]
pub struct Plot {
    /// Run folder
    pub run: PathBuf,
    /// PNG or SVG file; inside the run folder if not given
    #[arg(long, short, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// `wale view`
#[derive(Debug, Args)]
pub struct View {
    /// Run folder
    pub run: PathBuf,
    /// HTML file; inside the run folder if not given
    #[arg(long, short, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// `wale export`
#[derive(Debug, Args)]
pub struct Export {
    /// Run folder
    pub run: PathBuf,
    /// Format
    #[arg(long, short, value_enum)]
    pub format: Format,
    /// File, or folder for one file a frame; inside the run folder if not given
    #[arg(long, short, value_name = "PATH")]
    pub out: Option<PathBuf>,
    /// Frames to write: `last`, `all`, a number, or a range such as `10..20`
    #[arg(long, default_value = "all")]
    pub frames: FrameChoice,
    /// The world's up axis in the file, where the format can say so
    #[arg(long, value_enum, default_value_t = Up::Z)]
    pub up: Up,
}

/// Formats that other programs read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// USD BasisCurves with time samples, one `.usda` file
    Usd,
    /// VTK polydata for ParaView, a `.vtp` file a frame and their `.pvd`
    Vtk,
    /// Binary curve collection, a `.bcc` file a frame
    Bcc,
    /// Yarns as tubes, an `.obj` file a frame
    Obj,
    /// Yarns as tubes, a `.ply` file a frame
    Ply,
    /// The metrics table
    Csv,
}

/// Which axis of a file points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Up {
    /// As in films
    Y,
    /// As in the simulation
    Z,
}

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
    /// Garter, lace and other patterns side by side, and how long 100,000 loops of each take to lay out
    Patterns,
    /// Factors against conjugate gradients, at the sizes around which one takes over from the other
    Solver,
}

/// `wale version`
#[derive(Debug, Args)]
pub struct Version {
    /// Print JSON
    #[arg(long)]
    pub json: bool,
}

/// A choice among the frames of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameChoice {
    /// The last.
    Last,
    /// All of them.
    All,
    /// From one up to, not including, another.
    Range(u64, u64),
}

impl FrameChoice {
    /// The chosen range among so many frames; `None` if it is empty or reaches beyond.
    #[must_use]
    pub fn among(self, count: u64) -> Option<std::ops::Range<u64>> {
        let range = match self {
            Self::Last => count.checked_sub(1)?..count,
            Self::All => 0..count,
            Self::Range(first, end) => first..end,
        };
        (!range.is_empty() && range.end <= count).then_some(range)
    }
}

impl std::str::FromStr for FrameChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let bad = || format!("`{text}` is not `last`, `all`, a number, or a range such as `10..20`");
        let number = |text: &str| text.trim().parse::<u64>().map_err(|_| bad());
        match (text, text.split_once("..")) {
            ("last", _) => Ok(Self::Last),
            ("all", _) => Ok(Self::All),
            (_, Some((first, end))) => Ok(Self::Range(number(first)?, number(end)?)),
            (_, None) => {
                let index = number(text)?;
                Ok(Self::Range(index, index.checked_add(1).ok_or_else(bad)?))
            }
        }
    }
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

fn parse_picture_size(text: &str) -> Result<[u32; 2], String> {
    text.split_once('x')
        .and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]))
        .filter(|size| size.iter().all(|side| (16..=16_384).contains(side)))
        .ok_or_else(|| format!("`{text}` is no size such as `1600x1200`, with sides of 16 to 16384"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_sound() {
        use clap::CommandFactory;
        Arguments::command().debug_assert();
    }

    #[test]
    fn frames_are_chosen() {
        let choose = |text: &str| text.parse::<FrameChoice>().unwrap().among(10);
        assert_eq!(choose("last"), Some(9..10));
        assert_eq!(choose("all"), Some(0..10));
        assert_eq!(choose("3"), Some(3..4));
        assert_eq!(choose("3..5"), Some(3..5));
        assert_eq!(choose("9..11"), None);
        assert_eq!(choose("5..3"), None);
        assert_eq!(FrameChoice::Last.among(0), None);
        for bad in ["", "x", "-1", "1..", "18446744073709551615"] {
            assert!(bad.parse::<FrameChoice>().is_err(), "{bad}");
        }
    }

    #[test]
    fn durations_are_read() {
        assert_eq!(parse_duration("0.25"), Ok(0.25));
        for bad in ["", "-1", "NaN", "inf", "1 s", "1e300"] {
            assert!(parse_duration(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn picture_sizes_are_read() {
        assert_eq!(parse_picture_size("1600x1200"), Ok([1600, 1200]));
        for bad in ["", "1600", "0x100", "99999x100", "axb", "-1x5"] {
            assert!(parse_picture_size(bad).is_err(), "{bad}");
        }
    }
}
