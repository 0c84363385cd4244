//! A stitch chart: which stitch stands where, as seen from the front of the fabric.

use std::fmt;

use thiserror::Error;

use super::stitch::Stitch;

/// Why rows of stitches are no chart.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
pub enum ChartError {
    /// There is no row.
    #[error("the chart has no rows")]
    NoRows,
    /// A row has no stitch, works none or leaves none.
    #[error("row {} of the chart is empty", .row + 1)]
    EmptyRow {
        /// Row, counted from 0 at the cast-on.
        row: usize,
    },
    /// A row works more or fewer stitches than the row below leaves.
    #[error("row {} works {found} stitches, but the row below it leaves {expected}", .row + 1)]
    Count {
        /// Row, counted from 0 at the cast-on.
        row: usize,
        /// The stitches that it works.
        found: usize,
        /// The stitches that the row below leaves.
        expected: usize,
    },
    /// More loops in one stitch than [`Chart::MOST_STACKED`].
    #[error("row {} draws a loop through {loops} others, the limit is {}", .row + 1, Chart::MOST_STACKED)]
    Stacked {
        /// Row, counted from 0 at the cast-on.
        row: usize,
        /// The loops.
        loops: usize,
    },
    /// More loops than [`Chart::MAX_LOOPS`].
    #[error("{columns} columns × {rows} rows are {} loops, the limit is {}", u128::from(*.columns) * u128::from(*.rows), Chart::MAX_LOOPS)]
    TooLarge {
        /// Columns asked for.
        columns: u64,
        /// Rows asked for.
        rows: u64,
    },
    /// A width at which a repeat cannot be cut off.
    #[error("{columns} columns are no multiple of the {repeat} that a repeat begins with, and its rows cannot be cut")]
    Cut {
        /// Columns asked for.
        columns: usize,
        /// Columns of the repeat.
        repeat: usize,
    },
    /// The last row leaves another number of stitches than the first works, so that the rows cannot be repeated.
    #[error("the rows begin with {first} stitches and end with {last}: they cannot follow each other again")]
    Shaped {
        /// Stitches that the first row works.
        first: usize,
        /// Stitches that the last row leaves.
        last: usize,
    },
    /// A stitch that every row of a repeat passes on.
    #[error("stitch {} is slipped in every row: no endless fabric can be made of it", .column + 1)]
    NeverWorked {
        /// Column, counted from 0 at the left.
        column: usize,
    },
    /// Yarns that do not belong to the stitches.
    #[error("row {} has {found} stitches with a yarn, the chart has {expected} there", .row + 1)]
    Yarns {
        /// Row, counted from 0 at the cast-on.
        row: usize,
        /// Yarns of the row.
        found: usize,
        /// Its stitches.
        expected: usize,
    },
}

/// Rows of stitches as seen from the front of the fabric, and the yarn of every stitch.
///
/// Row 0 is the first row worked above the cast-on; within a row, stitches run from the left. Every row works as many
/// stitches as the row below it leaves (the first: as are cast on); there are at most [`Chart::MAX_LOOPS`] loops.
/// Places on the needle are called columns, counted from the left in each row.
#[derive(Clone, PartialEq, Eq, Hash)]
pub struct Chart {
    rows: Vec<Vec<Stitch>>,
    /// Yarn of each stitch; empty if there is one yarn only.
    yarns: Vec<Vec<u8>>,
}

impl Chart {
    /// Most loops that a chart may have: four nodes a loop must keep every index of the network within 32 bits, and
    /// a fabric of this size already needs some 0.4 TB.
    pub const MAX_LOOPS: u64 = 16_000_000;

    /// Most loops that one may be drawn through.
    pub const MOST_STACKED: usize = 7;

    /// Checks rows of stitches, the first row worked first, each from left to right as seen from the front.
    ///
    /// # Errors
    /// If there are no rows, a row is empty, does not work what the row below leaves, draws a loop through too many, or
    /// there are too many loops.
    pub fn new(rows: Vec<Vec<Stitch>>) -> Result<Self, ChartError> {
        let first = rows.first().ok_or(ChartError::NoRows)?;
        let mut loops = 0_u64;
        // Loops at each place of the needle.
        let mut needle = vec![1_usize; first.iter().map(|stitch| stitch.takes()).sum()];
        for (row, stitches) in rows.iter().enumerate() {
            let found: usize = stitches.iter().map(|stitch| stitch.takes()).sum();
            let expected = needle.len();
            if found == 0 {
                return Err(ChartError::EmptyRow { row });
            }
            if found != expected {
                return Err(ChartError::Count { row, found, expected });
            }
            let mut below = needle.into_iter();
            let mut above = Vec::with_capacity(found);
            for stitch in stitches {
                let taken: usize = below.by_ref().take(stitch.takes()).sum();
                match stitch {
                    Stitch::Slip { .. } => above.push(taken),
                    Stitch::Tuck => above.push(taken + 1),
                    _ => above.extend(std::iter::repeat_n(1, stitch.leaves())),
                }
                let loops = if *stitch == Stitch::Tuck { taken + 1 } else { taken };
                if loops > Self::MOST_STACKED {
                    return Err(ChartError::Stacked { row, loops });
                }
            }
            loops += above.len() as u64;
            Self::check_size(loops, 1)?;
            needle = above;
        }
        Ok(Self { rows, yarns: Vec::new() })
    }

    /// The chart with a yarn for every stitch, row by row as the stitches; slipped stitches have the yarn that floats
    /// past them.
    ///
    /// # Errors
    /// If the rows do not have as many yarns as stitches.
    pub fn with_yarns(mut self, yarns: Vec<Vec<u8>>) -> Result<Self, ChartError> {
        for row in 0..self.rows.len().max(yarns.len()) {
            let count = |found: Option<usize>| found.unwrap_or(0);
            let (found, expected) = (count(yarns.get(row).map(Vec::len)), count(self.rows.get(row).map(Vec::len)));
            if found != expected {
                return Err(ChartError::Yarns { row, found, expected });
            }
        }
        self.yarns = if yarns.iter().flatten().all(|yarn| *yarn == 0) { Vec::new() } else { yarns };
        Ok(self)
    }

    /// The chart striped: each row of one yarn, in turn.
    #[must_use]
    pub fn striped(self, stripes: &[u8]) -> Self {
        let yarns = self.rows.iter().zip(stripes.iter().cycle()).map(|(row, yarn)| vec![*yarn; row.len()]).collect();
        let same = self.clone();
        // Without stripes there is nothing to zip; the chart stays as it is.
        self.with_yarns(yarns).unwrap_or(same)
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

    /// The yarn of a stitch.
    #[must_use]
    pub fn yarn(&self, row: usize, stitch: usize) -> u8 {
        self.yarns.get(row).map_or(0, |row| row[stitch])
    }

    /// Number of yarns.
    #[must_use]
    pub fn yarn_count(&self) -> usize {
        self.yarns.iter().flatten().max().map_or(1, |most| usize::from(*most) + 1)
    }

    /// Number of rows (courses).
    #[must_use]
    pub fn row_count(&self) -> usize {
        self.rows.len()
    }

    /// Number of stitches to cast on.
    #[must_use]
    pub fn cast_on(&self) -> usize {
        self.rows[0].iter().map(|stitch| stitch.takes()).sum()
    }

    /// Number of columns (wales): the most that are on the needle at once.
    #[must_use]
    pub fn column_count(&self) -> usize {
        let leaves = |row: &Vec<Stitch>| row.iter().map(|stitch| stitch.leaves()).sum::<usize>();
        self.rows.iter().map(leaves).fold(self.cast_on(), usize::max)
    }

    /// Number of loops that the rows make.
    #[must_use]
    pub fn loop_count(&self) -> usize {
        self.rows.iter().flatten().map(|stitch| stitch.makes()).sum()
    }

    /// Knit–purl changes from one stitch to the next within a row, per loop, of the chart repeated side by side.
    #[must_use]
    pub fn transitions_per_stitch(&self) -> f64 {
        let changes = |row: &Vec<Stitch>| {
            let next = row.iter().cycle().skip(1);
            row.iter().zip(next).filter(|(stitch, next)| stitch.turns_to(**next)).count()
        };
        self.rows.iter().map(changes).sum::<usize>() as f64 / self.loop_count().max(1) as f64
    }

    /// Rows and yarns of a chart that is known to be sound.
    pub(super) fn of_sound(rows: Vec<Vec<Stitch>>) -> Self {
        Self { rows, yarns: Vec::new() }
    }

    /// The rows with the yarns of their stitches.
    pub(super) fn cells(&self) -> Vec<Vec<(Stitch, u8)>> {
        let row = |(row, stitches): (usize, &Vec<Stitch>)| {
            stitches.iter().enumerate().map(|(at, stitch)| (*stitch, self.yarn(row, at))).collect()
        };
        self.rows.iter().enumerate().map(row).collect()
    }

    /// A chart of stitches with their yarns.
    pub(super) fn from_cells(cells: Vec<Vec<(Stitch, u8)>>) -> Result<Self, ChartError> {
        let rows = cells.iter().map(|row| row.iter().map(|(stitch, _)| *stitch).collect()).collect();
        let yarns = cells.iter().map(|row| row.iter().map(|(_, yarn)| *yarn).collect()).collect();
        Self::new(rows)?.with_yarns(yarns)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::symbols::{default_legend, read_symbols};

    fn chart(lines: &[&str]) -> Chart {
        read_symbols(lines, &default_legend()).unwrap()
    }

    #[test]
    fn bad_rows_are_refused() {
        assert_eq!(Chart::new(vec![]), Err(ChartError::NoRows));
        let ragged = vec![vec![Stitch::Knit; 3], vec![Stitch::Knit; 2]];
        let error = Chart::new(ragged).unwrap_err();
        assert_eq!(error.to_string(), "row 2 works 2 stitches, but the row below it leaves 3");
        assert_eq!(Chart::new(vec![vec![]]), Err(ChartError::EmptyRow { row: 0 }));
        assert_eq!(Chart::new(vec![vec![Stitch::YarnOver]]), Err(ChartError::EmptyRow { row: 0 }));
        let tucks = vec![vec![Stitch::Tuck]; 7];
        assert_eq!(Chart::new(tucks).unwrap_err(), ChartError::Stacked { row: 6, loops: 8 });
    }

    #[test]
    fn shaping_changes_the_counts_from_row_to_row() {
        let chart = chart(&["^", "/k\\", "kkkkk", "kmkm k"]);
        assert_eq!((chart.cast_on(), chart.column_count(), chart.loop_count()), (3, 5, 14));
    }

    #[test]
    fn slipped_stitches_make_no_loop() {
        let chart = chart(&["kkkk", "kVkW", "kTkk"]);
        assert_eq!((chart.cast_on(), chart.column_count(), chart.loop_count()), (4, 4, 10));
    }

    #[test]
    fn yarns_belong_to_stitches() {
        let striped = chart(&["kk", "kk", "kk"]).striped(&[0, 1]);
        assert_eq!((striped.yarn(0, 1), striped.yarn(1, 0), striped.yarn(2, 0), striped.yarn_count()), (0, 1, 0, 2));
        let plain = chart(&["kk"]);
        assert_eq!(plain.clone().striped(&[0]), plain);
        let error = plain.with_yarns(vec![vec![0]]).unwrap_err();
        assert_eq!(error.to_string(), "row 1 has 1 stitches with a yarn, the chart has 2 there");
    }

    #[test]
    fn transitions_count_changes_along_the_row_only() {
        assert_eq!(Chart::garter().transitions_per_stitch(), 0.0);
        assert_eq!(Chart::seed().transitions_per_stitch(), 1.0);
        assert_eq!(Chart::rib(2, 2).unwrap().transitions_per_stitch(), 0.5);
    }
}
