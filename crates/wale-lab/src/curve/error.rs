//! What is wrong with a table, where, and the mend.

use std::fmt;

use thiserror::Error;

/// Why a curve cannot be had from a table.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub struct CurveError {
    /// Name of the file.
    pub file: String,
    /// Line, from 1; none if the whole file is meant.
    pub line: Option<usize>,
    /// What is wrong.
    pub what: String,
    /// How to mend it.
    pub mend: String,
}

impl fmt::Display for CurveError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "{}:{line}: {}; {}", self.file, self.what, self.mend),
            None => write!(f, "{}: {}; {}", self.file, self.what, self.mend),
        }
    }
}
