//! Charts side by side and above each other, and the smallest piece that a chart repeats.

use super::chart::{Chart, ChartError};
use super::stitch::Stitch;

impl Chart {
    /// The chart repeated side by side and upwards until a size is reached: `columns` are those cast on.
    ///
    /// Where every stitch takes one place and leaves one in all rows alike, any size is cut off; otherwise whole repeats
    /// stand side by side.
    ///
    /// # Errors
    /// If a count is zero, the loops are too many, a width is asked for at which the rows cannot be cut, or the rows
    /// cannot follow each other again.
    pub fn repeat(&self, columns: usize, rows: usize) -> Result<Self, ChartError> {
        Self::check_size(columns as u64, rows as u64)?;
        let (first, last) = (self.cast_on(), leaves(&self.rows()[self.row_count() - 1]));
        // Increases make rows longer than what is cast on.
        Self::check_size((self.column_count() as u64).saturating_mul((columns / first) as u64).max(1), rows as u64)?;
        if rows > self.row_count() && first != last {
            return Err(ChartError::Shaped { first, last });
        }
        let (cells, grid) = (self.cells(), self.is_grid());
        let cut = |r: usize| -> Vec<(Stitch, u8)> {
            let source = &cells[r % cells.len()];
            if grid { source.iter().copied().cycle().take(columns).collect() } else { source.repeat(columns / first) }
        };
        if !grid && !columns.is_multiple_of(first) {
            return Err(ChartError::Cut { columns, repeat: first });
        }
        let cut = Self::from_cells((0..rows).map(cut).collect());
        // Within a repeat, yarn-overs and decreases may lie on both sides of the cut.
        cut.map_err(|error| match error {
            ChartError::Count { .. } => ChartError::Cut { columns, repeat: first },
            other => other,
        })
    }

    /// Whether all rows have the same number of stitches, as many as are on the needle before and after.
    fn is_grid(&self) -> bool {
        let columns = self.cast_on();
        self.rows().iter().all(|row| row.len() == columns && leaves(row) == columns)
    }

    /// The smallest piece that, repeated, gives this chart again.
    ///
    /// A repeat that does not divide the chart counts when the chart shows at least two whole ones of it.
    #[must_use]
    pub fn smallest_repeat(&self) -> Self {
        let cells = self.cells();
        let rows = smallest_period(cells.len(), |a, b| cells[a] == cells[b]);
        let rows = if self.rows()[..rows].iter().all(|row| !row.is_empty()) { rows } else { cells.len() };
        let side_by_side = if self.is_grid() {
            let columns = smallest_period(self.cast_on(), |a, b| cells.iter().all(|row| row[a] == row[b]));
            cells[..rows].iter().map(|row| row[..columns].to_vec()).collect()
        } else {
            // The most equal pieces that every row is made of.
            let fewest = cells.iter().map(Vec::len).min().unwrap_or(1);
            let alike = |count: usize| {
                cells.iter().all(|row| {
                    row.len().is_multiple_of(count) && {
                        let piece = row.len() / count;
                        row.iter().skip(piece).eq(row.iter().take(row.len() - piece))
                    }
                })
            };
            let count = (1..=fewest).rev().find(|count| alike(*count)).unwrap_or(1);
            cells[..rows].iter().map(|row| row[..row.len() / count].to_vec()).collect()
        };
        // Pieces whose yarn-overs and decreases balance only together with others are none.
        match Self::from_cells(side_by_side) {
            Ok(piece) if piece.check_repeats().is_ok() => piece,
            _ => self.clone(),
        }
    }

    /// Whether the chart can be repeated without end in both directions.
    ///
    /// # Errors
    /// If the last row leaves another number of stitches than the first works, or a stitch is slipped in every row.
    pub fn check_repeats(&self) -> Result<(), ChartError> {
        let (first, last) = (self.cast_on(), leaves(&self.rows()[self.row_count() - 1]));
        if first != last {
            return Err(ChartError::Shaped { first, last });
        }
        // Where each place that is passed on comes from; a place that comes round to itself is never worked.
        let mut from: Vec<Option<usize>> = (0..first).map(Some).collect();
        for row in self.rows() {
            let mut below = from.into_iter();
            from = Vec::with_capacity(first);
            for stitch in row {
                let taken: Vec<Option<usize>> = below.by_ref().take(stitch.takes()).collect();
                match stitch {
                    Stitch::Slip { .. } | Stitch::Tuck => from.extend(taken),
                    _ => from.extend(std::iter::repeat_n(None, stitch.leaves())),
                }
            }
        }
        match (0..first).find(|&start| comes_round(&mut from, start)) {
            Some(column) => Err(ChartError::NeverWorked { column }),
            None => Ok(()),
        }
    }
}

/// Whether the way back from a place never ends. A way that ends is forgotten but for its end, so that all of them are walked once.
fn comes_round(from: &mut [Option<usize>], start: usize) -> bool {
    let mut at = start;
    for _ in 0..=from.len() {
        let Some(before) = from[at] else {
            let mut at = start;
            while let Some(before) = from[at].take() {
                at = before;
            }
            return false;
        };
        at = before;
    }
    true
}

/// Places on the needle that a row leaves.
fn leaves(row: &[Stitch]) -> usize {
    row.iter().map(|stitch| stitch.leaves()).sum()
}

/// Length of the longest border (a proper prefix that is also a suffix) of every beginning of a sequence of length `n`.
///
/// The failure function of Knuth, Morris and Pratt: linear in comparisons.
pub(super) fn borders(n: usize, equal: impl Fn(usize, usize) -> bool) -> Vec<usize> {
    let mut border = vec![0_usize; n];
    for i in 1..n {
        let mut length = border[i - 1];
        while length > 0 && !equal(i, length) {
            length = border[length - 1];
        }
        border[i] = length + usize::from(equal(i, length));
    }
    border
}

/// Smallest period of a sequence of length `n ≥ 1` that divides it or fits in it twice: every period is `n` less the length
/// of a border, and all borders lie on a chain.
fn smallest_period(n: usize, equal: impl Fn(usize, usize) -> bool) -> usize {
    let border = borders(n, equal);
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
    use crate::pattern::symbols::{default_legend, read_symbols};

    fn chart(lines: &[&str]) -> Chart {
        read_symbols(lines, &default_legend()).unwrap()
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
            chart(&["kkkk", "kVkT"]),
            Chart::garter().repeat(1, 4).unwrap().striped(&[0, 0, 1, 1]),
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
    fn rows_of_unequal_counts_repeat_as_a_whole() {
        let pattern = chart(&["kokok", "k^k", "kkkkk"]);
        let fabric = pattern.repeat(20, 12).unwrap();
        assert_eq!((fabric.cast_on(), fabric.row_count(), fabric.loop_count()), (20, 12, 4 * 4 * 13));
        assert_eq!(fabric.smallest_repeat(), pattern);
        assert_eq!(pattern.repeat(18, 3).unwrap_err(), ChartError::Cut { columns: 18, repeat: 5 });
        let shaped = chart(&["/", "kk"]);
        assert_eq!(shaped.repeat(2, 4).unwrap_err(), ChartError::Shaped { first: 2, last: 1 });
        assert_eq!(shaped.smallest_repeat(), shaped);
    }

    #[test]
    fn a_border_seen_once_is_no_repeat() {
        assert_eq!(chart(&["kkpkk"]).smallest_repeat().column_count(), 5);
    }

    #[test]
    fn a_stitch_that_is_always_slipped_makes_no_endless_fabric() {
        assert_eq!(chart(&["kV", "kV"]).check_repeats().unwrap_err(), ChartError::NeverWorked { column: 1 });
        assert!(chart(&["Vk", "kV"]).check_repeats().is_ok());
    }

    #[test]
    fn sizes_too_large_are_refused() {
        let text = Chart::stockinette().repeat(1_000_000, 1_000_000).unwrap_err().to_string();
        assert!(text.contains("1000000000000 loops") && text.contains("16000000"));
    }
}
