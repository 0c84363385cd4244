//! Small derivative mathematics, block-sparse matrices and solvers. Knows no cloth.

pub mod block_matrix;
pub mod block_pattern;
pub mod check;
pub mod dense;
pub mod jet;
pub mod scalar;
pub mod sparse_cholesky;
