//! One file per command.

pub mod bench;
pub mod census;
pub mod check;
pub mod export;
pub mod fit;
pub mod inspect;
pub mod lab;
pub mod new;
pub mod pattern_pictures;
pub mod patterns;
pub mod plot;
pub mod register;
pub mod relax;
pub mod render;
pub mod resume;
pub mod run;
pub mod schema;
pub mod tile_picture;
pub mod topology;
pub mod version;
pub mod view;
