//! What can go wrong while a fabric is written for other tools.

use std::error::Error;
use std::io;
use std::path::PathBuf;

/// Why an export failed. Nothing is left under the final name of a file that failed.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// A file could not be created, written or renamed.
    #[error("cannot write {}: {source}", path.display())]
    File {
        /// The file asked for.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A stream refused what was written to it, or ended before all was read.
    #[error("cannot write the export: {0}")]
    Stream(#[from] io::Error),
    /// There is nothing to write.
    #[error("there is no frame to export")]
    NoFrames,
    /// A frame could not be read.
    #[error("frame {index} cannot be read: {source}")]
    Frame {
        /// Place of the frame in the sequence.
        index: usize,
        /// What its reader said.
        source: Box<dyn Error + Send + Sync>,
    },
    /// A number is not finite.
    #[error("{what} is not a finite number")]
    NotFinite {
        /// What the number is, with its place.
        what: String,
    },
    /// Frames of one animation differ in their yarns or points.
    #[error("frame {index} has other yarns or points than the first frame")]
    Changed {
        /// Place of the frame in the sequence.
        index: usize,
    },
    /// Times do not increase from frame to frame.
    #[error("frame {index} is not later than the frame before it")]
    Order {
        /// Place of the frame in the sequence.
        index: usize,
    },
    /// More things than the format can count.
    #[error("too many {what} for this format (at most {most})")]
    TooMany {
        /// The things.
        what: &'static str,
        /// The format's limit.
        most: u64,
    },
    /// A table or snapshot whose parts do not fit together.
    #[error("{0}")]
    Inconsistent(String),
    /// A file that is not what it claims to be.
    #[error("not a readable {format} file: {reason}")]
    Malformed {
        /// The format that was expected.
        format: &'static str,
        /// What is wrong.
        reason: String,
    },
}
