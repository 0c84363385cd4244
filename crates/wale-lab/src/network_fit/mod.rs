//! Stiffnesses of the contact model fitted to the stretch of a fabric: what \[Cirio2017\] left to artists.

mod fit;
mod of_fabric;
mod problem;
mod pull;
#[cfg(test)]
mod tests;

pub use fit::{NetworkFit, NetworkFitError, NetworkFitSettings, fit_network};
pub use of_fabric::{SceneFitError, fit_scene, relaxed_reference};
pub use problem::{NetworkEvaluation, NetworkProblem};
pub use pull::{NetworkPull, NetworkPullSettings, SizeSlopes, pull_network};
