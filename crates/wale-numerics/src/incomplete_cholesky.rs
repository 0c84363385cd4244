//! Incomplete Cholesky factors without fill, by blocks, cut in domains that work in parallel.
//!
//! The matrix is approximated by `(D + L) D⁻¹ (D + L)ᵀ`, `L` with the pattern of the strictly
//! lower blocks and `D` block diagonal; on a pattern without fill this is exact. Rows keep their
//! natural order, which follows the yarn along the courses. Couplings between domains are dropped
//! in the factor: nearly free for the loose solves inside Newton. The number of domains follows
//! from the size of the matrix alone, so results are the same on any thread count.

use crate::block_matrix::{BLOCK, BlockMatrix, SLOTS};
use crate::block_pattern::BlockPattern;
use crate::preconditioner::Preconditioner;
use crate::scalar::Scalar;
use crate::small_block::inverse_of_positive;
use rayon::prelude::*;
use std::sync::Arc;
use thiserror::Error;

/// Lanes of one column: a column is read as a full vector register, the rest is ignored.
const LANES: usize = 8;
/// Numbers of a block, column-major, with room to read a full register from its last column.
const STRIDE: usize = 28;

type Block<T> = [T; STRIDE];
type Lanes<T> = [T; LANES];

/// How to cut and how to go on when a pivot fails.
#[derive(Clone, Debug, PartialEq)]
pub struct IncompleteCholeskySettings {
    /// Block rows a domain should have; a matrix of fewer than twice as many is one domain.
    pub rows_per_domain: usize,
    /// Largest number of domains.
    pub max_domains: usize,
    /// Relative shifts of the diagonal, tried in this order by each domain.
    pub shifts: Vec<f64>,
    /// A pivot counts as failed when it is not above this fraction of the matrix' own diagonal.
    pub smallest_pivot: f64,
}

impl Default for IncompleteCholeskySettings {
    fn default() -> Self {
        Self {
            rows_per_domain: 8192,
            max_domains: 32,
            shifts: vec![0.0, 1e-3, 4e-3, 1.6e-2, 6.4e-2, 0.25, 1.0],
            smallest_pivot: 1e-6,
        }
    }
}

/// No shift made all pivots positive.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("incomplete Cholesky failed at block row {row} with every diagonal shift")]
pub struct IncompleteCholeskyError {
    /// First block row that failed with the last shift.
    pub row: usize,
}

/// What a factorisation needed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IncompleteCholeskyReport {
    /// Largest relative shift of a domain.
    pub largest_shift: f64,
    /// Domains that needed more than the first shift.
    pub shifted_domains: usize,
    /// Number of domains.
    pub domains: usize,
}

/// The factor, in numbers of 32 bits unless said otherwise.
#[derive(Clone, Debug)]
pub struct IncompleteCholesky<T = f32> {
    pattern: Arc<BlockPattern>,
    settings: IncompleteCholeskySettings,
    rows_per_domain: usize,
    domains: Vec<Domain<T>>,
}

/// Some consecutive rows and the couplings among them.
#[derive(Clone, Debug)]
struct Domain<T> {
    first_row: usize,
    /// Per row, where its strictly lower blocks begin.
    row_start: Vec<u32>,
    /// Column of each lower block, counted from the first row of the domain.
    column: Vec<u32>,
    /// Place of each lower block in the matrix.
    source: Vec<u32>,
    lower: Vec<Block<T>>,
    inverse_diagonal: Vec<Block<T>>,
    /// `L D⁻¹` of the row being factored.
    scaled: Vec<Block<T>>,
    /// Solution of the forward sweep.
    forward: Vec<Lanes<T>>,
    /// `Lᵀ x` as far as it is known in the backward sweep.
    pulled: Vec<Lanes<T>>,
    outcome: Result<f64, usize>,
}

impl<T: Scalar> IncompleteCholesky<T> {
    /// Takes the memory for matrices over `pattern`.
    pub fn new(pattern: Arc<BlockPattern>, settings: IncompleteCholeskySettings) -> Self {
        let rows = pattern.rows();
        let wanted = rows / settings.rows_per_domain.max(1);
        let count = wanted.clamp(1, settings.max_domains.max(1));
        let rows_per_domain = rows.div_ceil(count).max(1);
        let domains = (0..rows)
            .step_by(rows_per_domain)
            .map(|first| Domain::new(&pattern, first, rows.min(first + rows_per_domain)))
            .collect();
        Self { pattern, settings, rows_per_domain, domains }
    }

    /// Factors a matrix, from which fixed slots have been taken out
    /// ([`BlockMatrix::fix_slots`]).
    ///
    /// Every call starts from the first shift: the factor depends on the matrix alone.
    ///
    /// # Errors
    /// If a domain finds no shift that makes its pivots positive; the factor is then of no use.
    ///
    /// # Panics
    /// If the matrix is over another pattern.
    pub fn factor(&mut self, matrix: &BlockMatrix) -> Result<IncompleteCholeskyReport, IncompleteCholeskyError> {
        assert_eq!(matrix.pattern().block_count(), self.pattern.block_count());
        let settings = &self.settings;
        self.domains.par_iter_mut().for_each(|domain| domain.factor(matrix, settings));
        let first_shift = self.settings.shifts.first().copied().unwrap_or(0.0);
        let mut report =
            IncompleteCholeskyReport { largest_shift: 0.0, shifted_domains: 0, domains: self.domains.len() };
        for domain in &self.domains {
            match domain.outcome {
                Ok(shift) => {
                    report.largest_shift = report.largest_shift.max(shift);
                    report.shifted_domains += usize::from(shift != first_shift);
                }
                Err(row) => return Err(IncompleteCholeskyError { row }),
            }
        }
        Ok(report)
    }

    /// `out = M⁻¹ residual`, or `out += M⁻¹ residual` if `ADD`.
    fn solve<const ADD: bool>(&mut self, residual: &[f64], out: &mut [f64]) {
        let dimension = self.pattern.rows() * SLOTS;
        assert!(residual.len() == dimension && out.len() == dimension);
        if let [domain] = self.domains.as_mut_slice() {
            return domain.solve::<ADD>(residual, out);
        }
        let length = self.rows_per_domain * SLOTS;
        self.domains
            .par_iter_mut()
            .zip(residual.par_chunks(length))
            .zip(out.par_chunks_mut(length))
            .for_each(|((domain, residual), out)| domain.solve::<ADD>(residual, out));
    }
}

impl<T: Scalar> Preconditioner for IncompleteCholesky<T> {
    fn add(&mut self, residual: &[f64], out: &mut [f64]) {
        self.solve::<true>(residual, out);
    }
    fn apply(&mut self, residual: &[f64], out: &mut [f64]) {
        self.solve::<false>(residual, out);
    }
}

impl<T: Scalar> Domain<T> {
    fn new(pattern: &BlockPattern, first_row: usize, end_row: usize) -> Self {
        let rows = end_row - first_row;
        let mut row_start = vec![0];
        let (mut column, mut source) = (Vec::new(), Vec::new());
        let mut longest = 0;
        for row in first_row..end_row {
            for position in pattern.row_start()[row]..pattern.diagonal_position(row) {
                let other = pattern.columns()[position] as usize;
                if other >= first_row {
                    column.push((other - first_row) as u32);
                    source.push(position as u32);
                }
            }
            longest = longest.max(column.len() - row_start[row - first_row] as usize);
            row_start.push(column.len() as u32);
        }
        Self {
            first_row,
            lower: vec![[T::ZERO; STRIDE]; column.len()],
            inverse_diagonal: vec![[T::ZERO; STRIDE]; rows],
            scaled: vec![[T::ZERO; STRIDE]; longest],
            forward: vec![[T::ZERO; LANES]; rows],
            pulled: vec![[T::ZERO; LANES]; rows],
            row_start,
            column,
            source,
            outcome: Err(first_row),
        }
    }

    fn factor(&mut self, matrix: &BlockMatrix, settings: &IncompleteCholeskySettings) {
        for &shift in &settings.shifts {
            self.outcome = self.factor_shifted(matrix, 1.0 + shift, settings.smallest_pivot).map(|()| shift);
            if self.outcome.is_ok() {
                return;
            }
        }
    }

    fn factor_shifted(&mut self, matrix: &BlockMatrix, diagonal_factor: f64, smallest_pivot: f64) -> Result<(), usize> {
        let blocks = matrix.blocks();
        for row in 0..self.inverse_diagonal.len() {
            let range = self.row_start[row] as usize..self.row_start[row + 1] as usize;
            for place in range.clone() {
                let mut sums = [[T::ZERO; LANES]; SLOTS];
                let other = self.column[place] as usize;
                self.common_products(range.start..place, other, &mut sums);
                let block = &blocks[self.source[place] as usize];
                let entry = &mut self.lower[place];
                for c in 0..SLOTS {
                    for r in 0..SLOTS {
                        entry[c * SLOTS + r] = T::from_f64(block[r * SLOTS + c]) - sums[c][r];
                    }
                }
                let mut scaled = [[T::ZERO; LANES]; SLOTS];
                add_product(&mut scaled, entry, &self.inverse_diagonal[other]);
                store(&scaled, &mut self.scaled[place - range.start]);
            }
            let mut sums = [[T::ZERO; LANES]; SLOTS];
            for (scaled, lower) in self.scaled.iter().zip(&self.lower[range]) {
                add_product(&mut sums, scaled, lower);
            }
            let global = self.first_row + row;
            let block = &blocks[matrix.pattern().diagonal_position(global)];
            let remains: [f64; BLOCK] = std::array::from_fn(|k| {
                let (r, c) = (k / SLOTS, k % SLOTS);
                let shifted = if r == c { diagonal_factor } else { 1.0 };
                block[k] * shifted - sums[c][r].to_f64()
            });
            let kept = (0..SLOTS).all(|s| remains[s * (SLOTS + 1)] > smallest_pivot * block[s * (SLOTS + 1)]);
            let inverse = if kept { inverse_of_positive(&remains, smallest_pivot) } else { None };
            let inverse = inverse.ok_or(global)?;
            for (entry, value) in self.inverse_diagonal[row].iter_mut().zip(inverse) {
                *entry = T::from_f64(value);
            }
        }
        Ok(())
    }

    /// Adds `Σ (L D⁻¹)ᵢⱼ Lₖⱼᵀ` over the columns that the present row `i`, up to the place being
    /// computed, has in common with row `k`.
    #[inline]
    fn common_products(&self, present: std::ops::Range<usize>, k: usize, sums: &mut [Lanes<T>; SLOTS]) {
        let other_end = self.row_start[k + 1] as usize;
        let (mut mine, mut other) = (present.start, self.row_start[k] as usize);
        while mine < present.end && other < other_end {
            match self.column[mine].cmp(&self.column[other]) {
                std::cmp::Ordering::Less => mine += 1,
                std::cmp::Ordering::Greater => other += 1,
                std::cmp::Ordering::Equal => {
                    add_product(sums, &self.scaled[mine - present.start], &self.lower[other]);
                    mine += 1;
                    other += 1;
                }
            }
        }
    }

    fn solve<const ADD: bool>(&mut self, residual: &[f64], out: &mut [f64]) {
        let rows = self.inverse_diagonal.len();
        let residual = &residual.as_chunks::<SLOTS>().0[..rows];
        for row in 0..rows {
            let range = self.row_start[row] as usize..self.row_start[row + 1] as usize;
            let mut sums = [[T::ZERO; LANES]; SLOTS];
            for (block, &column) in self.lower[range.clone()].iter().zip(&self.column[range]) {
                add_columns(&mut sums, block, &self.forward[column as usize]);
            }
            let mut rest = [T::ZERO; LANES];
            for r in 0..SLOTS {
                rest[r] = T::from_f64(residual[row][r]) - total(&sums, r);
            }
            self.forward[row] = times(&self.inverse_diagonal[row], &rest);
            self.pulled[row] = [T::ZERO; LANES];
        }
        let out = &mut out.as_chunks_mut::<SLOTS>().0[..rows];
        for row in (0..rows).rev() {
            let correction = times(&self.inverse_diagonal[row], &self.pulled[row]);
            let mut x = [T::ZERO; LANES];
            for r in 0..SLOTS {
                x[r] = self.forward[row][r] - correction[r];
                let value = x[r].to_f64();
                out[row][r] = if ADD { out[row][r] + value } else { value };
            }
            let range = self.row_start[row] as usize..self.row_start[row + 1] as usize;
            for (block, &column) in self.lower[range.clone()].iter().zip(&self.column[range]) {
                let pulled = &mut self.pulled[column as usize];
                for c in 0..SLOTS {
                    let mut sum = pulled[c];
                    for r in 0..SLOTS {
                        sum = block[c * SLOTS + r].fused(x[r], sum);
                    }
                    pulled[c] = sum;
                }
            }
        }
    }
}

/// Column `c` of a block and what follows it in memory.
#[inline(always)]
fn column_of<T: Scalar>(block: &Block<T>, c: usize) -> Lanes<T> {
    std::array::from_fn(|lane| block[c * SLOTS + lane])
}

/// `sums += a bᵀ`, column by column.
#[inline(always)]
fn add_product<T: Scalar>(sums: &mut [Lanes<T>; SLOTS], a: &Block<T>, b: &Block<T>) {
    for c in 0..SLOTS {
        let column = column_of(a, c);
        for r in 0..SLOTS {
            for lane in 0..LANES {
                sums[r][lane] = column[lane].fused(b[c * SLOTS + r], sums[r][lane]);
            }
        }
    }
}

/// Adds to sum `c` column `c` of the block times `x[c]`: five independent chains.
#[inline(always)]
fn add_columns<T: Scalar>(sums: &mut [Lanes<T>; SLOTS], block: &Block<T>, x: &Lanes<T>) {
    for c in 0..SLOTS {
        let column = column_of(block, c);
        for lane in 0..LANES {
            sums[c][lane] = column[lane].fused(x[c], sums[c][lane]);
        }
    }
}

#[inline(always)]
fn total<T: Scalar>(sums: &[Lanes<T>; SLOTS], lane: usize) -> T {
    (sums[0][lane] + sums[1][lane]) + (sums[2][lane] + sums[3][lane]) + sums[4][lane]
}

/// Block times vector; the lanes beyond the slots hold nothing of meaning.
#[inline(always)]
fn times<T: Scalar>(block: &Block<T>, x: &Lanes<T>) -> Lanes<T> {
    let mut sums = [[T::ZERO; LANES]; SLOTS];
    add_columns(&mut sums, block, x);
    std::array::from_fn(|lane| total(&sums, lane))
}

#[inline(always)]
fn store<T: Scalar>(sums: &[Lanes<T>; SLOTS], block: &mut Block<T>) {
    for c in 0..SLOTS {
        for r in 0..SLOTS {
            block[c * SLOTS + r] = sums[c][r];
        }
    }
}
