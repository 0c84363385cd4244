//! Linear systems of a step: sparse Cholesky or conjugate gradients, behind one door.

use wale_numerics::block_matrix::BlockMatrix;
use wale_numerics::sparse_cholesky::{BlockOrder, CholeskyError, SparseCholesky};

use super::system::System;

/// What a linear solve took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinearReport {
    /// Iterations of conjugate gradients; zero for a direct solve.
    pub iterations: usize,
}

/// A linear solver of symmetric positive definite block systems.
pub enum Linear {
    /// Not set up yet, or the free slots changed.
    None,
    /// Sparse Cholesky factors with the symbolic part kept.
    Cholesky(Box<SparseCholesky>),
}

impl Linear {
    /// Solves `A x = b` for the free slots; `x` holds `b` on entry.
    ///
    /// # Errors
    /// If the matrix is not positive definite or not finite.
    pub fn solve(
        &mut self,
        system: &System,
        matrix: &BlockMatrix,
        free: &[bool],
        relative_shift: f64,
        x: &mut [f64],
    ) -> Result<LinearReport, CholeskyError> {
        if matches!(self, Self::None) {
            let factor = SparseCholesky::new(system.pattern().clone(), free, BlockOrder::MinimumDegree)?;
            *self = Self::Cholesky(Box::new(factor));
        }
        match self {
            Self::None => Ok(LinearReport::default()),
            Self::Cholesky(factor) => {
                factor.factor(matrix, relative_shift)?;
                factor.solve_in_place(x);
                Ok(LinearReport::default())
            }
        }
    }
}
