//! Contact: how hard stacked yarns press on each other, and where a point lies against a rigid obstacle.

pub mod compression;
pub mod surface;

pub use compression::Compression;
