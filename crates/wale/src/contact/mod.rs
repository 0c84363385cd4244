//! Contact: how hard stacked yarns press on each other, where a point lies against a rigid obstacle, and which parts of a
//! fabric have come near each other.

pub mod compression;
mod least_squares;
pub mod nearby;
pub mod strands;
pub mod surface;

pub use compression::Compression;
pub use nearby::Nearby;
pub use strands::Strands;
