//! A yarn fitted from the beginning to the end, by whichever way.

use rayon::prelude::*;

use super::gradients::{Found, GradientSettings, Round, fit_by_gradients, improve};
use super::journal::Stopped;
use super::objective::{BendingTarget, YarnFitError, errors};
use super::problem::{Answers, Evaluation, P, Question, YarnProblem};
use super::progress::Progress;
use super::space::RodSpace;
use super::swarm::{FAILED, SwarmSettings, fit_by_swarm, fit_locally};
use super::target::Target;
use crate::yarn_tile::{RodMaterial, RodParameter};

/// A way to fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Way {
    /// Least squares with exact derivatives from several places.
    Gradients(GradientSettings),
    /// A swarm, then COBYLA [Sperl2022, section 7.3.3].
    Swarm(SwarmSettings),
    /// COBYLA alone, from the middle of the bounds [Sperl2022, Fig. 11].
    Local(SwarmSettings),
}

/// Part of the width of its bounds within which a coordinate is at one.
const AT_BOUND: f64 = 1e-3;

/// A yarn that was fitted.
#[derive(Clone, Debug)]
pub struct YarnFit {
    /// What the yarn is made of.
    pub material: RodMaterial,
    /// Sum of squares [Sperl2022, Eq. 11].
    pub cost: f64,
    /// Errors as the paper gives them.
    pub error: YarnFitError,
    /// What was to be met, and what the fitted yarn does there.
    pub targets: Vec<Target>,
    /// Bending stiffnesses that were to be met, too; empty if they were not fitted.
    pub bending: Vec<BendingTarget>,
    /// Its answers.
    pub evaluation: Evaluation,
    /// Factor within which each number is known with 95 % confidence, infinite where the data do not say, one where it was held. Of
    /// the onset, `e^{δ/0.05}` of an interval `δ`.
    pub within: [f64; P],
    /// Evaluations that were made.
    pub evaluations: usize,
    /// What stays open, in words.
    pub open: Vec<String>,
}

/// Fits the yarn of a fabric. `None` if its tile could not be tested anywhere within the bounds.
///
/// # Errors
/// If a question is not answered now.
pub fn fit_yarn<A: Answers>(
    problem: &YarnProblem,
    answers: &A,
    way: &Way,
    progress: &Progress<'_>,
) -> Result<Option<YarnFit>, A::Unanswered> {
    let found = fit_together(std::slice::from_ref(problem), answers, way, progress)?;
    Ok(found.and_then(|fits| fits.into_iter().next()))
}

/// Fits one yarn to all fabrics that are made of it: a fit for each, of the same material. `None` if there is no fabric, or if they
/// could not all be tested anywhere. The bounds are those of the first; [`super::of_fabric::problems`] gives all the same.
///
/// # Errors
/// If a question is not answered now.
pub fn fit_together<A: Answers>(
    problems: &[YarnProblem],
    answers: &A,
    way: &Way,
    progress: &Progress<'_>,
) -> Result<Option<Vec<YarnFit>>, A::Unanswered> {
    if problems.is_empty() {
        return Ok(None);
    }
    let found = match way {
        Way::Gradients(settings) => fit_by_gradients(problems, answers, settings, progress)?,
        Way::Swarm(settings) => fit_by_swarm(problems, answers, settings, progress)?,
        Way::Local(settings) => Some(fit_locally(problems, answers, [0.5; P], settings, progress)?),
    };
    let Some(found) = found.filter(|found| found.cost < FAILED) else { return Ok(None) };
    judge(problems, answers, found, progress)
}

/// Looks at what was found once more: its curves, how well each number is known, and what is at a bound.
fn judge<A: Answers>(
    problems: &[YarnProblem],
    answers: &A,
    found: Found,
    progress: &Progress<'_>,
) -> Result<Option<Vec<YarnFit>>, A::Unanswered> {
    // At its own points: what lies between them was not measured.
    let points = problems.iter().flat_map(|problem| &problem.targets).map(|target| target.points.len());
    let samples = points.max().unwrap_or(1);
    let looked = Round { starts: 1, evaluations: 1, samples };
    let least_noise = GradientSettings::default().least_noise;
    let at = found.coordinates;
    let within = match found.least_squares {
        Some(least_squares) => Some(least_squares.uncertainty),
        None => {
            let once = improve(problems, answers, at, &looked, least_noise, progress)?;
            once.and_then(|found| found.least_squares).map(|least_squares| least_squares.uncertainty)
        }
    };
    let within = within.unwrap_or([f64::INFINITY; P]);
    let parameters = RodSpace::parameters(at);
    let one = |(fabric, problem): (usize, &YarnProblem)| {
        let question = Question { fabric, ..Question::of(parameters, samples, false) };
        let Some(evaluation) = answers.answer(&question)? else { return Ok(None) };
        let targets: Vec<Target> = problem.targets.iter().map(|target| target.resampled(samples)).collect();
        Ok(Some(YarnFit {
            material: problem.base.with_parameters(parameters),
            cost: found.cost,
            error: errors(&targets, &evaluation.stretch),
            targets,
            bending: problem.bending.clone(),
            evaluation,
            within,
            evaluations: progress.now().evaluations,
            open: open(problem, &at, &within),
        }))
    };
    let fits: Vec<Result<Option<YarnFit>, A::Unanswered>> = problems.par_iter().enumerate().map(one).collect();
    fits.into_iter().collect()
}

/// What a fit leaves open, in words.
fn open(problem: &YarnProblem, at: &[f64; P], within: &[f64; P]) -> Vec<String> {
    let mut open = Vec::new();
    for (k, [low, high]) in problem.space.coordinate_bounds().into_iter().enumerate() {
        let (name, width) = (RodParameter::NAMES[k], high - low);
        if width > 0.0 && at[k] <= low + AT_BOUND * width {
            open.push(format!("{name} is at its lower bound"));
        } else if width > 0.0 && at[k] >= high - AT_BOUND * width {
            open.push(format!("{name} is at its upper bound"));
        } else if within[k] > 3.0 {
            open.push(format!("{name} is not determined by these tests"));
        }
    }
    open
}

/// Answers until somebody wants to stop.
pub struct Interruptible<'a, A> {
    /// Who answers.
    pub by: A,
    /// Whether enough was answered.
    pub stop: &'a (dyn Fn() -> bool + Sync),
}

impl<A: Answers> Answers for Interruptible<'_, A>
where
    A::Unanswered: Into<Stopped>,
{
    type Unanswered = Stopped;

    fn answer(&self, question: &Question) -> Result<Option<Evaluation>, Stopped> {
        if (self.stop)() {
            return Err(Stopped::Interrupted);
        }
        self.by.answer(question).map_err(Into::into)
    }
}
