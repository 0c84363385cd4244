//! Equilibrium of a tile under a stretch, by Newton's method.

use thiserror::Error;
use wale_numerics::sparse_cholesky::CholeskyError;
use wale_numerics::trust::Trust;

use super::direction::Direction;
use super::reference::TileReference;
use crate::dynamics::tile_descent::{Descent, RULE};
use crate::dynamics::tile_equilibrium::TileSettings;
use crate::dynamics::tile_stiffness::UnitEnergies;
use crate::dynamics::tile_system::{Around, TileSystem};

/// Why a tile has no equilibrium under a stretch.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum StretchError {
    /// The tile from which stretch is measured is not at rest.
    #[error("the tile is not at rest before it is stretched: forces of {residual} k_b/ℓ² are left")]
    NotRelaxed {
        /// Largest force left, in `k_b/ℓ²`.
        residual: f64,
    },
    /// The stretch turns the fabric inside out, or is not finite.
    #[error("a stretch of {stretch} with a compression of {compression} cannot be applied")]
    Deformation {
        /// Stretch \[–\].
        stretch: f64,
        /// Compression \[–\].
        compression: f64,
    },
    /// The system could not be built or solved.
    #[error(transparent)]
    Cholesky(#[from] CholeskyError),
    /// Newton's method ended elsewhere.
    #[error("no equilibrium was found at a stretch of {stretch}: forces of {residual} k_b/ℓ² are left")]
    NoEquilibrium {
        /// Stretch \[–\].
        stretch: f64,
        /// Largest force left, in `k_b/ℓ²`.
        residual: f64,
    },
}

/// A tile at rest under a stretch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StretchedEquilibrium {
    /// Stretch along the direction \[–\].
    pub stretch: f64,
    /// Compression across it \[–\].
    pub compression: f64,
    /// Elastic energy over the area of the relaxed tile, the bed's included \[J/m²\].
    pub energy_density: f64,
    /// First Piola-Kirchhoff stress `σ_s = (1/A) ∂W/∂s` along the direction \[N/m\], forces over lengths of the relaxed tile.
    pub stress: f64,
    /// `(1/A) ∂W/∂c` across it \[N/m\], positive where the fabric resists becoming narrower.
    pub stress_across: f64,
    /// Newton iterations used.
    pub iterations: usize,
    /// Largest force left, in `k_b/ℓ²` \[–\].
    pub residual: f64,
    /// Whether that is within the tolerance of the tile's settings.
    pub converged: bool,
}

/// Finds equilibria of one relaxed tile stretched along one direction, each from the one before.
///
/// `F = U diag(1 + s, 1 − c) Uᵀ` [Sperl2022, section 7.1]: a place `X` of the relaxed tile goes to `F X + ũ`, an image of it `k`
/// periods away to `F (X + kP) + ũ`. Unknowns are `ũ`, heights, sliding coordinates, and the compression if it is free; rigid motion
/// and one sliding coordinate of each yarn are held, of a weave all of them, and the bed lies under the tile, as where it was relaxed.
///
/// Differs from the paper: there COBYLA looks for the compression of least energy and solves for equilibrium at every try; here it is
/// one more unknown of Newton's method. Test: `stress_is_the_central_difference_of_the_energy`.
#[derive(Debug)]
pub struct StretchedTile {
    pub(super) system: TileSystem,
    pub(super) units: UnitEnergies,
    /// Own slots, then stretch and compression times `length` \[m\].
    pub(super) unknowns: Vec<f64>,
    /// Equilibria of the two last stretches.
    last: Option<Vec<f64>>,
    before: Option<Vec<f64>>,
    pub(super) free_compression: bool,
    /// `√A` \[m\].
    pub(super) length: f64,
    /// Units of force `k_b/ℓ²` \[N\] and of length `ℓ` \[m\].
    pub(super) force: f64,
    pub(super) unit_length: f64,
    settings: TileSettings,
}

/// Force up to which a tile is taken for what it is, in `k_b/ℓ²`: a thousandth of what bends a loop, far below any force of a test.
pub const ACCEPTED: f64 = 1e-3;

/// Multiple of the last change of stretch over which the next equilibrium is extrapolated.
const FARTHEST: f64 = 2.0;

impl StretchedTile {
    /// A tile along a direction at an angle \[rad\] from the course, of a weave from the weft; with a compression that is free, so that nothing pulls across,
    /// or given.
    ///
    /// # Errors
    /// [`StretchError::Cholesky`] if the system is too large.
    pub fn new(reference: &TileReference, angle: f64, free_compression: bool) -> Result<Self, StretchError> {
        let length = reference.area().sqrt();
        let coordinates = reference.coordinates(&Direction::at(angle), length);
        let (yarns, card, settings) = (&reference.yarns, &reference.card, reference.settings);
        let (bending, unit_length) = reference.bending_and_length();
        let force = bending / unit_length.powi(2);
        let bed = settings.bed * force / unit_length;
        let units = reference.units(coordinates.clone());
        let around = Around { bed, held: [true, !free_compression], ..Around::default() };
        let system = TileSystem::with(&reference.network, yarns, card, coordinates, around)?;
        let mut world = reference.rest().coordinates.clone();
        world.truncate(system.coordinates.own().len());
        world.extend([0.0; 2]);
        let unknowns = system.coordinates.unknowns(world);
        Ok(Self {
            system,
            units,
            unknowns,
            last: None,
            before: None,
            free_compression,
            length,
            force,
            unit_length,
            settings,
        })
    }

    /// Brings the tile to rest under a stretch, from where it is. A compression that is free begins where it is, or where the last
    /// two equilibria point; otherwise it is the given one.
    ///
    /// # Errors
    /// [`StretchError::Deformation`]; [`StretchError::NoEquilibrium`] if more than [`ACCEPTED`] is left;
    /// [`StretchError::Cholesky`] if numbers are not finite. The tile is then where it was before.
    pub fn solve(&mut self, stretch: f64, compression: f64) -> Result<StretchedEquilibrium, StretchError> {
        let n = self.unknowns.len();
        let given = if self.free_compression { self.unknowns[n - 1] / self.length } else { compression };
        if !(stretch > -1.0 && given < 1.0 && stretch.is_finite() && given.is_finite()) {
            return Err(StretchError::Deformation { stretch, compression: given });
        }
        let mut start = self.unknowns.clone();
        start[n - 2] = stretch * self.length;
        start[n - 1] = given * self.length;
        let foreseen = self.foreseen(&start);
        let sound = foreseen.as_ref().is_some_and(|foreseen| self.system.is_sound(foreseen));
        let mut descent = Descent::new(
            &mut self.system,
            foreseen.filter(|_| sound).unwrap_or(start),
            self.force,
            self.unit_length,
            self.settings,
            Trust::new(RULE, 0.0, 0.0),
        );
        descent.run();
        let Descent { unknowns, iterations, residual, .. } = descent;
        if residual.is_nan() {
            return Err(CholeskyError::NotFinite.into());
        }
        if residual > ACCEPTED {
            return Err(StretchError::NoEquilibrium { stretch, residual });
        }
        self.before = self.last.replace(unknowns.clone());
        self.unknowns = unknowns;
        let energy = self.system.linearise(&self.unknowns, 0.0);
        let [along, across] = self.system.period_gradient.map(|g| g / self.length);
        Ok(StretchedEquilibrium {
            stretch,
            compression: self.unknowns[n - 1] / self.length,
            energy_density: energy / (self.length * self.length),
            stress: along,
            stress_across: across,
            iterations,
            residual,
            converged: residual <= self.settings.tolerance,
        })
    }

    /// Holds the compression, from here on given, or lets it go.
    pub fn hold_compression(&mut self, hold: bool) {
        self.free_compression = !hold;
        self.system.hold_second(hold);
    }

    /// Where the last two equilibria point, for the stretch and the given compression of `start`.
    fn foreseen(&self, start: &[f64]) -> Option<Vec<f64>> {
        let (last, before) = (self.last.as_ref()?, self.before.as_ref()?);
        let n = start.len();
        let change = |to: &[f64], from: &[f64]| [to[n - 2] - from[n - 2], to[n - 1] - from[n - 1]];
        let (gone, going) = (change(last, before), change(start, last));
        let part = going[0] / gone[0];
        let straight = self.free_compression || (going[1] - part * gone[1]).abs() <= 1e-9 * self.length;
        if !part.is_finite() || part.abs() > FARTHEST || !straight {
            return None;
        }
        let mut foreseen: Vec<f64> =
            last.iter().zip(before).map(|(last, before)| last + part * (last - before)).collect();
        foreseen[n - 2] = start[n - 2];
        if !self.free_compression {
            foreseen[n - 1] = start[n - 1];
        }
        Some(foreseen)
    }
}
