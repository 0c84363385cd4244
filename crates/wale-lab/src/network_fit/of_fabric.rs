//! The contact model of a fabric file whose structure is a chart: a scene of it with the stiffnesses that its tests tell.

use thiserror::Error;
use wale::dynamics::stretched_tile::{StretchError, TileReference};
use wale::dynamics::tile_equilibrium::{TileSettings, relax_from_starts};
use wale::model::{FabricCard, KnitCard, Network};
use wale::pattern::{ChartError, knit};
use wale::scene::Scene;

use super::fit::{NetworkFit, NetworkFitError, NetworkFitSettings, fit_network};
use crate::yarn_fit::Target;

/// Why there is no such scene.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SceneFitError {
    /// The scene has no chart.
    #[error("only charts are fitted with the contact model")]
    NoChart,
    /// The chart does not repeat.
    #[error(transparent)]
    Chart(#[from] ChartError),
    /// The repeat is too large to be pulled many times.
    #[error("the repeat has {loops} loops, and at most {MOST_LOOPS} are fitted")]
    TooLarge {
        /// Its loops.
        loops: usize,
    },
    /// Nothing was fitted.
    #[error(transparent)]
    Fit(#[from] NetworkFitError),
    /// The repeat does not come to rest.
    #[error(transparent)]
    Pull(#[from] StretchError),
}

/// Most loops of a repeat.
const MOST_LOOPS: usize = 16;
/// Factors of the scene's stiffnesses from which the search begins: none, and bending, spacing and legs much stiffer, as thick soft yarns
/// are that were given the numbers of firm ones.
const STARTS: [[f64; 6]; 3] = [[1.0; 6], [1.0, 8.0, 1.0, 1.0, 30.0, 10.0], [1.0, 1.0, 1.0, 1.0, 30.0, 1.0]];

/// Fits the stiffnesses of a scene's yarns and contacts, and gives the scene with them.
///
/// # Errors
/// [`SceneFitError`].
pub fn fit_scene(scene: &Scene, targets: &[Target]) -> Result<(Scene, NetworkFit), SceneFitError> {
    let (network, card) = repeat_of(scene)?;
    let settings = NetworkFitSettings { starts: STARTS.to_vec(), ..NetworkFitSettings::default() };
    let found = fit_network(&network, &scene.yarns, card, targets, &settings)?;
    let fitted = Scene { yarns: found.yarns.clone(), fabric: FabricCard::from(&found.card), ..scene.clone() };
    Ok((fitted, found))
}

/// Starts from which a repeat is relaxed, and the one of least energy taken.
const STARTS_AT_REST: usize = 3;

/// The repeat of a scene's chart with its own stiffnesses, relaxed: what is pulled by [`super::NetworkPull`].
///
/// # Errors
/// [`SceneFitError`]; [`SceneFitError::Pull`] if it does not come to rest.
pub fn relaxed_reference(scene: &Scene) -> Result<TileReference, SceneFitError> {
    let (network, card) = repeat_of(scene)?;
    let settings = TileSettings::of(card);
    let rest = relax_from_starts(&network, &scene.yarns, card, &settings, STARTS_AT_REST).swap_remove(0);
    Ok(TileReference::new(&network, &scene.yarns, card, &settings, rest)?)
}

/// The smallest repeat of a scene's chart as a tile, and the card.
fn repeat_of(scene: &Scene) -> Result<(Network, &KnitCard), SceneFitError> {
    let (Some(chart), Some(card)) = (scene.structure.chart(), scene.fabric.knit()) else {
        return Err(SceneFitError::NoChart);
    };
    let repeat = chart.smallest_repeat();
    let loops = repeat.loop_count();
    if loops > MOST_LOOPS {
        return Err(SceneFitError::TooLarge { loops });
    }
    Ok((knit::tile(&repeat, card)?, card))
}
