//! Stitch charts and what is made of them; this room knows no force.

pub mod chart;
pub mod knit;
mod layout;

pub use chart::{Chart, Stitch, Working};
