//! Textile tests on a fabric without end: a periodic tile is deformed evenly, and says what each metre of fabric would.
//!
//! Tiles are those that fits are made with: yarns in full contact ([`crate::yarn_tile`]), and the contact model's
//! ([`wale::dynamics::stretched_tile`]). They have no edges, so that nothing can be clamped, hang or fold; and no friction, so that all
//! work comes back. Definitions and sources: `docs/topics/virtual-tests.md`.

pub mod bending;
pub mod cantilever;
pub mod fast;
pub mod picture_frame;
pub mod shear;
pub mod strip;
pub mod tensile;

use thiserror::Error;
use wale::dynamics::stretched_tile::StretchError;

use crate::yarn_fit::PullSettings;
use crate::yarn_tile::{RodMaterial, TileError, YarnTile};

pub use bending::{TileBendingResult, TileBendingTest};
pub use cantilever::{HeavyElastica, heavy_elastica, tile_cantilever};
pub use fast::{UniformFastDirection, UniformFastResult, uniform_fast};
pub use picture_frame::tile_picture_frame;
pub use shear::tile_shear;
pub use strip::{StripPoint, UniformStrip};
pub use tensile::{draw, stretch_at_load, tensile};

/// A tile of yarns in full contact, what it is made of, and how it is brought to rest.
#[derive(Clone, Debug, PartialEq)]
pub struct TestedTile {
    /// With its rest shapes.
    pub tile: YarnTile,
    /// Of its yarns.
    pub material: RodMaterial,
    /// Steps and precision; those of fits.
    pub settings: PullSettings,
}

/// Why a tile was not tested.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum UniformTestError {
    /// A number of the test is not what it can be.
    #[error("{what} is {value}, and must be {must}")]
    Number {
        /// Which number.
        what: &'static str,
        /// What it is.
        value: f64,
        /// What it must be.
        must: &'static str,
    },
    /// The tile did not come to rest.
    #[error("the tile at {place}: {cause}")]
    Tile {
        /// How far the test had come, in words.
        place: String,
        /// What is wrong.
        cause: TileError,
    },
    /// The tile of the contact model did not come to rest.
    #[error("the tile of the contact model: {0}")]
    Contacts(#[from] StretchError),
    /// A load that is never reached.
    #[error("the tile does not bear {load:.4} N/m: at a stretch of {stretch:.2} it bears {force:.4} N/m")]
    Load {
        /// The load by width \[N/m\].
        load: f64,
        /// Largest stretch that was tried \[–\].
        stretch: f64,
        /// Force by width there \[N/m\].
        force: f64,
    },
}

impl UniformTestError {
    /// Of a tile at a place of a test.
    fn at(place: impl Into<String>) -> impl FnOnce(TileError) -> Self {
        let place = place.into();
        move |cause| Self::Tile { place, cause }
    }
}

/// That a number is positive and finite.
fn positive(what: &'static str, value: f64) -> Result<(), UniformTestError> {
    if value > 0.0 && value < f64::INFINITY {
        return Ok(());
    }
    Err(UniformTestError::Number { what, value, must: "positive and finite" })
}
