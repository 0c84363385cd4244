//! Sums of elements in parallel: every chunk of matrix rows evaluates the elements that touch it and writes its own
//! rows alone, so that results do not depend on threads.

use std::ops::Range;

use rayon::prelude::*;
use wale_numerics::block_matrix::RowChunk;

use crate::energy::Element;
use crate::fabric::coordinates::{BLOCK, Dof};
use crate::fabric::elements::{Elements, Linearisation};

/// Cuts of the block rows into chunks; decided by the fabric's size alone.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chunks {
    bounds: Vec<usize>,
}

/// Blocks a chunk has at least, but for the smallest fabrics.
const SMALLEST_CHUNK: usize = 512;
/// Most chunks: more would repeat more of the elements that straddle two.
const MOST_CHUNKS: usize = 16;

impl Chunks {
    /// Cuts `block_count` rows.
    #[must_use]
    pub fn new(block_count: usize) -> Self {
        let count = (block_count / SMALLEST_CHUNK).clamp(1, MOST_CHUNKS);
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

/// The rows of gradient and matrix that one chunk writes.
pub struct ChunkOutput<'a, 'm> {
    /// Block rows.
    pub rows: Range<usize>,
    /// Their part of the gradient, five slots a row.
    pub gradient: &'a mut [f64],
    /// Their part of the matrix, if wanted.
    pub matrix: Option<&'a mut RowChunk<'m>>,
}

/// Elements of one kind with the plan of who evaluates them.
#[derive(Clone, Debug, Default)]
pub struct Term<E, const N: usize> {
    /// The elements.
    pub set: Elements<E, N>,
    /// For each chunk the elements that touch it: its own first (those whose first block it holds), then others'.
    lists: Vec<(Vec<u32>, usize)>,
}

impl<E: Element<N>, const N: usize> Term<E, N> {
    /// Plans a set.
    #[must_use]
    pub fn new(set: Elements<E, N>, chunks: &Chunks) -> Self {
        let mut term = Self { set, lists: vec![(Vec::new(), 0); chunks.count()] };
        term.plan(chunks);
        term
    }

    /// Plans anew after elements were added or removed; allocates only if there are more than ever before.
    pub fn plan(&mut self, chunks: &Chunks) {
        self.lists.resize(chunks.count(), (Vec::new(), 0));
        for (list, own) in &mut self.lists {
            list.clear();
            *own = 0;
        }
        for (index, stencil) in self.set.stencils.iter().enumerate() {
            let (list, own) = &mut self.lists[chunks.of(stencil[0] as usize / BLOCK)];
            list.push(index as u32);
            *own += 1;
        }
        for (index, stencil) in self.set.stencils.iter().enumerate() {
            let first = chunks.of(stencil[0] as usize / BLOCK);
            let mut last = first;
            for &dof in stencil {
                let chunk = chunks.of(dof as usize / BLOCK);
                if chunk != first && chunk != last {
                    let list = &mut self.lists[chunk].0;
                    if list.last() != Some(&(index as u32)) {
                        list.push(index as u32);
                    }
                    last = chunk;
                }
            }
        }
    }

    /// Elements that a chunk owns, for updates before a step.
    pub fn update(&mut self, q: &[f64], update: impl Fn(usize, &mut E, &[f64; N]) + Sync) {
        let stencils = &self.set.stencils;
        self.set.elements.par_iter_mut().with_min_len(2048).enumerate().for_each(|(index, element)| {
            let local = std::array::from_fn(|i| q[stencils[index][i] as usize]);
            update(index, element, &local);
        });
    }
}

/// A sum of elements of one kind, as the system sees it.
pub trait AnyTerm: Send + Sync {
    /// Name of the kind.
    fn name(&self) -> &'static str;
    /// Energy of the elements that a chunk owns \[J\].
    fn chunk_energy(&self, chunk: usize, q: &[f64]) -> f64;
    /// Adds gradient and Hessian rows of every element that touches a chunk; returns the energy of those it owns.
    fn accumulate(&self, chunk: usize, q: &[f64], linearisation: Linearisation, out: &mut ChunkOutput<'_, '_>) -> f64;
    /// Calls `pair` for every two blocks that an element couples.
    fn pairs(&self, pair: &mut dyn FnMut(u32, u32));
    /// Bytes that the term holds.
    fn bytes(&self) -> usize;
}

impl<E: Element<N>, const N: usize> AnyTerm for Term<E, N> {
    fn name(&self) -> &'static str {
        E::NAME
    }

    fn chunk_energy(&self, chunk: usize, q: &[f64]) -> f64 {
        let (list, own) = &self.lists[chunk];
        list[..*own]
            .iter()
            .map(|&index| {
                let index = index as usize;
                self.set.elements[index].energy(&self.set.local(index, q))
            })
            .sum()
    }

    fn accumulate(&self, chunk: usize, q: &[f64], linearisation: Linearisation, out: &mut ChunkOutput<'_, '_>) -> f64 {
        let (list, own) = &self.lists[chunk];
        let mut energy = 0.0;
        for (k, &index) in list.iter().enumerate() {
            let index = index as usize;
            let local_q = self.set.local(index, q);
            let stencil = &self.set.stencils[index];
            let element = &self.set.elements[index];
            let value = match &mut out.matrix {
                None => {
                    let (value, gradient) = element.gradient(&local_q);
                    scatter_gradient(stencil, &gradient, &out.rows, out.gradient);
                    value
                }
                Some(matrix) => {
                    let local = match linearisation {
                        Linearisation::Blended(convexity) => element.blended(&local_q, convexity),
                        Linearisation::Exact => element.exact(&local_q),
                    };
                    scatter_gradient(stencil, &local.gradient, &out.rows, out.gradient);
                    scatter_hessian(stencil, &local.hessian, &out.rows, matrix);
                    local.energy
                }
            };
            if k < *own {
                energy += value;
            }
        }
        energy
    }

    fn pairs(&self, pair: &mut dyn FnMut(u32, u32)) {
        for stencil in &self.set.stencils {
            let (runs, count) = runs(stencil);
            for a in &runs[..count] {
                for b in &runs[..count] {
                    if a.0 < b.0 {
                        pair(a.0 as u32, b.0 as u32);
                    }
                }
            }
        }
    }

    fn bytes(&self) -> usize {
        let lists: usize = self.lists.iter().map(|(list, _)| list.capacity() * size_of::<u32>()).sum();
        lists + self.set.elements.capacity() * size_of::<E>() + self.set.stencils.capacity() * size_of::<[Dof; N]>()
    }
}

/// Stretches of a stencil that lie in one block: block, first local coordinate, one past the last.
fn runs<const N: usize>(stencil: &[Dof; N]) -> ([(usize, usize, usize); N], usize) {
    let mut runs = [(0, 0, 0); N];
    let mut count = 0;
    for (i, &dof) in stencil.iter().enumerate() {
        let block = dof as usize / BLOCK;
        if count > 0 && runs[count - 1].0 == block {
            runs[count - 1].2 = i + 1;
        } else {
            runs[count] = (block, i, i + 1);
            count += 1;
        }
    }
    (runs, count)
}

fn scatter_gradient<const N: usize>(stencil: &[Dof; N], local: &[f64; N], rows: &Range<usize>, out: &mut [f64]) {
    let (start, end) = (rows.start * BLOCK, rows.end * BLOCK);
    for i in 0..N {
        let dof = stencil[i] as usize;
        if dof >= start && dof < end {
            out[dof - start] += local[i];
        }
    }
}

fn scatter_hessian<const N: usize>(
    stencil: &[Dof; N],
    local: &[[f64; N]; N],
    rows: &Range<usize>,
    matrix: &mut RowChunk<'_>,
) {
    let (runs, count) = runs(stencil);
    for &(row, row_start, row_end) in &runs[..count] {
        if !rows.contains(&row) {
            continue;
        }
        for &(column, column_start, column_end) in &runs[..count] {
            let block = matrix.block_mut(row, column);
            for i in row_start..row_end {
                let r = (stencil[i] as usize - row * BLOCK) * BLOCK;
                for j in column_start..column_end {
                    block[r + stencil[j] as usize - column * BLOCK] += local[i][j];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::energy::Stretch;
    use std::sync::Arc;
    use wale_numerics::block_matrix::BlockMatrix;
    use wale_numerics::block_pattern::BlockPattern;

    #[test]
    fn chunked_rows_equal_one_chunk() {
        // A zigzag yarn over 40 blocks, cut into five chunks and into one.
        let n = 40;
        let q: Vec<f64> = (0..n)
            .flat_map(|i| {
                let t = f64::from(i);
                [t, (0.3 * t).sin(), 0.1 * t * t.cos(), 0.9 * t, 0.0]
            })
            .collect();
        let mut set = Elements::default();
        for i in 0..n as u32 - 1 {
            let (a, b) = (5 * i, 5 * i + 5);
            set.push(Stretch { stiffness: 2.0 }, [a, a + 1, a + 2, a + 3, b, b + 1, b + 2, b + 3]);
        }
        let result = |bounds: Vec<usize>| {
            let chunks = Chunks { bounds };
            let term = Term::new(set.clone(), &chunks);
            let mut pairs = Vec::new();
            term.pairs(&mut |a, b| pairs.push((a, b)));
            let mut matrix = BlockMatrix::zeros(Arc::new(BlockPattern::from_pairs(n as usize, pairs)));
            let mut gradient = vec![0.0; 5 * n as usize];
            let mut energy = 0.0;
            for (chunk, mut rows) in matrix.split_rows(chunks.bounds()).enumerate() {
                let range = chunks.rows(chunk);
                let (start, end) = (range.start * 5, range.end * 5);
                let mut out = ChunkOutput { rows: range, gradient: &mut gradient[start..end], matrix: Some(&mut rows) };
                energy += term.accumulate(chunk, &q, Linearisation::CONVEX, &mut out);
            }
            let owned: f64 = (0..chunks.count()).map(|chunk| term.chunk_energy(chunk, &q)).sum();
            assert!((owned - energy).abs() < 1e-12 * energy);
            (energy, gradient, matrix.values)
        };
        let (one, many) = (result(vec![0, 40]), result(vec![0, 7, 8, 21, 33, 40]));
        assert!((one.0 - many.0).abs() < 1e-12 * one.0 && one.0 > 1.0);
        assert!(one.1.iter().zip(&many.1).all(|(a, b)| (a - b).abs() < 1e-12));
        assert!(one.2.iter().zip(&many.2).all(|(a, b)| (a - b).abs() < 1e-12));
    }
}
