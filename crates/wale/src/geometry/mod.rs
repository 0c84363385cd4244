//! The drawn shape of yarns: smooth curves through the nodes, offset by each pass's place in its stack.

pub mod curve;

pub use curve::Curve;
