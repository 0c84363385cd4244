//! The mechanics of a network: its coordinates, and the elements that act on them.

pub mod coordinates;
pub mod elements;
pub mod mechanics;
pub mod sides;
pub mod thickness;
pub mod tile;

pub use coordinates::{CoordinateMap, Coordinates, Dof};
pub use elements::{ElementSet, Elements};
pub use mechanics::Mechanics;
pub use tile::{Matrix2, PlaneMap, TileCoordinates};
