//! Yarn-level cloth: from a stitch chart to moving fabric.

pub mod dynamics;
pub mod geometry;
pub mod model;
pub mod picture;
pub mod view;
