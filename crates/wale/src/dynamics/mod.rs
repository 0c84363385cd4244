//! How a fabric moves and where it comes to rest.

pub mod state;
pub mod tile_equilibrium;

pub use state::State;
