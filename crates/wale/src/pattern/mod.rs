//! Stitch charts and what is made of them; this room knows no force.

pub mod chart;
pub mod image;
pub mod increase;
pub mod instructions;
pub mod knit;
mod layout;
pub mod library;
pub mod loops;
pub mod named;
mod places;
mod plain;
mod repeat;
mod stacks;
pub mod stitch;
mod strands;
pub mod symbols;
pub mod work;
pub mod working;

pub use chart::{Chart, ChartError};
pub use increase::{Part, Parts};
pub use stitch::{Lean, Stitch};
pub use working::{Side, Working};
