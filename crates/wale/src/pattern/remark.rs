//! What a reader found unusual in a file that it could read all the same.

/// Something in a file that is worth a word.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct Remark {
    /// Line of the file, from 1.
    pub line: usize,
    /// What was seen there.
    pub what: String,
}
