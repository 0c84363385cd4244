//! The contact model of a fabric file whose structure is a chart or a draft: a scene of it with the stiffnesses that its tests tell.

use thiserror::Error;
use wale::dynamics::stretched_tile::{StretchError, TileReference};
use wale::dynamics::tile_equilibrium::{TileSettings, relax_from_starts};
use wale::model::Network;
use wale::pattern::weave::{self, DraftError};
use wale::pattern::{ChartError, knit};
use wale::scene::Scene;

use super::fit::{NetworkFit, NetworkFitError, NetworkFitSettings, fit_network};
use crate::yarn_fit::Target;

/// Why there is no such scene.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SceneFitError {
    /// The scene has neither a chart nor a draft.
    #[error("only charts and drafts are tiles of the contact model")]
    NoRepeat,
    /// The chart does not repeat.
    #[error(transparent)]
    Chart(#[from] ChartError),
    /// The draft cannot be repeated.
    #[error(transparent)]
    Draft(#[from] DraftError),
    /// The repeat is too large to be pulled many times.
    #[error("the repeat has {size} {what}, and at most {most} are fitted")]
    TooLarge {
        /// Loops or crossings.
        what: &'static str,
        /// How many it has.
        size: usize,
        /// How many it may have.
        most: usize,
    },
    /// Nothing was fitted.
    #[error(transparent)]
    Fit(#[from] NetworkFitError),
    /// The repeat does not come to rest.
    #[error(transparent)]
    Pull(#[from] StretchError),
}

/// Most loops of a repeat, and most crossings: those of a weave are soon at rest.
const MOST_LOOPS: usize = 16;
const MOST_CROSSINGS: usize = 400;
/// Factors of a knit's stiffnesses from which the search begins: none, and bending, spacing and legs much stiffer, as thick soft yarns
/// are that were given the numbers of firm ones.
const STARTS: [[f64; 6]; 3] = [[1.0; 6], [1.0, 8.0, 1.0, 1.0, 30.0, 10.0], [1.0, 1.0, 1.0, 1.0, 30.0, 1.0]];

/// Fits the stiffnesses of a scene's yarns and contacts, and gives the scene with them.
///
/// # Errors
/// [`SceneFitError`].
pub fn fit_scene(scene: &Scene, targets: &[Target]) -> Result<(Scene, NetworkFit), SceneFitError> {
    let network = repeat_of(scene)?;
    let starts = if scene.fabric.knit().is_some() { &STARTS[..] } else { &STARTS[..1] };
    let settings = NetworkFitSettings { starts: starts.to_vec(), ..NetworkFitSettings::default() };
    let found = fit_network(&network, &scene.yarns, &scene.fabric, targets, &settings)?;
    let fitted = Scene { yarns: found.yarns.clone(), fabric: found.card.clone(), ..scene.clone() };
    Ok((fitted, found))
}

/// Starts from which a repeat is relaxed, and the one of least energy taken.
const STARTS_AT_REST: usize = 3;

/// The repeat of a scene's chart or draft with its own stiffnesses, relaxed: what is pulled by [`super::NetworkPull`].
///
/// # Errors
/// [`SceneFitError`]; [`SceneFitError::Pull`] if it does not come to rest.
pub fn relaxed_reference(scene: &Scene) -> Result<TileReference, SceneFitError> {
    let (network, card) = (repeat_of(scene)?, &scene.fabric);
    let settings = TileSettings { strand_contact: false, ..TileSettings::of(card) };
    let rest = relax_from_starts(&network, &scene.yarns, card, &settings, STARTS_AT_REST).swap_remove(0);
    Ok(TileReference::new(&network, &scene.yarns, card, &settings, rest)?)
}

/// The smallest repeat of a scene's chart or draft as a tile.
fn repeat_of(scene: &Scene) -> Result<Network, SceneFitError> {
    let fits = |what, size, most| if size > most { Err(SceneFitError::TooLarge { what, size, most }) } else { Ok(()) };
    if let (Some(chart), Some(card)) = (scene.structure.chart(), scene.fabric.knit()) {
        let repeat = chart.smallest_repeat();
        fits("loops", repeat.loop_count(), MOST_LOOPS)?;
        return Ok(knit::tile(&repeat, card)?);
    }
    let (Some(woven), Some(card)) = (scene.structure.woven(), scene.fabric.woven()) else {
        return Err(SceneFitError::NoRepeat);
    };
    let repeat = woven.draft.smallest_repeat();
    fits("crossings", repeat.ends() * repeat.picks(), MOST_CROSSINGS)?;
    Ok(weave::tile(&repeat, card.spacing)?)
}
