//! One file per command.

pub mod version;
