//! Yarns fitted to the stretch of a fabric [Sperl2022, section 7.3].

pub mod ablation;
pub mod gradients;
pub mod journal;
mod objective;
pub mod of_fabric;
pub mod problem;
mod progress;
mod pull;
pub mod run;
mod sequence;
mod space;
pub mod swarm;
mod target;

pub use objective::{BendingTarget, YarnFitError, add_residuals, errors};
pub use progress::{Progress, Step};
pub use pull::{Answer, PullSettings, TilePull, pull};
pub use space::RodSpace;
pub use target::Target;
