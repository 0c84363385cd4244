//! A tile pulled along one direction, free to narrow: what a fit compares with a measured curve.

use serde::{Deserialize, Serialize};

use crate::shell::StretchPoint;
use crate::yarn_tile::{
    CoarseDeformation, EquilibriumSettings, RodMaterial, RodParameter, TileEquilibrium, TileError, TileSolver, YarnTile,
};

/// A point of a uniform stretch with its derivatives by `P` numbers of the model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "[f64; P]: Serialize + serde::de::DeserializeOwned")]
pub struct Answer<const P: usize> {
    /// Stretch, first Piola-Kirchhoff stress \[N/m\], compression.
    pub point: StretchPoint,
    /// Derivatives of the stress.
    pub stress_slope: [f64; P],
    /// Derivatives of the compression.
    pub compression_slope: [f64; P],
}

/// How a tile is pulled.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PullSettings {
    /// Largest step of stretch \[–\].
    pub largest_step: f64,
    /// How equilibria are found.
    pub equilibrium: EquilibriumSettings,
    /// Residual, in the unit of [`EquilibriumSettings::tolerance`], up to which a tile that did not come to rest is taken for what
    /// it is: yarns that touch softly creep along valleys that stress does not feel.
    pub accepted: f64,
}

impl Default for PullSettings {
    fn default() -> Self {
        let equilibrium = EquilibriumSettings { tolerance: 1e-8, max_iterations: 300, anchor: 1e-4 };
        Self { largest_step: 0.08, equilibrium, accepted: 1e-4 }
    }
}

/// A tile on its way along one direction, free to narrow.
#[derive(Debug)]
pub struct TilePull {
    solver: TileSolver,
    found: TileEquilibrium,
    angle: f64,
    stretch: f64,
    settings: PullSettings,
}

impl TilePull {
    /// A tile that has not been stretched yet, along a direction at an angle \[rad\] from the weft.
    ///
    /// # Errors
    /// [`TileError`].
    pub fn new(
        tile: &YarnTile,
        material: &RodMaterial,
        angle: f64,
        settings: &PullSettings,
    ) -> Result<Self, TileError> {
        let mut solver = TileSolver::free_compression(tile, material, settings.equilibrium)?;
        let found = solver.solve(&CoarseDeformation::stretched(angle, 0.0, 0.0))?;
        Ok(Self { solver, found, angle, stretch: 0.0, settings: *settings })
    }

    /// Stretches it further, or lets it go back, without stress across.
    ///
    /// # Errors
    /// [`TileError`]; [`TileError::NoEquilibrium`] where more force is left than the settings accept.
    pub fn to(&mut self, stretch: f64) -> Result<&TileEquilibrium, TileError> {
        let from = self.stretch;
        let steps = ((stretch - from).abs() / self.settings.largest_step).ceil().max(1.0) as u32;
        for step in 1..=steps {
            let next = from + (stretch - from) * f64::from(step) / f64::from(steps);
            let compression = self.found.deformation.compression();
            self.found = self.solver.solve(&CoarseDeformation::stretched(self.angle, next, compression))?;
        }
        self.stretch = stretch;
        if self.found.residual > self.settings.accepted {
            return Err(TileError::NoEquilibrium { residual: self.found.residual });
        }
        Ok(&self.found)
    }
}

/// Pulls a tile along a direction at an angle \[rad\] from the weft to each of the rising stretches, without stress across.
///
/// Differs from the paper: there the compression of no stress is found at both ends of the range, and interpolated between; here it
/// is an unknown of every equilibrium, at hardly any cost.
///
/// # Errors
/// [`TileError`]; of the first stretch at which there is no equilibrium.
pub fn pull(
    tile: &YarnTile,
    material: &RodMaterial,
    angle: f64,
    stretches: &[f64],
    with_slopes: bool,
    settings: &PullSettings,
) -> Result<Vec<Answer<{ RodParameter::COUNT }>>, TileError> {
    let mut pulled = TilePull::new(tile, material, angle, settings)?;
    let mut answers = Vec::with_capacity(stretches.len());
    for &to in stretches {
        let found = pulled.to(to)?;
        let point =
            StretchPoint { stretch: to, force: found.stress.stretch, compression: found.deformation.compression() };
        let (mut stress_slope, mut compression_slope) = ([0.0; RodParameter::COUNT], [0.0; RodParameter::COUNT]);
        if with_slopes {
            let slopes = pulled.solver.slopes()?;
            (stress_slope, compression_slope) = (slopes.stress, slopes.compression);
        }
        answers.push(Answer { point, stress_slope, compression_slope });
    }
    Ok(answers)
}
