//! Periodic tiles of yarns in full contact [Sperl2022, sections 6 and 7].

mod closest;
mod coarse;
mod constraints;
mod drawn;
mod elements;
mod equilibrium;
mod kinds;
mod material;
mod neighbours;
mod of_structure;
mod parameters;
mod path;
mod pattern_file;
mod resized;
mod rest;
mod rest_shape;
mod sensitivity;
mod soundness;
mod sticks;
mod stress;
mod system;
#[cfg(test)]
pub(crate) mod test_tiles;
#[cfg(test)]
mod tests;
mod tile;

pub use coarse::CoarseDeformation;
pub use drawn::drawn_curves;
pub use equilibrium::{EquilibriumSettings, TileEquilibrium, TileError, TileSolver};
pub use material::RodMaterial;
pub use of_structure::{StructureError, tile_of_chart, tile_of_draft};
pub use parameters::RodParameter;
pub use pattern_file::{PatternFileError, read_pattern, write_pattern};
pub use rest::RestShape;
pub use rest_shape::{RestShapeReport, RestShapeSettings, contact_radius, estimate_rest_shapes};
pub use sensitivity::{BendingAnswer, EquilibriumSlopes, bending_answer};
pub use soundness::{Unsound, unsound};
pub use stress::{CoarseStress, bending_stiffness};
pub use tile::{Edge, TileFault, YarnTile};
