//! How a fabric moves and where it comes to rest.

pub mod state;

pub use state::State;
