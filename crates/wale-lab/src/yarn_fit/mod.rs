//! Yarns fitted to the stretch of a fabric [Sperl2022, section 7.3].

mod objective;
mod pull;
mod space;
mod target;

pub use objective::{YarnFitError, add_residuals, errors};
pub use pull::{Answer, PullSettings, pull};
pub use space::{RodSpace, material_at};
pub use target::Target;
