//! A strip of fabric that is stretched evenly along one direction and free to narrow.

use super::{TestedTile, UniformTestError};
use crate::network_fit::NetworkPull;
use crate::yarn_fit::TilePull;

/// What a strip does at a stretch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StripPoint {
    /// Stretch \[–\].
    pub stretch: f64,
    /// Force by width at rest \[N/m\].
    pub force: f64,
    /// Contraction of the width \[–\].
    pub compression: f64,
    /// Energy by area at rest \[J/m²\].
    pub energy: f64,
}

/// A strip, from one stretch to the next.
pub trait UniformStrip {
    /// Stretches it further, or lets it go back, without stress across.
    ///
    /// # Errors
    /// [`UniformTestError`] if it does not come to rest.
    fn at(&mut self, stretch: f64) -> Result<StripPoint, UniformTestError>;
}

impl TestedTile {
    /// A strip of it along a direction at an angle \[rad\] from the weft.
    ///
    /// # Errors
    /// [`UniformTestError`] if it does not come to rest.
    pub fn strip(&self, angle: f64) -> Result<TilePull, UniformTestError> {
        TilePull::new(&self.tile, &self.material, angle, &self.settings).map_err(UniformTestError::at("rest"))
    }
}

impl UniformStrip for TilePull {
    fn at(&mut self, stretch: f64) -> Result<StripPoint, UniformTestError> {
        let place = format!("a stretch of {:.2} %", 100.0 * stretch);
        let found = self.to(stretch).map_err(UniformTestError::at(place))?;
        let compression = found.deformation.compression();
        Ok(StripPoint { stretch, force: found.stress.stretch, compression, energy: found.energy_density })
    }
}

impl UniformStrip for NetworkPull {
    fn at(&mut self, stretch: f64) -> Result<StripPoint, UniformTestError> {
        let found = self.to(stretch)?;
        Ok(StripPoint { stretch, force: found.stress, compression: found.compression, energy: found.energy_density })
    }
}
