//! The fabric as plain data: yarns, the nodes where they touch, the stitch contacts, and what yarns are made of.

pub mod card;
pub mod frame;
pub mod ids;
pub mod motion;
pub mod network;
pub mod plan;
pub mod selection;

pub use card::{FabricCard, LoopProportions, YarnCard};
pub use frame::Frame;
pub use ids::{NodeId, PassId, StitchId, YarnId};
pub use motion::{Motion, Pose};
pub use network::{ContactPair, LoopInfo, Neighbour, Network, PassKind, SegmentKind, StitchContact, WrapPair};
pub use plan::{
    Drive, ExportFormat, Grip, LinearSolver, Obstacle, Output, Pictures, Placement, Plan, Shape, Simulation,
};
pub use selection::{Edge, Selection};
