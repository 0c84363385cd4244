//! Yarn-level cloth: from a stitch chart to moving fabric.

pub mod dynamics;
pub mod export;
pub mod geometry;
pub mod model;
