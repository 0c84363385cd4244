//! The drawn shape of yarns: smooth curves through the nodes, offset by each pass's place in its stack.

pub mod coloring;
pub mod curve;
pub mod solid;

pub use coloring::{PointScalars, Quantity};
pub use curve::Curve;
pub use solid::{Solid, SolidShape};
