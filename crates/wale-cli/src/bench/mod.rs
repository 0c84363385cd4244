//! Measurements of speed, each beside the machine's memory bandwidth of the same minute.

pub mod layout;
pub mod patterns;
pub mod swatch;
mod triad;

pub use triad::triad;
