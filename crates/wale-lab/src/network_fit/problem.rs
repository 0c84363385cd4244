//! What a fabric does with given stiffnesses: it is brought to rest, and pulled along every target.

use rayon::prelude::*;
use wale::dynamics::stretched_tile::{StretchError, TileReference};
use wale::dynamics::tile_equilibrium::{TileEquilibrium, TileSettings, relax_from_starts, relax_tile_from};
use wale::dynamics::tile_stiffness::TileStiffness;
use wale::model::{FabricCard, Network, Yarns};

use super::pull::{NetworkPullSettings, pull_network};
use crate::least_squares::Residuals;
use crate::yarn_fit::{Answer, Target, add_residuals};

const P: usize = TileStiffness::COUNT;

/// A tile and its targets.
#[derive(Clone, Debug)]
pub struct NetworkProblem {
    network: Network,
    yarns: Yarns,
    card: FabricCard,
    targets: Vec<Target>,
    tile: TileSettings,
    pull: NetworkPullSettings,
    /// The tile at rest with the yarns and the card as they were given, from which every other is relaxed.
    rest: TileEquilibrium,
}

/// What the tile does.
#[derive(Clone, Debug)]
pub struct NetworkEvaluation {
    /// The tile at rest.
    pub rest: TileEquilibrium,
    /// Stress and compression along each target's points.
    pub answers: Vec<Vec<Answer<P>>>,
}

impl NetworkProblem {
    /// Relaxes the tile with the stiffnesses that its yarns and card have, from a number of starts.
    ///
    /// # Errors
    /// [`StretchError::NotRelaxed`] if none of them comes to rest.
    pub fn new(
        network: &Network,
        yarns: impl Into<Yarns>,
        card: impl Into<FabricCard>,
        targets: Vec<Target>,
        tile: TileSettings,
        pull: NetworkPullSettings,
        starts: usize,
    ) -> Result<Self, StretchError> {
        let (yarns, card) = (yarns.into(), card.into());
        let rest = relax_from_starts(network, &yarns, &card, &tile, starts.max(1)).swap_remove(0);
        TileReference::new(network, &yarns, &card, &tile, rest.clone())?;
        Ok(Self { network: network.clone(), yarns, card, targets, tile, pull, rest })
    }

    /// The stiffnesses as they were given.
    #[must_use]
    pub fn stiffness(&self) -> [f64; P] {
        TileStiffness::of(&self.network, &self.yarns, &self.card)
    }

    /// Yarns and card with other stiffnesses.
    #[must_use]
    pub fn with(&self, stiffness: [f64; P]) -> (Yarns, FabricCard) {
        TileStiffness::with(&self.network, &self.yarns, &self.card, stiffness)
    }

    /// What is to be met.
    #[must_use]
    pub fn targets(&self) -> &[Target] {
        &self.targets
    }

    /// Relaxes and pulls the tile with some stiffnesses; `None` where it cannot be.
    ///
    /// The relaxed tile is found again for every evaluation, from the one of the given stiffnesses, and slopes reckon with it.
    #[must_use]
    pub fn evaluate(&self, stiffness: [f64; P], slopes: bool) -> Option<NetworkEvaluation> {
        let (yarns, card) = self.with(stiffness);
        let rest = relax_tile_from(&self.network, &yarns, &card, &self.tile, self.rest.coordinates.clone());
        let reference = TileReference::new(&self.network, &yarns, &card, &self.tile, rest.clone()).ok()?;
        let size_slopes = if slopes { Some(reference.size_slopes()?) } else { None };
        let one = |target: &Target| {
            pull_network(&reference, target.angle, &target.stretches(), size_slopes.as_ref(), &self.pull).ok()
        };
        let answers = self.targets.par_iter().map(one).collect::<Option<Vec<_>>>()?;
        Some(NetworkEvaluation { rest, answers })
    }

    /// How far an evaluation is from the targets, with derivatives by the logarithms of the stiffnesses.
    #[must_use]
    pub fn residuals(&self, stiffness: [f64; P], evaluation: &NetworkEvaluation) -> Residuals<P> {
        let mut out = Residuals::default();
        let by_logarithms = |slopes: [f64; P]| std::array::from_fn(|k| slopes[k] * stiffness[k]);
        for (target, answers) in self.targets.iter().zip(&evaluation.answers) {
            add_residuals(target, answers, by_logarithms, &mut out);
        }
        out
    }
}
