//! Virtual textile tests: what an instrument would print of a fabric that is a thin shell.
//!
//! A file a test. Each takes a [`ShellCard`](crate::shell::ShellCard), does what the test does, and gives a plain struct of SI
//! numbers; [`units`] has what instruments print them in. A shell is elastic: whatever a test measures between loading and
//! unloading is zero here, or all of it comes back, and no test pretends otherwise. Definitions and sources: `docs/topics/virtual-tests.md`.

pub mod bias_extension;
pub mod bias_mesh;
pub mod cantilever;
pub mod drape;
pub mod drape_mesh;
pub mod fast;
pub mod kes_bending;
pub mod kes_shear;
pub mod kes_tensile;
pub mod pear_loop;
pub mod picture_frame;
pub mod rig;
pub mod shadow;
pub mod stretch;
pub mod units;

pub use bias_extension::{BiasExtensionResult, BiasExtensionTest};
pub use cantilever::{CantileverResult, CantileverTest};
pub use drape::{DrapeResult, DrapeTest};
pub use fast::{FastResult, FastTest};
pub use kes_bending::{KesBendingResult, KesBendingTest};
pub use kes_shear::{KesShearResult, KesShearTest};
pub use kes_tensile::{KesTensileResult, KesTensileTest};
pub use pear_loop::{PearLoopResult, PearLoopTest};
pub use picture_frame::{PictureFrameResult, PictureFrameTest};
pub use rig::Rig;
pub use stretch::{StretchResult, StretchTest};
