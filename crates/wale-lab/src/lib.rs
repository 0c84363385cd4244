//! The fabric lab: textile tests on thin shells and on periodic yarn tiles, and models fitted to what was measured
//! \[Sperl2022\].

pub mod card_file;
pub mod curve;
pub mod fabric_file;
pub mod foretold;
pub mod least_squares;
pub mod network_fit;
pub mod register;
pub mod report;
pub mod shell;
pub mod swatch_test;
pub mod uniform_test;
pub mod virtual_test;
pub mod yarn_fit;
pub mod yarn_tile;
