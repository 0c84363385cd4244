//! What is to be fitted, and the question that a fit asks again and again: what does the fabric do with these numbers?

use std::collections::HashMap;
use std::sync::{Arc, Mutex};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::objective::{BendingTarget, add_bending_residuals, add_residuals};
use super::pull::{Answer, PullSettings, pull};
use super::space::RodSpace;
use super::target::Target;
use crate::least_squares::Residuals;
use crate::yarn_tile::{
    BendingAnswer, CoarseDeformation, RestShapeSettings, RodMaterial, RodParameter, YarnTile, bending_answer,
    estimate_rest_shapes,
};

/// Number of parameters.
pub const P: usize = RodParameter::COUNT;

/// A yarn to be fitted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct YarnProblem {
    /// The tile as it was registered.
    pub tile: YarnTile,
    /// What of the material is not fitted: the inner contact and how contact is read.
    pub base: RodMaterial,
    /// Which numbers are fitted, and their bounds.
    pub space: RodSpace,
    /// Uniform stretches of the fabric.
    pub targets: Vec<Target>,
    /// Bending stiffnesses of the fabric, empty if they are not fitted.
    pub bending: Vec<BendingTarget>,
    /// Whether rest shapes are estimated; if not, yarns are at rest as they were registered.
    pub rest_shapes: bool,
    /// How.
    pub rest: RestShapeSettings,
    /// How tiles are pulled.
    pub pull: PullSettings,
}

/// A question: what does a tile do with these numbers?
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Question {
    /// Which of the fabrics that are fitted together is meant.
    #[serde(default, skip_serializing_if = "is_first")]
    pub fabric: usize,
    /// Numbers with which rest shapes are found.
    pub rest: [f64; P],
    /// Numbers with which the tile is then pulled.
    pub at: [f64; P],
    /// Points along each curve.
    pub samples: usize,
    /// Whether derivatives are wanted.
    pub slopes: bool,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_first(fabric: &usize) -> bool {
    *fabric == 0
}

impl Question {
    /// Everything with the same numbers, of the first fabric.
    #[must_use]
    pub fn of(at: [f64; P], samples: usize, slopes: bool) -> Self {
        Self { fabric: 0, rest: at, at, samples, slopes }
    }

    /// Whether an answer has all that this question asks about one of the problems.
    #[must_use]
    pub fn is_answered_by(&self, answer: Option<&Evaluation>, problems: &[YarnProblem]) -> bool {
        let Some(problem) = problems.get(self.fabric) else { return false };
        answer.is_none_or(|answer| {
            answer.stretch.len() == problem.targets.len()
                && answer.stretch.iter().all(|curve| curve.len() == self.samples)
                && answer.bending.len() == problem.bending.len()
        })
    }
}

/// What the tile does.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    /// Stress and compression along each target's points.
    pub stretch: Vec<Vec<Answer<P>>>,
    /// Bending stiffnesses.
    pub bending: Vec<BendingAnswer>,
}

impl Evaluation {
    /// The same places with no stress in them.
    fn without_stress(&self) -> Self {
        let mut still = self.clone();
        still.stretch.iter_mut().flatten().for_each(|answer| answer.point.force = 0.0);
        still.bending.iter_mut().for_each(|answer| answer.stiffness = 0.0);
        still
    }
}

/// Somebody who answers questions: `None` where the tile cannot be tested.
pub trait Answers: Sync {
    /// Why a question is not answered now.
    type Unanswered: Send;
    /// Answers.
    ///
    /// # Errors
    /// If it is not answered now.
    fn answer(&self, question: &Question) -> Result<Option<Evaluation>, Self::Unanswered>;
}

impl YarnProblem {
    /// What keeps it from being fitted, if anything does: one that was read from a file may have been edited.
    #[must_use]
    pub fn fault(&self) -> Option<&'static str> {
        let rising = |target: &Target| {
            let before = std::iter::once(0.0).chain(target.stretches());
            !target.points.is_empty() && before.zip(target.stretches()).all(|(a, b)| a < b && b.is_finite())
        };
        if self.targets.is_empty() || !self.targets.iter().all(rising) {
            return Some("its targets need points of rising stretch");
        }
        let ordered = self.space.bounds.iter().all(|[low, high]| low <= high && low.is_finite() && high.is_finite());
        (!ordered).then_some("a lower bound is above its upper one")
    }

    /// The tile with the rest shapes of some numbers; `None` if there are none.
    #[must_use]
    pub fn rested(&self, parameters: &[f64; P]) -> Option<YarnTile> {
        if !self.rest_shapes {
            return Some(self.tile.at_rest_as_it_lies());
        }
        let material = self.base.with_parameters(*parameters);
        estimate_rest_shapes(&self.tile, &material, &self.rest).ok().map(|found| found.tile)
    }

    /// Answers a question with a tile whose rest shapes were found already.
    #[must_use]
    pub fn evaluate(&self, rested: &YarnTile, question: &Question) -> Option<Evaluation> {
        let material = self.base.with_parameters(question.at);
        let one = |target: &Target| {
            let stretches = target.resampled(question.samples).stretches();
            pull(rested, &material, target.angle, &stretches, question.slopes, &self.pull).ok()
        };
        let bend = |target: &BendingTarget| {
            let flat = CoarseDeformation::stretched(target.angle, 0.0, 0.0);
            bending_answer(rested, &material, self.pull.equilibrium, &flat, target.curvature).ok()
        };
        Some(Evaluation {
            stretch: self.targets.par_iter().map(one).collect::<Option<_>>()?,
            bending: self.bending.par_iter().map(bend).collect::<Option<_>>()?,
        })
    }

    /// How far an evaluation is from the targets, with derivatives by the coordinates.
    #[must_use]
    pub fn residuals(&self, question: &Question, evaluation: &Evaluation) -> Residuals<P> {
        let mut out = Residuals::default();
        let by_coordinates = |slopes| RodSpace::by_coordinates(&question.at, slopes);
        for (target, answers) in self.targets.iter().zip(&evaluation.stretch) {
            add_residuals(&target.resampled(question.samples), answers, by_coordinates, &mut out);
        }
        add_bending_residuals(&self.bending, &evaluation.bending, by_coordinates, &mut out);
        if !question.slopes {
            out.slopes.clear();
        }
        out
    }
}

/// By how much all stiffnesses together would best be larger, and the sum of squares with them; `None` where one of the fabrics cannot be
/// tested, or bears nothing.
///
/// The stress of elastic yarns goes up and down with all of their stiffnesses, while they lie where they lay. A place that is off by
/// nothing but such a factor is as good as the right one.
///
/// # Errors
/// If one question is not answered now.
pub fn best_scale<A: Answers>(
    problems: &[YarnProblem],
    answers: &A,
    question: &Question,
) -> Result<Option<(f64, f64)>, A::Unanswered> {
    let one = |(fabric, problem): (usize, &YarnProblem)| {
        let question = Question { fabric, ..*question };
        let parts = |found: Evaluation| {
            let whole = problem.residuals(&question, &found).values;
            let without = problem.residuals(&question, &found.without_stress()).values;
            let squares = |a: &dyn Fn(usize) -> f64, b: &dyn Fn(usize) -> f64| -> f64 {
                (0..whole.len()).map(|k| a(k) * b(k)).sum()
            };
            let (of_stress, rest) = (|k: usize| whole[k] - without[k], |k: usize| without[k]);
            [squares(&of_stress, &of_stress), squares(&of_stress, &rest), squares(&rest, &rest)]
        };
        Ok(answers.answer(&question)?.map(parts))
    };
    let found: Vec<Result<Option<[f64; 3]>, A::Unanswered>> = problems.par_iter().enumerate().map(one).collect();
    let mut sums = [0.0; 3];
    for parts in found {
        let Some(parts) = parts? else { return Ok(None) };
        sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part);
    }
    let [square, mixed, rest] = sums;
    let (scale, cost) = (-mixed / square, rest - mixed * mixed / square);
    Ok((scale > 0.0 && scale.is_finite() && cost.is_finite()).then_some((scale, cost)))
}

/// What tells problems that are fitted together from others: SHA-256 of their JSON.
///
/// # Panics
/// Never: their numbers are finite.
#[must_use]
pub fn fingerprint(problems: &[YarnProblem]) -> String {
    let text = serde_json::to_vec(problems).expect("finite numbers are JSON");
    Sha256::digest(text).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Asks of all fabrics of one yarn at once; residuals in the order of the fabrics. `None` where one of them cannot be tested.
///
/// # Errors
/// If one question is not answered now; the others have been asked.
pub fn ask_all<A: Answers>(
    problems: &[YarnProblem],
    answers: &A,
    question: &Question,
) -> Result<Option<Residuals<P>>, A::Unanswered> {
    let one = |(fabric, problem): (usize, &YarnProblem)| {
        let question = Question { fabric, ..*question };
        Ok(answers.answer(&question)?.map(|found| problem.residuals(&question, &found)))
    };
    let found: Vec<Result<Option<Residuals<P>>, A::Unanswered>> = problems.par_iter().enumerate().map(one).collect();
    let found: Vec<Option<Residuals<P>>> = found.into_iter().collect::<Result<_, _>>()?;
    let found: Option<Vec<Residuals<P>>> = found.into_iter().collect();
    Ok(found.map(|each| {
        let mut all = Residuals::default();
        for one in each {
            all.values.extend(one.values);
            all.slopes.extend(one.slopes);
        }
        all
    }))
}

/// Tiles with their rest shapes, by fabric and by the bits of their numbers; none where there are none.
type Rested = HashMap<(usize, [u64; P]), Option<Arc<YarnTile>>>;

/// Problems that are answered here and now; rest shapes are kept for the next question with the same.
#[derive(Clone, Debug)]
pub struct Here<'a> {
    problems: &'a [YarnProblem],
    rested: Arc<Mutex<Rested>>,
}

impl<'a> Here<'a> {
    /// Answers questions about a fabric.
    #[must_use]
    pub fn new(problem: &'a YarnProblem) -> Self {
        Self::of(std::slice::from_ref(problem))
    }

    /// Answers questions about fabrics that are fitted together.
    #[must_use]
    pub fn of(problems: &'a [YarnProblem]) -> Self {
        Self { problems, rested: Arc::default() }
    }

    /// The tile of a fabric with the rest shapes of some numbers; none if there is no such fabric.
    ///
    /// # Panics
    /// Never: nobody panics with the lock.
    #[must_use]
    pub fn rested(&self, fabric: usize, parameters: &[f64; P]) -> Option<Arc<YarnTile>> {
        let key = (fabric, parameters.map(f64::to_bits));
        let known = self.rested.lock().expect("nobody panics with it").get(&key).cloned();
        known.unwrap_or_else(|| {
            let found = self.problems.get(fabric).and_then(|problem| problem.rested(parameters)).map(Arc::new);
            self.rested.lock().expect("nobody panics with it").insert(key, found.clone());
            found
        })
    }
}

impl Answers for Here<'_> {
    type Unanswered = std::convert::Infallible;

    fn answer(&self, question: &Question) -> Result<Option<Evaluation>, Self::Unanswered> {
        let tile = self.rested(question.fabric, &question.rest);
        Ok(tile.and_then(|tile| self.problems[question.fabric].evaluate(&tile, question)))
    }
}
