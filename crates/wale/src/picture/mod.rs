//! Pictures of fabrics: yarns as spun tubes under soft light, with a scale bar in millimetres.
//!
//! [`Camera::framing`] places the eye, [`render`] casts the rays, [`write_png`] writes the file.

pub mod base64;
pub mod bvh;
pub mod camera;
pub mod chart_grid;
pub mod color_map;
mod hair;
pub mod image;
pub mod lettering;
mod light;
pub mod plot;
pub mod png;
pub mod ray_caster;
mod sampling;
pub mod scale_bar;
pub mod settings;
mod solid;
mod spun_yarn;
mod tube;
pub mod yarn_colors;

pub use base64::base64;
pub use camera::{Camera, Projection, View};
pub use chart_grid::{Chart, ChartGrid};
pub use color_map::ColorMap;
pub use image::Image;
pub use plot::{Panel, Plot, PlotError, Series};
pub use png::{PngError, read_png, sequence_name, write_png};
pub use ray_caster::render;
pub use settings::{ColorMode, Settings, Subject};
pub use yarn_colors::{color_map, color_range};
