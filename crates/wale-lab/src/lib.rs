//! The fabric lab: textile tests on thin shells and on periodic yarn tiles, and models fitted to what was measured
//! [Sperl2022].

pub mod shell;
pub mod yarn_tile;
