//! What a fabric measures: counts of its parts, and the shape of a frame.

pub mod census;
pub mod shadow;
pub mod shape;

pub use census::{Census, YarnAmount};
pub use shadow::shadow_area;
pub use shape::{Curvature, Shape};
