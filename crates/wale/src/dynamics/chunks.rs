//! Which rows of the matrix are summed together.

use std::ops::Range;

/// Cuts of the block rows into chunks; decided by the fabric's size alone.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chunks {
    pub(super) bounds: Vec<usize>,
}

/// Blocks a chunk has at least, but for the smallest fabrics.
const SMALLEST_CHUNK: usize = 1024;
/// Chunks up to the size at which each has [`LARGE_CHUNK`] blocks: more would repeat more of the elements that straddle
/// two.
const MOST_CHUNKS: usize = 16;
/// Blocks of a chunk of a large fabric.
const LARGE_CHUNK: usize = 8192;

impl Chunks {
    /// Cuts `block_count` rows.
    #[must_use]
    pub fn new(block_count: usize) -> Self {
        let most = MOST_CHUNKS.max(block_count / LARGE_CHUNK);
        let count = (block_count / SMALLEST_CHUNK).clamp(1, most);
        Self { bounds: (0..=count).map(|k| k * block_count / count).collect() }
    }
    /// First row of each chunk, and the number of rows.
    #[must_use]
    pub fn bounds(&self) -> &[usize] {
        &self.bounds
    }
    /// Number of chunks.
    #[must_use]
    pub fn count(&self) -> usize {
        self.bounds.len() - 1
    }
    /// Rows of a chunk.
    #[must_use]
    pub fn rows(&self, chunk: usize) -> Range<usize> {
        self.bounds[chunk]..self.bounds[chunk + 1]
    }
    /// The chunk of a row.
    #[must_use]
    pub fn of(&self, row: usize) -> usize {
        self.bounds.partition_point(|&bound| bound <= row) - 1
    }
}
