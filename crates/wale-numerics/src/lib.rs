//! Small derivative mathematics, block-sparse matrices and solvers. Knows no cloth.

pub mod check;
pub mod dense;
pub mod jet;
