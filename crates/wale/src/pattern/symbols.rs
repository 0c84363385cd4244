//! Charts drawn with symbols: the topmost line is the last row, as charts are printed.

use std::collections::BTreeMap;
use std::ops::Range;

use thiserror::Error;

use super::chart::{Chart, ChartError};
use super::stitch::Stitch;

/// What the symbols of a chart mean; each stands for the stitch as seen from the front, in every row.
pub type Legend = BTreeMap<char, Stitch>;

/// The usual signs: `k K | □` knit, `p P - • .` purl, `o O ○` yarn-over, `/` k2tog, `\` ssk, `r` p2tog, `l` ssp, `>` k3tog,
/// `<` sssk, `^` centred double decrease, `R` p3tog, `L` sssp, `v` the centred one purled, `f` kfb, `F` pfb, `Y` k-yo-k, `Z`
/// k-p-k, `z` p-k-p, `m` m1, `M` m1p, `V` slip with the yarn behind, `W` slip with the yarn in front, `T` tuck; `#` and `■` are
/// places without a stitch.
#[must_use]
pub fn default_legend() -> Legend {
    let more =
        [(Stitch::Knit, &['K', '|', '□'][..]), (Stitch::Purl, &['P', '-', '•', '.']), (Stitch::YarnOver, &['O', '○'])];
    let more = more.into_iter().flat_map(|(stitch, symbols)| symbols.iter().map(move |symbol| (*symbol, stitch)));
    Stitch::all().map(|(_, symbol, stitch)| (symbol, stitch)).chain(more).collect()
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
    /// Too many loops, or rows whose counts do not fit together.
    #[error(transparent)]
    Chart(ChartError),
}

/// Reads lines of symbols, the topmost first; spaces between symbols are left out.
///
/// # Errors
/// If there is no line, a line is empty or works another number of stitches than the line below it leaves, or a symbol
/// is unknown. The error names the row, counted from 1 at the bottom as knitters do, and both counts.
pub fn read_symbols<S: AsRef<str>>(lines: &[S], legend: &Legend) -> Result<Chart, SymbolError> {
    let error = |line, bytes, reason| SymbolError { line, bytes, reason };
    let row_of = |line: usize| lines.len() - line;
    if lines.is_empty() {
        return Err(error(0, None, SymbolErrorReason::NoRows));
    }
    let mut rows = Vec::with_capacity(lines.len());
    for (line, text) in lines.iter().map(AsRef::as_ref).enumerate().rev() {
        let row = row_of(line);
        let found = stitches_in(text);
        if found == 0 {
            return Err(error(line, None, SymbolErrorReason::EmptyRow { row }));
        }
        let mut stitches = Vec::with_capacity(found);
        for (at, symbol) in text.char_indices().filter(|(_, c)| !is_blank(*c)) {
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
        rows.push(stitches);
    }
    Chart::new(rows).map_err(|refused| match refused {
        ChartError::Count { row, .. } | ChartError::Stacked { row, .. } | ChartError::EmptyRow { row } => {
            error(lines.len() - 1 - row, None, SymbolErrorReason::Chart(refused))
        }
        _ => error(0, None, SymbolErrorReason::Chart(refused)),
    })
}

/// The lines that [`read_symbols`] reads back with the default legend, the topmost row first.
#[must_use]
pub fn write_symbols(chart: &Chart) -> Vec<String> {
    let line = |row: &Vec<Stitch>| row.iter().map(|stitch| stitch.symbol()).collect();
    chart.rows().iter().rev().map(line).collect()
}

/// Whether a symbol stands for no stitch.
fn is_blank(symbol: char) -> bool {
    symbol.is_whitespace() || matches!(symbol, '#' | '■')
}

fn stitches_in(line: &str) -> usize {
    line.chars().filter(|c| !is_blank(*c)).count()
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
        assert_eq!(ragged.to_string(), "row 3 works 3 stitches, but the row below it leaves 2");
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
