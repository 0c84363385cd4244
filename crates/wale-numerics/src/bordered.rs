//! A block-sparse system with two dense columns beside it: a periodic tile and its two periods.

use std::sync::Arc;

use crate::block_matrix::BlockMatrix;
use crate::block_pattern::BlockPattern;
use crate::sparse_cholesky::{BlockOrder, CholeskyError, SparseCholesky};
use crate::vector::dot;

/// Dense columns beside the sparse matrix.
pub const BORDER: usize = 2;

/// The symmetric system `[A B; Bᵀ C]` with a block-sparse `A` and a `B` of two columns, shifted to be positive definite.
#[derive(Debug)]
pub struct Bordered {
    /// `A`; its fixed slots are left out of the system.
    pub matrix: BlockMatrix,
    /// The columns of `B`.
    pub border: [Vec<f64>; BORDER],
    /// `C`.
    pub corner: [[f64; BORDER]; BORDER],
    cholesky: SparseCholesky,
    /// `A⁻¹ B` of the shifted matrix.
    columns: [Vec<f64>; BORDER],
    ones: Vec<f64>,
    /// Shift that is in the matrix now.
    shift: f64,
}

impl Bordered {
    /// Zeros over a pattern; `free` has one flag a slot.
    ///
    /// # Errors
    /// [`CholeskyError::TooLarge`].
    pub fn new(pattern: Arc<BlockPattern>, free: &[bool]) -> Result<Self, CholeskyError> {
        let cholesky = SparseCholesky::new(Arc::clone(&pattern), free, BlockOrder::MinimumDegree)?;
        let zeros = vec![0.0; free.len()];
        Ok(Self {
            matrix: BlockMatrix::zeros(pattern),
            border: [zeros.clone(), zeros.clone()],
            corner: [[0.0; BORDER]; BORDER],
            cholesky,
            columns: [zeros.clone(), zeros],
            ones: vec![1.0; free.len()],
            shift: 0.0,
        })
    }

    /// Makes it a system of zeros.
    pub fn clear(&mut self) {
        self.matrix.clear();
        self.border.iter_mut().for_each(|column| column.fill(0.0));
        self.corner = [[0.0; BORDER]; BORDER];
        self.shift = 0.0;
    }

    /// Solves with `shift` times the identity, on the border times `weight` too, added; the right side is replaced by the
    /// solution. Returns whether the shifted system is positive definite; if not, the right side is as it was.
    ///
    /// # Errors
    /// [`CholeskyError::NotFinite`].
    pub fn solve(
        &mut self,
        shift: f64,
        weight: f64,
        right: &mut [f64],
        right_border: &mut [f64; BORDER],
    ) -> Result<bool, CholeskyError> {
        self.matrix.add_diagonal(&self.ones, shift - self.shift);
        self.shift = shift;
        match self.cholesky.factor(&self.matrix, 0.0) {
            Ok(()) => {}
            Err(CholeskyError::NotPositiveDefinite { .. }) => return Ok(false),
            Err(other) => return Err(other),
        }
        for (column, border) in self.columns.iter_mut().zip(&self.border) {
            column.copy_from_slice(border);
            self.cholesky.solve_in_place(column);
        }
        // What is left for the border when A has answered: C − Bᵀ A⁻¹ B.
        let left: [[f64; BORDER]; BORDER] = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let diagonal = if i == j { weight * shift } else { 0.0 };
                self.corner[i][j] + diagonal - dot(&self.border[i], &self.columns[j])
            })
        });
        let determinant = left[0][0] * left[1][1] - left[0][1] * left[1][0];
        if left[0][0].is_nan() || determinant.is_nan() {
            return Err(CholeskyError::NotFinite);
        }
        if left[0][0] <= 0.0 || determinant <= 0.0 {
            return Ok(false);
        }
        self.cholesky.solve_in_place(right);
        let rest: [f64; BORDER] = std::array::from_fn(|i| right_border[i] - dot(&self.border[i], right));
        *right_border = [
            (left[1][1] * rest[0] - left[0][1] * rest[1]) / determinant,
            (left[0][0] * rest[1] - left[1][0] * rest[0]) / determinant,
        ];
        for (column, &y) in self.columns.iter().zip(&*right_border) {
            for (x, c) in right.iter_mut().zip(column) {
                *x -= c * y;
            }
        }
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two blocks, of which the last two slots are fixed, with a diagonal that is `diagonal` and a border.
    fn system(diagonal: f64) -> (Bordered, Vec<bool>) {
        let pattern = Arc::new(BlockPattern::from_pairs(2, [(0, 1)]));
        let free: Vec<bool> = (0..10).map(|slot| slot < 8).collect();
        let mut system = Bordered::new(pattern, &free).unwrap();
        for slot in 0..10 {
            let (block, k) = (slot / 5, slot % 5);
            system.matrix.block_mut(block, block).unwrap()[6 * k] = diagonal + slot as f64;
            system.border[0][slot] = 0.1 * slot as f64;
            system.border[1][slot] = 0.3;
        }
        system.matrix.block_mut(0, 1).unwrap()[0] = 0.7;
        system.matrix.block_mut(1, 0).unwrap()[0] = 0.7;
        system.corner = [[5.0, 0.2], [0.2, 4.0]];
        (system, free)
    }

    #[test]
    fn solves_what_it_says() {
        let (mut system, free) = system(2.0);
        let right: Vec<f64> = (0..10).map(|slot| 1.0 - 0.3 * slot as f64).collect();
        let (shift, weight) = (0.4, 3.0);
        let (mut x, mut y) = (right.clone(), [0.5, -1.0]);
        assert!(system.solve(shift, weight, &mut x, &mut y).unwrap());
        assert!(x[8] == 0.0 && x[9] == 0.0);
        // The shift is in the matrix now.
        let mut product = vec![0.0; 10];
        system.matrix.multiply(&x, &mut product);
        for slot in (0..10).filter(|&slot| free[slot]) {
            let found = product[slot] + system.border[0][slot] * y[0] + system.border[1][slot] * y[1];
            assert!((found - right[slot]).abs() < 1e-12, "{slot}: {found}");
        }
        for (i, right) in [0.5, -1.0].into_iter().enumerate() {
            let beside = (0..8).map(|slot| system.border[i][slot] * x[slot]).sum::<f64>();
            let found = beside + system.corner[i][0] * y[0] + system.corner[i][1] * y[1] + shift * weight * y[i];
            assert!((found - right).abs() < 1e-12, "{i}: {found}");
        }
    }

    #[test]
    fn says_when_it_is_not_positive_definite() {
        let (mut inside, _) = system(-1.0);
        let (mut x, mut y) = (vec![1.0; 10], [1.0; 2]);
        assert!(!inside.solve(0.0, 1.0, &mut x, &mut y).unwrap());
        assert!(x == [1.0; 10] && y == [1.0; 2]);
        assert!(inside.solve(2.0, 1.0, &mut x, &mut y).unwrap());
        let (mut corner, _) = system(2.0);
        corner.corner[1][1] = 1e-3;
        assert!(!corner.solve(0.0, 1.0, &mut x, &mut y).unwrap());
        let (mut broken, _) = system(f64::NAN);
        assert!(broken.solve(0.0, 1.0, &mut x, &mut y).is_err());
    }
}
