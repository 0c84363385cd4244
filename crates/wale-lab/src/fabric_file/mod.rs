//! Fabric files: what is known of a real fabric, in TOML, with the tables of its tests beside it [Sperl2022, section 4.4].
//!
//! ```toml
//! schema = 1
//! title = "Single jersey"
//! areal_mass = "170 g/m^2"
//!
//! [[yarn]]
//! name = "polyester"
//! linear_density = "72 den"
//! filaments = 75
//! share = "90 %"
//!
//! [structure]
//! scene = "jersey.toml"
//!
//! [[stretch]]
//! direction = "weft"
//! file = "weft.csv"
//! length = "100 mm"
//! width = "60 mm"
//! ```

mod known;
mod resolve;
mod schema;

pub use known::KnownNumbers;
pub use schema::ArealMass;

use std::path::{Path, PathBuf};

use thiserror::Error;
use wale::scene::{ErrorClass, Scene, SceneError, TextFile};

use crate::curve::{CurveError, LoopCurve, Specimen, StretchCurve};

/// Version of the format.
pub const SCHEMA: u32 = 1;

/// A fabric and what was measured of it, in SI units.
#[derive(Clone, Debug)]
pub struct FabricFile {
    /// What it is called, perhaps nothing.
    pub title: String,
    /// Mass per area \[kg/m²\], if known.
    pub areal_mass: Option<f64>,
    /// What of all this was not measured of this fabric, in words.
    pub assumed: Vec<String>,
    /// What it is made of.
    pub yarns: Vec<Yarn>,
    /// How its yarns lie, if known.
    pub structure: Option<Structure>,
    /// Distance of neighbouring wales, and of neighbouring courses \[m\], where they were measured.
    pub spacing: [Option<f64>; 2],
    /// Stretch tests, by direction.
    pub stretch: Vec<StretchTest>,
    /// Pear-loop tests, by direction.
    pub bending: Vec<LoopTest>,
    /// Bending rigidities that instruments printed, by direction.
    pub rigidity: Vec<Rigidity>,
    /// Numbers of its yarn that are known, or known to lie within bounds.
    pub known: KnownNumbers,
    /// The fabric file and all others that were opened for it.
    pub inputs: Vec<PathBuf>,
}

/// A yarn of a fabric.
#[derive(Clone, Debug, PartialEq)]
pub struct Yarn {
    /// What it is called.
    pub name: String,
    /// Mass by length \[kg/m\].
    pub linear_density: f64,
    /// Filaments in it, if known.
    pub filaments: Option<u32>,
    /// Part of the fabric's mass \[–\], if known.
    pub share: Option<f64>,
    /// Force for each strain up to 5 cN \[N\], if measured.
    pub stiffness: Option<f64>,
    /// What its fibres are coated with, if anything.
    pub finish: Option<String>,
}

/// How yarns lie.
#[derive(Clone, Debug)]
pub enum Structure {
    /// In a file with the geometry of a periodic tile.
    Tile(PathBuf),
    /// As the chart or draft of a scene is worked.
    Scene(Box<Scene>),
}

/// A stretch test of one specimen.
#[derive(Clone, Debug, PartialEq)]
pub struct StretchTest {
    /// Angle of the pull from the weft \[rad\].
    pub direction: f64,
    /// What was clamped; of uniform stretch, a metre of width.
    pub specimen: Specimen,
    /// Whether it was stretched uniformly, without stress across, and not between clamps.
    pub uniform: bool,
    /// What was measured.
    pub curve: StretchCurve,
}

/// A pear-loop test of one specimen.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopTest {
    /// Angle of the specimen's length from the weft \[rad\].
    pub direction: f64,
    /// What was clamped.
    pub specimen: Specimen,
    /// What was measured.
    pub curve: LoopCurve,
}

/// A bending rigidity that an instrument printed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rigidity {
    /// Angle of the curvature from the weft \[rad\].
    pub direction: f64,
    /// Moment a width for each curvature \[N·m\].
    pub value: f64,
}

/// Why a fabric cannot be had.
#[derive(Clone, Debug, Error)]
pub enum FabricFileError {
    /// Something is wrong in the fabric file, or in a scene that it names.
    #[error(transparent)]
    Fabric(#[from] SceneError),
    /// Something is wrong in a table that it names.
    #[error(transparent)]
    Curve(#[from] CurveError),
}

impl FabricFileError {
    /// What kind of error this is.
    #[must_use]
    pub fn class(&self) -> ErrorClass {
        match self {
            Self::Fabric(error) => error.class(),
            Self::Curve(_) => ErrorClass::BadInput,
        }
    }
}

impl FabricFile {
    /// Reads a fabric file and what it names.
    ///
    /// # Errors
    /// If one cannot be read, or something in them is wrong.
    pub fn read(path: &Path) -> Result<Self, FabricFileError> {
        resolve::fabric(path, &TextFile::read(path, "fabric file")?)
    }

    /// Angles from the weft \[rad\] of weft, bias and warp, as far as no stretch test was made along them.
    pub fn unstretched(&self) -> impl Iterator<Item = f64> {
        let untested = |degrees: &f64| !self.stretch.iter().any(|test| is_along(test.direction, *degrees));
        DIRECTIONS.into_iter().map(|(_, degrees)| degrees).filter(untested).map(f64::to_radians)
    }

    /// What the tests leave open, in words: directions that none was made in, and curves without compression.
    #[must_use]
    pub fn gaps(&self) -> Vec<String> {
        let mut gaps = Vec::new();
        for (name, degrees) in DIRECTIONS {
            let near = |direction: f64| is_along(direction, degrees);
            let of: Vec<_> = self.stretch.iter().filter(|test| near(test.direction)).collect();
            if of.is_empty() {
                gaps.push(format!("no stretch test along the {name}"));
            } else if of.iter().all(|test| test.curve.compression.is_none()) {
                gaps.push(format!("no orthogonal compression along the {name}"));
            }
            let loops = self.bending.iter().any(|test| near(test.direction));
            if !loops && !self.rigidity.iter().any(|test| near(test.direction)) {
                gaps.push(format!("no bending test along the {name}"));
            }
        }
        gaps
    }
}

/// Whether a direction \[rad\] is one of so many degrees: tests are cut by hand.
fn is_along(direction: f64, degrees: f64) -> bool {
    (direction.to_degrees() - degrees).abs() < 1.0
}

/// Directions with a name, and their angle from the weft \[°\].
const DIRECTIONS: [(&str, f64); 3] = [("weft", 0.0), ("bias", 45.0), ("warp", 90.0)];

/// A direction in words: its name if it has one, or its angle from the weft.
#[must_use]
pub fn direction_name(radians: f64) -> String {
    let degrees = radians.to_degrees();
    let named = DIRECTIONS.iter().find(|(_, known)| (degrees - known).abs() < 1e-9);
    named.map_or_else(|| format!("{}°", (1e3 * degrees).round() / 1e3), |(name, _)| (*name).to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_have_names() {
        assert_eq!(direction_name(0.0), "weft");
        assert_eq!(direction_name(45f64.to_radians()), "bias");
        assert_eq!(direction_name(0.5), "28.648°");
    }
}
