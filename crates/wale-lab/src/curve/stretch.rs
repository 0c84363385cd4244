//! A stretch test: force, stretch and orthogonal compression [Sperl2022, section 4.3].

use super::columns::Meaning;
use super::find::{Column, column, rows};
use super::{CurveError, Request, Table};

/// Fewest samples of a curve.
const FEWEST: usize = 3;
/// Largest stretch that is believed: the fabric is a thing of this world \[–\].
const LARGEST_STRETCH: f64 = 10.0;
/// Largest stretch that is believed of a column without a unit; beyond it, per cent are likelier \[–\].
const LARGEST_WITHOUT_UNIT: f64 = 2.0;
/// Force below zero that is taken for the noise of a load cell, over the largest force \[–\].
const FORCE_NOISE: f64 = 0.05;

/// A rectangular specimen without what is clamped \[m\].
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Specimen {
    /// Along the pull.
    pub length: f64,
    /// Across it.
    pub width: f64,
}

/// A measured curve of a stretch test, in order of stretch.
#[derive(Clone, PartialEq, Debug)]
pub struct StretchCurve {
    /// Deformed over undeformed length, less one \[–\].
    pub stretch: Vec<f64>,
    /// Force on the clamps \[N\].
    pub force: Vec<f64>,
    /// One less deformed over undeformed width \[–\], if it was measured.
    pub compression: Option<Vec<f64>>,
    /// How each column was read, to be shown to whoever asked.
    pub read_as: Vec<String>,
    /// How the table was read: delimiter, decimal sign, lines before the numbers, and rows.
    pub table_read_as: String,
}

impl StretchCurve {
    /// The curve that a table holds.
    ///
    /// # Errors
    /// If columns are missing, contradict each other or themselves, a cell is no finite number, stretch decreases or exceeds 2 in a
    /// column without a unit, the fabric pushes, a compression leaves no width, or there are fewer than three samples.
    pub fn of(table: &Table, request: &Request, specimen: Specimen) -> Result<Self, CurveError> {
        // What was asked for goes before what is found.
        let first_of = |mut meanings: Vec<Meaning>| -> Result<Option<(Meaning, Column)>, CurveError> {
            meanings.sort_by_key(|meaning| !request.columns.contains_key(meaning));
            for meaning in meanings {
                if let Some(column) = column(table, request, meaning)? {
                    return Ok(Some((meaning, column)));
                }
            }
            Ok(None)
        };
        let along = first_of(vec![Meaning::Stretch, Meaning::Extension])?;
        let (along, stretch) = needed(table, along, "stretch or extension")?;
        let pull = first_of(vec![Meaning::Force, Meaning::LineForce])?;
        let (pull, force) = needed(table, pull, "force or line_force")?;
        let transverse = first_of(vec![Meaning::Compression, Meaning::TransverseStrain, Meaning::Width])?;
        let (by_length, by_width) = (along == Meaning::Extension, pull == Meaning::LineForce);
        let chosen = rows(table, request)?;
        let mut curve = Self {
            stretch: Vec::new(),
            force: Vec::new(),
            compression: transverse.is_some().then(Vec::new),
            read_as: [Some(&stretch), Some(&force), transverse.as_ref().map(|(_, column)| column)]
                .into_iter()
                .flatten()
                .map(|column: &Column| column.read_as.clone())
                .collect(),
            table_read_as: table.read_as(request, chosen.len()),
        };
        for &row in &chosen {
            let line = Some(row.0);
            let s = stretch.value(table, row)? / if by_length { specimen.length } else { 1.0 };
            if let Some(&before) = curve.stretch.last()
                && s < before
            {
                let what = format!("stretch falls from {before:.4} to {s:.4}");
                return Err(table.error(
                    line,
                    what,
                    "give the loading branch of one trial alone, or choose rows with `only`",
                ));
            }
            if s > LARGEST_WITHOUT_UNIT && along == Meaning::Stretch && !stretch.has_unit {
                let what = format!("a stretch of {s} in a column without a unit may be per cent or a ratio");
                let mend = "say which: units = { stretch = \"%\" }, or units = { stretch = \"1\" } for a ratio";
                return Err(table.error(line, what, mend));
            }
            if !(s > -1.0 && s < LARGEST_STRETCH) {
                let what = format!("a stretch of {s:.3} cannot be");
                return Err(table.error(line, what, "is the unit of that column right, and the specimen's length?"));
            }
            curve.stretch.push(s);
            curve.force.push(force.value(table, row)? * if by_width { specimen.width } else { 1.0 });
            if let (Some(values), Some((meaning, column))) = (&mut curve.compression, &transverse) {
                let value = column.value(table, row)?;
                let compression = match meaning {
                    Meaning::Width => 1.0 - value / specimen.width,
                    Meaning::TransverseStrain => -value,
                    _ => value,
                };
                if compression.abs() >= 1.0 {
                    let does = if compression > 0.0 { "leaves no width" } else { "doubles the width" };
                    let mend = if column.has_unit {
                        "is the unit of that column right, and the specimen's width?".to_owned()
                    } else {
                        format!("if it is in per cent, say so: units = {{ {} = \"%\" }}", meaning.name())
                    };
                    return Err(table.error(line, format!("a compression of {compression:.3} {does}"), mend));
                }
                values.push(compression);
            }
        }
        let largest = curve.force.iter().fold(0.0f64, |most, force| most.max(force.abs()));
        if let Some(index) = curve.force.iter().position(|&force| force < -FORCE_NOISE * largest) {
            let what =
                format!("a force of {:.4} N pushes at a stretch of {:.4}", curve.force[index], curve.stretch[index]);
            let mend = "pulls are positive: turn the sign of the column, or take the force at rest from all of it";
            return Err(table.error(Some(chosen[index].0), what, mend));
        }
        if curve.stretch.len() < FEWEST {
            let what = format!("has {} samples", curve.stretch.len());
            return Err(table.error(None, what, "a curve needs three"));
        }
        Ok(curve)
    }

    /// Force \[N\] and compression \[–\] at a stretch, linear between samples and held beyond them.
    #[must_use]
    pub fn at(&self, stretch: f64) -> (f64, Option<f64>) {
        let right = self.stretch.partition_point(|s| *s < stretch).clamp(1, self.stretch.len() - 1);
        let (a, b) = (self.stretch[right - 1], self.stretch[right]);
        let part = if b > a { ((stretch - a) / (b - a)).clamp(0.0, 1.0) } else { 1.0 };
        let between = |values: &[f64]| values[right - 1] + part * (values[right] - values[right - 1]);
        (between(&self.force), self.compression.as_deref().map(between))
    }
}

pub(super) fn needed<T>(table: &Table, found: Option<T>, what: &str) -> Result<T, CurveError> {
    found.ok_or_else(|| {
        let heads: Vec<String> = table.heads().iter().filter(|head| !head.is_empty()).cloned().collect();
        let mend = if heads.is_empty() {
            format!("it has no heads: give columns = {{ {} = NUMBER }}", what.split(' ').next().unwrap_or_default())
        } else {
            format!("say which it is: columns = {{ … = \"{}\" }}", heads[0])
        };
        table.error(None, format!("no column is recognised as {what}"), mend)
    })
}
