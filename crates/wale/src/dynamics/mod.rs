//! How a fabric moves and where it comes to rest.

pub mod grips;
pub mod implicit_euler;
pub mod linear;
pub mod loop_shapes;
mod scatter;
pub mod state;
pub mod step;
pub mod system;
pub mod terms;
pub mod tile_equilibrium;

pub use state::State;
