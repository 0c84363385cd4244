//! Stitch charts and what is made of them; this room knows no force.

pub mod chart;
pub mod instructions;
pub mod knit;
mod layout;
pub mod named;
pub mod symbols;

pub use chart::{Chart, ChartError, Side, Stitch, Working};
