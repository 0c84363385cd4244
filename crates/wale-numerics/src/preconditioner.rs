//! Approximate inverses for conjugate gradients, and their sum.

use crate::block_matrix::{BLOCK, BlockMatrix, SLOTS};
use crate::small_block::inverse_of_positive;
use crate::vector;
use rayon::prelude::*;

/// A symmetric positive definite approximation of the inverse of a matrix.
pub trait Preconditioner {
    /// `out += M⁻¹ residual`.
    fn add(&mut self, residual: &[f64], out: &mut [f64]);

    /// `out = M⁻¹ residual`.
    fn apply(&mut self, residual: &[f64], out: &mut [f64]) {
        vector::fill(out, 0.0);
        self.add(residual, out);
    }
}

impl<P: Preconditioner + ?Sized> Preconditioner for &mut P {
    fn add(&mut self, residual: &[f64], out: &mut [f64]) {
        (**self).add(residual, out);
    }
    fn apply(&mut self, residual: &[f64], out: &mut [f64]) {
        (**self).apply(residual, out);
    }
}

/// An approximate inverse in two halves, the first of which writes to memory of its own and can go on beside others.
pub trait InTwoHalves: Preconditioner {
    /// Takes in the residual.
    fn take(&mut self, residual: &[f64]);
    /// `out += M⁻¹ residual` of the residual taken in last.
    fn give(&self, out: &mut [f64]);
}

impl<P: InTwoHalves + ?Sized> InTwoHalves for &mut P {
    fn take(&mut self, residual: &[f64]) {
        (**self).take(residual);
    }
    fn give(&self, out: &mut [f64]) {
        (**self).give(out);
    }
}

/// The sum of two approximate inverses, as of a local one and a coarse space; the second takes in the residual while
/// the first is applied.
#[derive(Clone, Debug)]
pub struct Additive<A, B>(pub A, pub B);

impl<A: Preconditioner + Send, B: InTwoHalves + Send> Preconditioner for Additive<A, B> {
    fn add(&mut self, residual: &[f64], out: &mut [f64]) {
        let Self(first, second) = self;
        rayon::join(|| second.take(residual), || first.add(residual, out));
        second.give(out);
    }
    fn apply(&mut self, residual: &[f64], out: &mut [f64]) {
        let Self(first, second) = self;
        rayon::join(|| second.take(residual), || first.apply(residual, out));
        second.give(out);
    }
}

/// Nothing at all: plain conjugate gradients.
#[derive(Clone, Copy, Debug)]
pub struct Identity;

impl Preconditioner for Identity {
    fn add(&mut self, residual: &[f64], out: &mut [f64]) {
        vector::add_scaled(out, 1.0, residual);
    }
}

/// The inverse of every diagonal block.
#[derive(Clone, Debug)]
pub struct BlockJacobi {
    inverse: Vec<[f32; BLOCK]>,
}

/// Block rows in one parallel piece.
const ROWS_PER_PIECE: usize = 2048;

impl BlockJacobi {
    /// Memory for a matrix of `rows` block rows.
    pub fn new(rows: usize) -> Self {
        Self { inverse: vec![[0.0; BLOCK]; rows] }
    }

    /// Inverts the diagonal blocks.
    ///
    /// A block that is not positive definite is replaced by the absolute values of its diagonal.
    ///
    /// # Panics
    /// If the matrix has another number of rows.
    pub fn factor(&mut self, matrix: &BlockMatrix) {
        assert_eq!(self.inverse.len(), matrix.rows());
        let invert = |row: usize, inverse: &mut [f32; BLOCK]| {
            let block = &matrix.blocks()[matrix.pattern().diagonal_position(row)];
            let wide = inverse_of_positive(block, 1e-14).unwrap_or_else(|| {
                let mut diagonal = [0.0; BLOCK];
                for slot in 0..SLOTS {
                    let size = block[slot * (SLOTS + 1)].abs();
                    diagonal[slot * (SLOTS + 1)] = if size > 0.0 { 1.0 / size } else { 1.0 };
                }
                diagonal
            });
            *inverse = wide.map(|v| v as f32);
        };
        self.inverse.par_chunks_mut(ROWS_PER_PIECE).enumerate().for_each(|(piece, inverses)| {
            for (k, inverse) in inverses.iter_mut().enumerate() {
                invert(piece * ROWS_PER_PIECE + k, inverse);
            }
        });
    }
}

impl Preconditioner for BlockJacobi {
    fn add(&mut self, residual: &[f64], out: &mut [f64]) {
        assert!(residual.len() == self.inverse.len() * SLOTS && out.len() == residual.len());
        let piece = |inverses: &[[f32; BLOCK]], residual: &[f64], out: &mut [f64]| {
            let residual = residual.as_chunks::<SLOTS>().0;
            let out = out.as_chunks_mut::<SLOTS>().0;
            for ((inverse, residual), out) in inverses.iter().zip(residual).zip(out) {
                for r in 0..SLOTS {
                    for c in 0..SLOTS {
                        out[r] += f64::from(inverse[r * SLOTS + c]) * residual[c];
                    }
                }
            }
        };
        if self.inverse.len() <= ROWS_PER_PIECE {
            return piece(&self.inverse, residual, out);
        }
        let length = ROWS_PER_PIECE * SLOTS;
        out.par_chunks_mut(length)
            .zip(residual.par_chunks(length))
            .zip(self.inverse.par_chunks(ROWS_PER_PIECE))
            .for_each(|((out, residual), inverses)| piece(inverses, residual, out));
    }
}
