//! The network of a tile pulled along one direction, free to narrow: what a fit compares with a measured curve.

use wale::dynamics::stretched_tile::{StretchError, StretchedEquilibrium, StretchedTile, TileReference};
use wale::dynamics::tile_stiffness::TileStiffness;

use crate::shell::StretchPoint;
use crate::yarn_fit::Answer;

/// How a tile is pulled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NetworkPullSettings {
    /// Largest step of stretch \[–\].
    pub largest_step: f64,
    /// Least step, to which steps are halved where there is no equilibrium \[–\].
    pub least_step: f64,
}

impl Default for NetworkPullSettings {
    fn default() -> Self {
        Self { largest_step: 0.04, least_step: 0.002 }
    }
}

/// No step is shorter, whatever the settings say \[–\].
const SHORTEST: f64 = 1e-5;

/// Derivatives of the logarithms of a relaxed tile's periods by its stiffnesses.
pub type SizeSlopes = [[f64; TileStiffness::COUNT]; 2];

/// A tile on its way along one direction, free to narrow.
#[derive(Debug)]
pub struct NetworkPull {
    tile: StretchedTile,
    from: f64,
    settings: NetworkPullSettings,
}

impl NetworkPull {
    /// A relaxed tile that has not been stretched yet, along a direction at an angle \[rad\] from the course, of a weave from the weft.
    ///
    /// # Errors
    /// [`StretchError`].
    pub fn new(reference: &TileReference, angle: f64, settings: &NetworkPullSettings) -> Result<Self, StretchError> {
        let mut tile = StretchedTile::new(reference, angle, true)?;
        let from = tile.solve(0.0, 0.0)?.stretch;
        Ok(Self { tile, from, settings: *settings })
    }

    /// Stretches it further, or lets it go back, without stress across.
    ///
    /// # Errors
    /// [`StretchError`].
    pub fn to(&mut self, stretch: f64) -> Result<StretchedEquilibrium, StretchError> {
        let found = advance(&mut self.tile, self.from, stretch, &self.settings)?;
        self.from = stretch;
        Ok(found)
    }
}

/// Pulls a relaxed tile along a direction at an angle \[rad\] from the course, of a weave from the weft, to each of the rising stretches, without stress
/// across.
///
/// With `size_slopes` ([`TileReference::size_slopes`]) the answers have derivatives by the stiffnesses in the order of
/// [`TileStiffness::all`], to which that of the relaxed tile contributes; without they are zero.
///
/// # Errors
/// [`StretchError`]; of the first stretch at which there is no equilibrium.
pub fn pull_network(
    reference: &TileReference,
    angle: f64,
    stretches: &[f64],
    size_slopes: Option<&SizeSlopes>,
    settings: &NetworkPullSettings,
) -> Result<Vec<Answer<{ TileStiffness::COUNT }>>, StretchError> {
    let mut pulled = NetworkPull::new(reference, angle, settings)?;
    let mut answers = Vec::with_capacity(stretches.len());
    for &to in stretches {
        let found = pulled.to(to)?;
        let point = StretchPoint { stretch: to, force: found.stress, compression: found.compression };
        let (mut stress_slope, mut compression_slope) = ([0.0; TileStiffness::COUNT], [0.0; TileStiffness::COUNT]);
        if let Some(size_slopes) = size_slopes {
            let slopes = pulled.tile.slopes(Some(size_slopes))?;
            (stress_slope, compression_slope) = (slopes.stress, slopes.compression);
        }
        answers.push(Answer { point, stress_slope, compression_slope });
    }
    Ok(answers)
}

/// From one stretch to another in steps that are halved where they lead nowhere.
fn advance(
    tile: &mut StretchedTile,
    from: f64,
    to: f64,
    settings: &NetworkPullSettings,
) -> Result<StretchedEquilibrium, StretchError> {
    let least = settings.least_step.max(SHORTEST);
    let (mut at, mut step) = (from, settings.largest_step.max(least));
    loop {
        let left = (to - at).abs();
        // Even steps, so that none is tiny.
        let next = if left <= step { to } else { at + (to - at) / (left / step).ceil() };
        match tile.solve(next, 0.0) {
            Ok(found) if next == to => return Ok(found),
            Ok(_) => at = next,
            Err(StretchError::NoEquilibrium { .. } | StretchError::Cholesky(_)) if 0.5 * step >= least => {
                step *= 0.5;
            }
            Err(error) => return Err(error),
        }
    }
}
