//! How a fabric moves and where it comes to rest.

pub mod chunks;
mod few;
pub mod grips;
pub mod implicit_euler;
pub mod linear;
pub mod loop_shapes;
pub mod off_needles;
mod remaining;
mod scatter;
mod selected;
pub(crate) mod soft_start;
pub mod state;
pub mod step;
mod strands;
pub mod stretched_tile;
mod surroundings;
pub mod system;
pub mod terms;
mod tile_conditions;
mod tile_contacts;
mod tile_descent;
pub mod tile_equilibrium;
mod tile_places;
pub mod tile_sensitivity;
pub mod tile_shaking;
pub mod tile_stiffness;
mod tile_system;
mod weave_systems;
pub mod workspace;

pub use state::State;
