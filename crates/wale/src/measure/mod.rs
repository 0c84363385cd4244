//! What a fabric measures: counts of its parts, and the shape of a frame.

pub mod census;
pub mod shape;

pub use census::Census;
pub use shape::{Curvature, Shape};
