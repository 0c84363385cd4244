//! The default way to fit: many places looked at, and from the best of them least squares with exact derivatives.

use rayon::prelude::*;

use super::problem::{Answers, P, Question, YarnProblem, ask_all, best_scale};
use super::progress::Progress;
use super::sequence::halton;
use super::space::RodSpace;
use crate::least_squares::{LeastSquaresFit, LeastSquaresSettings, Residuals, fit};
use crate::yarn_tile::RodParameter;

/// Least squares from the best places that are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Round {
    /// How many of them.
    pub starts: usize,
    /// Steps from each, those that were not taken too.
    pub evaluations: usize,
    /// Points along each curve.
    pub samples: usize,
}

/// How a fit by gradients is done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GradientSettings {
    /// Places that are looked at before any is improved.
    pub screened: usize,
    /// Points along each curve then.
    pub screening_samples: usize,
    /// Rounds of improving, each from the best of the one before: many for a few steps, then few for many. One of no start is left out.
    pub rounds: [Round; 3],
    /// Noise of the data that intervals reckon with even where the fit is closer \[–\].
    pub least_noise: f64,
}

impl Default for GradientSettings {
    fn default() -> Self {
        let round = |starts, evaluations, samples| Round { starts, evaluations, samples };
        Self {
            screened: 48,
            screening_samples: 3,
            rounds: [round(8, 6, 4), round(3, 10, 4), round(1, 30, 8)],
            least_noise: 0.01,
        }
    }
}

impl GradientSettings {
    /// A first look, in a tenth of the time.
    #[must_use]
    pub fn quick() -> Self {
        let round = |starts, evaluations, samples| Round { starts, evaluations, samples };
        Self { screened: 8, rounds: [round(1, 3, 4), round(1, 4, 5), round(0, 0, 0)], ..Self::default() }
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

/// Parts of an onset that no yarn reaches, of which the best is gone on with.
const EARLIER: [f64; 6] = [0.9, 0.8, 0.65, 0.5, 0.3, 0.1];
/// Relative gain of a step below which least squares ends, and the sum of squares below which nobody could measure a difference.
const LEAST_GAIN: f64 = 1e-3;
const ENOUGH: f64 = 1e-8;
/// Change of a coordinate by which the rest shapes' part of a derivative is found.
const DIFFERENCE: f64 = 1e-2;
/// Places that are nearer than this in every coordinate are one.
const SAME: f64 = 0.02;

/// Fits fabrics of one yarn by gradients. `None` if they could not all be tested anywhere.
///
/// Differs from the paper: there a swarm looks for the valley and COBYLA, which knows no derivatives, goes down it. Valleys are many here,
/// and how deep one is shows only a few steps down, so that many are followed for a few steps and few for many. Rest shapes are found
/// anew for every place, as in the paper; with them held, derivatives are exact, and what a number does by way of the rest shapes is
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
    let look = |coordinates: &[f64; P]| {
        let question = Question::of(RodSpace::parameters(*coordinates), settings.screening_samples, false);
        let found = scaled(problems, answers, coordinates, &question)?;
        progress.tell(found.as_ref().map(|found| found.cost), &question.at);
        Ok(found)
    };
    let places: Vec<[f64; P]> = (0..settings.screened).map(|k| problems[0].space.at_parts(halton(k))).collect();
    let looked: Vec<Result<Option<Found>, A::Unanswered>> = places.par_iter().map(look).collect();
    let mut known: Vec<Found> = looked.into_iter().collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect();
    best_first(&mut known);
    for round in settings.rounds.iter().filter(|round| round.starts > 0) {
        let from: Vec<[f64; P]> = known.iter().take(round.starts).map(|found| found.coordinates).collect();
        let improved: Vec<Result<Option<Found>, A::Unanswered>> = from
            .par_iter()
            .map(|&from| improve(problems, answers, from, round, settings.least_noise, progress))
            .collect();
        let mut improved: Vec<Found> =
            improved.into_iter().collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect();
        // What was found with fewer points along the curves is no longer known where more are wanted.
        if !improved.is_empty() {
            best_first(&mut improved);
            known = improved;
        }
    }
    Ok(known.into_iter().next())
}

/// Puts the least cost first, the earlier where two are equal, and leaves out what is the same place as a better one.
fn best_first(known: &mut Vec<Found>) {
    known.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let mut kept: Vec<Found> = Vec::with_capacity(known.len());
    for found in known.drain(..) {
        let near = |other: &Found| other.coordinates.iter().zip(&found.coordinates).all(|(a, b)| (a - b).abs() < SAME);
        if !kept.iter().any(near) {
            kept.push(found);
        }
    }
    *known = kept;
}

/// Least squares from one place, and once more from an earlier onset if no yarn came to the one that it ends with: what is felt by
/// nothing has no derivative that would lead back.
///
/// # Errors
/// As [`fit_by_gradients`].
pub fn improve<A: Answers>(
    problems: &[YarnProblem],
    answers: &A,
    from: [f64; P],
    round: &Round,
    least_noise: f64,
    progress: &Progress<'_>,
) -> Result<Option<Found>, A::Unanswered> {
    let search = Search { problems, answers, round, least_noise, progress };
    let Some(first) = search.descend(from)? else { return Ok(None) };
    let Some(from) = search.earlier_onset(&first)? else { return Ok(Some(first)) };
    let second = search.descend(from)?;
    Ok(Some(second.filter(|second| second.cost < first.cost).unwrap_or(first)))
}

/// Least squares of some fabrics.
struct Search<'a, A> {
    problems: &'a [YarnProblem],
    answers: &'a A,
    round: &'a Round,
    least_noise: f64,
    progress: &'a Progress<'a>,
}

impl<A: Answers> Search<'_, A> {
    /// From one place down.
    fn descend(&self, from: [f64; P]) -> Result<Option<Found>, A::Unanswered> {
        let Self { problems, answers, round, least_noise, progress } = *self;
        let evaluate = |coordinates: &[f64; P], slopes: bool| {
            let at = RodSpace::parameters(*coordinates);
            let question = Question::of(at, round.samples, slopes);
            let residuals = ask_all(problems, answers, &question)?;
            progress.tell(residuals.as_ref().map(Residuals::cost), &at);
            let Some(mut residuals) = residuals else { return Ok(None) };
            if slopes && problems[0].rest_shapes {
                add_slopes_of_rest(problems, answers, coordinates, &question, &mut residuals)?;
            }
            Ok(Some(residuals))
        };
        let bounds = problems[0].space.coordinate_bounds();
        let search = LeastSquaresSettings {
            least_gain: LEAST_GAIN,
            enough: ENOUGH,
            ..LeastSquaresSettings::to_the_end(round.evaluations, bounds, least_noise)
        };
        let found = fit(evaluate, &[from], &search)?;
        Ok(found.map(|found| Found { coordinates: found.parameters, cost: found.cost, least_squares: Some(found) }))
    }

    /// The best place with an earlier onset, and stiffnesses that make up for it, if no yarn reaches the onset of a place that was found.
    fn earlier_onset(&self, found: &Found) -> Result<Option<[f64; P]>, A::Unanswered> {
        let onset = RodParameter::Onset as usize;
        let space = &self.problems[0].space;
        let [low, high] = space.coordinate_bounds()[onset];
        let felt =
            found.least_squares.as_ref().is_some_and(|least_squares| least_squares.uncertainty[onset].is_finite());
        if felt || low >= high || found.cost < ENOUGH {
            return Ok(None);
        }
        let rest = RodSpace::parameters(found.coordinates);
        let look = |part: &f64| {
            let mut place = found.coordinates;
            place[onset] = low + part * (place[onset] - low);
            // Yarns at rest are stretched by too little for an onset to matter.
            let question = Question { rest, ..Question::of(RodSpace::parameters(place), self.round.samples, false) };
            self.progress.tell(None, &question.at);
            scaled(self.problems, self.answers, &place, &question)
        };
        let looked: Vec<Result<Option<Found>, A::Unanswered>> = EARLIER.par_iter().map(look).collect();
        let looked = looked.into_iter().collect::<Result<Vec<_>, _>>()?.into_iter().flatten();
        Ok(looked.min_by(|a, b| a.cost.total_cmp(&b.cost)).map(|best| best.coordinates))
    }
}

/// A place with the stiffnesses that suit it best, as far as one factor for all can tell.
fn scaled<A: Answers>(
    problems: &[YarnProblem],
    answers: &A,
    place: &[f64; P],
    question: &Question,
) -> Result<Option<Found>, A::Unanswered> {
    let scaled = |(scale, cost)| {
        let coordinates = problems[0].space.scaled(place, scale);
        Found { coordinates, cost, least_squares: None }
    };
    Ok(best_scale(problems, answers, question)?.map(scaled))
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
