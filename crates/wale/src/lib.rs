//! Yarn-level cloth: from a stitch chart to moving fabric.

pub mod contact;
pub mod dynamics;
pub mod energy;
pub mod export;
pub mod fabric;
pub mod geometry;
pub mod measure;
pub mod model;
pub mod pattern;
pub mod picture;
pub mod record;
pub mod scene;
pub mod simulation;
pub mod view;
