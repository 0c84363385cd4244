//! Which column of a table is what, in which unit.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::table::shortened;
use super::units::{Kind, split_head};
use super::{CurveError, Table};

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

    fn kind(self) -> Kind {
        match self {
            Self::Force => Kind::Force,
            Self::LineForce => Kind::LineForce,
            Self::Stretch | Self::Compression | Self::TransverseStrain | Self::AspectRatio => Kind::Ratio,
            Self::Extension | Self::Width | Self::ClampDistance => Kind::Length,
        }
    }

    /// What heads of such columns say: one of these begins or is the head, in lower case and with spaces.
    fn words(self) -> &'static [&'static str] {
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

/// A column that was found.
#[derive(Clone, Debug)]
pub(super) struct Column {
    pub index: usize,
    /// SI units for one of the table's.
    unit_size: f64,
    /// How it was read, to be shown.
    pub read_as: String,
}

impl Column {
    pub fn value(&self, table: &Table, row: &(usize, Vec<String>)) -> Result<f64, CurveError> {
        Ok(table.number(row, self.index)? * self.unit_size)
    }
}

/// The column that holds something; `None` if none does.
///
/// # Errors
/// If it was given and is not there, or its unit is none or not told.
pub(super) fn column(table: &Table, request: &Request, meaning: Meaning) -> Result<Option<Column>, CurveError> {
    let heads: Vec<(String, Option<String>)> = table.heads().iter().map(|head| split_head(head)).collect();
    let plain = |text: &str| text.to_lowercase().replace(['_', '-'], " ");
    let unit_fits = |unit: &Option<String>| unit.as_deref().is_none_or(|unit| meaning.kind().size(unit).is_some());
    let index = match request.columns.get(&meaning) {
        Some(ColumnName::Number(number)) => {
            let count = table.heads().len();
            let index = number.checked_sub(1).filter(|&index| index < count);
            Some(index.ok_or_else(|| {
                table.error(None, format!("has no column {number}"), format!("its columns are 1 to {count}"))
            })?)
        }
        Some(ColumnName::Head(name)) => {
            let found = (0..heads.len())
                .find(|&k| table.heads()[k] == *name)
                .or_else(|| (0..heads.len()).find(|&k| plain(&heads[k].0) == plain(name)));
            Some(found.ok_or_else(|| {
                let known: Vec<String> = table.heads().iter().map(|head| format!("\"{}\"", shortened(head))).collect();
                let what = format!("has no column \"{}\"", shortened(name));
                table.error(None, what, format!("its columns are {}", known.join(", ")))
            })?)
        }
        None => {
            let is = |k: usize, word: &str| plain(&heads[k].0) == word;
            let begins = |k: usize, word: &str| plain(&heads[k].0).starts_with(&format!("{word} "));
            let words = meaning.words();
            let fits = |k: &usize| unit_fits(&heads[*k].1);
            let found = words.iter().find_map(|word| (0..heads.len()).filter(fits).find(|&k| is(k, word)));
            found.or_else(|| words.iter().find_map(|word| (0..heads.len()).filter(fits).find(|&k| begins(k, word))))
        }
    };
    let Some(index) = index else { return Ok(None) };
    let kind = meaning.kind();
    let given = request.units.get(&meaning).or(heads[index].1.as_ref());
    let (unit_size, unit) = match given {
        Some(unit) => {
            let size = kind.size(unit).ok_or_else(|| {
                let what =
                    format!("column {} is {} in \"{}\", no unit of it", index + 1, meaning.name(), shortened(unit));
                table.error(None, what, format!("known: {}", kind.known()))
            })?;
            (size, unit.as_str())
        }
        // A ratio without a unit is one; nothing else is told by itself.
        None if kind == Kind::Ratio => (1.0, "1"),
        None => {
            let what = format!("column {} (\"{}\") has no unit", index + 1, shortened(&table.heads()[index]));
            let mend = format!("give it: units = {{ {} = \"…\" }}, one of {}", meaning.name(), kind.known());
            return Err(table.error(None, what, mend));
        }
    };
    let read_as =
        format!("{}: column {}, \"{}\", in {unit}", meaning.name(), index + 1, shortened(&table.heads()[index]));
    Ok(Some(Column { index, unit_size, read_as }))
}

/// Rows with the words that were asked for.
///
/// # Errors
/// If a column that is asked for is not there, or no row is left.
pub(super) fn rows<'a>(table: &'a Table, request: &Request) -> Result<Vec<&'a (usize, Vec<String>)>, CurveError> {
    let mut left: Vec<&(usize, Vec<String>)> = table.rows().iter().collect();
    for (head, word) in &request.only {
        let index = table.heads().iter().position(|known| known == head).ok_or_else(|| {
            let what = format!("has no column \"{}\" to choose rows by", shortened(head));
            table.error(None, what, format!("its columns are {}", shortened(&table.heads().join(", "))))
        })?;
        left.retain(|(_, cells)| cells.get(index) == Some(word));
        if left.is_empty() {
            let what = format!("no row has \"{}\" in \"{}\"", shortened(word), shortened(head));
            return Err(table.error(None, what, "words are compared letter by letter"));
        }
    }
    Ok(left)
}
