//! A coarse space of slow motions, added to a local preconditioner.
//!
//! Smooth motions of a whole fabric cost almost no energy and no local method sees them. Here they
//! are spanned by translations of the nodes of a coarse grid ([`Prolongation`]); the coarse matrix
//! `PᵀAP` is formed in one pass over the matrix and factored each time.

use crate::block_matrix::{BLOCK, BlockMatrix, SLOTS};
use crate::block_pattern::BlockPattern;
use crate::preconditioner::{InTwoHalves, Preconditioner};
use crate::prolongation::Prolongation;
use crate::scalar::Scalar;
use crate::sparse_cholesky::{BlockOrder, CholeskyError, SparseCholesky};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// Translations of a node: the first three of its slots.
const AXES: usize = 3;
/// Relative shifts of the coarse diagonal, tried in this order. The first is a guard: on a thin
/// fabric two hats may carry the same motion.
const SHIFTS: [f64; 5] = [1e-10, 1e-8, 1e-6, 1e-4, 1e-2];

/// The coarse part of a two-level preconditioner.
#[derive(Debug)]
pub struct CoarseSpace {
    pattern: Arc<BlockPattern>,
    prolongation: Prolongation,
    /// Per block, which translations are free, one bit each.
    free: Vec<u8>,
    pieces: Vec<Piece>,
    rows_per_piece: usize,
    /// 1 on coarse slots without support and 0 elsewhere.
    matrix: BlockMatrix,
    cholesky: SparseCholesky,
    solution: Vec<f64>,
}

/// Some consecutive fine rows, and their share of the coarse matrix and of a coarse vector.
///
/// Pieces follow from the size of the matrix alone and are summed in their order.
#[derive(Debug)]
struct Piece {
    rows: Range<usize>,
    /// Coarse rows that the fine rows touch.
    coarse: Range<usize>,
    /// 3 × 3 blocks of those coarse rows.
    blocks: Vec<[f64; AXES * AXES]>,
    vector: Vec<[f64; AXES]>,
    row: RowSums,
}

/// `Σⱼ Aᵢⱼ Pⱼ` of one fine row, by coarse node.
#[derive(Debug, Default)]
struct RowSums {
    nodes: Vec<u32>,
    sums: Vec<[f64; AXES * AXES]>,
}

impl CoarseSpace {
    /// Analyses the coarse problem of matrices over `pattern`.
    ///
    /// `free` holds one flag a slot; coarse translations that move no free slot are left out.
    ///
    /// # Errors
    /// [`CholeskyError::TooLarge`].
    ///
    /// # Panics
    /// If the prolongation or the flags are of another number of blocks.
    pub fn new(pattern: Arc<BlockPattern>, prolongation: Prolongation, free: &[bool]) -> Result<Self, CholeskyError> {
        let rows = pattern.rows();
        assert!(prolongation.corners.len() == rows && free.len() == rows * SLOTS);
        let free: Vec<u8> =
            free.as_chunks::<SLOTS>().0.iter().map(|f| (0..AXES).map(|axis| u8::from(f[axis]) << axis).sum()).collect();
        let coarse_pattern = Arc::new(coarse_pattern(&pattern, &prolongation));
        let supported = supported_slots(&prolongation, &free);
        let cholesky = SparseCholesky::new(Arc::clone(&coarse_pattern), &supported, BlockOrder::MinimumDegree)?;
        let rows_per_piece = rows.div_ceil((rows / 4096).clamp(1, 32)).max(1);
        let pieces = (0..rows)
            .step_by(rows_per_piece)
            .map(|first| {
                let rows = first..rows.min(first + rows_per_piece);
                Piece::new(rows, &prolongation, &coarse_pattern)
            })
            .collect();
        Ok(Self {
            pattern,
            free,
            pieces,
            rows_per_piece,
            solution: vec![0.0; prolongation.coarse_nodes * SLOTS],
            prolongation,
            matrix: BlockMatrix::zeros(coarse_pattern),
            cholesky,
        })
    }

    /// Number of coarse unknowns.
    pub fn unknowns(&self) -> usize {
        self.cholesky.unknowns()
    }

    /// The coarse matrix `PᵀAP` of the last [`CoarseSpace::factor`], in the first three slots of
    /// its blocks.
    pub fn coarse_matrix(&self) -> &BlockMatrix {
        &self.matrix
    }

    /// Forms and factors the coarse matrix; returns the relative diagonal shift it took.
    ///
    /// Fixed slots of the matrix count for nothing, whatever it holds there.
    ///
    /// # Errors
    /// If the coarse matrix is not positive definite even with the largest shift.
    ///
    /// # Panics
    /// If the matrix is over another pattern.
    pub fn factor<T: Scalar>(&mut self, matrix: &BlockMatrix<T>) -> Result<f64, CholeskyError> {
        self.project(matrix);
        let mut outcome = Ok(0.0);
        for shift in SHIFTS {
            outcome = self.cholesky.factor(&self.matrix, shift).map(|()| shift);
            if outcome.is_ok() {
                break;
            }
        }
        outcome
    }

    fn project<T: Scalar>(&mut self, matrix: &BlockMatrix<T>) {
        assert_eq!(matrix.pattern().block_count(), self.pattern.block_count());
        let (prolongation, free) = (&self.prolongation, &self.free);
        let coarse_pattern = Arc::clone(self.matrix.pattern());
        self.pieces.par_iter_mut().for_each(|piece| piece.project(matrix, prolongation, free, &coarse_pattern));
        self.matrix.values.fill(0.0);
        for piece in &self.pieces {
            let start = coarse_pattern.row_start()[piece.coarse.start];
            let coarse = &mut self.matrix.values.as_chunks_mut::<BLOCK>().0[start..];
            for (to, from) in coarse.iter_mut().zip(&piece.blocks) {
                for r in 0..AXES {
                    for c in 0..AXES {
                        to[c * SLOTS + r] += from[r * AXES + c];
                    }
                }
            }
        }
    }
}

impl Preconditioner for CoarseSpace {
    fn add(&mut self, residual: &[f64], out: &mut [f64]) {
        self.take(residual);
        self.give(out);
    }
}

impl InTwoHalves for CoarseSpace {
    fn take(&mut self, residual: &[f64]) {
        assert!(residual.len() == self.free.len() * SLOTS);
        let (prolongation, free) = (&self.prolongation, &self.free);
        self.pieces.par_iter_mut().for_each(|piece| piece.restrict(residual, prolongation, free));
        self.solution.fill(0.0);
        let coarse = self.solution.as_chunks_mut::<SLOTS>().0;
        for piece in &self.pieces {
            for (to, from) in coarse[piece.coarse.clone()].iter_mut().zip(&piece.vector) {
                for axis in 0..AXES {
                    to[axis] += from[axis];
                }
            }
        }
        self.cholesky.solve_in_place(&mut self.solution);
    }

    fn give(&self, out: &mut [f64]) {
        assert!(out.len() == self.free.len() * SLOTS);
        let (prolongation, free) = (&self.prolongation, &self.free);
        let coarse = self.solution.as_chunks::<SLOTS>().0;
        out.par_chunks_mut(self.rows_per_piece * SLOTS).zip(&self.pieces).for_each(|(out, piece)| {
            let blocks = out.as_chunks_mut::<SLOTS>().0;
            for (out, row) in blocks.iter_mut().zip(piece.rows.clone()) {
                let mask = axis_mask(free[row]);
                let (corners, weights) = prolongation.weights_of(row);
                for (&corner, &weight) in corners.iter().zip(weights) {
                    for axis in 0..AXES {
                        out[axis] += weight * mask[axis] * coarse[corner as usize][axis];
                    }
                }
            }
        });
    }
}

impl Piece {
    fn new(rows: Range<usize>, prolongation: &Prolongation, coarse_pattern: &BlockPattern) -> Self {
        let touched = prolongation.corners[rows.clone()].as_flattened();
        let least = touched.iter().copied().min().unwrap_or(0) as usize;
        let coarse = least..touched.iter().copied().max().map_or(least, |m| m as usize + 1);
        let start = coarse_pattern.row_start();
        Self {
            rows,
            blocks: vec![[0.0; AXES * AXES]; start[coarse.end] - start[coarse.start]],
            vector: vec![[0.0; AXES]; coarse.len()],
            coarse,
            row: RowSums::default(),
        }
    }

    fn project<T: Scalar>(
        &mut self,
        matrix: &BlockMatrix<T>,
        prolongation: &Prolongation,
        free: &[u8],
        coarse_pattern: &BlockPattern,
    ) {
        self.blocks.fill([0.0; AXES * AXES]);
        let base = coarse_pattern.row_start()[self.coarse.start];
        for row in self.rows.clone() {
            if free[row] == 0 {
                continue;
            }
            self.row.collect(matrix, row, prolongation, free);
            let (corners, weights) = prolongation.weights_of(row);
            for (&corner, &weight) in corners.iter().zip(weights) {
                if weight == 0.0 {
                    continue;
                }
                let start = coarse_pattern.row_start()[corner as usize];
                let columns = coarse_pattern.row(corner as usize);
                for (node, sum) in self.row.nodes.iter().zip(&self.row.sums) {
                    // Present by construction of the coarse pattern.
                    let Some(found) = columns.iter().position(|c| c == node) else {
                        continue;
                    };
                    let block = &mut self.blocks[start + found - base];
                    for k in 0..AXES * AXES {
                        block[k] += weight * sum[k];
                    }
                }
            }
        }
    }

    fn restrict(&mut self, residual: &[f64], prolongation: &Prolongation, free: &[u8]) {
        self.vector.fill([0.0; AXES]);
        let residual = residual.as_chunks::<SLOTS>().0;
        for row in self.rows.clone() {
            let mask = axis_mask(free[row]);
            let (corners, weights) = prolongation.weights_of(row);
            for (&corner, &weight) in corners.iter().zip(weights) {
                let sum = &mut self.vector[corner as usize - self.coarse.start];
                for axis in 0..AXES {
                    sum[axis] += weight * mask[axis] * residual[row][axis];
                }
            }
        }
    }
}

impl RowSums {
    /// Sums the blocks of one row, each times the weights of its column.
    fn collect<T: Scalar>(&mut self, matrix: &BlockMatrix<T>, row: usize, prolongation: &Prolongation, free: &[u8]) {
        self.nodes.clear();
        self.sums.clear();
        let pattern = matrix.pattern();
        let start = pattern.row_start()[row];
        let rows_free = axis_mask(free[row]);
        // Neighbours mostly lie in the same coarse cell.
        let mut last = None;
        let mut places = [0; 4];
        for (k, &column) in pattern.row(row).iter().enumerate() {
            let column = column as usize;
            let (corners, weights) = prolongation.weights_of(column);
            if last != Some(corners) {
                for (place, &corner) in places.iter_mut().zip(corners) {
                    *place = self.place_of(corner);
                }
                last = Some(corners);
            }
            let block = &matrix.blocks()[start + k];
            let columns_free = axis_mask(free[column]);
            let entries: [f64; AXES * AXES] = std::array::from_fn(|k| {
                let (r, c) = (k / AXES, k % AXES);
                block[c * SLOTS + r].to_f64() * rows_free[r] * columns_free[c]
            });
            for (&place, &weight) in places.iter().zip(weights) {
                let sum = &mut self.sums[place];
                for k in 0..AXES * AXES {
                    sum[k] += weight * entries[k];
                }
            }
        }
    }

    fn place_of(&mut self, node: u32) -> usize {
        if let Some(place) = self.nodes.iter().position(|&n| n == node) {
            return place;
        }
        self.nodes.push(node);
        self.sums.push([0.0; AXES * AXES]);
        self.nodes.len() - 1
    }
}

/// 1 for a free translation, 0 for a fixed one.
#[inline(always)]
fn axis_mask(free: u8) -> [f64; AXES] {
    std::array::from_fn(|axis| f64::from((free >> axis) & 1))
}

/// Coarse nodes meet when blocks that move with them do.
fn coarse_pattern(pattern: &BlockPattern, prolongation: &Prolongation) -> BlockPattern {
    let mut meets: Vec<Vec<u32>> = vec![Vec::new(); prolongation.coarse_nodes];
    let mut last = None;
    for row in 0..pattern.rows() {
        for &column in pattern.row(row) {
            let cells = (&prolongation.corners[row], &prolongation.corners[column as usize]);
            if last == Some(cells) {
                continue;
            }
            last = Some(cells);
            for &a in cells.0 {
                let meets = &mut meets[a as usize];
                for &b in cells.1 {
                    if !meets.contains(&b) {
                        meets.push(b);
                    }
                }
            }
        }
    }
    let pairs = meets.iter().enumerate().flat_map(|(a, others)| others.iter().map(move |&b| (a as u32, b)));
    BlockPattern::from_pairs(prolongation.coarse_nodes, pairs)
}

/// Coarse slots that move at least one free slot.
fn supported_slots(prolongation: &Prolongation, free: &[u8]) -> Vec<bool> {
    let mut supported = vec![false; prolongation.coarse_nodes * SLOTS];
    for (row, &free) in free.iter().enumerate() {
        let (corners, weights) = prolongation.weights_of(row);
        for (&corner, &weight) in corners.iter().zip(weights) {
            for axis in 0..AXES {
                if weight != 0.0 && (free >> axis) & 1 == 1 {
                    supported[corner as usize * SLOTS + axis] = true;
                }
            }
        }
    }
    supported
}
