//! The words of a fabric file.

use std::collections::BTreeMap;

use serde::Deserialize;
use wale::scene::dimensions::{Force, Length, LinearDensity, Ratio};
use wale::scene::units::{Dimension, Fraction, Positive, Quantity};

use super::known::{HeldText, WithinText};
use crate::card_file::SheetBending;
use crate::curve::{ColumnName, Decimal, Delimiter, Meaning};

/// Mass per area \[kg/m²\].
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ArealMass;

impl Dimension for ArealMass {
    const NAME: &'static str = "an areal mass";
    const SI: &'static str = "kg/m^2";
    const UNITS: &'static [(&'static str, f64)] = &[("kg/m^2", 1.0), ("g/m^2", 1e-3), ("gsm", 1e-3)];
    const EXAMPLE: &'static str = "\"170 g/m^2\"";
    const LARGEST: f64 = 10.0;
}

/// A whole file.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FabricText {
    /// Version of the format; 1.
    pub schema: u32,
    /// What the fabric is called.
    pub title: Option<String>,
    /// Mass of the fabric.
    pub areal_mass: Option<Quantity<ArealMass, Positive>>,
    /// Numbers of this file that were not measured of this fabric, each with where it is from.
    #[serde(default)]
    pub assumed: Vec<String>,
    /// What it is made of.
    #[serde(default)]
    pub yarn: Vec<YarnText>,
    /// How its yarns lie.
    pub structure: Option<StructureText>,
    /// Stretch tests.
    #[serde(default)]
    pub stretch: Vec<TestText>,
    /// Pear-loop tests.
    #[serde(default)]
    pub bending: Vec<TestText>,
    /// Bending rigidities that an instrument printed.
    #[serde(default)]
    pub rigidity: Vec<RigidityText>,
    /// Numbers of the yarn that are not fitted.
    #[serde(default)]
    pub held: HeldText,
    /// Bounds of others.
    #[serde(default)]
    pub within: WithinText,
}

/// A bending rigidity `B`, as KES-FB2, FAST or a cantilever print it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RigidityText {
    /// As of a test.
    pub direction: String,
    /// What was printed: "0.1 gf cm^2/cm".
    pub value: Quantity<SheetBending, Positive>,
}

/// A yarn of the fabric.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct YarnText {
    /// What it is called.
    pub name: String,
    /// Its mass by length, not stretched.
    pub linear_density: Quantity<LinearDensity, Positive>,
    /// Filaments in it.
    pub filaments: Option<u32>,
    /// Part of the fabric's mass.
    pub share: Option<Quantity<Ratio, Fraction>>,
    /// Force for each strain, as measured up to 5 cN.
    pub stiffness: Option<Quantity<Force, Positive>>,
    /// What its fibres are coated with.
    pub finish: Option<String>,
}

/// How the yarns lie: a file with the geometry of a periodic tile, or a scene whose chart or draft is worked.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StructureText {
    /// A periodic tile of yarns, in the format `.pyp`.
    pub tile: Option<String>,
    /// A scene of wale.
    pub scene: Option<String>,
    /// Distance of neighbouring wales of the real fabric, if it is not that of the relaxed scene.
    pub wale_spacing: Option<Quantity<Length, Positive>>,
    /// Likewise of neighbouring courses.
    pub course_spacing: Option<Quantity<Length, Positive>>,
}

/// A test of one specimen.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TestText {
    /// "weft" (or "course"), "bias", "warp" (or "wale"), or an angle from the weft such as "30 deg".
    pub direction: String,
    /// A table of numbers beside the fabric file.
    pub file: String,
    /// Length of the specimen between its clamps; 100 mm if left out.
    pub length: Option<Quantity<Length, Positive>>,
    /// Its width; 60 mm if left out.
    pub width: Option<Quantity<Length, Positive>>,
    /// Whether the table is of uniform stretch without stress across, and not of a swatch between clamps: values of a published model,
    /// or of a strain field that a camera saw. Only for stretch.
    #[serde(default)]
    pub uniform: bool,
    /// What separates the cells of the table, where it does not tell: ",", ";", "|" or "\t".
    pub delimiter: Option<Delimiter>,
    /// The sign before its decimals, where it does not tell: "." or ",".
    pub decimal: Option<Decimal>,
    /// Which column is what, by its head or its number from 1, where the heads do not tell: `{ force = "Load", stretch = 3 }`.
    #[serde(default)]
    pub columns: BTreeMap<Meaning, ColumnName>,
    /// Units that the heads do not tell: `{ force = "cN" }`.
    #[serde(default)]
    pub units: BTreeMap<Meaning, String>,
    /// Only rows with these words: `{ trial = "2" }`.
    #[serde(default)]
    pub only: BTreeMap<String, String>,
}
