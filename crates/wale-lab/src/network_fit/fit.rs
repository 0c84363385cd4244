//! Stiffnesses of yarns and contacts, looked for by least squares over measured curves.

use std::convert::Infallible;

use thiserror::Error;
use wale::dynamics::stretched_tile::StretchError;
use wale::dynamics::tile_equilibrium::{TileEquilibrium, TileSettings};
use wale::dynamics::tile_stiffness::TileStiffness;
use wale::model::{FabricCard, Network, Yarns};

use super::problem::NetworkProblem;
use super::pull::NetworkPullSettings;
use crate::least_squares::{LeastSquaresFit, LeastSquaresSettings, Residuals, fit};
use crate::yarn_fit::{Answer, Target, YarnFitError, errors};

const P: usize = TileStiffness::COUNT;

/// How stiffnesses are looked for.
#[derive(Clone, Debug, PartialEq)]
pub struct NetworkFitSettings {
    /// Most evaluations a start.
    pub max_evaluations: usize,
    /// Least and largest value of each stiffness over the given one; equal for one that is held.
    pub bounds: [[f64; 2]; P],
    /// Where searches begin, as factors of the given stiffnesses.
    pub starts: Vec<[f64; P]>,
    /// Noise of the data that intervals reckon with even where the fit is closer \[–\].
    pub least_noise: f64,
    /// How tiles are pulled.
    pub pull: NetworkPullSettings,
    /// How they are relaxed; by default as their card says.
    pub tile: Option<TileSettings>,
    /// How many starts the first relaxation has.
    pub relaxations: usize,
}

impl Default for NetworkFitSettings {
    fn default() -> Self {
        Self {
            max_evaluations: 60,
            bounds: [[1e-3, 1e3]; P],
            starts: vec![[1.0; P]],
            least_noise: 0.01,
            pull: NetworkPullSettings::default(),
            tile: None,
            relaxations: 2,
        }
    }
}

/// Why nothing was fitted.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NetworkFitError {
    /// There is nothing to fit to.
    #[error("there is no curve to fit to")]
    NoTarget,
    /// A stiffness from which the search begins is none.
    #[error("the {what} stiffness is {value}, and should be positive and finite")]
    Stiffness {
        /// Which.
        what: &'static str,
        /// What it is.
        value: f64,
    },
    /// Bounds or a start are no positive factors.
    #[error("bounds and starts of the {what} stiffness should be positive factors in their order")]
    Bounds {
        /// Which stiffness.
        what: &'static str,
    },
    /// The tile does not come to rest.
    #[error(transparent)]
    Tile(#[from] StretchError),
    /// The tile cannot be pulled as far as the curves go from any start.
    #[error("the tile could not be pulled as far as the curves go from any start")]
    NoStart,
}

/// What was fitted.
#[derive(Clone, Debug)]
pub struct NetworkFit {
    /// Yarns and card with the stiffnesses that were found.
    pub yarns: Yarns,
    /// The card.
    pub card: FabricCard,
    /// What was fitted, in the order of arrays.
    pub kinds: [TileStiffness; P],
    /// The stiffnesses in SI units, in the order of `kinds`; zero where the fabric has none.
    pub stiffness: [f64; P],
    /// Factor within which each is known with 95 % confidence; one where it is held, infinite where the curves do not say.
    pub within: [f64; P],
    /// Mean errors over the values at the end of comfort \[–\].
    pub error: YarnFitError,
    /// Those with the given stiffnesses, where the tile could be pulled with them.
    pub start_error: Option<YarnFitError>,
    /// Stiffnesses that the curves do not determine within a factor of three, by name.
    pub undetermined: Vec<&'static str>,
    /// Stiffnesses that stopped at a bound.
    pub at_bound: Vec<&'static str>,
    /// The tile at rest.
    pub rest: TileEquilibrium,
    /// What the tile does along each target's points.
    pub answers: Vec<Vec<Answer<P>>>,
    /// How it was found; its parameters are the logarithms of the factors of the given stiffnesses.
    pub least_squares: LeastSquaresFit<P>,
}

/// Fits the stiffnesses of a tile's yarns and card to uniform stretches without stress across.
///
/// Lengths and angles of the card stay as they are; the relaxed tile of a knit, from which stretch is measured, follows the stiffnesses,
/// that of a weave keeps its sett.
///
/// # Errors
/// [`NetworkFitError`].
pub fn fit_network(
    network: &Network,
    yarns: impl Into<Yarns>,
    card: impl Into<FabricCard>,
    targets: &[Target],
    settings: &NetworkFitSettings,
) -> Result<NetworkFit, NetworkFitError> {
    let (yarns, card) = (yarns.into(), card.into());
    if targets.is_empty() || targets.iter().any(|target| target.points.is_empty()) {
        return Err(NetworkFitError::NoTarget);
    }
    let given = TileStiffness::of(network, &yarns, &card);
    let kinds = TileStiffness::all(&card);
    for (k, (&value, kind)) in given.iter().zip(kinds).enumerate() {
        let what = kind.name();
        if !(!kind.is_there(network, &card) || value > 0.0 && value.is_finite()) {
            return Err(NetworkFitError::Stiffness { what, value });
        }
        let ([low, high], starts) = (settings.bounds[k], settings.starts.iter().map(|start| start[k]));
        let positive = |x: f64| x > 0.0 && x.is_finite();
        if !positive(low) || !positive(high) || low > high || !starts.into_iter().all(positive) {
            return Err(NetworkFitError::Bounds { what });
        }
    }
    let tile = settings.tile.unwrap_or_else(|| TileSettings { strand_contact: false, ..TileSettings::of(&card) });
    let problem =
        NetworkProblem::new(network, yarns, card, targets.to_vec(), tile, settings.pull, settings.relaxations)?;
    let at = |logarithms: &[f64; P]| -> [f64; P] { std::array::from_fn(|k| given[k] * logarithms[k].exp()) };
    let evaluate = |logarithms: &[f64; P], _| -> Result<Option<Residuals<P>>, Infallible> {
        let stiffness = at(logarithms);
        Ok(problem.evaluate(stiffness, true).map(|found| problem.residuals(stiffness, &found)))
    };
    // A stiffness of zero has no logarithm that would change it.
    let bounds: [[f64; 2]; P] =
        std::array::from_fn(|k| if given[k] > 0.0 { settings.bounds[k].map(f64::ln) } else { [0.0; 2] });
    let least = LeastSquaresSettings::to_the_end(settings.max_evaluations, bounds, settings.least_noise);
    let starts: Vec<[f64; P]> = settings.starts.iter().map(|start| start.map(f64::ln)).collect();
    let found = match fit(evaluate, &starts, &least) {
        Ok(found) => found.ok_or(NetworkFitError::NoStart)?,
        Err(never) => match never {},
    };
    let stiffness = at(&found.parameters);
    let best = problem.evaluate(stiffness, false).ok_or(NetworkFitError::NoStart)?;
    let names = |indices: Vec<usize>| indices.into_iter().map(|k| kinds[k].name()).collect::<Vec<_>>();
    let at_bound = (0..P).filter(|&k| {
        bounds[k][0] < bounds[k][1] && bounds[k].iter().any(|bound| (found.parameters[k] - bound).abs() < 1e-6)
    });
    let (yarns, card) = problem.with(stiffness);
    Ok(NetworkFit {
        yarns,
        card,
        kinds,
        stiffness,
        within: found.uncertainty,
        error: errors(targets, &best.answers),
        start_error: problem.evaluate(given, false).map(|start| errors(targets, &start.answers)),
        undetermined: names(found.undetermined()),
        at_bound: names(at_bound.collect()),
        rest: best.rest,
        answers: best.answers,
        least_squares: found,
    })
}
