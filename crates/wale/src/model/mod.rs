//! The fabric as plain data: yarns, the nodes where they touch, the stitch contacts, and what yarns are made of.

pub mod card;
pub mod frame;
pub mod ids;
pub mod knit_card;
pub mod motion;
pub mod network;
pub mod plan;
pub mod selection;
pub mod woven_card;
pub mod yarn_card;

pub use card::FabricCard;
pub use frame::Frame;
pub use ids::{NodeId, PassId, StitchId, YarnId};
pub use knit_card::{KnitCard, LoopProportions, Thickness};
pub use motion::{Motion, Pose};
pub use network::{
    ContactPair, Crossing, Float, LoopInfo, Neighbour, Network, PassKind, SegmentKind, StitchContact, WrapPair,
    YarnRole,
};
pub use plan::{
    Drive, ExportFormat, Grip, LinearSolver, Obstacle, Output, Pictures, Placement, Plan, Shape, Simulation,
};
pub use selection::{Edge, Selection, WhichEnd};
pub use woven_card::{WovenCard, WovenGeometry};
pub use yarn_card::{Member, YarnCard, Yarns};
