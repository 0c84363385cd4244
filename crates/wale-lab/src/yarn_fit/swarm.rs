//! The paper's way to fit: a swarm of particles, then COBYLA from the best place it found [Sperl2022, section 7.3.3].

use std::cell::RefCell;

use cobyla::{RhoBeg, StopTols, minimize};
use rayon::prelude::*;

use super::gradients::Found;
use super::problem::{Answers, P, Question, YarnProblem, ask_all};
use super::progress::Progress;
use super::sequence::Random;
use super::space::RodSpace;

/// How a swarm looks, and how COBYLA goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SwarmSettings {
    /// Particles.
    pub particles: usize,
    /// Steps of all of them.
    pub steps: usize,
    /// Part of its velocity that a particle keeps, at the first and at the last step.
    pub inertia: [f64; 2],
    /// Pull towards the best place of its own, and towards that of all.
    pub pulls: [f64; 2],
    /// Distance, over the bounds, within which particles push each other away \[–\].
    pub repulsion: f64,
    /// Points along each curve.
    pub samples: usize,
    /// Evaluations of COBYLA after it, and its points along each curve.
    pub local: [usize; 2],
    /// Seed.
    pub seed: u64,
}

impl Default for SwarmSettings {
    fn default() -> Self {
        Self {
            particles: 64,
            steps: 10,
            inertia: [0.9, 0.1],
            pulls: [1.5, 1.5],
            repulsion: 0.05,
            samples: 7,
            local: [60, 20],
            seed: 1,
        }
    }
}

impl SwarmSettings {
    /// A first look, in a tenth of the time.
    #[must_use]
    pub fn quick() -> Self {
        Self { particles: 12, steps: 4, samples: 5, local: [12, 5], ..Self::default() }
    }
}

/// Cost of a place at which the tile cannot be tested: worse than any other, and finite, since COBYLA stalls at what is not.
pub(super) const FAILED: f64 = 1e6;
/// First step of COBYLA, and that at which it ends, over the bounds.
const FIRST_STEP: f64 = 0.05;
const LAST_STEP: f64 = 1e-3;

struct Particle {
    /// Place and velocity, over the bounds: the cube from zero to one.
    place: [f64; P],
    velocity: [f64; P],
    best: [f64; P],
    least: f64,
}

/// Fits fabrics of one yarn by a swarm, then by COBYLA. `None` if they could all be tested nowhere.
///
/// # Errors
/// If a question is not answered now.
pub fn fit_by_swarm<A: Answers>(
    problems: &[YarnProblem],
    answers: &A,
    settings: &SwarmSettings,
    progress: &Progress<'_>,
) -> Result<Option<Found>, A::Unanswered> {
    let free = free(&problems[0]);
    let mut random = Random::new(settings.seed);
    let mut cube = || std::array::from_fn(|k| if free[k] { random.next() } else { 0.5 });
    let mut particles: Vec<Particle> = (0..settings.particles)
        .map(|_| {
            let (place, away): ([f64; P], [f64; P]) = (cube(), cube());
            let velocity = std::array::from_fn(|k| 0.5 * (away[k] - place[k]));
            Particle { place, velocity, best: place, least: f64::INFINITY }
        })
        .collect();
    let (mut best, mut least) = ([0.5; P], f64::INFINITY);
    for step in 0..settings.steps.max(1) {
        let costs: Vec<Result<f64, A::Unanswered>> = particles
            .par_iter()
            .map(|particle| cost(problems, answers, &particle.place, settings.samples, progress))
            .collect();
        for (particle, cost) in particles.iter_mut().zip(costs) {
            let cost = cost?;
            if cost < particle.least {
                (particle.best, particle.least) = (particle.place, cost);
            }
            if cost < least {
                (best, least) = (particle.place, cost);
            }
        }
        let part = step as f64 / (settings.steps.max(2) - 1) as f64;
        let inertia = settings.inertia[0] + part * (settings.inertia[1] - settings.inertia[0]);
        advance(&mut particles, &best, inertia, settings, &free, &mut random);
    }
    if least >= FAILED {
        return Ok(None);
    }
    fit_locally(problems, answers, best, settings, progress).map(Some)
}

/// COBYLA from a place in the unit cube of the bounds.
///
/// # Errors
/// As [`fit_by_swarm`].
pub fn fit_locally<A: Answers>(
    problems: &[YarnProblem],
    answers: &A,
    from: [f64; P],
    settings: &SwarmSettings,
    progress: &Progress<'_>,
) -> Result<Found, A::Unanswered> {
    let free = free(&problems[0]);
    let [evaluations, samples] = settings.local;
    let unknown: Vec<usize> = (0..P).filter(|&k| free[k]).collect();
    if unknown.is_empty() {
        // Nothing is to be found; COBYLA cannot be given no unknown.
        let cost = cost(problems, answers, &from, samples, progress)?;
        return Ok(Found { coordinates: problems[0].space.at_parts(from), cost, least_squares: None });
    }
    let whole = |x: &[f64]| {
        let mut place = from;
        unknown.iter().zip(x).for_each(|(&k, &x)| place[k] = x.clamp(0.0, 1.0));
        place
    };
    // Once a question is not answered, COBYLA is led to its end without another.
    let unanswered = RefCell::new(None);
    let best = RefCell::new((from, f64::INFINITY));
    let evaluate = |x: &[f64], _: &mut ()| {
        if unanswered.borrow().is_some() {
            return FAILED;
        }
        let place = whole(x);
        match cost(problems, answers, &place, samples, progress) {
            Ok(cost) => {
                let mut best = best.borrow_mut();
                if cost < best.1 {
                    *best = (place, cost);
                }
                cost
            }
            Err(end) => {
                *unanswered.borrow_mut() = Some(end);
                FAILED
            }
        }
    };
    let start: Vec<f64> = unknown.iter().map(|&k| from[k]).collect();
    let bounds = vec![(0.0, 1.0); unknown.len()];
    let stop = StopTols { xtol_abs: vec![LAST_STEP; unknown.len()], ..StopTols::default() };
    let none: [fn(&[f64], &mut ()) -> f64; 0] = [];
    // How it ended does not matter: the best place of all it asked about is taken.
    let _ = minimize(evaluate, &start, &bounds, &none, (), evaluations, RhoBeg::All(FIRST_STEP), Some(stop));
    if let Some(end) = unanswered.into_inner() {
        return Err(end);
    }
    let (place, cost) = best.into_inner();
    Ok(Found { coordinates: problems[0].space.at_parts(place), cost, least_squares: None })
}

/// Which parameters are fitted.
fn free(problem: &YarnProblem) -> [bool; P] {
    problem.space.bounds.map(|[low, high]| low < high)
}

fn cost<A: Answers>(
    problems: &[YarnProblem],
    answers: &A,
    place: &[f64; P],
    samples: usize,
    progress: &Progress<'_>,
) -> Result<f64, A::Unanswered> {
    let question = Question::of(RodSpace::parameters(problems[0].space.at_parts(*place)), samples, false);
    let cost = ask_all(problems, answers, &question)?.map(|residuals| residuals.cost());
    let cost = cost.filter(|cost| cost.is_finite());
    progress.tell(cost, &question.at);
    Ok(cost.map_or(FAILED, |cost| cost.min(FAILED)))
}

/// Moves all particles; at a wall they stop.
fn advance(
    particles: &mut [Particle],
    best: &[f64; P],
    inertia: f64,
    settings: &SwarmSettings,
    free: &[bool; P],
    random: &mut Random,
) {
    let places: Vec<[f64; P]> = particles.iter().map(|particle| particle.place).collect();
    for (i, particle) in particles.iter_mut().enumerate() {
        let nearest = places
            .iter()
            .enumerate()
            .filter(|(j, _)| *j != i)
            .map(|(_, place)| (distance(place, &places[i]), place))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        for k in (0..P).filter(|&k| free[k]) {
            let x = particle.place[k];
            let [own, all] = settings.pulls;
            let mut velocity = inertia * particle.velocity[k]
                + own * random.next() * (particle.best[k] - x)
                + all * random.next() * (best[k] - x);
            if let Some((distance, place)) = nearest.filter(|near| near.0 < settings.repulsion) {
                velocity += (settings.repulsion - distance) * (x - place[k]).signum() * random.next();
            }
            let to = x + velocity;
            (particle.place[k], particle.velocity[k]) =
                if (0.0..=1.0).contains(&to) { (to, velocity) } else { (to.clamp(0.0, 1.0), 0.0) };
        }
    }
}

fn distance(a: &[f64; P], b: &[f64; P]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}
