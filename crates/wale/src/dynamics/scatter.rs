//! From an element's few numbers to their places in gradient and matrix.

use std::ops::Range;

use wale_numerics::block_matrix::RowChunk;
use wale_numerics::scalar::Scalar;

use crate::fabric::coordinates::{BLOCK, Dof};

/// Place of a block that an element leaves zero.
pub(super) const NOWHERE: u32 = u32::MAX;

/// A stretch of a stencil that lies in one block.
#[derive(Clone, Copy, Default)]
pub(super) struct Run {
    pub block: usize,
    /// First local coordinate, and one past the last.
    pub start: usize,
    pub end: usize,
}

/// The stretches of a stencil by blocks, and how many there are.
pub(super) fn runs<const N: usize>(stencil: &[Dof; N]) -> ([Run; N], usize) {
    let mut runs = [Run::default(); N];
    let mut count = 0;
    for (i, &dof) in stencil.iter().enumerate() {
        let block = dof as usize / BLOCK;
        if count > 0 && runs[count - 1].block == block {
            runs[count - 1].end = i + 1;
        } else {
            runs[count] = Run { block, start: i, end: i + 1 };
            count += 1;
        }
    }
    (runs, count)
}

/// Adds an element's gradient to the rows that are written here.
pub(super) fn scatter_gradient<const N: usize>(
    stencil: &[Dof; N],
    local: &[f64; N],
    rows: &Range<usize>,
    out: &mut [f64],
) {
    let (start, end) = (rows.start * BLOCK, rows.end * BLOCK);
    for i in 0..N {
        let dof = stencil[i] as usize;
        if dof >= start && dof < end {
            out[dof - start] += local[i];
        }
    }
}

/// Adds an element's Hessian to the rows that are written here; `places` are those of its blocks.
pub(super) fn scatter_hessian<T: Scalar, const N: usize>(
    stencil: &[Dof; N],
    local: &[[f64; N]; N],
    rows: &Range<usize>,
    places: &[u32],
    matrix: &mut RowChunk<'_, T>,
) {
    let (runs, count) = runs(stencil);
    let slots: [usize; N] = std::array::from_fn(|i| stencil[i] as usize % BLOCK);
    for (a, row) in runs[..count].iter().enumerate() {
        if !rows.contains(&row.block) {
            continue;
        }
        for (b, column) in runs[..count].iter().enumerate() {
            let place = places[a * count + b];
            if place == NOWHERE {
                continue;
            }
            // Columns of a block are its mirror image's rows.
            let block = matrix.block_at(place as usize).as_chunks_mut::<BLOCK>().0;
            let (first, last) = (row.start, row.end - 1);
            // Nearly always a whole position, with or without one arc length: short loops of known length.
            let position = slots[first] == 0 && (row.end - first).abs_diff(3) <= 1 && row.end - first >= 3;
            for j in column.start..column.end {
                let (to, from) = (&mut block[slots[j]], &local[j]);
                if position {
                    for (to, from) in to[..3].iter_mut().zip(&from[first..first + 3]) {
                        *to += T::from_f64(*from);
                    }
                    if last == first + 3 {
                        to[slots[last]] += T::from_f64(from[last]);
                    }
                } else {
                    for i in row.start..row.end {
                        to[slots[i]] += T::from_f64(from[i]);
                    }
                }
            }
        }
    }
}
