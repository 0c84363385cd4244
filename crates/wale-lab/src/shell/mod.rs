//! Thin shells of triangles: the continuum that stands between a measured swatch and a yarn tile [Sperl2022, section 5].
//!
//! A [`ShellCard`] says what a fabric is, a [`TriangleMesh`] what was cut of it, and a virtual test ([`ClampedStretch`],
//! [`PearLoop`], [`Cantilever`], [`bias_extension`], [`uniform`]) what is done with it. [`membrane_fit`] and [`bending_fit`] find the card whose
//! tests come out as measured.

pub mod bending_fit;
pub mod bias_extension;
pub mod cantilever;
pub mod card;
pub mod clamped_stretch;
pub mod error;
pub mod membrane_fit;
mod membrane_law;
pub mod mesh;
pub mod of_fabric;
pub mod pear_loop;
pub mod polygon;
pub mod rest;
pub mod stretch_curve;
pub mod system;
pub mod uniform;

pub use cantilever::Cantilever;
pub use card::ShellCard;
pub use clamped_stretch::{ClampedStretch, OutOfPlane, Sheet};
pub use error::ShellError;
pub use mesh::TriangleMesh;
pub use pear_loop::PearLoop;
pub use rest::RestSettings;
pub use stretch_curve::{StretchCurve, StretchPoint};
pub use system::ShellSystem;
