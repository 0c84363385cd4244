//! Sums of elements in parallel: every chunk of matrix rows evaluates the elements that touch it and writes its own
//! rows alone, so that results do not depend on threads.

use std::ops::Range;

use rayon::prelude::*;
use wale_numerics::block_matrix::RowChunk;
use wale_numerics::block_pattern::BlockPattern;
use wale_numerics::check::Local;
use wale_numerics::scalar::Scalar;

use super::chunks::Chunks;
use super::few::Few;
use super::scatter::{NOWHERE, runs, scatter_gradient, scatter_hessian};
use crate::energy::Element;
use crate::fabric::coordinates::{BLOCK, Dof};
use crate::fabric::elements::Elements;

/// The rows of gradient and matrix that one chunk writes.
pub struct ChunkOutput<'a, 'm> {
    /// Block rows.
    pub rows: Range<usize>,
    /// Their part of the gradient, five slots a row.
    pub gradient: &'a mut [f64],
    /// Their part of the matrix, if wanted.
    pub matrix: Option<MatrixRows<'a, 'm>>,
}

/// Rows of a matrix of either width.
pub enum MatrixRows<'a, 'm> {
    /// Of 32 bits.
    Single(&'a mut RowChunk<'m, f32>),
    /// Of 64 bits.
    Double(&'a mut RowChunk<'m, f64>),
}

/// A width that terms can write.
pub trait Width: Scalar {
    /// Rows of this width.
    fn rows<'a, 'm>(rows: &'a mut RowChunk<'m, Self>) -> MatrixRows<'a, 'm>;
}

impl Width for f32 {
    fn rows<'a, 'm>(rows: &'a mut RowChunk<'m, Self>) -> MatrixRows<'a, 'm> {
        MatrixRows::Single(rows)
    }
}

impl Width for f64 {
    fn rows<'a, 'm>(rows: &'a mut RowChunk<'m, Self>) -> MatrixRows<'a, 'm> {
        MatrixRows::Double(rows)
    }
}

/// Elements of one kind with the plan of who evaluates them.
#[derive(Clone, Debug, Default)]
pub struct Term<E, const N: usize> {
    /// The elements.
    pub set: Elements<E, N>,
    /// For each chunk the elements that touch it: its own first (those whose first block it holds), then others'.
    lists: Vec<(Vec<u32>, usize)>,
    /// Where in the matrix the blocks of each element lie, row by row of the blocks it touches.
    places: Vec<u32>,
    /// First of the places of each element.
    first_place: Vec<u32>,
}

impl<E: Element<N>, const N: usize> Term<E, N> {
    /// Plans a set.
    #[must_use]
    pub fn new(set: Elements<E, N>, chunks: &Chunks) -> Self {
        let lists = vec![(Vec::new(), 0); chunks.count()];
        let mut term = Self { set, lists, places: Vec::new(), first_place: Vec::new() };
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

    /// Finds the elements' blocks in the matrix, after [`Term::plan`].
    ///
    /// # Panics
    /// If blocks that an element couples do not meet in the pattern.
    pub fn locate(&mut self, pattern: &BlockPattern) {
        self.places.clear();
        self.first_place.clear();
        for stencil in &self.set.stencils {
            self.first_place.push(self.places.len() as u32);
            let (runs, count) = runs(stencil);
            for a in &runs[..count] {
                for b in &runs[..count] {
                    let place = if E::COUPLES || a.block == b.block {
                        let place = pattern.position(a.block, b.block);
                        place.expect("blocks that an element couples meet in the pattern") as u32
                    } else {
                        NOWHERE
                    };
                    self.places.push(place);
                }
            }
        }
    }

    /// Updates every element from its stencil and local coordinates, before a step.
    pub fn update(&mut self, q: &[f64], update: impl Fn(&[Dof; N], &mut E, &[f64; N]) + Sync) {
        self.set.elements.par_iter_mut().zip(&self.set.stencils).with_min_len(2048).for_each(|(element, stencil)| {
            let local = std::array::from_fn(|i| q[stencil[i] as usize]);
            update(stencil, element, &local);
        });
    }
}

impl<E: Element<N>, const N: usize> Term<E, N> {
    /// Visits every element that touches a chunk; the sum of the values of those it owns.
    fn sum(&self, chunk: usize, mut visit: impl FnMut(usize) -> f64) -> f64 {
        let (list, own) = &self.lists[chunk];
        let mut energy = 0.0;
        for (k, &index) in list.iter().enumerate() {
            let value = visit(index as usize);
            if k < *own {
                energy += value;
            }
        }
        energy
    }

    fn linearise<T: Scalar>(
        &self,
        chunk: usize,
        q: &[f64],
        convexity: f64,
        rows: &Range<usize>,
        gradient: &mut [f64],
        matrix: &mut RowChunk<'_, T>,
    ) -> f64 {
        self.sum(chunk, |index| {
            let stencil = &self.set.stencils[index];
            let mut local = Local::zero();
            self.set.elements[index].add_blended(&self.set.local(index, q), convexity, &mut local);
            scatter_gradient(stencil, &local.gradient, rows, gradient);
            let places = &self.places[self.first_place[index] as usize..];
            scatter_hessian(stencil, &local.hessian, rows, places, matrix);
            local.energy
        })
    }
}

/// Most parts of an element.
const MOST_PARTS: usize = 4;

/// A sum of elements of one kind, as the system sees it.
pub trait AnyTerm: Send + Sync {
    /// Calls `visit` with the kinds and energies \[J\] of the elements that a chunk owns.
    fn chunk_parts(&self, chunk: usize, q: &[f64], visit: &mut dyn FnMut(&'static str, f64));
    /// Energy of the elements that a chunk owns \[J\].
    fn chunk_energy(&self, chunk: usize, q: &[f64]) -> f64;
    /// Adds gradient and Hessian rows of every element that touches a chunk; returns the energy of those it owns.
    fn accumulate(&self, chunk: usize, q: &[f64], convexity: f64, out: &mut ChunkOutput<'_, '_>) -> f64;
    /// The elements that touch a chunk.
    fn of_chunk(&self, chunk: usize) -> &[u32];
    /// Adds to `found` those of some elements that touch a block of which `place` is below a limit.
    fn touching(&self, among: &[u32], place: &[u32], limit: u32, found: &mut Vec<u32>);
    /// Energy of some elements \[J\].
    fn energy_of(&self, list: &[u32], q: &[f64]) -> f64;
    /// Adds gradient and Hessian of some elements to a system of few nodes.
    fn linearise_few(&self, list: &[u32], q: &[f64], convexity: f64, few: &mut Few<'_>);
    /// Adds to a whole matrix what some elements' convex Hessians are more than those of a convexity.
    fn stiffen(&self, list: &[u32], q: &[f64], convexity: f64, rows: &Range<usize>, matrix: &mut MatrixRows<'_, '_>);
    /// Calls `pair` for every two blocks that an element couples.
    fn pairs(&self, pair: &mut dyn FnMut(u32, u32));
    /// Bytes that the term holds.
    fn bytes(&self) -> usize;
}

impl<E: Element<N>, const N: usize> AnyTerm for Term<E, N> {
    fn chunk_parts(&self, chunk: usize, q: &[f64], visit: &mut dyn FnMut(&'static str, f64)) {
        // Few kinds to an element: summed here, so that the virtual call is made once a kind.
        let mut sums: [(&'static str, f64); MOST_PARTS] = [("", 0.0); MOST_PARTS];
        let (list, own) = &self.lists[chunk];
        for &index in &list[..*own] {
            let index = index as usize;
            let mut part = 0;
            self.set.elements[index].parts(&self.set.local(index, q), &mut |name, energy| {
                sums[part] = (name, sums[part].1 + energy);
                part += 1;
            });
        }
        for (name, energy) in sums.iter().filter(|(name, _)| !name.is_empty()) {
            visit(name, *energy);
        }
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

    fn accumulate(&self, chunk: usize, q: &[f64], convexity: f64, out: &mut ChunkOutput<'_, '_>) -> f64 {
        let (rows, gradient) = (&out.rows, &mut *out.gradient);
        match &mut out.matrix {
            None => self.sum(chunk, |index| {
                let (value, by_local) = self.set.elements[index].gradient(&self.set.local(index, q));
                scatter_gradient(&self.set.stencils[index], &by_local, rows, gradient);
                value
            }),
            Some(MatrixRows::Single(matrix)) => self.linearise(chunk, q, convexity, rows, gradient, matrix),
            Some(MatrixRows::Double(matrix)) => self.linearise(chunk, q, convexity, rows, gradient, matrix),
        }
    }

    fn of_chunk(&self, chunk: usize) -> &[u32] {
        &self.lists[chunk].0
    }

    fn touching(&self, among: &[u32], place: &[u32], limit: u32, found: &mut Vec<u32>) {
        let touches = |&&index: &&u32| {
            let stencil = &self.set.stencils[index as usize];
            stencil.iter().any(|&dof| place[dof as usize / BLOCK] < limit)
        };
        found.extend(among.iter().filter(touches));
    }

    fn energy_of(&self, list: &[u32], q: &[f64]) -> f64 {
        let energy = |&index: &u32| self.set.elements[index as usize].energy(&self.set.local(index as usize, q));
        list.iter().map(energy).sum()
    }

    fn linearise_few(&self, list: &[u32], q: &[f64], convexity: f64, few: &mut Few<'_>) {
        for &index in list {
            let index = index as usize;
            let mut local = Local::zero();
            self.set.elements[index].add_blended(&self.set.local(index, q), convexity, &mut local);
            few.add(&self.set.stencils[index], &local);
        }
    }

    fn stiffen(&self, list: &[u32], q: &[f64], convexity: f64, rows: &Range<usize>, matrix: &mut MatrixRows<'_, '_>) {
        for &index in list {
            let index = index as usize;
            let q = self.set.local(index, q);
            let (mut convex, mut blended) = (Local::zero(), Local::zero());
            self.set.elements[index].add_blended(&q, 1.0, &mut convex);
            self.set.elements[index].add_blended(&q, convexity, &mut blended);
            for (to, from) in convex.hessian.iter_mut().flatten().zip(blended.hessian.iter().flatten()) {
                *to -= from;
            }
            let (stencil, places) = (&self.set.stencils[index], &self.places[self.first_place[index] as usize..]);
            match matrix {
                MatrixRows::Single(matrix) => scatter_hessian(stencil, &convex.hessian, rows, places, matrix),
                MatrixRows::Double(matrix) => scatter_hessian(stencil, &convex.hessian, rows, places, matrix),
            }
        }
    }

    fn pairs(&self, pair: &mut dyn FnMut(u32, u32)) {
        if !E::COUPLES {
            return;
        }
        for stencil in &self.set.stencils {
            let (runs, count) = runs(stencil);
            for a in &runs[..count] {
                for b in &runs[..count] {
                    if a.block < b.block {
                        pair(a.block as u32, b.block as u32);
                    }
                }
            }
        }
    }

    fn bytes(&self) -> usize {
        let lists: usize = self.lists.iter().map(|(list, _)| list.capacity() * size_of::<u32>()).sum();
        let places = (self.places.capacity() + self.first_place.capacity()) * size_of::<u32>();
        lists
            + places
            + self.set.elements.capacity() * size_of::<E>()
            + self.set.stencils.capacity() * size_of::<[Dof; N]>()
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
            let mut term = Term::new(set.clone(), &chunks);
            let mut pairs = Vec::new();
            term.pairs(&mut |a, b| pairs.push((a, b)));
            let mut matrix = BlockMatrix::zeros(Arc::new(BlockPattern::from_pairs(n as usize, pairs)));
            term.locate(matrix.pattern());
            let mut gradient = vec![0.0; 5 * n as usize];
            let mut energy = 0.0;
            for (chunk, mut rows) in matrix.split_rows(chunks.bounds()).enumerate() {
                let range = chunks.rows(chunk);
                let (start, end) = (range.start * 5, range.end * 5);
                let mut out = ChunkOutput {
                    rows: range,
                    gradient: &mut gradient[start..end],
                    matrix: Some(MatrixRows::Double(&mut rows)),
                };
                energy += term.accumulate(chunk, &q, 1.0, &mut out);
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
