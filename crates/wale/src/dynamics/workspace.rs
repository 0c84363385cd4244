//! Scratch memory of sums, a part for each chunk of rows, so that their order does not depend on threads.

use super::chunks::Chunks;
use crate::fabric::coordinates::BLOCK;

/// Kinds of energy that there is room for.
const KINDS: usize = 16;

/// Scratch memory of sums.
#[derive(Default)]
pub struct Workspace {
    pub(super) chunks: Vec<ChunkWork>,
}

/// That of a chunk.
#[derive(Default)]
pub(super) struct ChunkWork {
    pub chunk: usize,
    pub gradient: Vec<f64>,
    pub energy: f64,
    pub by_kind: Vec<(&'static str, f64)>,
}

impl Workspace {
    /// Makes room for the chunks.
    pub(super) fn prepare(&mut self, chunks: &Chunks) {
        if self.chunks.len() != chunks.count() {
            self.chunks = (0..chunks.count())
                .map(|chunk| ChunkWork {
                    chunk,
                    gradient: vec![0.0; BLOCK * chunks.rows(chunk).len()],
                    energy: 0.0,
                    by_kind: Vec::with_capacity(KINDS),
                })
                .collect();
        }
    }

    /// Copies the rows' gradients together; the energies are added in the order of chunks.
    pub(super) fn collect(&self, chunks: &Chunks, gradient: &mut [f64]) -> f64 {
        for work in &self.chunks {
            let rows = chunks.rows(work.chunk);
            gradient[BLOCK * rows.start..BLOCK * rows.end].copy_from_slice(&work.gradient);
        }
        self.chunks.iter().map(|work| work.energy).sum()
    }
}
