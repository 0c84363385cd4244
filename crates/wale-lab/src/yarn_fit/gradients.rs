//! The default way to fit: many places looked at, and from the best of them least squares with exact derivatives.

use rayon::prelude::*;

use super::problem::{Answers, P, Question, YarnProblem};
use super::progress::Progress;
use super::sequence::halton;
use super::space::RodSpace;
use crate::least_squares::{LeastSquaresFit, LeastSquaresSettings, fit};

/// How a fit by gradients is done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GradientSettings {
    /// Places that are looked at before any is improved.
    pub screened: usize,
    /// Points along each curve then.
    pub screening_samples: usize,
    /// How many of the best are improved.
    pub starts: usize,
    /// Turns of rest shapes and of least squares.
    pub rounds: usize,
    /// Evaluations of least squares in each.
    pub evaluations: usize,
    /// Points along each curve then.
    pub samples: usize,
    /// Noise of the data that intervals reckon with even where the fit is closer \[–\].
    pub least_noise: f64,
}

impl Default for GradientSettings {
    fn default() -> Self {
        Self { screened: 32, screening_samples: 3, starts: 3, rounds: 8, evaluations: 6, samples: 8, least_noise: 0.01 }
    }
}

impl GradientSettings {
    /// A first look, in a tenth of the time.
    #[must_use]
    pub fn quick() -> Self {
        Self { screened: 8, starts: 1, rounds: 3, evaluations: 4, samples: 5, ..Self::default() }
    }
}

/// Numbers that were found.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// Coordinates.
    pub coordinates: [f64; P],
    /// Sum of squares, with rest shapes of the same numbers.
    pub cost: f64,
    /// How well each is known, if it is known.
    pub least_squares: Option<LeastSquaresFit<P>>,
}

/// Gain of a round, over the cost, below which another is not worth it.
const LEAST_GAIN: f64 = 1e-3;

/// Fits by gradients. `None` if the tile could not be tested anywhere.
///
/// Differs from the paper: there a swarm looks for the valley and COBYLA, which knows no derivatives, goes down it. Rest shapes are
/// held within a round of least squares, and found anew before the next [after Sperl2022, section 7.2].
///
/// # Errors
/// If a question is not answered now.
pub fn fit_by_gradients<A: Answers>(
    problem: &YarnProblem,
    answers: &A,
    settings: &GradientSettings,
    progress: &Progress<'_>,
) -> Result<Option<Found>, A::Unanswered> {
    let cost = |coordinates: &[f64; P]| -> Result<Option<f64>, A::Unanswered> {
        let question = Question::of(RodSpace::parameters(*coordinates), settings.screening_samples, false);
        let found = answers.answer(&question)?;
        let cost = found.map(|found| problem.residuals(&question, &found).cost());
        progress.tell(cost, &question.at);
        Ok(cost.filter(|cost| cost.is_finite()))
    };
    let places: Vec<[f64; P]> = (0..settings.screened).map(|k| problem.space.at_parts(halton(k))).collect();
    let looked: Vec<Result<Option<f64>, A::Unanswered>> = places.par_iter().map(cost).collect();
    let looked: Vec<Option<f64>> = looked.into_iter().collect::<Result<_, _>>()?;
    let mut order: Vec<(f64, usize)> = looked.iter().enumerate().filter_map(|(k, c)| Some(((*c)?, k))).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let improved: Vec<Result<Option<Found>, A::Unanswered>> = order
        .par_iter()
        .take(settings.starts)
        .map(|&(_, k)| improve(problem, answers, places[k], settings, progress))
        .collect();
    let improved: Vec<Option<Found>> = improved.into_iter().collect::<Result<_, _>>()?;
    Ok(improved.into_iter().flatten().reduce(|best, next| if next.cost < best.cost { next } else { best }))
}

/// Turns of rest shapes and least squares from one place; the best of all that were tested with rest shapes of their own.
///
/// # Errors
/// As [`fit_by_gradients`].
pub fn improve<A: Answers>(
    problem: &YarnProblem,
    answers: &A,
    from: [f64; P],
    settings: &GradientSettings,
    progress: &Progress<'_>,
) -> Result<Option<Found>, A::Unanswered> {
    let mut at = from;
    let mut best: Option<Found> = None;
    for round in 0..=settings.rounds {
        // The last round only looks at where the one before has come to.
        let max_evaluations = if round == settings.rounds { 1 } else { settings.evaluations };
        let rest = RodSpace::parameters(at);
        let evaluate = |coordinates: &[f64; P]| {
            let parameters = RodSpace::parameters(*coordinates);
            let question = Question { rest, at: parameters, samples: settings.samples, slopes: true };
            let found = answers.answer(&question)?;
            let residuals = found.map(|found| problem.residuals(&question, &found));
            let own = *coordinates == at;
            progress.tell(residuals.as_ref().filter(|_| own).map(|r| r.cost()), &parameters);
            Ok(residuals)
        };
        let bounds = problem.space.coordinate_bounds();
        let search = LeastSquaresSettings { max_evaluations, bounds, least_noise: settings.least_noise };
        let found = fit(evaluate, &[at], &search)?;
        let Some(found) = found else {
            // Nothing can be tested there: half way back to what could.
            let Some(best) = &best else { return Ok(None) };
            at = std::array::from_fn(|k| 0.5 * (at[k] + best.coordinates[k]));
            continue;
        };
        let before = best.as_ref().map_or(f64::INFINITY, |best| best.cost);
        if found.start_cost < before {
            best = Some(Found { coordinates: at, cost: found.start_cost, least_squares: Some(found.clone()) });
            if before - found.start_cost < LEAST_GAIN * before {
                break;
            }
            at = found.parameters;
        } else if let Some(best) = &best {
            // Rest shapes changed more than the fit foresaw.
            at = std::array::from_fn(|k| 0.5 * (at[k] + best.coordinates[k]));
        }
    }
    Ok(best)
}
