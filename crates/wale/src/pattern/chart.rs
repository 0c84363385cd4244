//! A stitch chart: which stitch stands where, as seen from the front of the fabric.

use std::fmt;

use thiserror::Error;

/// A stitch as seen from the front (right side) of the fabric.
///
/// Later work adds decreases, increases and yarn-overs, hence the open end.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Stitch {
    /// The new loop comes through its parent from back to front: legs in front, head behind.
    Knit,
    /// The new loop comes through its parent from front to back: head in front, legs behind.
    Purl,
}

impl Stitch {
    /// The same stitch seen from the other side of the fabric.
    #[must_use]
    pub fn from_behind(self) -> Self {
        match self {
            Self::Knit => Self::Purl,
            Self::Purl => Self::Knit,
        }
    }

    /// The symbol that charts and listings of this program print.
    #[must_use]
    pub fn symbol(self) -> char {
        match self {
            Self::Knit => 'k',
            Self::Purl => 'p',
        }
    }
}

/// A side of the fabric.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Default)]
pub enum Side {
    /// The front: the side that charts show.
    #[default]
    RightSide,
    /// The back.
    WrongSide,
}

/// How rows follow each other on the needles. It decides the course of the yarn, never the look of the front.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash)]
pub enum Working {
    /// Back and forth: the yarn turns at the selvedges. Right-side rows run right to left as seen from the front,
    /// wrong-side rows left to right.
    Flat {
        /// The side that faces the knitter while the first row above the cast-on is worked.
        first_row: Side,
    },
    /// In the round: a tube; every row runs right to left as seen from its outside, which is the front.
    Round,
}

impl Default for Working {
    fn default() -> Self {
        Self::Flat { first_row: Side::RightSide }
    }
}

impl Working {
    /// The side that faces the knitter in a row (counted from 0, the first row above the cast-on).
    #[must_use]
    pub fn side(self, row: usize) -> Side {
        match self {
            Self::Round => Side::RightSide,
            Self::Flat { first_row } => match (first_row, row.is_multiple_of(2)) {
                (side, true) => side,
                (Side::RightSide, false) => Side::WrongSide,
                (Side::WrongSide, false) => Side::RightSide,
            },
        }
    }

    /// Whether the yarn of a row runs from the left edge to the right edge as seen from the front.
    #[must_use]
    pub fn left_to_right(self, row: usize) -> bool {
        self.side(row) == Side::WrongSide
    }
}

/// Why rows of stitches are no chart.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
pub enum ChartError {
    /// There is no row.
    #[error("the chart has no rows")]
    NoRows,
    /// A row has no stitch.
    #[error("row {} of the chart is empty", .row + 1)]
    EmptyRow {
        /// Row, counted from 0 at the cast-on.
        row: usize,
    },
    /// A row is longer or shorter than the first.
    #[error("row {} has {found} stitches, the rows below it have {expected}", .row + 1)]
    Ragged {
        /// Row, counted from 0 at the cast-on.
        row: usize,
        /// Its stitches.
        found: usize,
        /// The stitches of the first row.
        expected: usize,
    },
    /// More loops than [`Chart::MAX_LOOPS`].
    #[error("{columns} columns × {rows} rows are {} loops, the limit is {}", u128::from(*.columns) * u128::from(*.rows), Chart::MAX_LOOPS)]
    TooLarge {
        /// Columns asked for.
        columns: u64,
        /// Rows asked for.
        rows: u64,
    },
}

/// A rectangle of stitches as seen from the front of the fabric.
///
/// Row 0 is the first row worked above the cast-on; column 0 is the leftmost. There is at least one row and one
/// column, every row has the same number of columns, and there are at most [`Chart::MAX_LOOPS`] loops.
#[derive(Clone, PartialEq, Eq, Hash)]
pub struct Chart {
    /// `rows[row][column]`.
    pub(crate) rows: Vec<Vec<Stitch>>,
}

impl Chart {
    /// Most loops that a chart may have: four nodes a loop must keep every index of the network within 32 bits, and
    /// a fabric of this size already needs some 0.4 TB.
    pub const MAX_LOOPS: u64 = 16_000_000;

    /// Checks rows of stitches, the first row worked first, each from left to right as seen from the front.
    ///
    /// # Errors
    /// If there are no rows, a row is empty, the rows are of unequal length, or there are too many loops.
    pub fn new(rows: Vec<Vec<Stitch>>) -> Result<Self, ChartError> {
        let expected = rows.first().ok_or(ChartError::NoRows)?.len();
        for (row, stitches) in rows.iter().enumerate() {
            let found = stitches.len();
            if found == 0 {
                return Err(ChartError::EmptyRow { row });
            }
            if found != expected {
                return Err(ChartError::Ragged { row, found, expected });
            }
        }
        Self::check_size(expected as u64, rows.len() as u64)?;
        Ok(Self { rows })
    }

    /// Refuses a size before anything is allocated for it.
    ///
    /// # Errors
    /// If a count is zero, or the loops are more than [`Chart::MAX_LOOPS`].
    pub fn check_size(columns: u64, rows: u64) -> Result<(), ChartError> {
        if rows == 0 {
            return Err(ChartError::NoRows);
        }
        if columns == 0 {
            return Err(ChartError::EmptyRow { row: 0 });
        }
        if u128::from(columns) * u128::from(rows) > u128::from(Self::MAX_LOOPS) {
            return Err(ChartError::TooLarge { columns, rows });
        }
        Ok(())
    }

    /// The rows from the cast-on upwards, each from left to right as seen from the front.
    #[must_use]
    pub fn rows(&self) -> &[Vec<Stitch>] {
        &self.rows
    }

    /// Number of rows (courses).
    #[must_use]
    pub fn row_count(&self) -> usize {
        self.rows.len()
    }

    /// Number of columns (wales).
    #[must_use]
    pub fn column_count(&self) -> usize {
        self.rows[0].len()
    }

    /// Number of loops.
    #[must_use]
    pub fn loop_count(&self) -> usize {
        self.row_count() * self.column_count()
    }

    /// The chart repeated side by side and upwards to a total size, cut off where the size is no multiple.
    ///
    /// # Errors
    /// If a count is zero or the loops are too many.
    pub fn repeat(&self, columns: usize, rows: usize) -> Result<Self, ChartError> {
        Self::check_size(columns as u64, rows as u64)?;
        let row = |r: usize| -> Vec<Stitch> {
            let source = &self.rows[r % self.row_count()];
            source.iter().copied().cycle().take(columns).collect()
        };
        Ok(Self { rows: (0..rows).map(row).collect() })
    }

    /// The smallest rectangle that, repeated, gives this chart again.
    ///
    /// A repeat that does not divide the chart counts when the chart shows at least two whole ones of it.
    #[must_use]
    pub fn smallest_repeat(&self) -> Self {
        let columns = smallest_period(self.column_count(), |a, b| self.rows.iter().all(|row| row[a] == row[b]));
        let rows = smallest_period(self.row_count(), |a, b| self.rows[a] == self.rows[b]);
        Self { rows: self.rows[..rows].iter().map(|row| row[..columns].to_vec()).collect() }
    }

    /// Knit–purl changes from one stitch to the next within a row, per stitch, of the chart repeated side by side.
    #[must_use]
    pub fn transitions_per_stitch(&self) -> f64 {
        let columns = self.column_count();
        let changes: usize =
            self.rows.iter().map(|row| (0..columns).filter(|&c| row[c] != row[(c + 1) % columns]).count()).sum();
        changes as f64 / self.loop_count() as f64
    }

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
        Self { rows: (0..rows).map(|row| (0..columns).map(|column| stitch(column, row)).collect()).collect() }
    }
}

impl fmt::Debug for Chart {
    /// As charts are printed: the last row on top.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for row in self.rows.iter().rev() {
            writeln!(f)?;
            for stitch in row {
                write!(f, "{}", stitch.symbol())?;
            }
        }
        Ok(())
    }
}

fn knit_if(knit: bool) -> Stitch {
    if knit { Stitch::Knit } else { Stitch::Purl }
}

/// Smallest period of a sequence of length `n ≥ 1` that divides it or fits in it twice.
///
/// The failure function of Knuth, Morris and Pratt: every period of the sequence is `n` less the length of a border
/// (a proper prefix that is also a suffix), and all borders lie on the chain of failures. Linear in comparisons.
fn smallest_period(n: usize, equal: impl Fn(usize, usize) -> bool) -> usize {
    let mut border = vec![0_usize; n];
    for i in 1..n {
        let mut length = border[i - 1];
        while length > 0 && !equal(i, length) {
            length = border[length - 1];
        }
        border[i] = length + usize::from(equal(i, length));
    }
    let mut length = border[n - 1];
    loop {
        let period = n - length;
        if n.is_multiple_of(period) || 2 * period <= n {
            return period;
        }
        length = border[length - 1];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(chart: &Chart) -> Vec<String> {
        let line = |row: &Vec<Stitch>| row.iter().map(|s| s.symbol()).collect();
        chart.rows().iter().map(line).collect()
    }

    #[test]
    fn named_patterns_look_as_knitters_know_them() {
        assert_eq!(drawn(&Chart::garter()), ["k", "p"]);
        assert_eq!(drawn(&Chart::rib(2, 1).unwrap()), ["kkp"]);
        assert_eq!(drawn(&Chart::seed()), ["kp", "pk"]);
        assert_eq!(drawn(&Chart::moss()), ["kp", "kp", "pk", "pk"]);
        assert_eq!(drawn(&Chart::basket(2, 1).unwrap()), ["kkpp", "ppkk"], "blocks change places");
        assert_eq!(drawn(&Chart::welting(2, 1).unwrap()), ["k", "k", "p"]);
    }

    #[test]
    fn repeating_and_finding_the_repeat_are_inverse() {
        let patterns = [
            Chart::stockinette(),
            Chart::garter(),
            Chart::rib(3, 2).unwrap(),
            Chart::seed(),
            Chart::moss(),
            Chart::basket(3, 4).unwrap(),
            Chart::welting(2, 2).unwrap(),
        ];
        for pattern in patterns {
            let (columns, rows) = (pattern.column_count(), pattern.row_count());
            for (c, r) in [(2 * columns, 3 * rows), (2 * columns + 1, 2 * rows + 1)] {
                let fabric = pattern.repeat(c, r).unwrap();
                assert_eq!((fabric.column_count(), fabric.row_count()), (c, r));
                assert_eq!(fabric.smallest_repeat(), pattern);
            }
        }
    }

    #[test]
    fn a_border_seen_once_is_no_repeat() {
        let row: Vec<Stitch> = "kkpkk".chars().map(|c| knit_if(c == 'k')).collect();
        let chart = Chart::new(vec![row]).unwrap();
        assert_eq!(chart.smallest_repeat().column_count(), 5);
    }

    #[test]
    fn bad_sizes_are_refused() {
        assert_eq!(Chart::new(vec![]), Err(ChartError::NoRows));
        let ragged = vec![vec![Stitch::Knit; 3], vec![Stitch::Knit; 2]];
        let error = Chart::new(ragged).unwrap_err();
        assert_eq!(error.to_string(), "row 2 has 2 stitches, the rows below it have 3");
        assert_eq!(Chart::new(vec![vec![]]), Err(ChartError::EmptyRow { row: 0 }));
        assert!(Chart::rib(0, 0).is_err());
        assert!(Chart::rib(usize::MAX, 1).is_err());
        assert!(Chart::basket(usize::MAX, usize::MAX).is_err());
        let huge = Chart::stockinette().repeat(1_000_000, 1_000_000);
        let text = huge.unwrap_err().to_string();
        assert!(text.contains("1000000000000 loops") && text.contains("16000000"));
    }

    #[test]
    fn sides_alternate_flat_and_not_in_the_round() {
        let flat = Working::default();
        assert!(!flat.left_to_right(0) && flat.left_to_right(1));
        let from_behind = Working::Flat { first_row: Side::WrongSide };
        assert!(from_behind.left_to_right(0) && !from_behind.left_to_right(1));
        assert!(!Working::Round.left_to_right(1));
    }

    #[test]
    fn transitions_count_changes_along_the_row_only() {
        assert_eq!(Chart::garter().transitions_per_stitch(), 0.0);
        assert_eq!(Chart::seed().transitions_per_stitch(), 1.0);
        assert_eq!(Chart::rib(2, 2).unwrap().transitions_per_stitch(), 0.5);
    }
}
