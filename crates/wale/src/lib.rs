//! Yarn-level cloth: from a stitch chart to moving fabric.
//!
//! A [`scene`] is read into plain numbers; [`pattern`] knits its chart into a network of yarns ([`model`]); a
//! [`simulation`] moves it, or [`dynamics::tile_equilibrium`] finds where one repeat of it rests. Frames go to a run
//! folder ([`record`]); [`geometry`] makes smooth yarns of them for [`picture`], [`view`] and [`export`], and [`measure`]
//! numbers. The forces are in [`energy`], one file each; [`fabric`] says which coordinates they act on, [`contact`] what
//! presses on what. `ARCHITECTURE.md` says which room may use which.
//!
//! ```
//! use wale::scene::Scene;
//! use wale::simulation::{Simulation, Start};
//!
//! let text = "
//!     schema = 1
//!     [fabric.chart]
//!     pattern = \"garter\"
//!     columns = 4
//!     rows = 4
//! ";
//! let scene = Scene::from_text(text, "swatch.toml")?;
//! let start = Start::new(&scene.structure, &scene.yarns, &scene.fabric, false);
//! let mut simulation = Simulation::new(start.network, &scene.yarns, &scene.fabric, scene.plan.clone());
//! let report = simulation.step()?;
//! assert!(report.time > 0.0 && report.largest_stretch < 1.1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod contact;
pub mod dynamics;
pub mod energy;
pub mod export;
pub mod fabric;
pub mod geometry;
pub mod measure;
pub mod model;
pub mod pattern;
pub mod picture;
pub mod record;
pub mod scene;
pub mod simulation;
pub mod view;
