//! A pear-loop test: aspect ratio by distance of the clamps [Sperl2022, section 4.3].

use super::columns::{Meaning, column, rows};
use super::stretch::needed;
use super::{CurveError, Request, Table};

/// A measured curve of a pear-loop test.
#[derive(Clone, PartialEq, Debug)]
pub struct LoopCurve {
    /// Distance of the clamps \[m\].
    pub distance: Vec<f64>,
    /// Height of the loop over its width \[–\].
    pub aspect_ratio: Vec<f64>,
    /// How each column was read.
    pub read_as: Vec<String>,
}

impl LoopCurve {
    /// The curve that a table holds, in the order of its rows.
    ///
    /// # Errors
    /// If columns are missing, or a cell is no finite positive number.
    pub fn of(table: &Table, request: &Request) -> Result<Self, CurveError> {
        let distance = needed(table, column(table, request, Meaning::ClampDistance)?, "clamp_distance")?;
        let ratio = needed(table, column(table, request, Meaning::AspectRatio)?, "aspect_ratio")?;
        let read_as = vec![distance.read_as.clone(), ratio.read_as.clone()];
        let mut curve = Self { distance: Vec::new(), aspect_ratio: Vec::new(), read_as };
        for row in rows(table, request)? {
            let (d, r) = (distance.value(table, row)?, ratio.value(table, row)?);
            if !(d >= 0.0 && r > 0.0) {
                let what = format!("a distance of {d} m with a ratio of {r} cannot be");
                return Err(table.error(Some(row.0), what, "both are positive"));
            }
            curve.distance.push(d);
            curve.aspect_ratio.push(r);
        }
        Ok(curve)
    }
}
