//! A block-sparse system with a few linear constraints and a few dense unknowns: a periodic tile that may neither move nor slide.

use std::sync::Arc;

use crate::block_matrix::{BlockMatrix, SLOTS};
use crate::block_pattern::BlockPattern;
use crate::dense::SmallCholesky;
use crate::sparse_cholesky::{BlockOrder, CholeskyError, SparseCholesky};
use crate::vector::dot;

/// A direction within one block that is held lightly while the sparse matrix is factored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pin {
    /// The block.
    pub block: usize,
    /// The direction, a unit vector.
    pub direction: [f64; SLOTS],
}

/// The symmetric system `[H B; Bᵀ K]` on the vectors with `C x = 0`, shifted to be positive definite there.
///
/// `H` alone may be singular along what the constraints forbid: a tile that moves as a whole. So it is factored with springs on
/// the pins, as many as constraints and chosen to stop the same motions, and the springs are taken out again exactly, together
/// with constraints and dense unknowns, in a small dense system.
#[derive(Debug)]
pub struct ConstrainedSystem {
    /// `H`; blocks below the diagonal are not read.
    pub matrix: BlockMatrix,
    /// The columns of `B`.
    pub border: Vec<Vec<f64>>,
    /// `K` by rows.
    pub corner: Vec<f64>,
    constraints: Vec<Vec<f64>>,
    pins: Vec<Pin>,
    /// One where a slot is an unknown.
    unknown: Vec<f64>,
    cholesky: SparseCholesky,
    /// What was added to the diagonal, and the stiffness of the pins' springs, that is in the matrix now.
    shift: f64,
    spring: f64,
    /// `A⁻¹ W`, where `A` is the matrix as it was factored and `W` are constraints, pins and border.
    columns: Vec<Vec<f64>>,
    /// `Wᵀ A⁻¹ W` by rows.
    gram: Vec<f64>,
    of_constraints: SmallCholesky,
    of_rest: SmallCholesky,
}

impl ConstrainedSystem {
    /// Zeros over a pattern; `free` has one flag a slot, constraints one row of numbers a slot, `border` is the number of dense
    /// unknowns.
    ///
    /// # Errors
    /// [`CholeskyError::TooLarge`].
    ///
    /// # Panics
    /// If a constraint has not one number a slot.
    pub fn new(
        pattern: Arc<BlockPattern>,
        free: &[bool],
        constraints: Vec<Vec<f64>>,
        pins: Vec<Pin>,
        border: usize,
    ) -> Result<Self, CholeskyError> {
        assert!(constraints.iter().all(|row| row.len() == free.len()));
        let cholesky = SparseCholesky::new(Arc::clone(&pattern), free, BlockOrder::MinimumDegree)?;
        let size = constraints.len() + pins.len() + border;
        Ok(Self {
            matrix: BlockMatrix::zeros(pattern),
            border: vec![vec![0.0; free.len()]; border],
            corner: vec![0.0; border * border],
            constraints,
            pins,
            unknown: free.iter().map(|&free| f64::from(u8::from(free))).collect(),
            cholesky,
            shift: 0.0,
            spring: 0.0,
            columns: vec![vec![0.0; free.len()]; size],
            gram: vec![0.0; size * size],
            of_constraints: SmallCholesky::default(),
            of_rest: SmallCholesky::default(),
        })
    }

    /// Makes it a system of zeros.
    pub fn clear(&mut self) {
        self.matrix.clear();
        self.border.iter_mut().for_each(|column| column.fill(0.0));
        self.corner.fill(0.0);
        (self.shift, self.spring) = (0.0, 0.0);
    }

    /// Adds numbers, one a slot, to the diagonal of `H`.
    pub fn add_diagonal(&mut self, values: &[f64]) {
        self.matrix.add_diagonal(values, 1.0);
    }

    /// Factors it with `shift` times the identity, on the border times `weight` too, added; whether the shifted system is
    /// positive definite where the constraints hold. If not, it cannot be solved.
    ///
    /// # Errors
    /// [`CholeskyError::NotFinite`].
    pub fn factor(&mut self, shift: f64, weight: f64) -> Result<bool, CholeskyError> {
        self.add(-self.shift, -self.spring);
        let spring = self.mean_diagonal() + shift;
        self.add(shift, spring);
        (self.shift, self.spring) = (shift, spring);
        match self.cholesky.factor(&self.matrix, 0.0) {
            Ok(()) => {}
            Err(CholeskyError::NotPositiveDefinite { .. }) => return Ok(false),
            Err(other) => return Err(other),
        }
        let (m, p, b) = (self.constraints.len(), self.pins.len(), self.border.len());
        let size = m + p + b;
        let mut columns = std::mem::take(&mut self.columns);
        for (k, column) in columns.iter_mut().enumerate() {
            column.fill(0.0);
            self.add_outer(k, 1.0, column);
        }
        self.cholesky.solve_columns_in_place(&mut columns);
        self.columns = columns;
        for i in 0..size {
            for j in 0..size {
                self.gram[i * size + j] = self.outer_dot(i, &self.columns[j]);
            }
        }
        // Constraints first: C A⁻¹ Cᵀ is positive definite wherever A is.
        let gram = |i: usize, j: usize| 0.5 * (self.gram[i * size + j] + self.gram[j * size + i]);
        if !self.of_constraints.factor(m, gram) {
            return Ok(false);
        }
        let rest = p + b;
        let mut schur = vec![0.0; rest * rest];
        let mut answer = vec![0.0; m];
        for j in 0..rest {
            answer.iter_mut().enumerate().for_each(|(k, a)| *a = gram(k, m + j));
            self.of_constraints.solve(&mut answer);
            for i in 0..rest {
                let own = if i >= p && j >= p { self.corner[(i - p) * b + j - p] } else { 0.0 };
                let diagonal = match (i == j, i < p) {
                    (false, _) => 0.0,
                    (true, true) => 1.0,
                    (true, false) => weight * shift,
                };
                let through = (0..m).map(|k| gram(m + i, k) * answer[k]).sum::<f64>();
                schur[i * rest + j] = own + diagonal - gram(m + i, m + j) + through;
            }
        }
        Ok(self.of_rest.factor(rest, |i, j| schur[i * rest + j]))
    }

    /// Replaces the right side by the solution, which has `C x = 0`, after [`Self::factor`] said yes.
    ///
    /// # Panics
    /// If the right side has not the system's size.
    pub fn solve(&mut self, right: &mut [f64], right_border: &mut [f64]) {
        let (m, p, size) = (self.constraints.len(), self.pins.len(), self.columns.len());
        assert_eq!(right_border.len(), self.border.len());
        self.cholesky.solve_in_place(right);
        let mut left: Vec<f64> = (0..size).map(|k| -self.outer_dot(k, right)).collect();
        for (l, &r) in left[m + p..].iter_mut().zip(&*right_border) {
            *l += r;
        }
        let (of_constraints, of_rest) = left.split_at_mut(m);
        let mut answer = of_constraints.to_vec();
        self.of_constraints.solve(&mut answer);
        for (i, r) in of_rest.iter_mut().enumerate() {
            *r -= (0..m).map(|k| self.gram[(m + i) * size + k] * answer[k]).sum::<f64>();
        }
        self.of_rest.solve(of_rest);
        for (k, r) in of_constraints.iter_mut().enumerate() {
            *r = -*r - of_rest.iter().enumerate().map(|(i, v)| self.gram[k * size + m + i] * v).sum::<f64>();
        }
        self.of_constraints.solve(of_constraints);
        right_border.copy_from_slice(&of_rest[p..]);
        for (column, &value) in self.columns.iter().zip(&left) {
            for (x, c) in right.iter_mut().zip(column) {
                *x -= c * value;
            }
        }
    }

    /// Adds to the diagonal and to the pins.
    fn add(&mut self, shift: f64, spring: f64) {
        self.matrix.add_diagonal(&self.unknown, shift);
        for pin in &self.pins {
            let block = self.matrix.block_mut(pin.block, pin.block).expect("diagonal blocks are there");
            for c in 0..SLOTS {
                for r in 0..SLOTS {
                    block[c * SLOTS + r] += spring * pin.direction[r] * pin.direction[c];
                }
            }
        }
    }

    fn mean_diagonal(&self) -> f64 {
        let mut diagonal = vec![0.0; self.unknown.len()];
        self.matrix.diagonal_into(&mut diagonal);
        let sum: f64 = diagonal.iter().zip(&self.unknown).map(|(d, u)| d.abs() * u).sum();
        sum / self.unknown.iter().sum::<f64>().max(1.0)
    }

    /// Adds a multiple of a column of `W`: a constraint, a pin by the root of its spring, or a border.
    fn add_outer(&self, k: usize, factor: f64, out: &mut [f64]) {
        let (m, p) = (self.constraints.len(), self.pins.len());
        if k >= m && k < m + p {
            let pin = &self.pins[k - m];
            for (slot, direction) in pin.direction.iter().enumerate() {
                out[pin.block * SLOTS + slot] += factor * self.spring.sqrt() * direction;
            }
            return;
        }
        let column = if k < m { &self.constraints[k] } else { &self.border[k - m - p] };
        out.iter_mut().zip(column).for_each(|(o, c)| *o += factor * c);
    }

    /// A column of `W` times a vector.
    fn outer_dot(&self, k: usize, x: &[f64]) -> f64 {
        let (m, p) = (self.constraints.len(), self.pins.len());
        if k >= m && k < m + p {
            let pin = &self.pins[k - m];
            let of_block = &x[pin.block * SLOTS..(pin.block + 1) * SLOTS];
            return self.spring.sqrt() * pin.direction.iter().zip(of_block).map(|(d, x)| d * x).sum::<f64>();
        }
        dot(if k < m { &self.constraints[k] } else { &self.border[k - m - p] }, x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain of three nodes in space with unit springs, free to move as a whole, whose mean may not move, and one dense unknown.
    fn chain(stiffness: f64) -> ConstrainedSystem {
        let pattern = Arc::new(BlockPattern::from_pairs(3, [(0, 1), (1, 2)]));
        let free: Vec<bool> = (0..15).map(|slot| slot % SLOTS < 3).collect();
        let constraints = (0..3).map(|axis| (0..15).map(|slot| f64::from(u8::from(slot % SLOTS == axis))).collect());
        let pins = (0..3).map(|axis| {
            let direction = std::array::from_fn(|slot| f64::from(u8::from(slot == axis)));
            Pin { block: 0, direction }
        });
        let mut system = ConstrainedSystem::new(pattern, &free, constraints.collect(), pins.collect(), 1).unwrap();
        for (i, j, k) in [(0, 1, 1.0), (1, 2, stiffness)] {
            for slot in 0..3 {
                let place = slot * (SLOTS + 1);
                system.matrix.block_mut(i, i).unwrap()[place] += k;
                system.matrix.block_mut(j, j).unwrap()[place] += k;
                system.matrix.block_mut(i, j).unwrap()[place] -= k;
                system.matrix.block_mut(j, i).unwrap()[place] -= k;
            }
        }
        for slot in 0..15 {
            system.border[0][slot] = if free[slot] { 0.1 * (slot as f64).sin() } else { 0.0 };
        }
        system.corner[0] = 2.0;
        system
    }

    #[test]
    fn solves_what_it_says() {
        for shift in [0.0, 0.7] {
            let mut system = chain(2.0);
            let product_of = system.matrix.clone();
            let right: Vec<f64> = (0..15).map(|s| if s % SLOTS < 3 { (s as f64).cos() } else { 0.0 }).collect();
            let (mut x, mut y) = (right.clone(), [0.5]);
            assert!(system.factor(shift, 3.0).unwrap());
            system.solve(&mut x, &mut y);
            let mut product = vec![0.0; 15];
            product_of.multiply(&x, &mut product);
            let mut left: Vec<f64> =
                (0..15).map(|s| right[s] - product[s] - shift * x[s] - system.border[0][s] * y[0]).collect();
            // What is left over is a force along the constraints.
            for axis in 0..3 {
                let mean = (0..3).map(|node| left[SLOTS * node + axis]).sum::<f64>() / 3.0;
                (0..3).for_each(|node| left[SLOTS * node + axis] -= mean);
                assert!((0..3).map(|node| x[SLOTS * node + axis]).sum::<f64>().abs() < 1e-12);
                assert!(mean.abs() > 1e-3, "the constraint does something");
            }
            assert!((0..15).filter(|s| s % SLOTS < 3).all(|s| left[s].abs() < 1e-12), "{left:?}");
            let corner = dot(&system.border[0], &x) + (2.0 + 3.0 * shift) * y[0];
            assert!((corner - 0.5).abs() < 1e-12);
        }
    }

    #[test]
    fn a_second_factor_forgets_the_first() {
        let (mut once, mut twice) = (chain(2.0), chain(2.0));
        assert!(twice.factor(5.0, 1.0).unwrap() && twice.factor(0.3, 1.0).unwrap() && once.factor(0.3, 1.0).unwrap());
        let solve = |system: &mut ConstrainedSystem| {
            let (mut x, mut y) = ((0..15).map(|s| s as f64).collect::<Vec<_>>(), [1.0]);
            system.solve(&mut x, &mut y);
            x.push(y[0]);
            x
        };
        assert!(solve(&mut once).iter().zip(&solve(&mut twice)).all(|(a, b)| (a - b).abs() < 1e-12));
    }

    #[test]
    fn says_when_it_is_not_positive_definite() {
        assert!(!chain(-0.1).factor(0.0, 1.0).unwrap());
        assert!(chain(-0.1).factor(2.0, 1.0).unwrap());
        let mut corner = chain(2.0);
        corner.corner[0] = 1e-4;
        assert!(!corner.factor(0.0, 1.0).unwrap());
        assert!(chain(f64::NAN).factor(0.0, 1.0).is_err());
    }
}
