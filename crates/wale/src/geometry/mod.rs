//! The drawn shape of yarns: smooth curves through the nodes, offset by each pass's place in its stack.

mod claspings;
pub mod coloring;
pub mod curve;
pub mod obstacle_solid;
pub mod order;
pub(crate) mod parallel_transport;
mod passes;
pub mod passing;
pub mod ply_twist;
#[cfg(test)]
pub(crate) mod sample_fabric;
pub mod solid;
mod spline;
mod stack_normal;
pub mod stretch;
pub mod tube;
pub mod yarn_geometry;

pub use coloring::{PointScalars, Quantity};
pub use curve::Curve;
pub use obstacle_solid::solid_at;
pub use order::CrossingOrder;
pub use passing::Passages;
pub use ply_twist::ply_curves;
pub use solid::{Solid, SolidShape};
pub use stack_normal::fronts;
pub use stretch::segment_stretch;
pub use tube::{TubeMesh, tube};
pub use yarn_geometry::{CurveSettings, curves};
