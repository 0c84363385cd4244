//! Sparse Cholesky factors of a block matrix, analysed once and refactored in the same memory.
//!
//! The order of elimination is found on the graph of blocks, five times smaller than that of
//! slots, and only free slots enter the factor. Everything runs on the calling thread: below some
//! 100,000 unknowns two threads are slower than one, and one thread always gives the same bits.

use crate::block_matrix::{BLOCK, BlockMatrix, SLOTS};
use crate::block_pattern::BlockPattern;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltError, LltRegularization};
use faer::perm::PermRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::linalg::{SupernodalThreshold, amd};
use faer::sparse::{SparseColMat, SymbolicSparseColMat, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side, Spec};
use std::sync::Arc;
use thiserror::Error;

/// Why a factor could not be made.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum CholeskyError {
    /// The matrix has a direction of zero or negative curvature; a shift may mend it.
    #[error("the matrix is not positive definite (pivot {pivot} of {unknowns})")]
    NotPositiveDefinite {
        /// Place of the pivot that failed, in elimination order.
        pivot: usize,
        /// Number of unknowns.
        unknowns: usize,
    },
    /// The matrix holds an infinite value or a NaN.
    #[error("the matrix holds a value that is not finite")]
    NotFinite,
    /// The factor does not fit in memory, or its size not in 31 bits.
    #[error("the factor of {unknowns} unknowns is too large")]
    TooLarge {
        /// Number of unknowns.
        unknowns: usize,
    },
}

/// In which order the blocks are eliminated.
#[derive(Clone, Copy, Debug)]
pub enum BlockOrder<'a> {
    /// Approximate minimum degree on the graph of blocks.
    MinimumDegree,
    /// The given order: entry `k` is the block eliminated `k`-th. Each block once.
    Given(&'a [u32]),
}

/// A sparse `L Lᵀ` factor of the free part of a block matrix.
pub struct SparseCholesky {
    pattern: Arc<BlockPattern>,
    /// Slots that are unknowns, ascending.
    slots: Vec<u32>,
    /// Per block, where its slots begin in `slots`.
    slot_start: Vec<u32>,
    /// Lower triangle of the free part, by columns.
    lower: SparseColMat<u32, f64>,
    symbolic: SymbolicCholesky<u32>,
    factor: Vec<f64>,
    right_hand_side: Vec<f64>,
    /// Several right sides over the unknowns, one after the other.
    columns: Vec<f64>,
    memory: MemBuffer,
    factored: bool,
}

impl std::fmt::Debug for SparseCholesky {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SparseCholesky")
            .field("unknowns", &self.unknowns())
            .field("factor_values", &self.factor_values())
            .field("factored", &self.factored)
            .finish()
    }
}

/// First and largest relative shift of a matrix whose rounding alone makes it indefinite.
const ROUNDING: f64 = 1e-14;
const LARGEST_ROUNDING: f64 = 1e-7;

impl SparseCholesky {
    /// Analyses the pattern and takes all memory that factoring and solving will need.
    ///
    /// `free` holds one flag a slot; fixed slots are left out, whatever the matrix holds there.
    ///
    /// # Errors
    /// [`CholeskyError::TooLarge`].
    ///
    /// # Panics
    /// If `free` has not one flag a slot, or a given order is not a permutation of the blocks.
    pub fn new(pattern: Arc<BlockPattern>, free: &[bool], order: BlockOrder<'_>) -> Result<Self, CholeskyError> {
        assert_eq!(free.len(), pattern.rows() * SLOTS);
        let (slots, slot_start) = unknown_slots(free);
        let unknowns = slots.len();
        let too_large = |_| CholeskyError::TooLarge { unknowns };
        let order = match order {
            BlockOrder::MinimumDegree => minimum_degree(&pattern)?,
            BlockOrder::Given(order) => order.to_vec(),
        };
        let (forward, inverse) = expand_order(&order, &slot_start);
        let lower = lower_triangle(&pattern, &slots, &slot_start);
        let params = CholeskySymbolicParams {
            // Blocks make dense columns, so supernodes always pay.
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let symbolic = factorize_symbolic_cholesky(
            lower.symbolic(),
            Side::Lower,
            SymmetricOrdering::Custom(PermRef::new_checked(&forward, &inverse, unknowns)),
            params,
        )
        .map_err(too_large)?;
        let request = symbolic
            .factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default())
            .or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        let memory = MemBuffer::try_new(request).map_err(|_| CholeskyError::TooLarge { unknowns })?;
        let mut factor = Vec::new();
        factor.try_reserve_exact(symbolic.len_val()).map_err(|_| CholeskyError::TooLarge { unknowns })?;
        factor.resize(symbolic.len_val(), 0.0);
        Ok(Self {
            pattern,
            slots,
            slot_start,
            lower,
            symbolic,
            factor,
            right_hand_side: vec![0.0; unknowns],
            columns: Vec::new(),
            memory,
            factored: false,
        })
    }

    /// Number of unknowns in the factor.
    pub fn unknowns(&self) -> usize {
        self.slots.len()
    }

    /// Numbers stored in the factor.
    pub fn factor_values(&self) -> usize {
        self.factor.len()
    }

    /// Factors the free part of `matrix`, whose diagonal is first multiplied by
    /// `1 + relative_shift`.
    ///
    /// # Errors
    /// [`CholeskyError::NotPositiveDefinite`] and [`CholeskyError::NotFinite`]; the factor is then
    /// of no use until a later call succeeds.
    ///
    /// # Panics
    /// If the matrix is over another pattern.
    pub fn factor(&mut self, matrix: &BlockMatrix, relative_shift: f64) -> Result<(), CholeskyError> {
        self.factored = false;
        self.gather(matrix, 1.0 + relative_shift)?;
        let unknowns = self.unknowns();
        if unknowns > 0 {
            self.symbolic
                .factorize_numeric_llt(
                    &mut self.factor,
                    self.lower.as_ref(),
                    Side::Lower,
                    LltRegularization::default(),
                    Par::Seq,
                    MemStack::new(&mut self.memory),
                    Spec::default(),
                )
                .map_err(|LltError::NonPositivePivot { index: pivot }| CholeskyError::NotPositiveDefinite {
                    pivot,
                    unknowns,
                })?;
        }
        self.factored = true;
        Ok(())
    }

    /// Factors a matrix that is positive definite but for what is rounded off in it, with the least of a few relative shifts; the first is none.
    /// What is stiff beside what is soft leaves such: of `k + c` and `−k`, with `c` a seventeenth digit of `k`, nothing remains of `c`.
    ///
    /// # Errors
    /// As [`SparseCholesky::factor`], if the largest shift does not do either.
    ///
    /// # Panics
    /// If the matrix is over another pattern.
    pub fn factor_rounded(&mut self, matrix: &BlockMatrix) -> Result<(), CholeskyError> {
        let mut shift = 0.0;
        loop {
            match self.factor(matrix, shift) {
                Err(CholeskyError::NotPositiveDefinite { .. }) if shift < LARGEST_ROUNDING => {
                    shift = f64::max(16.0 * shift, ROUNDING);
                }
                result => return result,
            }
        }
    }

    /// Solves in place for all slots; fixed slots come back as zero.
    ///
    /// # Panics
    /// If the last [`SparseCholesky::factor`] did not succeed, or the length is wrong.
    pub fn solve_in_place(&mut self, x: &mut [f64]) {
        assert!(self.factored, "solve without a factor");
        assert_eq!(x.len(), self.pattern.rows() * SLOTS);
        for (value, &slot) in self.right_hand_side.iter_mut().zip(&self.slots) {
            *value = x[slot as usize];
        }
        let unknowns = self.unknowns();
        if unknowns > 0 {
            LltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
                Conj::No,
                MatMut::from_column_major_slice_mut(&mut self.right_hand_side, unknowns, 1),
                Par::Seq,
                MemStack::new(&mut self.memory),
            );
        }
        x.fill(0.0);
        for (&value, &slot) in self.right_hand_side.iter().zip(&self.slots) {
            x[slot as usize] = value;
        }
    }

    /// Replaces several right sides at once, which is quicker than one after the other: the factor is read once.
    ///
    /// # Panics
    /// As [`Self::solve_in_place`].
    pub fn solve_columns_in_place(&mut self, columns: &mut [Vec<f64>]) {
        assert!(self.factored, "solve without a factor");
        assert!(columns.iter().all(|column| column.len() == self.pattern.rows() * SLOTS));
        let unknowns = self.unknowns();
        if unknowns == 0 || columns.is_empty() {
            return columns.iter_mut().for_each(|column| column.fill(0.0));
        }
        let request = self.symbolic.solve_in_place_scratch::<f64>(columns.len(), Par::Seq);
        if self.memory.len() < request.unaligned_bytes_required() {
            self.memory = MemBuffer::new(request);
        }
        self.columns.clear();
        for column in columns.iter() {
            self.columns.extend(self.slots.iter().map(|&slot| column[slot as usize]));
        }
        LltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(&mut self.columns, unknowns, columns.len()),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
        for (column, values) in columns.iter_mut().zip(self.columns.chunks_exact(unknowns)) {
            column.fill(0.0);
            for (&value, &slot) in values.iter().zip(&self.slots) {
                column[slot as usize] = value;
            }
        }
    }

    /// Copies the lower triangle of the free part, in the order of [`lower_triangle`].
    fn gather(&mut self, matrix: &BlockMatrix, diagonal_factor: f64) -> Result<(), CholeskyError> {
        assert_eq!(matrix.pattern().block_count(), self.pattern.block_count());
        let values = self.lower.val_mut();
        let mut next = 0;
        let mut finite = true;
        for row in 0..self.pattern.rows() {
            let mine = slots_of(&self.slots, &self.slot_start, row);
            let diagonal = self.pattern.diagonal_position(row);
            for &slot in mine {
                let r = slot as usize % SLOTS;
                for position in diagonal..self.pattern.row_start()[row + 1] {
                    let column = self.pattern.columns()[position] as usize;
                    let block: &[f64; BLOCK] = &matrix.blocks()[position];
                    for &other in slots_of(&self.slots, &self.slot_start, column) {
                        if other >= slot {
                            let factor = if other == slot { diagonal_factor } else { 1.0 };
                            let value = block[other as usize % SLOTS * SLOTS + r] * factor;
                            finite &= value.is_finite();
                            values[next] = value;
                            next += 1;
                        }
                    }
                }
            }
        }
        if finite { Ok(()) } else { Err(CholeskyError::NotFinite) }
    }
}

/// The free slots, and per block where its own begin.
fn unknown_slots(free: &[bool]) -> (Vec<u32>, Vec<u32>) {
    let mut slots = Vec::new();
    let mut start = vec![0];
    for (block, flags) in free.as_chunks::<SLOTS>().0.iter().enumerate() {
        for (slot, &flag) in flags.iter().enumerate() {
            if flag {
                slots.push((block * SLOTS + slot) as u32);
            }
        }
        start.push(slots.len() as u32);
    }
    (slots, start)
}

fn slots_of<'a>(slots: &'a [u32], start: &[u32], block: usize) -> &'a [u32] {
    &slots[start[block] as usize..start[block + 1] as usize]
}

/// Approximate minimum degree on the graph of blocks.
fn minimum_degree(pattern: &BlockPattern) -> Result<Vec<u32>, CholeskyError> {
    let rows = pattern.rows();
    let too_large = CholeskyError::TooLarge { unknowns: rows * SLOTS };
    let start: Vec<u32> = pattern.row_start().iter().map(|&s| s as u32).collect();
    let graph = SymbolicSparseColMatRef::new_checked(rows, rows, &start, None, pattern.columns());
    let (mut forward, mut inverse) = (vec![0; rows], vec![0; rows]);
    let request = amd::order_scratch::<u32>(rows, pattern.block_count());
    let mut memory = MemBuffer::try_new(request).map_err(|_| too_large.clone())?;
    amd::order(&mut forward, &mut inverse, graph, amd::Control::default(), MemStack::new(&mut memory))
        .map_err(|_| too_large)?;
    Ok(forward)
}

/// From an order of blocks to one of unknowns, and its inverse.
fn expand_order(order: &[u32], slot_start: &[u32]) -> (Vec<u32>, Vec<u32>) {
    assert_eq!(order.len() + 1, slot_start.len());
    let unknowns = slot_start[order.len()] as usize;
    let mut forward = Vec::with_capacity(unknowns);
    let mut inverse = vec![0; unknowns];
    for &block in order {
        for unknown in slot_start[block as usize]..slot_start[block as usize + 1] {
            inverse[unknown as usize] = forward.len() as u32;
            forward.push(unknown);
        }
    }
    (forward, inverse)
}

/// The pattern of the lower triangle over the unknowns, by columns.
///
/// A column below the diagonal is, by symmetry, a row right of it, so one walk along the rows of
/// the block pattern gives the columns in order.
fn lower_triangle(pattern: &BlockPattern, slots: &[u32], slot_start: &[u32]) -> SparseColMat<u32, f64> {
    let mut column_start = vec![0];
    let mut row_index = Vec::new();
    for row in 0..pattern.rows() {
        for unknown in slot_start[row]..slot_start[row + 1] {
            for position in pattern.diagonal_position(row)..pattern.row_start()[row + 1] {
                let column = pattern.columns()[position] as usize;
                let others = slot_start[column]..slot_start[column + 1];
                row_index.extend(others.filter(|&other| other >= unknown));
            }
            column_start.push(row_index.len() as u32);
        }
    }
    let values = vec![0.0; row_index.len()];
    let unknowns = slots.len();
    let symbolic = SymbolicSparseColMat::new_checked(unknowns, unknowns, column_start, None, row_index);
    SparseColMat::new(symbolic, values)
}
