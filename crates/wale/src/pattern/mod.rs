//! Stitch charts, drafts and what is made of them; this room knows no force.

pub mod chart;
pub mod image;
pub mod increase;
pub mod instructions;
pub mod knit;
pub mod knitout;
mod layout;
pub mod library;
pub mod loops;
pub mod named;
mod places;
mod plain;
mod remark;
mod repeat;
mod rest_lengths;
mod stacks;
pub mod stitch;
mod strands;
pub mod structure;
pub mod symbols;
pub mod weave;
pub mod work;
pub mod working;

pub use chart::{Chart, ChartError};
pub use increase::{Part, Parts};
pub use remark::Remark;
pub use stitch::{Lean, NotHeld, Stitch};
pub use structure::{Program, Structure};
pub use working::{Side, Working};
