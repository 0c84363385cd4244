//! How the size of a tile at rest follows the numbers of its card, without relaxing it again.

use super::tile_equilibrium::{TileEquilibrium, TileSettings};
use super::tile_system::TileSystem;
use crate::model::{KnitCard, Network, Yarns};

/// The two rows of the inverse of a tile's second derivatives that belong to its periods, at rest.
///
/// At rest the gradient `g` of the energy is zero; where a number `p` of the card changes, the unknowns follow by
/// `dy/dp = −H⁻¹ ∂g/∂p`. Of these only the periods are asked for, so that two solutions, `H⁻¹` of a one at either period,
/// answer for every number (the adjoint).
#[derive(Debug)]
pub struct TileSensitivity {
    /// By own slots, then by periods \[m/N\].
    rows: [Vec<f64>; 2],
    /// Gradient at rest: what the tolerance has left \[N\].
    left: Vec<f64>,
    periods: [f64; 2],
}

impl TileSensitivity {
    /// At an equilibrium of a tile. `None` where its second derivatives are not positive definite: the tile is not at rest, or
    /// may leave for another equilibrium.
    ///
    /// # Panics
    /// If the equilibrium is not of this tile.
    #[must_use]
    pub fn new(
        network: &Network,
        yarns: impl Into<Yarns>,
        card: &KnitCard,
        settings: &TileSettings,
        at: &TileEquilibrium,
    ) -> Option<Self> {
        let (mut system, unknowns) = system(network, &yarns.into(), card, settings, at);
        system.linearise(&unknowns, 0.0);
        let rows = [0, 1].map(|axis| system.inverse_row(axis));
        let [Some(width), Some(height)] = rows else { return None };
        let n = unknowns.len();
        Some(Self { rows: [width, height], left: whole_gradient(&system), periods: [unknowns[n - 2], unknowns[n - 1]] })
    }

    /// Change of the logarithms of width and height, to first order, where the tile gets another card that differs a little.
    #[must_use]
    pub fn change(
        &self,
        network: &Network,
        yarns: impl Into<Yarns>,
        card: &KnitCard,
        settings: &TileSettings,
        at: &TileEquilibrium,
    ) -> [f64; 2] {
        let (mut system, unknowns) = system(network, &yarns.into(), card, settings, at);
        system.linearise(&unknowns, 0.0);
        let gradient = whole_gradient(&system);
        [0, 1].map(|axis| {
            let moved = self.rows[axis].iter().zip(&gradient).zip(&self.left);
            -moved.map(|((row, new), old)| row * (new - old)).sum::<f64>() / self.periods[axis]
        })
    }
}

fn whole_gradient(system: &TileSystem) -> Vec<f64> {
    let mut gradient = system.gradient.clone();
    gradient.extend(system.period_gradient);
    gradient
}

/// The system of a tile, and its unknowns at an equilibrium.
fn system(
    network: &Network,
    yarns: &Yarns,
    card: &KnitCard,
    settings: &TileSettings,
    at: &TileEquilibrium,
) -> (TileSystem, Vec<f64>) {
    let system = TileSystem::of(network, yarns, &card.into(), settings);
    let unknowns = system.coordinates.unknowns(at.coordinates.clone());
    (system, unknowns)
}
