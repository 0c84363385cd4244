//! A pear-loop test: aspect ratio by distance of the clamps [Sperl2022, section 4.3].

use super::columns::Meaning;
use super::find::{column, rows};
use super::stretch::needed;
use super::{CurveError, Request, Specimen, Table};

/// Fewest loops of a curve. Each says one number and the fit looks for one stiffness a direction, so that a single loop is met by
/// whatever it says: its error would be nothing, and no slip would be seen.
const FEWEST: usize = 2;

/// A measured curve of a pear-loop test, in the order in which the clamps went.
#[derive(Clone, PartialEq, Debug)]
pub struct LoopCurve {
    /// Distance of the clamps, rising or falling \[m\].
    pub distance: Vec<f64>,
    /// Height of the loop over its width \[–\].
    pub aspect_ratio: Vec<f64>,
    /// How each column was read.
    pub read_as: Vec<String>,
    /// How the table was read: delimiter, decimal sign, lines before the numbers, and rows.
    pub table_read_as: String,
}

impl LoopCurve {
    /// The curve that a table holds, in the order of its rows.
    ///
    /// # Errors
    /// If columns are missing, contradict each other or themselves, a cell is no finite positive number, clamps are as far apart as
    /// the specimen is long, distances repeat or turn back, or there are fewer than two loops.
    pub fn of(table: &Table, request: &Request, specimen: Specimen) -> Result<Self, CurveError> {
        let distance = needed(table, column(table, request, Meaning::ClampDistance)?, "clamp_distance")?;
        let ratio = needed(table, column(table, request, Meaning::AspectRatio)?, "aspect_ratio")?;
        let read_as = vec![distance.read_as.clone(), ratio.read_as.clone()];
        let chosen = rows(table, request)?;
        let table_read_as = table.read_as(request, chosen.len());
        let mut curve = Self { distance: Vec::new(), aspect_ratio: Vec::new(), read_as, table_read_as };
        for row in chosen {
            let line = Some(row.0);
            let (d, r) = (distance.value(table, row)?, ratio.value(table, row)?);
            if !(d > 0.0 && r > 0.0) {
                let what = format!("a distance of {d} m with a ratio of {r} cannot be");
                return Err(table.error(line, what, "both are positive"));
            }
            if d >= specimen.length {
                let what = format!("clamps {d} m apart pull a specimen of {} m straight", specimen.length);
                return Err(table.error(line, what, "is the unit of that column right, and the specimen's length?"));
            }
            // Two trials in one table would be one curve that goes to and fro.
            if let Some(&before) = curve.distance.last()
                && (d == before || (d > before) != (curve.distance.get(1).unwrap_or(&d) > &curve.distance[0]))
            {
                let what = format!("the distance of the clamps goes from {before} m to {d} m, not on");
                let mend =
                    "give the loops of one trial, from near to far or from far to near, or choose rows with `only`";
                return Err(table.error(line, what, mend));
            }
            curve.distance.push(d);
            curve.aspect_ratio.push(r);
        }
        if curve.distance.len() < FEWEST {
            let what = "has one loop".to_owned();
            return Err(table.error(None, what, "a curve needs two: one alone is met by any fit"));
        }
        Ok(curve)
    }
}
