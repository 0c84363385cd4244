//! A periodic tile under an even stretch of the plane: its equilibrium, its stress, and how both follow its stiffnesses.

mod direction;
mod reference;
mod slopes;
mod solver;

pub use direction::Direction;
pub use reference::TileReference;
pub use slopes::StretchSlopes;
pub use solver::{ACCEPTED, StretchError, StretchedEquilibrium, StretchedTile};
