//! A symmetric matrix of 5 × 5 blocks in compressed block rows, stored in full.
//!
//! Each node of a fabric owns one block row of five slots (x y z u v); slots it does not use are
//! fixed. Both halves are stored, so that every row can be assembled and multiplied by itself.

use crate::block_pattern::BlockPattern;
use crate::scalar::{Scalar, Stored};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// Slots of a block: three positions, two arc lengths.
pub const SLOTS: usize = 5;
/// Numbers in a block, column-major: a column times a number is what a product adds up.
pub const BLOCK: usize = SLOTS * SLOTS;
/// Numbers that a register holds; a column is read with what follows it.
pub const LANES: usize = 8;
/// Numbers after the last column that are read with it.
pub const PADDING: usize = LANES - SLOTS;

/// A block of a vector in 32 bits, padded to a full register.
pub type PaddedBlock = [f32; LANES];

/// Block rows in one parallel piece; part of no result, a row is always summed alone.
const ROWS_PER_PIECE: usize = 512;
/// Rows of a piece that are read in turn: memory answers several streams faster than one, by a quarter.
const STREAMS: usize = 4;

/// A block-sparse matrix over a shared pattern.
#[derive(Clone, Debug)]
pub struct BlockMatrix<T = f64> {
    pattern: Arc<BlockPattern>,
    /// Column-major 5 × 5 blocks in the order of [`BlockPattern::columns`], and [`PADDING`] zeros.
    pub values: Vec<T>,
}

/// Some consecutive rows of a matrix, to be written while others write other rows.
#[derive(Debug)]
pub struct RowChunk<'a, T = f64> {
    pattern: &'a BlockPattern,
    rows: Range<usize>,
    /// Place of its first block in the whole matrix.
    first_block: usize,
    values: &'a mut [T],
}

impl<T: Scalar> BlockMatrix<T> {
    /// The zero matrix.
    pub fn zeros(pattern: Arc<BlockPattern>) -> Self {
        let values = vec![T::ZERO; pattern.block_count() * BLOCK + PADDING];
        Self { pattern, values }
    }

    /// The pattern.
    #[inline]
    pub fn pattern(&self) -> &Arc<BlockPattern> {
        &self.pattern
    }

    /// Number of block rows.
    #[inline]
    pub fn rows(&self) -> usize {
        self.pattern.rows()
    }

    /// Number of scalar rows, unused slots included.
    #[inline]
    pub fn dimension(&self) -> usize {
        self.rows() * SLOTS
    }

    /// All blocks in the order of the pattern.
    #[inline]
    pub fn blocks(&self) -> &[[T; BLOCK]] {
        self.values.as_chunks().0
    }

    /// Block `(row, column)`, if the two meet.
    pub fn block(&self, row: usize, column: usize) -> Option<&[T; BLOCK]> {
        Some(&self.blocks()[self.pattern.position(row, column)?])
    }

    /// Block `(row, column)` to be written, if the two meet.
    pub fn block_mut(&mut self, row: usize, column: usize) -> Option<&mut [T; BLOCK]> {
        let position = self.pattern.position(row, column)?;
        self.values.as_chunks_mut().0.get_mut(position)
    }

    /// Columns and blocks of one row.
    pub fn row_mut(&mut self, row: usize) -> (&[u32], &mut [[T; BLOCK]]) {
        let range = self.pattern.row_start()[row]..self.pattern.row_start()[row + 1];
        let blocks = &mut self.values.as_chunks_mut().0[range];
        (self.pattern.row(row), blocks)
    }

    /// Sets every number to zero.
    pub fn clear(&mut self) {
        self.values.par_chunks_mut(ROWS_PER_PIECE * BLOCK).for_each(|piece| piece.fill(T::ZERO));
    }

    /// Cuts the matrix into the row ranges between consecutive bounds.
    ///
    /// `bounds` ascends, starts at 0 and ends at the number of rows.
    pub fn split_rows<'a>(&'a mut self, bounds: &'a [usize]) -> impl Iterator<Item = RowChunk<'a, T>> + use<'a, T> {
        let mut rest = RowChunk {
            pattern: &self.pattern,
            rows: 0..self.pattern.rows(),
            first_block: 0,
            values: self.values.as_mut_slice(),
        };
        bounds.windows(2).map(move |pair| {
            let empty = RowChunk { pattern: rest.pattern, rows: 0..0, first_block: 0, values: &mut [] };
            let (head, tail) = std::mem::replace(&mut rest, empty).split_at(pair[1]);
            rest = tail;
            head
        })
    }

    /// Calls `fill` for the row ranges between consecutive bounds, in parallel, each with its own
    /// companion (scratch memory, a slice of another output).
    ///
    /// Nothing is allocated. What is written depends on the bounds alone, not on the threads.
    ///
    /// # Panics
    /// If the number of companions is not one less than that of the bounds.
    pub fn for_each_row_chunk<S: Send>(
        &mut self,
        bounds: &[usize],
        companions: &mut [S],
        fill: impl Fn(&mut S, RowChunk<'_, T>) + Sync,
    ) {
        assert_eq!(bounds.len(), companions.len() + 1);
        let chunk =
            RowChunk { pattern: &self.pattern, rows: 0..self.pattern.rows(), first_block: 0, values: &mut self.values };
        halve(bounds, companions, chunk, &fill);
    }

    /// `out = A x`.
    pub fn multiply(&self, x: &[T], out: &mut [T]) {
        assert!(x.len() == self.dimension() && out.len() == self.dimension());
        let x = x.as_chunks::<SLOTS>().0;
        let piece = |first_row: usize, out: &mut [T]| {
            let rows = &self.pattern.row_start()[first_row..];
            for (pair, out) in rows.windows(2).zip(out.as_chunks_mut::<SLOTS>().0) {
                let columns = &self.pattern.columns()[pair[0]..pair[1]];
                let sums = row_times_vector(&self.values[pair[0] * BLOCK..], columns, x);
                out.copy_from_slice(&sums[..SLOTS]);
            }
        };
        if self.rows() <= ROWS_PER_PIECE {
            return piece(0, out);
        }
        out.par_chunks_mut(ROWS_PER_PIECE * SLOTS)
            .enumerate()
            .for_each(|(index, out)| piece(index * ROWS_PER_PIECE, out));
    }

    /// Adds `scale * diagonal[s]` to the diagonal entry of every slot `s`.
    pub fn add_diagonal(&mut self, diagonal: &[T], scale: T) {
        assert_eq!(diagonal.len(), self.dimension());
        let blocks = self.values.as_chunks_mut::<BLOCK>().0;
        for (row, entries) in diagonal.as_chunks::<SLOTS>().0.iter().enumerate() {
            let block = &mut blocks[self.pattern.diagonal_position(row)];
            for slot in 0..SLOTS {
                block[slot * (SLOTS + 1)] += scale * entries[slot];
            }
        }
    }

    /// Writes the diagonal entry of every slot.
    pub fn diagonal_into(&self, out: &mut [T]) {
        assert_eq!(out.len(), self.dimension());
        for (row, entries) in out.as_chunks_mut::<SLOTS>().0.iter_mut().enumerate() {
            let block = &self.blocks()[self.pattern.diagonal_position(row)];
            for slot in 0..SLOTS {
                entries[slot] = block[slot * (SLOTS + 1)];
            }
        }
    }

    /// Takes the fixed slots out of the system: their rows and columns become zero and their
    /// diagonal `scale`.
    ///
    /// `free` holds one flag a slot.
    pub fn fix_slots(&mut self, free: &[bool], scale: T) {
        assert_eq!(free.len(), self.dimension());
        let pattern = Arc::clone(&self.pattern);
        let free = free.as_chunks::<SLOTS>().0;
        let fix = |row: usize, columns: &[u32], blocks: &mut [[T; BLOCK]]| {
            for (block, &column) in blocks.iter_mut().zip(columns) {
                let (rows_free, columns_free) = (&free[row], &free[column as usize]);
                if rows_free.iter().chain(columns_free).all(|&f| f) {
                    continue;
                }
                for r in 0..SLOTS {
                    for c in 0..SLOTS {
                        if !(rows_free[r] && columns_free[c]) {
                            let on_diagonal = row == column as usize && r == c;
                            block[c * SLOTS + r] = if on_diagonal { scale } else { T::ZERO };
                        }
                    }
                }
            }
        };
        let bounds = [0, pattern.rows()];
        let everything = RowChunk { pattern: &pattern, rows: 0..bounds[1], first_block: 0, values: &mut self.values };
        everything.for_each_row(&fix);
    }

    /// Copies the numbers of a matrix of another width over the same pattern.
    ///
    /// # Panics
    /// If the patterns differ in size.
    pub fn copy_from<U: Scalar>(&mut self, other: &BlockMatrix<U>) {
        assert_eq!(self.values.len(), other.values.len());
        let length = ROWS_PER_PIECE * BLOCK;
        self.values.par_chunks_mut(length).zip(other.values.par_chunks(length)).for_each(|(to, from)| {
            for (to, from) in to.iter_mut().zip(from) {
                *to = T::from_f64(from.to_f64());
            }
        });
    }
}

impl BlockMatrix<f32> {
    /// `out = A x`, the vector rounded to 32 bits into `rounded`, one block a row; no vector is stored in between.
    pub fn multiply_rounded(&self, x: &[f64], rounded: &mut [PaddedBlock], out: &mut [f64]) {
        assert!(x.len() == self.dimension() && out.len() == self.dimension() && rounded.len() == self.rows());
        rounded.par_chunks_mut(ROWS_PER_PIECE).zip(x.par_chunks(ROWS_PER_PIECE * SLOTS)).for_each(|(rounded, x)| {
            for (to, from) in rounded.iter_mut().zip(x.as_chunks::<SLOTS>().0) {
                for slot in 0..SLOTS {
                    to[slot] = from[slot] as f32;
                }
            }
        });
        let (rounded, start) = (&*rounded, self.pattern.row_start());
        let times = |row: usize, out: &mut [f64; SLOTS]| {
            let blocks = start[row]..start[row + 1];
            let sums = row_times_vector(&self.values[blocks.start * BLOCK..], &self.pattern.columns()[blocks], rounded);
            *out = std::array::from_fn(|slot| f64::from(sums[slot]));
        };
        out.par_chunks_mut(ROWS_PER_PIECE * SLOTS).enumerate().for_each(|(index, out)| {
            let (first, out) = (index * ROWS_PER_PIECE, out.as_chunks_mut::<SLOTS>().0);
            let length = out.len() / STREAMS;
            for k in 0..length {
                for stream in 0..STREAMS {
                    let row = stream * length + k;
                    times(first + row, &mut out[row]);
                }
            }
            for row in STREAMS * length..out.len() {
                times(first + row, &mut out[row]);
            }
        });
    }
}

/// One block row times a vector of blocks, each of which may be padded to `N` numbers. `entries` begin with the row's
/// first block and go on for at least [`PADDING`] after its last; the sums after the first five mean nothing.
#[inline(always)]
pub(crate) fn row_times_vector<T: Scalar, S: Stored<T>, const N: usize>(
    entries: &[S],
    columns: &[u32],
    x: &[[T; N]],
) -> [T; LANES] {
    // Two sums, so that one need not wait for the other.
    let mut sums = [[T::ZERO; LANES]; 2];
    for (k, &column) in columns.iter().enumerate() {
        let Some(block) = entries[k * BLOCK..].first_chunk::<{ BLOCK + PADDING }>() else { break };
        let v = &x[column as usize];
        for c in 0..SLOTS {
            for lane in 0..LANES {
                sums[c % 2][lane] = block[c * SLOTS + lane].load().fused(v[c], sums[c % 2][lane]);
            }
        }
    }
    std::array::from_fn(|lane| sums[0][lane] + sums[1][lane])
}

fn halve<T: Scalar, S: Send>(
    bounds: &[usize],
    companions: &mut [S],
    chunk: RowChunk<'_, T>,
    fill: &(impl Fn(&mut S, RowChunk<'_, T>) + Sync),
) {
    match companions {
        [] => {}
        [companion] => fill(companion, chunk),
        _ => {
            let middle = companions.len() / 2;
            let (left, right) = companions.split_at_mut(middle);
            let (head, tail) = chunk.split_at(bounds[middle]);
            rayon::join(|| halve(&bounds[..=middle], left, head, fill), || halve(&bounds[middle..], right, tail, fill));
        }
    }
}

impl<'a, T: Scalar> RowChunk<'a, T> {
    /// The rows that may be written.
    #[inline]
    pub fn rows(&self) -> Range<usize> {
        self.rows.clone()
    }

    /// The pattern of the whole matrix.
    #[inline]
    pub fn pattern(&self) -> &'a BlockPattern {
        self.pattern
    }

    /// Block `(row, column)`.
    ///
    /// # Panics
    /// If the row is outside this chunk or the two blocks do not meet in the pattern.
    #[inline]
    pub fn block_mut(&mut self, row: usize, column: usize) -> &mut [T; BLOCK] {
        assert!(self.rows.contains(&row), "row {row} is not in {:?}", self.rows);
        let Some(position) = self.pattern.position(row, column) else {
            panic!("blocks {row} and {column} do not meet in the pattern");
        };
        let local = position - self.pattern.row_start()[self.rows.start];
        &mut self.values.as_chunks_mut().0[local]
    }

    /// The block at a place of the whole matrix, as [`BlockPattern::position`] gives it.
    ///
    /// # Panics
    /// If it is outside this chunk.
    #[inline(always)]
    pub fn block_at(&mut self, place: usize) -> &mut [T; BLOCK] {
        let local = place - self.first_block;
        &mut self.values.as_chunks_mut().0[local]
    }

    /// Columns and blocks of one row of this chunk.
    ///
    /// # Panics
    /// If the row is outside this chunk.
    #[inline]
    pub fn row_mut(&mut self, row: usize) -> (&'a [u32], &mut [[T; BLOCK]]) {
        assert!(self.rows.contains(&row), "row {row} is not in {:?}", self.rows);
        let start = self.pattern.row_start();
        let base = start[self.rows.start];
        let blocks = &mut self.values.as_chunks_mut().0[start[row] - base..start[row + 1] - base];
        (self.pattern.row(row), blocks)
    }

    /// Sets every number of the chunk to zero.
    pub fn clear(&mut self) {
        self.values.fill(T::ZERO);
    }

    /// The rows below `row` and the others.
    fn split_at(self, row: usize) -> (Self, Self) {
        let start = self.pattern.row_start();
        let length = (start[row] - start[self.rows.start]) * BLOCK;
        let (head, tail) = self.values.split_at_mut(length);
        let chunk = |rows: Range<usize>, values| {
            let first_block = start[rows.start];
            Self { pattern: self.pattern, rows, first_block, values }
        };
        (chunk(self.rows.start..row, head), chunk(row..self.rows.end, tail))
    }

    /// Visits every row, long chunks in parallel.
    fn for_each_row(mut self, visit: &(impl Fn(usize, &[u32], &mut [[T; BLOCK]]) + Sync)) {
        if self.rows.len() <= ROWS_PER_PIECE {
            for row in self.rows() {
                let (columns, blocks) = self.row_mut(row);
                visit(row, columns, blocks);
            }
        } else {
            let middle = self.rows.start + self.rows.len() / 2;
            let (head, tail) = self.split_at(middle);
            rayon::join(|| head.for_each_row(visit), || tail.for_each_row(visit));
        }
    }
}
