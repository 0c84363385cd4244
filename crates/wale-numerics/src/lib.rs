//! Small derivative mathematics, block-sparse matrices and solvers. Knows no cloth.

pub mod block_matrix;
pub mod block_pattern;
pub mod bordered;
pub mod check;
pub mod coarse_space;
pub mod conjugate_gradient;
pub mod constrained;
pub mod dense;
pub mod eigen;
pub mod incomplete_cholesky;
pub mod jet;
pub mod preconditioner;
pub mod prolongation;
pub mod scalar;
mod small_block;
pub mod sparse_cholesky;
pub mod triad;
pub mod trust;
pub mod vector;
