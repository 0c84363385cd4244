//! What columns hold, and what is said of them beyond their heads.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::units::Kind;

/// What a column holds.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Meaning {
    /// Force on the clamps.
    Force,
    /// Force for each length of clamped width.
    LineForce,
    /// Deformed over undeformed length, less one.
    Stretch,
    /// Deformed length less undeformed length.
    Extension,
    /// One less deformed over undeformed width.
    Compression,
    /// Deformed over undeformed width, less one: compression with its sign turned.
    TransverseStrain,
    /// Deformed width.
    Width,
    /// Distance of the clamps of a loop.
    ClampDistance,
    /// Height of a loop over its width.
    AspectRatio,
}

impl Meaning {
    /// Name, as in a fabric file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Force => "force",
            Self::LineForce => "line_force",
            Self::Stretch => "stretch",
            Self::Extension => "extension",
            Self::Compression => "compression",
            Self::TransverseStrain => "transverse_strain",
            Self::Width => "width",
            Self::ClampDistance => "clamp_distance",
            Self::AspectRatio => "aspect_ratio",
        }
    }

    pub(super) fn kind(self) -> Kind {
        match self {
            Self::Force => Kind::Force,
            Self::LineForce => Kind::LineForce,
            Self::Stretch | Self::Compression | Self::TransverseStrain | Self::AspectRatio => Kind::Ratio,
            Self::Extension | Self::Width | Self::ClampDistance => Kind::Length,
        }
    }

    /// What heads of such columns say: one of these begins or is the head, in lower case and with spaces.
    pub(super) fn words(self) -> &'static [&'static str] {
        match self {
            Self::Force => &["force", "load", "standard force", "kraft", "standardkraft", "last"],
            Self::LineForce => &["line force", "force per width", "line tension", "tension"],
            Self::Stretch => &["stretch", "strain", "tensile strain", "axial strain", "elongation", "dehnung"],
            Self::Extension => {
                &["extension", "displacement", "tensile displacement", "elongation", "crosshead", "weg", "standardweg"]
            }
            Self::Compression => &["compression", "contraction", "transverse contraction", "orthogonal compression"],
            Self::TransverseStrain => &["transverse strain", "lateral strain", "width strain", "querdehnung"],
            Self::Width => &["width", "deformed width", "breite"],
            Self::ClampDistance => &["clamp distance", "inter clamp distance", "distance"],
            Self::AspectRatio => &["aspect ratio", "ratio", "h/p"],
        }
    }
}

/// A column, by its head or its number, from 1.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ColumnName {
    /// Its number, from 1.
    Number(usize),
    /// Its head, in full or without its unit.
    Head(String),
}

/// What is asked of a table beyond what its heads tell.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Request {
    /// Columns that are given; others are found by their heads.
    pub columns: BTreeMap<Meaning, ColumnName>,
    /// Units that are given; others are in the heads.
    pub units: BTreeMap<Meaning, String>,
    /// Only rows with these words in these columns.
    pub only: BTreeMap<String, String>,
}
