//! Knitout, the open format of machine knitting [Knitout2023, version 0.6], read to the graph of loops.
//!
//! A program moves carriers along two beds of needles: `knit` draws a loop through those on a needle, `tuck` adds one,
//! `split`, `xfer` and `drop` move and let go, `rack` shifts the back bed. Loops made on the front bed are knits as seen
//! from the front, loops made on the back bed purls.

mod beds;
mod cables;
mod graph;
mod machine;
mod program;
#[cfg(test)]
mod tests;

use std::ops::Range;

use thiserror::Error;

use super::loops::LoopGraph;
use super::remark::Remark;

/// Most bytes of a program.
pub const LARGEST_PROGRAM: usize = 16 << 20;
/// Most different yarns.
const MOST_YARNS: usize = 250;
/// Most carriers that the header or an operation names; machines have up to sixteen.
const MOST_CARRIERS: usize = 64;
/// Most characters of a carrier's name.
const LONGEST_NAME: usize = 40;
/// Most remarks on extensions; more of them tell nothing new.
const MOST_EXTENSIONS: usize = 100;

/// A program that has been worked.
#[derive(Clone, PartialEq, Debug)]
pub struct Knitted {
    /// Its loops and yarns.
    pub graph: LoopGraph,
    /// The carriers of the graph's yarns, in their order; several that feed one needle together are one yarn.
    pub carriers: Vec<String>,
    /// What was unusual but could be knitted, by line.
    pub remarks: Vec<Remark>,
}

/// Why a program cannot be knitted.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
#[error("line {line}: {reason}{}", made_from(.source_note))]
pub struct KnitoutError {
    /// Line of the program, from 1.
    pub line: usize,
    /// The bytes of the text that are wrong.
    pub span: Range<usize>,
    /// What is wrong.
    pub reason: Box<KnitoutErrorReason>,
    /// What the program's own `;!source:` comment says about the place.
    pub source_note: Option<String>,
}

fn made_from(note: &Option<String>) -> String {
    note.as_ref().map(|note| format!(" (made from {note})")).unwrap_or_default()
}

/// What is wrong with a program.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
pub enum KnitoutErrorReason {
    /// More bytes than [`LARGEST_PROGRAM`].
    #[error("the program has {bytes} bytes, the limit is {LARGEST_PROGRAM}")]
    TooLong {
        /// Its bytes.
        bytes: usize,
    },
    /// The first line is not `;!knitout-2`.
    #[error("this is no knitout: the first line must be `;!knitout-2`")]
    Magic,
    /// An operation that the format does not have.
    #[error("`{word}` is no operation of knitout")]
    Operation {
        /// The word.
        word: String,
    },
    /// An operation with too few or too many words after it, or wrong ones.
    #[error("`{operation}` needs {needs}")]
    Parameters {
        /// The operation.
        operation: &'static str,
        /// What it needs.
        needs: &'static str,
    },
    /// A needle that no machine has.
    #[error("needle `{needle}`: needles are numbered from -{limit} to {limit}", limit = beds::FARTHEST_NEEDLE)]
    Needle {
        /// As written.
        needle: String,
    },
    /// Racked farther than machines can.
    #[error("racked by {rack}: machines reach {limit} needles to either side", limit = beds::FARTHEST_RACK)]
    Rack {
        /// As written.
        rack: String,
    },
    /// A transfer between needles that do not face each other.
    #[error("{from} and {to} do not face each other: racked by {rack}, {from} faces {faces}")]
    Facing {
        /// The needle that gives.
        from: String,
        /// The needle that takes.
        to: String,
        /// The racking.
        rack: String,
        /// What the first one faces.
        faces: String,
    },
    /// A loop is made on a slider.
    #[error("{needle} is a slider: it holds loops, none can be made on it")]
    Slider {
        /// The needle.
        needle: String,
    },
    /// A carrier that the `;;Carriers:` header does not name.
    #[error("carrier `{carrier}` is not among those of the header ({known})")]
    Carrier {
        /// The carrier.
        carrier: String,
        /// Those of the header.
        known: String,
    },
    /// More carriers on a line than machines have.
    #[error("{count} carriers: no machine has more than {MOST_CARRIERS}")]
    TooManyCarriers {
        /// How many.
        count: usize,
    },
    /// A carrier's name that is none.
    #[error("carrier `{carrier}`: names have at most {LONGEST_NAME} characters")]
    CarrierName {
        /// How it begins.
        carrier: String,
    },
    /// A carrier that was not brought in.
    #[error("carrier {carrier} makes a loop but was not brought in; write `inhook {carrier}` or `in {carrier}` before")]
    NotIn {
        /// The carrier.
        carrier: String,
    },
    /// A carrier that is brought in twice.
    #[error("carrier {carrier} is brought in again; it was brought in at line {since}")]
    AlreadyIn {
        /// The carrier.
        carrier: String,
        /// Where it was.
        since: usize,
    },
    /// A carrier that is taken out but is not in.
    #[error("carrier {carrier} is taken out but was not brought in")]
    OutTwice {
        /// The carrier.
        carrier: String,
    },
    /// The hook is asked to hold a second yarn.
    #[error("the hook still holds carrier {carrier} from line {since}; write `releasehook {carrier}` first")]
    HookBusy {
        /// The carrier.
        carrier: String,
        /// Where it was hooked.
        since: usize,
    },
    /// A hook that lets go what it does not hold.
    #[error("the hook does not hold carrier {carrier}")]
    NotHooked {
        /// The carrier.
        carrier: String,
    },
    /// The program ends while the hook holds a yarn.
    #[error("the hook never lets carrier {carrier} go; write `releasehook {carrier}` after its first stitches")]
    NeverReleased {
        /// The carrier.
        carrier: String,
    },
    /// Loops that cross: a cable.
    #[error(
        "a cable: this loop and the one of line {other} cross those that they are drawn through, which fixed contacts \
         between neighbours cannot hold; knit the stitches without crossing them"
    )]
    Cable {
        /// Line of the other loop.
        other: usize,
    },
    /// More loops on a needle than one can be drawn through.
    #[error("{needle} holds {loops} loops, and one is drawn through {limit} at most", limit = super::Chart::MOST_STACKED)]
    Stacked {
        /// The needle.
        needle: String,
        /// Its loops.
        loops: usize,
    },
    /// More loops than can be knitted.
    #[error("there are more than {} loops", super::Chart::MAX_LOOPS)]
    TooManyLoops,
    /// More yarns than can be told apart.
    #[error("there are more than {MOST_YARNS} different yarns")]
    TooManyYarns,
    /// The program makes no loop.
    #[error("the program makes no loop")]
    NoLoops,
}

/// Reads a program and works it.
///
/// # Errors
/// With the line, where the program is no knitout or cannot be knitted.
pub fn read_knitout(text: &str) -> Result<Knitted, KnitoutError> {
    if text.len() > LARGEST_PROGRAM {
        let reason = Box::new(KnitoutErrorReason::TooLong { bytes: text.len() });
        return Err(KnitoutError { line: 1, span: 0..0, reason, source_note: None });
    }
    machine::knit(&program::read(text)?)
}
