//! The relaxed tile from which stretch is measured, and how its size follows its stiffnesses.

use super::direction::Direction;
use super::solver::StretchError;
use crate::dynamics::tile_equilibrium::{TileEquilibrium, TileSettings};
use crate::dynamics::tile_stiffness::{TileStiffness, UnitEnergies, bending_and_length};
use crate::dynamics::tile_system::TileSystem;
use crate::fabric::coordinates::BLOCK;
use crate::fabric::{Matrix2, PlaneMap, TileCoordinates};
use crate::model::{FabricCard, Network, Yarns};

/// A tile at rest with its yarns and its card.
#[derive(Clone, Debug)]
pub struct TileReference {
    pub(super) network: Network,
    pub(super) yarns: Yarns,
    pub(super) card: FabricCard,
    pub(super) settings: TileSettings,
    rest: TileEquilibrium,
    periods: [f64; 2],
}

impl TileReference {
    /// A tile that [`crate::dynamics::tile_equilibrium`] has brought to rest with these yarns, card and settings; of a weave at its sett.
    ///
    /// # Errors
    /// [`StretchError::NotRelaxed`] if it did not come to rest, or is another network's.
    pub fn new(
        network: &Network,
        yarns: impl Into<Yarns>,
        card: impl Into<FabricCard>,
        settings: &TileSettings,
        rest: TileEquilibrium,
    ) -> Result<Self, StretchError> {
        let n = rest.coordinates.len();
        let own = TileCoordinates::new(network).own().len();
        let finite = rest.coordinates.iter().all(|x| x.is_finite());
        if !rest.converged || own == 0 || n != own + 2 || !finite {
            return Err(StretchError::NotRelaxed { residual: rest.residual });
        }
        let periods = [rest.coordinates[n - 2], rest.coordinates[n - 1]];
        if periods.iter().any(|&p| p <= 0.0) {
            return Err(StretchError::NotRelaxed { residual: rest.residual });
        }
        Ok(Self {
            network: network.clone(),
            yarns: yarns.into(),
            card: card.into(),
            settings: *settings,
            rest,
            periods,
        })
    }

    /// The tile at rest.
    #[must_use]
    pub fn rest(&self) -> &TileEquilibrium {
        &self.rest
    }

    /// Its periods along x and y \[m\].
    #[must_use]
    pub fn periods(&self) -> [f64; 2] {
        self.periods
    }

    /// Its area \[m²\].
    #[must_use]
    pub fn area(&self) -> f64 {
        self.periods[0] * self.periods[1]
    }

    /// Its stiffnesses in SI units, in the order of [`TileStiffness::all`].
    #[must_use]
    pub fn stiffness(&self) -> [f64; TileStiffness::COUNT] {
        TileStiffness::of(&self.network, &self.yarns, &self.card)
    }

    /// Derivatives of the logarithms of both periods by the stiffnesses. `None` where the second derivatives are not positive
    /// definite: the tile may leave for another equilibrium.
    ///
    /// At rest `∂W/∂y = 0`, so that `dy/dp = −H⁻¹ ∂²W/∂y∂p`; the two rows of `H⁻¹` that belong to the periods answer for all
    /// stiffnesses. A weave keeps its sett, whatever they are.
    #[must_use]
    pub fn size_slopes(&self) -> Option<[[f64; TileStiffness::COUNT]; 2]> {
        if self.card.woven().is_some() {
            return Some([[0.0; TileStiffness::COUNT]; 2]);
        }
        let mut system = TileSystem::of(&self.network, &self.yarns, &self.card, &self.settings);
        let unknowns = system.coordinates.unknowns(self.rest.coordinates.clone());
        system.linearise(&unknowns, 0.0);
        let [Some(width), Some(height)] = [0, 1].map(|axis| system.inverse_row(axis)) else { return None };
        let units = self.units(TileCoordinates::new(&self.network));
        let work = units.work(&unknowns, [&width, &height]);
        Some([0, 1].map(|axis| work.map(|along| -along[axis] / self.periods[axis])))
    }

    /// Bending stiffness \[N·m²\] and length \[m\] by which its forces are measured.
    pub(super) fn bending_and_length(&self) -> (f64, f64) {
        bending_and_length(&self.network, &self.yarns, &self.card)
    }

    /// The energies of the stiffnesses over given coordinates.
    pub(super) fn units(&self, coordinates: TileCoordinates) -> UnitEnergies {
        let relative_bed = self.settings.bed / self.card.unit_length().powi(3);
        UnitEnergies::new(&self.network, &self.yarns, &self.card, relative_bed, coordinates)
    }

    /// Coordinates whose two numbers of the plane are stretch and compression times a length \[m\], and whose slots are
    /// displacements from the relaxed tile in the plane, else coordinates.
    pub(super) fn coordinates(&self, direction: &Direction, length: f64) -> TileCoordinates {
        let [w, h] = self.periods;
        // Columns are periods.
        let carried = |m: Matrix2, factor: f64| m.map(|[a, b]| [factor * a * w, factor * b * h]);
        let map = PlaneMap {
            base: [[w, 0.0], [0.0, h]],
            rates: [direction.stretch_rate(), direction.compression_rate()].map(|rate| carried(rate, 1.0 / length)),
        };
        let own = &self.rest.coordinates;
        let places = (0..self.network.node_count()).map(|node| [own[BLOCK * node] / w, own[BLOCK * node + 1] / h]);
        TileCoordinates::with_plane(&self.network, &places.collect::<Vec<_>>(), &map)
    }
}
