//! Small derivative mathematics, block-sparse matrices and solvers. Knows no cloth.

pub mod block_matrix;
pub mod block_pattern;
pub mod scalar;
pub mod sparse_cholesky;
