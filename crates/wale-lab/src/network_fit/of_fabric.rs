//! The contact model of a fabric file whose structure is a chart: a scene of it with the stiffnesses that its tests tell.

use thiserror::Error;
use wale::model::FabricCard;
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
    let (Some(chart), Some(card)) = (scene.structure.chart(), scene.fabric.knit()) else {
        return Err(SceneFitError::NoChart);
    };
    let repeat = chart.smallest_repeat();
    let loops = repeat.loop_count();
    if loops > MOST_LOOPS {
        return Err(SceneFitError::TooLarge { loops });
    }
    let network = knit::tile(&repeat, card)?;
    let settings = NetworkFitSettings { starts: STARTS.to_vec(), ..NetworkFitSettings::default() };
    let found = fit_network(&network, &scene.yarns, card, targets, &settings)?;
    let fitted = Scene { yarns: found.yarns.clone(), fabric: FabricCard::from(&found.card), ..scene.clone() };
    Ok((fitted, found))
}
