//! Incomplete Cholesky factors without fill, by blocks, cut in domains that work in parallel.
//!
//! The matrix is approximated by `(I + M) D (I + M)ᵀ`, `M` with the pattern of the strictly lower
//! blocks and `D` block diagonal; on a pattern without fill this is exact. It is computed in 64
//! bits, because stiff and soft directions differ by more than 32 bits can tell apart after
//! elimination; `M` is kept in 16, the same on both sides of the diagonal, because the sweeps are
//! bound by memory, `D⁻¹` in 32. Rows keep their natural
//! order, which follows the yarn along the courses. Couplings between domains are dropped in the
//! factor: nearly free for the loose solves inside Newton. The number of domains follows from the
//! size of the matrix alone, so results are the same on any thread count.

use crate::block_matrix::{BLOCK, BlockMatrix, LANES, PADDING, PaddedBlock, SLOTS, row_times_vector};
use crate::block_pattern::BlockPattern;
use crate::preconditioner::Preconditioner;
use crate::scalar::{Coarse, Scalar};
use crate::small_block::{inverse_of_positive, product, subtract_product, transposed};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;
use thiserror::Error;

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
            rows_per_domain: 2048,
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

/// The factor.
#[derive(Clone, Debug)]
pub struct IncompleteCholesky {
    pattern: Arc<BlockPattern>,
    settings: IncompleteCholeskySettings,
    rows_per_domain: usize,
    domains: Vec<Domain>,
}

/// Some consecutive rows and the couplings among them; rows and columns count from its first.
#[derive(Clone, Debug)]
struct Domain {
    first_row: usize,
    /// `M`.
    lower: Half,
    /// `Mᵀ`: kept too, so that both sweeps gather along rows; its rows lie in the order of the sweep, from the last.
    upper: Half,
    /// Column-major blocks, and [`PADDING`].
    inverse_diagonal: Vec<f32>,
    /// Place in the matrix of each lower block.
    source: Vec<u32>,
    /// Place in `upper` of the mirror image of each lower block.
    mirror: Vec<u32>,
    recent: Recent,
    /// What is left of the row being factored: its lower blocks, then its diagonal one.
    row: Vec<[f64; BLOCK]>,
    /// Solution of the forward sweep, then of both.
    solution: Vec<PaddedBlock>,
    outcome: Result<f64, usize>,
}

/// The blocks on one side of the diagonal, by rows.
#[derive(Clone, Debug)]
struct Half {
    backwards: bool,
    row_start: Vec<u32>,
    column: Vec<u32>,
    /// Column-major blocks, and [`PADDING`].
    entries: Vec<Coarse>,
}

/// The rows in 64 bits that later ones may still need, in two rings.
#[derive(Clone, Debug)]
struct Recent {
    /// `(D Mᵀ)` at `place & upper_mask`, places being those of the upper half.
    upper: Vec<[f64; BLOCK]>,
    upper_mask: usize,
    /// `D⁻¹` at `row & diagonal_mask`.
    diagonal: Vec<[f64; BLOCK]>,
    diagonal_mask: usize,
}

impl IncompleteCholesky {
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
    pub fn factor<T: Scalar>(
        &mut self,
        matrix: &BlockMatrix<T>,
    ) -> Result<IncompleteCholeskyReport, IncompleteCholeskyError> {
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

impl Preconditioner for IncompleteCholesky {
    fn add(&mut self, residual: &[f64], out: &mut [f64]) {
        self.solve::<true>(residual, out);
    }
    fn apply(&mut self, residual: &[f64], out: &mut [f64]) {
        self.solve::<false>(residual, out);
    }
}

impl Half {
    fn new(backwards: bool) -> Self {
        Self { backwards, row_start: vec![0], column: Vec::new(), entries: Vec::new() }
    }

    #[inline(always)]
    fn row(&self, row: usize) -> Range<usize> {
        let place = if self.backwards { self.row_start.len() - 2 - row } else { row };
        self.row_start[place] as usize..self.row_start[place + 1] as usize
    }

    /// The sum of blocks times vectors over one row.
    #[inline(always)]
    fn row_times(&self, row: usize, x: &[PaddedBlock]) -> PaddedBlock {
        let range = self.row(row);
        row_times_vector(&self.entries[range.start * BLOCK..], &self.column[range], x)
    }
}

fn write_block<S>(entries: &mut [S], place: usize, block: &[f64; BLOCK], store: impl Fn(f32) -> S) {
    for (to, from) in entries[place * BLOCK..][..BLOCK].iter_mut().zip(block) {
        *to = store(*from as f32);
    }
}

impl Recent {
    fn new(lower: &Half, upper: &Half) -> Self {
        let rows = lower.row_start.len() - 1;
        let (mut most_rows, mut most_places) = (0, 0);
        let mut first_needed = rows;
        for row in (0..rows).rev() {
            let lowest = lower.column[lower.row(row)].first();
            first_needed = first_needed.min(lowest.map_or(row, |&c| c as usize));
            most_rows = most_rows.max(row + 1 - first_needed);
            let places = upper.row(first_needed).end - upper.row(row).start;
            most_places = most_places.max(places);
        }
        let (rows, places) = (most_rows.max(1).next_power_of_two(), most_places.max(1).next_power_of_two());
        Self {
            upper: vec![[0.0; BLOCK]; places],
            upper_mask: places - 1,
            diagonal: vec![[0.0; BLOCK]; rows],
            diagonal_mask: rows - 1,
        }
    }
}

impl Domain {
    fn new(pattern: &BlockPattern, first_row: usize, end_row: usize) -> Self {
        let rows = end_row - first_row;
        let (mut lower, mut upper) = (Half::new(false), Half::new(true));
        let mut source = Vec::new();
        for row in first_row..end_row {
            for position in pattern.row_start()[row]..pattern.row_start()[row + 1] {
                let column = pattern.columns()[position] as usize;
                if (first_row..row).contains(&column) {
                    lower.column.push((column - first_row) as u32);
                    source.push(position as u32);
                }
            }
            lower.row_start.push(lower.column.len() as u32);
        }
        for row in (first_row..end_row).rev() {
            let above = pattern.row(row).iter().filter(|&&column| (row + 1..end_row).contains(&(column as usize)));
            upper.column.extend(above.map(|&column| column - first_row as u32));
            upper.row_start.push(upper.column.len() as u32);
        }
        // Rows ascend, so the mirror images in one upper row are met in its own order.
        let mut next: Vec<u32> = (0..rows).map(|row| upper.row(row).start as u32).collect();
        let mirror_of = |&column: &u32| {
            let place = &mut next[column as usize];
            *place += 1;
            *place - 1
        };
        let mirror = lower.column.iter().map(mirror_of).collect();
        for half in [&mut lower, &mut upper] {
            half.entries = vec![Coarse::default(); half.column.len() * BLOCK + PADDING];
        }
        let longest = (0..rows).map(|row| lower.row(row).len()).max();
        Self {
            first_row,
            source,
            mirror,
            recent: Recent::new(&lower, &upper),
            inverse_diagonal: vec![0.0; rows * BLOCK + PADDING],
            row: vec![[0.0; BLOCK]; longest.unwrap_or(0) + 1],
            solution: vec![[0.0; LANES]; rows],
            lower,
            upper,
            outcome: Err(first_row),
        }
    }

    fn factor<T: Scalar>(&mut self, matrix: &BlockMatrix<T>, settings: &IncompleteCholeskySettings) {
        for &shift in &settings.shifts {
            self.outcome = self.factor_shifted(matrix, shift, settings.smallest_pivot).map(|()| shift);
            if self.outcome.is_ok() {
                return;
            }
        }
    }

    fn factor_shifted<T: Scalar>(
        &mut self,
        matrix: &BlockMatrix<T>,
        shift: f64,
        smallest_pivot: f64,
    ) -> Result<(), usize> {
        for row in 0..self.solution.len() {
            let global = self.first_row + row;
            let diagonal = matrix.blocks()[matrix.pattern().diagonal_position(global)].map(T::to_f64);
            let range = self.lower.row(row);
            for (to, &source) in self.row.iter_mut().zip(&self.source[range.clone()]) {
                *to = transposed(&matrix.blocks()[source as usize].map(T::to_f64));
            }
            self.row[range.len()] = diagonal;
            self.eliminate(row);
            let remains = &mut self.row[range.len()];
            let mut kept = true;
            for entry in (0..BLOCK).step_by(SLOTS + 1) {
                remains[entry] += shift * diagonal[entry];
                kept &= remains[entry] > smallest_pivot * diagonal[entry];
            }
            let inverse = if kept { inverse_of_positive(remains, smallest_pivot) } else { None };
            let inverse = inverse.ok_or(global)?;
            self.recent.diagonal[row & self.recent.diagonal_mask] = inverse;
            write_block(&mut self.inverse_diagonal, row, &inverse, |x| x);
        }
        Ok(())
    }

    /// Subtracts from a row what the rows above it eliminate, one after the other.
    fn eliminate(&mut self, row: usize) {
        let range = self.lower.row(row);
        let columns = &self.lower.column[range.clone()];
        let mask = self.recent.upper_mask;
        for (k, &column) in columns.iter().enumerate() {
            let column = column as usize;
            let (done, rest) = self.row.split_at_mut(k + 1);
            let remains = &done[k];
            let mirror = self.mirror[range.start + k] as usize;
            let inverse = &self.recent.diagonal[column & self.recent.diagonal_mask];
            let factor = product(remains, inverse);
            let image = transposed(remains);
            self.recent.upper[mirror & mask] = image;
            // Column by column the mirror image is the factor row by row.
            write_block(&mut self.lower.entries, range.start + k, &transposed(&factor), Coarse::nearest);
            write_block(&mut self.upper.entries, mirror, &factor, Coarse::nearest);
            // The columns after this one that the row above has too; last of all the mirror
            // image itself, which meets the diagonal.
            let later = &columns[k + 1..];
            let mut next = 0;
            for place in self.upper.row(column).start..mirror {
                let other = self.upper.column[place];
                while next < later.len() && later[next] < other {
                    next += 1;
                }
                if next < later.len() && later[next] == other {
                    subtract_product(&mut rest[next], &factor, &self.recent.upper[place & mask]);
                }
            }
            subtract_product(&mut rest[later.len()], &factor, &image);
        }
    }

    fn solve<const ADD: bool>(&mut self, residual: &[f64], out: &mut [f64]) {
        let rows = self.solution.len();
        let residual = &residual.as_chunks::<SLOTS>().0[..rows];
        for row in 0..rows {
            let known = self.lower.row_times(row, &self.solution);
            let mut right: PaddedBlock = [0.0; LANES];
            for slot in 0..SLOTS {
                right[slot] = residual[row][slot] as f32;
            }
            self.solution[row] = std::array::from_fn(|lane| right[lane] - known[lane]);
        }
        let out = &mut out.as_chunks_mut::<SLOTS>().0[..rows];
        for row in (0..rows).rev() {
            let forward = [self.solution[row]];
            let scaled = row_times_vector(&self.inverse_diagonal[row * BLOCK..], &[0], &forward);
            let known = self.upper.row_times(row, &self.solution);
            let x: PaddedBlock = std::array::from_fn(|lane| scaled[lane] - known[lane]);
            self.solution[row] = x;
            for slot in 0..SLOTS {
                let value = f64::from(x[slot]);
                out[row][slot] = if ADD { out[row][slot] + value } else { value };
            }
        }
    }
}
