//! The command line of `wale lab`.

use std::path::PathBuf;

use clap::{Args, Command, Subcommand, ValueEnum};
use serde::{Deserialize, Serialize};
use wale::scene::dimensions::{Angle, Length, Ratio};
use wale::scene::units::Any;
use wale_lab::card_file::SheetBending;
use wale_lab::fabric_file::ArealMass;

use super::Results;
use super::quantities::{positive, quantity};

/// Between what stretches tests end \[–\]: nothing is seen of less, and no fabric takes more.
const LEAST_STRETCH: f64 = 1e-3;
const MOST_STRETCH: f64 = 10.0;

/// `wale lab`
#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, arg_required_else_help = true)]
pub struct Lab {
    /// The test.
    #[command(subcommand)]
    pub test: Option<Test>,
    /// Answer questions of `--ask`, JSON lines of standard input, and print the answers
    #[arg(long)]
    pub answer: bool,
    /// Threads for answers; all cores if left out
    #[arg(long, requires = "answer", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
}

/// Virtual textile tests.
#[derive(Clone, Debug, Subcommand, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Test {
    /// A swatch between clamps, 10 × 6 cm to 5 N
    Stretch(Stretch),
    /// The strip of ISO 13934-1, 200 × 50 mm; it does not break
    Strip(Stretch),
    /// KES-FB1 tensile: LT, WT, RT, EMT
    KesTensile(Directed),
    /// KES-FB1 shear: G, 2HG, 2HG5
    KesShear(Directed),
    /// KES-FB2 pure bending: B, 2HB
    KesBending(Directed),
    /// Cantilever of ASTM D1388: overhang, bending length, rigidity
    Cantilever(Cantilever),
    /// Pear loops: height over width by distance of the clamps
    PearLoop(PearLoop),
    /// Drape test of Cusick: drape coefficient, nodes, areas
    Drape(Drape),
    /// Picture frame: shear force by angle
    PictureFrame(PictureFrame),
    /// Bias extension: shear force by angle
    BiasExtension(BiasExtension),
    /// FAST-2 and FAST-3: bending, extension at 5, 20, 100 gf/cm, formability, shear rigidity
    Fast(Plain),
    /// Curl of a free swatch: curvature of its edges, and to which side
    Curl(Free),
    /// Relaxation shrinkage: from the size as knitted to the size at rest
    Relaxation(Free),
}

impl Test {
    /// What it shares with all.
    pub fn common(&self) -> &Common {
        match self {
            Self::Stretch(of) | Self::Strip(of) => &of.directed.common,
            Self::KesTensile(of) | Self::KesShear(of) | Self::KesBending(of) => &of.common,
            Self::Cantilever(of) => &of.directed.common,
            Self::PearLoop(of) => &of.directed.common,
            Self::Drape(of) => &of.common,
            Self::PictureFrame(of) => &of.directed.common,
            Self::BiasExtension(of) => &of.common,
            Self::Fast(of) => &of.common,
            Self::Curl(of) | Self::Relaxation(of) => &of.common,
        }
    }

    /// Directions that were asked for, of a test that has one.
    pub fn directions(&mut self) -> Option<&mut Vec<f64>> {
        match self {
            Self::Stretch(of) | Self::Strip(of) => Some(&mut of.directed.direction),
            Self::KesTensile(of) | Self::KesShear(of) | Self::KesBending(of) => Some(&mut of.direction),
            Self::Cantilever(of) => Some(&mut of.directed.direction),
            Self::PearLoop(of) => Some(&mut of.directed.direction),
            Self::PictureFrame(of) => Some(&mut of.directed.direction),
            Self::Drape(_) | Self::BiasExtension(_) | Self::Fast(_) | Self::Curl(_) | Self::Relaxation(_) => None,
        }
    }

    /// Names of all tests, in the order in which the help has them.
    pub fn names() -> Vec<String> {
        let command = Self::augment_subcommands(Command::new("lab"));
        command.get_subcommands().map(|test| test.get_name().to_owned()).collect()
    }

    /// Its name on the command line.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Stretch(_) => "stretch",
            Self::Strip(_) => "strip",
            Self::KesTensile(_) => "kes-tensile",
            Self::KesShear(_) => "kes-shear",
            Self::KesBending(_) => "kes-bending",
            Self::Cantilever(_) => "cantilever",
            Self::PearLoop(_) => "pear-loop",
            Self::Drape(_) => "drape",
            Self::PictureFrame(_) => "picture-frame",
            Self::BiasExtension(_) => "bias-extension",
            Self::Fast(_) => "fast",
            Self::Curl(_) => "curl",
            Self::Relaxation(_) => "relaxation",
        }
    }
}

/// A test that has no choice of its own.
#[derive(Clone, Debug, Args, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plain {
    #[allow(missing_docs)]
    #[command(flatten)]
    pub common: Common,
}

/// A swatch that nothing holds.
#[derive(Clone, Debug, Args, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Free {
    #[allow(missing_docs)]
    #[command(flatten)]
    pub common: Common,
    /// Columns of loops of the swatch
    #[arg(long, default_value_t = 16, value_parser = clap::value_parser!(u32).range(4..=1000))]
    pub columns: u32,
    /// Rows of loops
    #[arg(long, default_value_t = 16, value_parser = clap::value_parser!(u32).range(4..=1000))]
    pub rows: u32,
}

/// What all tests share.
#[derive(Clone, Debug, Args, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Common {
    /// Fabric files that `wale fit` has fitted, or cards; by contacts and by yarns, scenes too
    #[arg(required = true, value_name = "FABRIC")]
    #[serde(skip)]
    pub fabrics: Vec<PathBuf>,
    /// Model of the fabric that is tested; the one that suits the test best if left out, mostly the shell
    #[arg(long, value_enum, value_name = "MODEL")]
    pub by: Option<By>,
    #[allow(missing_docs)]
    #[command(flatten)]
    #[serde(skip)]
    pub results: Results,
    /// Print the test as questions, JSON lines, one for each fabric and direction; with `--tell`, those without an answer
    #[arg(long)]
    #[serde(skip)]
    pub ask: bool,
    /// Take answers of `wale lab --answer`, JSON lines of a file or of standard input (`-`), in place of testing
    #[arg(long, value_name = "FILE")]
    #[serde(skip)]
    pub tell: Option<PathBuf>,
    /// Mass by area in place of the card's, such as "170 g/m^2"
    #[arg(long, value_name = "MASS", value_parser = positive::<ArealMass>)]
    pub areal_mass: Option<f64>,
    /// Bending rigidity B, as instruments report it, in all directions in place of the card's, such as "0.05 gf cm^2/cm"
    #[arg(long, value_name = "RIGIDITY", value_parser = positive::<SheetBending>)]
    pub bending: Option<f64>,
}

/// What stands for a fabric.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum By {
    /// A thin shell
    Shell,
    /// A periodic tile of yarns in full contact
    Tile,
    /// A periodic tile of the contact model
    Contacts,
    /// All yarns of a specimen, in the contact model, with friction
    Yarns,
}

/// A test that has a direction and no other choice.
#[derive(Clone, Debug, Args, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Directed {
    #[allow(missing_docs)]
    #[command(flatten)]
    pub common: Common,
    /// weft (course), bias, warp (wale), or an angle from the weft such as "30 deg"; may be repeated. All three if left out, but for
    /// picture frames (weft) and tests by yarns and on the bias of KES shear (weft and warp)
    #[arg(long, value_name = "DIRECTION", value_parser = direction, allow_hyphen_values = true)]
    pub direction: Vec<f64>,
}

/// Of a rectangular specimen.
#[derive(Clone, Debug, Args, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Size {
    /// Length of the specimen, such as "10 cm"
    #[arg(long, value_parser = positive::<Length>)]
    pub length: Option<f64>,
    /// Width of the specimen
    #[arg(long, value_parser = positive::<Length>)]
    pub width: Option<f64>,
}

/// `wale lab stretch`, `wale lab strip`
#[derive(Clone, Debug, Args, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stretch {
    #[allow(missing_docs)]
    #[command(flatten)]
    pub directed: Directed,
    #[allow(missing_docs)]
    #[command(flatten)]
    pub size: Size,
    /// Stretch at which to end, such as "30 %"; left out, 5 N of a swatch 6 cm wide, 500 gf/cm of a strip
    #[arg(long, value_name = "STRETCH", value_parser = stretch)]
    pub to: Option<f64>,
    /// Let it leave its plane and wrinkle; needs bending
    #[arg(long)]
    pub wrinkle: bool,
}

/// `wale lab cantilever`
#[derive(Clone, Debug, Args, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cantilever {
    #[allow(missing_docs)]
    #[command(flatten)]
    pub directed: Directed,
    /// Width of the strip; 25 mm if left out
    #[arg(long, value_parser = positive::<Length>)]
    pub width: Option<f64>,
    /// Slope to which the end sinks
    #[arg(long, default_value = "41.5 deg", value_parser = positive::<Angle>)]
    pub slope: f64,
}

/// `wale lab pear-loop`
#[derive(Clone, Debug, Args, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PearLoop {
    #[allow(missing_docs)]
    #[command(flatten)]
    pub directed: Directed,
    #[allow(missing_docs)]
    #[command(flatten)]
    pub size: Size,
    /// Distance of the clamps, such as "10 mm"; may be repeated. Seven from 3 to 34 mm if left out
    #[arg(long, value_parser = positive::<Length>)]
    pub distance: Vec<f64>,
    /// Which way the weight pulls the loop
    #[arg(long, value_enum, default_value_t = Gravity::Down)]
    pub gravity: Gravity,
    /// How the clamps hold the strip
    #[arg(long, value_enum, default_value_t = Clamps::Facing)]
    pub clamps: Clamps,
}

/// Which way weight pulls.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Gravity {
    /// The loop hangs from the clamps
    Down,
    /// The loop stands on the clamps
    Up,
    /// The loop has no weight
    None,
}

/// How clamps hold a strip.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Clamps {
    /// The strip leaves them towards each other
    Facing,
    /// The strip leaves them side by side, downward
    SideBySide,
}

/// `wale lab drape`
#[derive(Clone, Debug, Args, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drape {
    #[allow(missing_docs)]
    #[command(flatten)]
    pub common: Common,
    /// Diameter of the specimen: 24 cm for limp fabrics, 36 cm for stiff ones
    #[arg(long, default_value = "30 cm", value_parser = positive::<Length>)]
    pub specimen: f64,
    /// Diameter of the support
    #[arg(long, default_value = "18 cm", value_parser = positive::<Length>)]
    pub support: f64,
    /// Edge length of the mesh
    #[arg(long, default_value = "7 mm", value_parser = positive::<Length>)]
    pub edge: f64,
    /// Drapes from so many different small pushes; folds depend on them
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub starts: u32,
}

/// `wale lab picture-frame`
#[derive(Clone, Debug, Args, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PictureFrame {
    #[allow(missing_docs)]
    #[command(flatten)]
    pub directed: Directed,
    /// Length of the bars
    #[arg(long, default_value = "20 cm", value_parser = positive::<Length>)]
    pub side: f64,
    /// Largest angle of shear
    #[arg(long, default_value = "45 deg", value_parser = positive::<Angle>)]
    pub to: f64,
}

/// `wale lab bias-extension`
#[derive(Clone, Debug, Args, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BiasExtension {
    #[allow(missing_docs)]
    #[command(flatten)]
    pub common: Common,
    #[allow(missing_docs)]
    #[command(flatten)]
    pub size: Size,
    /// Largest angle of shear
    #[arg(long, default_value = "40 deg", value_parser = positive::<Angle>)]
    pub to: f64,
}

/// A stretch at which a test ends \[–\].
fn stretch(text: &str) -> Result<f64, String> {
    let stretch = positive::<Ratio>(text)?;
    if (LEAST_STRETCH..=MOST_STRETCH).contains(&stretch) {
        Ok(stretch)
    } else {
        Err("write 0.1 % to 1000 %".to_owned())
    }
}

/// The angle of a direction from the weft \[rad\].
fn direction(text: &str) -> Result<f64, String> {
    let degrees = match text {
        "weft" | "course" => 0.0,
        "bias" => 45.0,
        "warp" | "wale" => 90.0,
        _ => quantity::<Angle, Any>(text)
            .ok()
            .map(f64::to_degrees)
            .filter(|angle| (-90.0..=180.0).contains(angle))
            .ok_or("write weft, bias, warp, or an angle such as \"30 deg\"")?,
    };
    Ok(degrees.to_radians())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_and_sizes_are_read_with_their_units() {
        assert_eq!(direction("wale"), Ok(90f64.to_radians()));
        assert!((direction("30 deg").unwrap().to_degrees() - 30.0).abs() < 1e-12);
        assert!(direction("weave").unwrap_err().contains("30 deg"));
        assert!(direction("300 deg").is_err());
        assert!((positive::<Length>("5 cm").unwrap() - 0.05).abs() < 1e-15);
        assert_eq!(stretch("30 %"), Ok(0.3));
        assert!(stretch("1e9").is_err() && stretch("1e-9 %").unwrap_err().contains("1000 %"));
        assert!((positive::<SheetBending>("1 gf cm^2/cm").unwrap() - 9.806_65e-5).abs() < 1e-18);
        for bad in ["5", "-5 cm", "cm", "0 m"] {
            let error = positive::<Length>(bad).unwrap_err();
            assert!(!error.contains('\n') && !error.is_empty(), "{bad}: {error}");
        }
    }
}
