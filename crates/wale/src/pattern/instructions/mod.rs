//! Written row instructions, as in `Row 1 (RS): *k2, p2*`, read to a chart.
//!
//! ```text
//! # 2x2 rib                                   comments run to the end of the line
//! Cast on 20                                  may be left out where the scene gives the columns
//! Row 1 (RS): *k2, p2*                        between stars: as often as the row has room for
//! Row 2 (WS): *p2, k2; rep from * to last 4 sts, p2, k2
//! Row 3: (k1, p1) 3 times, [k2, [p1, k1] twice] 2 times, p to end
//! Rows 4-6: knit
//! Rows 7-12: rep rows 1-6
//! Row 13: *k2tog 3 times, [yo, k1] 6 times, k2tog 3 times*
//! Row 14: (k1, yo, k1) in next st, sl1 wyif, p to end
//! Row 15: with B, k                           another yarn, from here on
//! Row 16: sl1, k2tog, psso, p2tog tbl, k to end
//! Rep rows 1-16 3 more times                  appends 48 rows
//! Bind off
//! ```
//!
//! `Row 2 and all WS rows: purl` says every second row from there on that no line says, and the last one if the text ends with the
//! row before it. `Rep rows 1-4` without a count, of all the rows that there are, says only that they are a repeat.
//!
//! `Rnd` in place of `Row` works in the round. Rows are numbered from 1 without gaps, in any order. Right-side rows
//! run right to left, wrong-side rows left to right as seen from the wrong side, so there a knit is a purl from the
//! front. A row works as many stitches as the row before it leaves. A row that is said to repeat another is *worked* like
//! it, from whichever side it then is.

mod alternate;
mod file;
mod lexer;
mod parts;
mod row;
#[cfg(test)]
mod tests;
mod write;
mod yarns;

use std::ops::Range;

use thiserror::Error;

use super::chart::{Chart, ChartError};
use super::increase::Parts;
use super::stitch::{NotHeld, Stitch};
use super::working::Working;

pub(crate) use lexer::shortened;
pub use write::write_instructions;

/// What written instructions say.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// The stitches as seen from the front.
    pub chart: Chart,
    /// Flat or in the round.
    pub working: Working,
    /// The stitches cast on, if the text says it.
    pub cast_on: Option<u64>,
    /// Names of the yarns in the order in which they come, the chart's first yarn first; empty if none is named.
    pub yarns: Vec<String>,
}

/// Most bytes of a text of instructions.
pub const LARGEST_TEXT: usize = 1 << 20;

/// Most yarns of a text.
pub const MOST_YARNS: usize = 16;

/// Deepest nesting of brackets and stars in a row.
pub const DEEPEST_NESTING: usize = 32;

/// Reads written instructions; `columns` counts the stitches where the text does not cast on.
///
/// # Errors
/// If the text is not understood, rows are missing or given twice, the counts of a row do not work out, or there are
/// too many loops. Work and memory are bounded by the text's length and [`Chart::MAX_LOOPS`].
pub fn read_instructions(text: &str, columns: Option<usize>) -> Result<Written, InstructionError> {
    if text.len() > LARGEST_TEXT {
        let reason = InstructionErrorReason::TooLong { bytes: text.len() };
        return Err(InstructionError::new(0..0, None, reason));
    }
    file::read(text, columns)
}

/// Why a text of instructions makes no chart.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
pub struct InstructionError {
    /// The bytes of the text that are wrong.
    pub span: Range<usize>,
    /// The row concerned, from 1.
    pub row: Option<u64>,
    /// What is wrong.
    pub reason: InstructionErrorReason,
}

impl InstructionError {
    fn new(span: Range<usize>, row: Option<u64>, reason: InstructionErrorReason) -> Self {
        Self { span, row, reason }
    }
}

impl std::fmt::Display for InstructionError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.row {
            Some(row) => write!(f, "row {row}: {}", self.reason),
            None => write!(f, "{}", self.reason),
        }
    }
}

/// What is wrong with a text of instructions.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
pub enum InstructionErrorReason {
    /// More than [`LARGEST_TEXT`].
    #[error("the text has {bytes} bytes, the limit is {LARGEST_TEXT}")]
    TooLong {
        /// Its bytes.
        bytes: usize,
    },
    /// A line that starts with none of the known words.
    #[error("a line starts with `Cast on`, `Row`, `Rnd`, `Rep rows` or `Bind off`, not with `{found}`")]
    UnknownLine {
        /// How it starts.
        found: String,
    },
    /// Something else should stand here.
    #[error("expected {expected}, found {found}")]
    Expected {
        /// What should stand here.
        expected: &'static str,
        /// What stands here.
        found: String,
    },
    /// A word that is no stitch.
    #[error("`{word}` is no stitch that wale knows; it knows {}", Stitch::names())]
    UnknownStitch {
        /// The word.
        word: String,
    },
    /// A stitch that the model cannot hold.
    #[error("`{word}` is {why}")]
    NotHeld {
        /// The stitch.
        word: String,
        /// What it is.
        why: NotHeld,
    },
    /// A count of zero, or one too large.
    #[error("a count must be from 1 to {}, not `{found}`", Chart::MAX_LOOPS)]
    Count {
        /// What stands there.
        found: String,
    },
    /// Brackets or stars around nothing.
    #[error("there is nothing to repeat")]
    NothingToRepeat,
    /// Brackets or stars nested deeper than [`DEEPEST_NESTING`].
    #[error("brackets are nested deeper than {DEEPEST_NESTING}")]
    TooDeep,
    /// A part that is to fill the row but takes none of its stitches.
    #[error("`{part}` takes no stitch of the row below, so it cannot fill the row")]
    TakesNothing {
        /// The part.
        part: String,
    },
    /// What is worked into one stitch cannot be.
    #[error("`{part}` cannot be worked into one stitch: 2 to {most} knits, purls and single yarn-overs between them can", most = Parts::MOST)]
    Increase {
        /// The part.
        part: String,
    },
    /// More yarns than can be told apart.
    #[error("there are more than {MOST_YARNS} yarns")]
    Yarns,
    /// A part that fills the row, inside another repeat or before another such part.
    #[error("`{part}` stretches to fill the row, which only one part of a row can do here")]
    SecondFill {
        /// The part.
        part: String,
    },
    /// The room left in the row is no multiple of the repeat.
    #[error(
        "`{part}` repeats {repeat} stitches, but {room} of the {total} stitches are left for it, which is no multiple"
    )]
    NoMultiple {
        /// The part.
        part: String,
        /// Its stitches.
        repeat: u64,
        /// Stitches left for it.
        room: u64,
        /// Stitches of the row.
        total: u64,
    },
    /// The row takes more stitches than there are.
    #[error("up to `{part}` the row takes {found} stitches, but there are {total}")]
    TooMany {
        /// The part where the row is full.
        part: String,
        /// Stitches up to its end.
        found: u64,
        /// Stitches on the needle.
        total: u64,
    },
    /// The row takes fewer stitches than there are.
    #[error("the row ends with `{part}` after {found} stitches, but there are {total}")]
    TooFew {
        /// The last part.
        part: String,
        /// Stitches up to its end.
        found: u64,
        /// Stitches on the needle.
        total: u64,
    },
    /// No `Cast on`, and no columns given.
    #[error("the number of stitches is unknown: no `Cast on` line, and the scene gives no columns")]
    NoCastOn,
    /// A second `Cast on` line.
    #[error("the stitches were cast on before")]
    SecondCastOn,
    /// There are no rows.
    #[error("there are no rows")]
    NoRows,
    /// A row is missing.
    #[error("row {missing} is missing")]
    MissingRow {
        /// Its number.
        missing: u64,
    },
    /// A row is given twice.
    #[error("row {again} was given before")]
    SecondRow {
        /// Its number.
        again: u64,
    },
    /// `Row` and `Rnd` in one text.
    #[error("rows (flat) and rounds cannot be mixed")]
    MixedWorking,
    /// A row's side does not fit the side of the other rows.
    #[error("it cannot be a {found} row: sides alternate, and {because}")]
    Side {
        /// `RS` or `WS`.
        found: &'static str,
        /// What decides the side.
        because: String,
    },
    /// A repeat of rows that are not yet worked.
    #[error("rows {first}–{last} are not worked before it")]
    RepeatsLater {
        /// First row to repeat.
        first: u64,
        /// Last row to repeat.
        last: u64,
    },
    /// A repeat without a count that is not of all rows.
    #[error(
        "how often rows {first}–{last} are repeated must be said, `3 more times`, as they are not all of the {count} rows"
    )]
    OpenRepeat {
        /// First row to repeat.
        first: u64,
        /// Last row to repeat.
        last: u64,
        /// All rows.
        count: u64,
    },
    /// `and all even rows` beside an odd row, or the other way round.
    #[error("`{rows}` would leave out row {row} itself")]
    NotAlternate {
        /// What the rows are called.
        rows: String,
        /// The row that is said with them.
        row: u64,
    },
    /// Rows and the rows they repeat do not come out even.
    #[error("{rows} rows repeat {repeat} rows, which is no multiple")]
    UnevenRepeat {
        /// Rows that repeat.
        rows: u64,
        /// Rows repeated.
        repeat: u64,
    },
    /// Too many loops.
    #[error(transparent)]
    Size(ChartError),
}
