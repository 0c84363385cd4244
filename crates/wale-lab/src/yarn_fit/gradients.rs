//! The default way to fit: many places looked at, and from the best of them least squares with exact derivatives.

use rayon::prelude::*;

use super::problem::{Answers, P, Question, YarnProblem, ask_all};
use super::progress::Progress;
use super::sequence::halton;
use super::space::RodSpace;
use crate::least_squares::{LeastSquaresFit, LeastSquaresSettings, Residuals, fit};
use crate::yarn_tile::RodParameter;

/// How a fit by gradients is done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GradientSettings {
    /// Places that are looked at before any is improved.
    pub screened: usize,
    /// Points along each curve then.
    pub screening_samples: usize,
    /// How many of the best are improved.
    pub starts: usize,
    /// Steps of least squares from each, those that were not taken too.
    pub evaluations: usize,
    /// Steps more from where the best of them has come to.
    pub polish: usize,
    /// Points along each curve then.
    pub samples: usize,
    /// Noise of the data that intervals reckon with even where the fit is closer \[–\].
    pub least_noise: f64,
}

impl Default for GradientSettings {
    fn default() -> Self {
        Self {
            screened: 32,
            screening_samples: 3,
            starts: 3,
            evaluations: 14,
            polish: 24,
            samples: 8,
            least_noise: 0.01,
        }
    }
}

impl GradientSettings {
    /// A first look, in a tenth of the time.
    #[must_use]
    pub fn quick() -> Self {
        Self { screened: 8, starts: 1, evaluations: 5, polish: 3, samples: 5, ..Self::default() }
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

/// Parts of the onset from which the best place is improved once more.
const EARLIER: [f64; 3] = [1.0, 0.4, 0.1];
/// Change of a coordinate by which the rest shapes' part of a derivative is found.
const DIFFERENCE: f64 = 1e-2;

/// Fits fabrics of one yarn by gradients. `None` if they could not all be tested anywhere.
///
/// Differs from the paper: there a swarm looks for the valley and COBYLA, which knows no derivatives, goes down it. Rest shapes are
/// found anew for every place, as there; with them held, derivatives are exact, and what a number does by way of the rest shapes is
/// found by differences. Test: `tests/yarn_fits.rs`.
///
/// # Errors
/// If a question is not answered now.
pub fn fit_by_gradients<A: Answers>(
    problems: &[YarnProblem],
    answers: &A,
    settings: &GradientSettings,
    progress: &Progress<'_>,
) -> Result<Option<Found>, A::Unanswered> {
    let cost = |coordinates: &[f64; P]| -> Result<Option<f64>, A::Unanswered> {
        let question = Question::of(RodSpace::parameters(*coordinates), settings.screening_samples, false);
        let cost = ask_all(problems, answers, &question)?.map(|residuals| residuals.cost());
        progress.tell(cost, &question.at);
        Ok(cost.filter(|cost| cost.is_finite()))
    };
    let places: Vec<[f64; P]> = (0..settings.screened).map(|k| problems[0].space.at_parts(halton(k))).collect();
    let looked: Vec<Result<Option<f64>, A::Unanswered>> = places.par_iter().map(cost).collect();
    let looked: Vec<Option<f64>> = looked.into_iter().collect::<Result<_, _>>()?;
    let mut order: Vec<(f64, usize)> = looked.iter().enumerate().filter_map(|(k, c)| Some(((*c)?, k))).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let improved: Vec<Result<Option<Found>, A::Unanswered>> = order
        .par_iter()
        .take(settings.starts)
        .map(|&(_, k)| improve(problems, answers, places[k], settings, progress))
        .collect();
    let improved: Vec<Option<Found>> = improved.into_iter().collect::<Result<_, _>>()?;
    let best = improved.into_iter().flatten().reduce(|best, next| if next.cost < best.cost { next } else { best });
    let Some(best) = best else { return Ok(None) };
    let polish = GradientSettings { evaluations: settings.polish, ..*settings };
    // An onset beyond what the yarns are stretched by is felt by nothing, and least squares does not come back from there.
    let onset = RodParameter::Onset as usize;
    let [low, high] = problems[0].space.coordinate_bounds()[onset];
    let earlier = |part: f64| {
        let mut from = best.coordinates;
        from[onset] = low + part * (from[onset] - low);
        from
    };
    let parts: &[f64] = if low < high { &EARLIER } else { &EARLIER[..1] };
    let polished: Vec<Result<Option<Found>, A::Unanswered>> =
        parts.par_iter().map(|&part| improve(problems, answers, earlier(part), &polish, progress)).collect();
    let polished: Vec<Option<Found>> = polished.into_iter().collect::<Result<_, _>>()?;
    let all = polished.into_iter().flatten();
    Ok(Some(all.fold(best, |best, next| if next.cost < best.cost { next } else { best })))
}

/// Least squares from one place.
///
/// # Errors
/// As [`fit_by_gradients`].
pub fn improve<A: Answers>(
    problems: &[YarnProblem],
    answers: &A,
    from: [f64; P],
    settings: &GradientSettings,
    progress: &Progress<'_>,
) -> Result<Option<Found>, A::Unanswered> {
    let evaluate = |coordinates: &[f64; P], slopes: bool| {
        let at = RodSpace::parameters(*coordinates);
        let question = Question::of(at, settings.samples, slopes);
        let residuals = ask_all(problems, answers, &question)?;
        progress.tell(residuals.as_ref().map(Residuals::cost), &at);
        let Some(mut residuals) = residuals else { return Ok(None) };
        if slopes && problems[0].rest_shapes {
            add_slopes_of_rest(problems, answers, coordinates, &question, &mut residuals)?;
        }
        Ok(Some(residuals))
    };
    let bounds = problems[0].space.coordinate_bounds();
    let (max_evaluations, least_noise) = (settings.evaluations, settings.least_noise);
    let search = LeastSquaresSettings { max_evaluations, bounds, least_noise };
    let found = fit(evaluate, &[from], &search)?;
    Ok(found.map(|found| Found { coordinates: found.parameters, cost: found.cost, least_squares: Some(found) }))
}

/// Adds what each number does to the residuals by way of the rest shapes: they are found with a number that differs a little, and
/// pulled with the one that does not.
fn add_slopes_of_rest<A: Answers>(
    problems: &[YarnProblem],
    answers: &A,
    coordinates: &[f64; P],
    question: &Question,
    residuals: &mut Residuals<P>,
) -> Result<(), A::Unanswered> {
    let bounds = problems[0].space.coordinate_bounds();
    // Yarns at rest are stretched by too little for an onset to matter.
    let free = (0..P).filter(|&k| bounds[k][0] < bounds[k][1] && k != RodParameter::Onset as usize);
    let moved: Vec<(usize, f64, Question)> = free
        .map(|k| {
            let step = if coordinates[k] + DIFFERENCE > bounds[k][1] { -DIFFERENCE } else { DIFFERENCE };
            let mut near = *coordinates;
            near[k] += step;
            (k, step, Question { rest: RodSpace::parameters(near), slopes: false, ..*question })
        })
        .collect();
    let found: Vec<Result<Option<Residuals<P>>, A::Unanswered>> =
        moved.par_iter().map(|(_, _, asked)| ask_all(problems, answers, asked)).collect();
    for ((k, step, _), found) in moved.iter().zip(found) {
        // Where the tile cannot be tested with those, they are taken not to matter.
        let Some(found) = found? else { continue };
        for (row, (near, here)) in residuals.slopes.iter_mut().zip(found.values.iter().zip(&residuals.values)) {
            row[*k] += (near - here) / step;
        }
    }
    Ok(())
}
