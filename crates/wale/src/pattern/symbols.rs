//! Charts drawn with symbols: the topmost line is the last row, as charts are printed.

use std::collections::BTreeMap;
use std::ops::Range;

use thiserror::Error;

use super::chart::{Chart, ChartError, Stitch};

/// What the symbols of a chart mean; each stands for the stitch as seen from the front, in every row.
pub type Legend = BTreeMap<char, Stitch>;

/// The usual signs: `k K | □` knit, `p P - • .` purl.
#[must_use]
pub fn default_legend() -> Legend {
    let knit = ['k', 'K', '|', '□'].map(|symbol| (symbol, Stitch::Knit));
    let purl = ['p', 'P', '-', '•', '.'].map(|symbol| (symbol, Stitch::Purl));
    knit.into_iter().chain(purl).collect()
}

/// Why lines of symbols are no chart.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
#[error("{reason}")]
pub struct SymbolError {
    /// The line, counted from 0 at the top.
    pub line: usize,
    /// The bytes of that line that are wrong; the whole line if `None`.
    pub bytes: Option<Range<usize>>,
    /// What is wrong.
    pub reason: SymbolErrorReason,
}

/// What is wrong with lines of symbols.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
pub enum SymbolErrorReason {
    /// There is no line.
    #[error("the chart has no rows")]
    NoRows,
    /// A line has no symbol.
    #[error("row {row} of the chart is empty")]
    EmptyRow {
        /// Row from 1 at the bottom.
        row: usize,
    },
    /// A line is longer or shorter than the bottom line.
    #[error("row {row} of the chart has {found} stitches, row 1 (the lowest) has {expected}")]
    Ragged {
        /// Row from 1 at the bottom.
        row: usize,
        /// Its stitches.
        found: usize,
        /// The stitches of the lowest row.
        expected: usize,
    },
    /// A symbol that the legend does not have.
    #[error("`{}` in row {row} is not in the legend ({known})", .symbol.escape_debug())]
    UnknownSymbol {
        /// Row from 1 at the bottom.
        row: usize,
        /// The symbol.
        symbol: char,
        /// The symbols of the legend.
        known: String,
    },
    /// Too many loops.
    #[error(transparent)]
    Size(ChartError),
}

/// Reads lines of symbols, the topmost first; spaces between symbols are left out.
///
/// # Errors
/// If there is no line, a line is empty or its length differs from the lowest line's, or a symbol is unknown. The
/// error names the row, counted from 1 at the bottom as knitters do, and both counts.
pub fn read_symbols<S: AsRef<str>>(lines: &[S], legend: &Legend) -> Result<Chart, SymbolError> {
    let error = |line, bytes, reason| SymbolError { line, bytes, reason };
    let row_of = |line: usize| lines.len() - line;
    let Some(lowest) = lines.last() else {
        return Err(error(0, None, SymbolErrorReason::NoRows));
    };
    let expected = stitches_in(lowest.as_ref());
    Chart::check_size(expected.max(1) as u64, lines.len() as u64)
        .map_err(|size| error(0, None, SymbolErrorReason::Size(size)))?;
    let mut rows = Vec::with_capacity(lines.len());
    for (line, text) in lines.iter().map(AsRef::as_ref).enumerate().rev() {
        let row = row_of(line);
        let found = stitches_in(text);
        if found == 0 {
            return Err(error(line, None, SymbolErrorReason::EmptyRow { row }));
        }
        let mut stitches = Vec::with_capacity(found);
        for (at, symbol) in text.char_indices().filter(|(_, c)| !c.is_whitespace()) {
            let stitch = legend.get(&symbol).ok_or_else(|| {
                let reason = SymbolErrorReason::UnknownSymbol {
                    row,
                    symbol,
                    known: legend.keys().map(char::to_string).collect::<Vec<_>>().join(" "),
                };
                error(line, Some(at..at + symbol.len_utf8()), reason)
            })?;
            stitches.push(*stitch);
        }
        if found != expected {
            let reason = SymbolErrorReason::Ragged { row, found, expected };
            return Err(error(line, None, reason));
        }
        rows.push(stitches);
    }
    Chart::new(rows).map_err(|size| error(0, None, SymbolErrorReason::Size(size)))
}

/// The lines that [`read_symbols`] reads back with the default legend, the topmost row first.
#[must_use]
pub fn write_symbols(chart: &Chart) -> Vec<String> {
    let line = |row: &Vec<Stitch>| row.iter().map(|stitch| stitch.symbol()).collect();
    chart.rows().iter().rev().map(line).collect()
}

fn stitches_in(line: &str) -> usize {
    line.chars().filter(|c| !c.is_whitespace()).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_topmost_line_is_the_last_row() {
        let chart = read_symbols(&["k k", "|-", "□•"], &default_legend()).unwrap();
        assert_eq!(write_symbols(&chart), ["kk", "kp", "kp"]);
        assert_eq!(chart.rows()[2], [Stitch::Knit, Stitch::Knit]);
    }

    #[test]
    fn errors_name_the_row_from_the_bottom_and_both_counts() {
        let read = |lines: &[&str]| read_symbols(lines, &default_legend()).unwrap_err();
        let ragged = read(&["kkk", "kk", "kk"]);
        assert_eq!((ragged.line, ragged.bytes.clone()), (0, None));
        assert_eq!(ragged.to_string(), "row 3 of the chart has 3 stitches, row 1 (the lowest) has 2");
        let empty = read(&["kk", "  ", "kk"]);
        assert_eq!(empty.to_string(), "row 2 of the chart is empty");
        assert_eq!(read(&[]).to_string(), "the chart has no rows");
        let unknown = read(&["k□x", "kkk"]);
        assert_eq!((unknown.line, unknown.bytes.clone()), (0, Some(4..5)));
        assert!(unknown.to_string().starts_with("`x` in row 2"));
    }

    proptest! {
        #[test]
        fn any_lines_are_read_or_refused(lines in prop::collection::vec(".{0,12}", 0..6)) {
            if let Ok(chart) = read_symbols(&lines, &default_legend()) {
                let again = read_symbols(&write_symbols(&chart), &default_legend());
                prop_assert_eq!(again.unwrap(), chart);
            }
        }

        #[test]
        fn lines_of_known_symbols_are_always_read(
            lines in prop::collection::vec("[kp|.-]{4}", 1..6)
        ) {
            let chart = read_symbols(&lines, &default_legend()).unwrap();
            prop_assert_eq!((chart.column_count(), chart.row_count()), (4, lines.len()));
        }
    }
}
