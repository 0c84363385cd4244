//! Sums over the elements at a few blocks.

use wale_numerics::block_matrix::BlockMatrix;

use super::few::Few;
use super::system::{System, TERMS};
use super::terms::Width;

/// Elements by term.
pub type Selected = [Vec<u32>; TERMS];

impl System {
    /// Finds the elements that touch blocks whose `place` is below a limit; `blocks` are all of those.
    pub(super) fn touching(&self, blocks: &[u32], place: &[u32], limit: u32, found: &mut Selected) {
        let mut last = None;
        found.iter_mut().for_each(Vec::clear);
        for &block in blocks {
            let chunk = Some(self.chunks.of(block as usize));
            if chunk == last {
                continue;
            }
            last = chunk;
            for (term, found) in self.terms().iter().zip(&mut *found) {
                term.touching(term.of_chunk(self.chunks.of(block as usize)), place, limit, found);
            }
        }
        for found in found {
            found.sort_unstable();
            found.dedup();
        }
    }

    /// Finds among some elements those that touch blocks whose `place` is below a limit.
    pub(super) fn touching_among(&self, among: &Selected, place: &[u32], limit: u32, found: &mut Selected) {
        for ((term, among), found) in self.terms().iter().zip(among).zip(found) {
            found.clear();
            term.touching(among, place, limit, found);
        }
    }

    /// Energy of some elements \[J\].
    pub(super) fn energy_of(&self, selected: &Selected, q: &[f64]) -> f64 {
        self.terms().iter().zip(selected).map(|(term, list)| term.energy_of(list, q)).sum()
    }

    /// Adds gradient and Hessian of some elements to a system of few nodes.
    pub(super) fn linearise_few(&self, selected: &Selected, q: &[f64], convexity: f64, few: &mut Few<'_>) {
        for (term, list) in self.terms().iter().zip(selected) {
            term.linearise_few(list, q, convexity, few);
        }
    }

    /// Makes a matrix that was taken at `q` with a convexity the convex one in some elements.
    pub(super) fn stiffen<T: Width>(
        &self,
        selected: &Selected,
        q: &[f64],
        convexity: f64,
        matrix: &mut BlockMatrix<T>,
    ) {
        let rows = 0..self.pattern.rows();
        for mut all in matrix.split_rows(&[0, rows.end]) {
            for (term, list) in self.terms().iter().zip(selected) {
                term.stiffen(list, q, convexity, &rows, &mut T::rows(&mut all));
            }
        }
    }
}
