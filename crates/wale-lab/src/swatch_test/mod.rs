//! Textile tests on swatches of all their yarns, in the contact model and with friction: what a scene does, done as instruments do it.
//!
//! Nothing here moves a yarn; [`wale::simulation`] does. Swatches have some hundred loops: where a specimen would have more, a smaller one
//! of the same shape is tested, and says so. Definitions and sources: `docs/topics/virtual-tests.md`.

pub mod clamped;
pub mod curl;
pub mod relaxation;

use glam::DVec3;
use thiserror::Error;
use wale::model::KnitCard;
use wale::pattern::{ChartError, Structure};
use wale::scene::Scene;
use wale::simulation::{Simulation, SimulationError, Start};

pub use clamped::{ClampedResult, ClampedSwatch};
pub use curl::{CurlResult, EdgeCurl, curl};
pub use relaxation::{Shrinkage, shrinkage_of_swatch, shrinkage_of_tile};

/// Most loops of a swatch: as many take minutes.
pub const MOST_LOOPS: usize = 2000;

/// Why a swatch was not tested.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SwatchTestError {
    /// A number of the test is not what it can be.
    #[error("{what} is {value}, and must be {must}")]
    Number {
        /// Which number.
        what: &'static str,
        /// What it is.
        value: f64,
        /// What it must be.
        must: &'static str,
    },
    /// There is no chart.
    #[error(
        "swatches are knitted from the chart of a scene, and there is none; test a weave as a shell, a tile or by its contacts"
    )]
    NoChart,
    /// A weave whose shrinkage was asked for.
    #[error("a weave is at rest at the sett that its scene gives it: nothing in its repeat shrinks")]
    Sett,
    /// The chart cannot be repeated to the size.
    #[error(transparent)]
    Chart(#[from] ChartError),
    /// Too many loops.
    #[error("a swatch of {loops} loops is too large, at most {MOST_LOOPS} are tested; ask for fewer columns or rows")]
    TooLarge {
        /// How many.
        loops: usize,
    },
    /// The swatch, or the repeat that it is laid out from, did not come to rest.
    #[error("the {what} did not come to rest: {why}")]
    NotAtRest {
        /// Which.
        what: &'static str,
        /// How fast it still was, or how much force was left.
        why: String,
    },
    /// The time loop stopped.
    #[error("the swatch was pulled to a stretch of {stretch:.3}, then: {cause}")]
    Stopped {
        /// How far it had come \[–\].
        stretch: f64,
        /// Why.
        cause: SimulationError,
    },
    /// A load that is never reached.
    #[error("the swatch does not bear {load:.4} N/m: at a stretch of {stretch:.2} it bears {force:.4} N/m")]
    Load {
        /// The load by width \[N/m\].
        load: f64,
        /// Largest stretch \[–\].
        stretch: f64,
        /// Force by width there \[N/m\].
        force: f64,
    },
}

/// A swatch of so many columns and rows of a scene's pattern, in nothing but air: neither weight, nor obstacles, nor grips.
///
/// # Errors
/// [`SwatchTestError`].
fn swatch(scene: &Scene, columns: usize, rows: usize) -> Result<Scene, SwatchTestError> {
    let chart = scene.structure.chart().ok_or(SwatchTestError::NoChart)?;
    let loops = columns.saturating_mul(rows);
    if loops > MOST_LOOPS {
        return Err(SwatchTestError::TooLarge { loops });
    }
    let chart = chart.smallest_repeat().repeat(columns, rows)?;
    let mut swatch = Scene { structure: Structure::flat(chart), ..scene.clone() };
    swatch.plan.simulation.gravity = DVec3::ZERO;
    swatch.plan.obstacles.clear();
    swatch.plan.grips.clear();
    Ok(swatch)
}

fn card(scene: &Scene) -> Result<&KnitCard, SwatchTestError> {
    scene.fabric.knit().ok_or(SwatchTestError::NoChart)
}

/// What a swatch starts from; with `relaxed`, every loop has the shape that it has in the relaxed repeat.
fn start(scene: &Scene, relaxed: bool) -> Start {
    Start::new(&scene.structure, &scene.yarns, &scene.fabric, relaxed)
}

/// Sets up its simulation.
fn simulation(scene: &Scene, start: Start) -> Simulation {
    Simulation::new(start.network, &scene.yarns, &scene.fabric, scene.plan.clone())
}

/// Distance of wales and of courses in the relaxed repeat of a scene \[m\].
///
/// # Errors
/// [`SwatchTestError::NotAtRest`].
fn relaxed_spacing(scene: &Scene) -> Result<[f64; 2], SwatchTestError> {
    let card = card(scene)?;
    let Some(report) = start(scene, true).compensation else {
        let why = "it has too many loops, or does not repeat".to_owned();
        return Err(SwatchTestError::NotAtRest { what: "repeat", why });
    };
    if !report.converged {
        let why = "forces are left; `wale relax` says how many".to_owned();
        return Err(SwatchTestError::NotAtRest { what: "repeat", why });
    }
    Ok([card.wale_spacing * report.width_change, card.course_spacing * report.height_change])
}
