//! The plain charts of knits and purls.

use super::chart::{Chart, ChartError};
use super::stitch::Stitch;

impl Chart {
    /// All knit.
    #[must_use]
    pub fn stockinette() -> Self {
        Self::from_fn(1, 1, |_, _| Stitch::Knit)
    }

    /// All purl: stockinette seen from behind.
    #[must_use]
    pub fn reverse_stockinette() -> Self {
        Self::from_fn(1, 1, |_, _| Stitch::Purl)
    }

    /// Rows knit and purl in turn.
    #[must_use]
    pub fn garter() -> Self {
        Self::from_fn(1, 2, |_, row| knit_if(row == 0))
    }

    /// Columns: `knit` knit ones, then `purl` purl ones.
    ///
    /// # Errors
    /// If there are no columns or too many.
    pub fn rib(knit: usize, purl: usize) -> Result<Self, ChartError> {
        let columns = knit.saturating_add(purl);
        Self::check_size(columns as u64, 1)?;
        Ok(Self::from_fn(columns, 1, |column, _| knit_if(column < knit)))
    }

    /// Knit and purl alternate along both directions.
    #[must_use]
    pub fn seed() -> Self {
        Self::from_fn(2, 2, |column, row| knit_if(column == row))
    }

    /// Knit and purl alternate along the row, and change places every two rows.
    #[must_use]
    pub fn moss() -> Self {
        Self::from_fn(2, 4, |column, row| knit_if(column == row / 2))
    }

    /// Blocks of `columns` × `rows` knits and purls, as on a chessboard.
    ///
    /// # Errors
    /// If a count is zero or the repeat is too large.
    pub fn basket(columns: usize, rows: usize) -> Result<Self, ChartError> {
        Self::check_size(columns as u64, rows as u64)?;
        Self::check_size(2 * columns as u64, 2 * rows as u64)?;
        Ok(Self::from_fn(2 * columns, 2 * rows, |column, row| knit_if((column < columns) == (row < rows))))
    }

    /// Rows: `knit` knit ones, then `purl` purl ones, as seen from the front.
    ///
    /// # Errors
    /// If there are no rows or too many.
    pub fn welting(knit: usize, purl: usize) -> Result<Self, ChartError> {
        let rows = knit.saturating_add(purl);
        Self::check_size(1, rows as u64)?;
        Ok(Self::from_fn(1, rows, |_, row| knit_if(row < knit)))
    }

    /// A small chart, sizes checked by the caller.
    fn from_fn(columns: usize, rows: usize, stitch: impl Fn(usize, usize) -> Stitch) -> Self {
        Self::of_sound((0..rows).map(|row| (0..columns).map(|column| stitch(column, row)).collect()).collect())
    }
}

fn knit_if(knit: bool) -> Stitch {
    if knit { Stitch::Knit } else { Stitch::Purl }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn named_patterns_look_as_knitters_know_them() {
        let drawn = |chart: &Chart| -> Vec<String> {
            chart.rows().iter().map(|row| row.iter().map(|stitch| stitch.symbol()).collect()).collect()
        };
        assert_eq!(drawn(&Chart::garter()), ["k", "p"]);
        assert_eq!(drawn(&Chart::rib(2, 1).unwrap()), ["kkp"]);
        assert_eq!(drawn(&Chart::seed()), ["kp", "pk"]);
        assert_eq!(drawn(&Chart::moss()), ["kp", "kp", "pk", "pk"]);
        assert_eq!(drawn(&Chart::basket(2, 1).unwrap()), ["kkpp", "ppkk"], "blocks change places");
        assert_eq!(drawn(&Chart::welting(2, 1).unwrap()), ["k", "k", "p"]);
        assert!(Chart::rib(0, 0).is_err());
        assert!(Chart::rib(usize::MAX, 1).is_err());
        assert!(Chart::basket(usize::MAX, usize::MAX).is_err());
    }
}
