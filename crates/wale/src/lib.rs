//! Yarn-level cloth: from a stitch chart to moving fabric.

pub mod model;
