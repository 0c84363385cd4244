//! Fit of a card to sizes: Gauss–Newton steps by differences from equilibrium to equilibrium.

use rayon::prelude::*;
use wale::dynamics::tile_equilibrium::TileEquilibrium;
use wale::model::{LoopProportions, Thickness};
use wale_numerics::dense::SmallSystem;

use super::sizes::{STOCKINETTE, relaxed, spacing};
use super::swatches::Swatch;

/// Where a number lies in the card.
type Place = fn(&mut LoopProportions) -> &mut f64;

/// A number that is fitted: its name, bounds, a step that matters, and its place.
pub struct Number {
    pub name: &'static str,
    bounds: [f64; 2],
    step: f64,
    pub place: Place,
}

const fn number(name: &'static str, bounds: [f64; 2], step: f64, place: Place) -> Number {
    Number { name, bounds, step, place }
}

fn thickness(proportions: &mut LoopProportions) -> &mut Thickness {
    proportions.thickness.as_mut().expect("a card with thickness")
}

/// What is fitted: in a card without thickness the first eight.
pub const NUMBERS: [Number; 12] = [
    number("stitch_length", [0.05, 0.13], 0.02, |p| &mut p.stitch_length),
    number("wrapping", [0.0, 30.0], 1.0, |p| &mut p.wrapping),
    number("wrapping_angle_course", [0.0, 3.0], 0.4, |p| &mut p.wrapping_angle_course),
    number("wrapping_angle_leg", [0.0, 3.0], 0.4, |p| &mut p.wrapping_angle_leg),
    number("bend_angle_foot_head", [0.0, 1.5], 0.3, |p| &mut p.bend_angle_foot_head),
    number("bend_angle_leg", [0.0, 1.5], 0.3, |p| &mut p.bend_angle_leg),
    number("spacing_leg", [0.02, 0.40], 0.05, |p| &mut p.spacing_leg),
    number("spacing_head_sinker", [0.02, 0.20], 0.03, |p| &mut p.spacing_head_sinker),
    number("contact_distance", [0.0, 0.15], 0.02, |p| &mut thickness(p).contact_distance),
    number("leg_distance", [0.0, 0.40], 0.03, |p| &mut thickness(p).leg_distance),
    number("leg_stiffness", [10.0, 1000.0], 50.0, |p| &mut thickness(p).leg_stiffness),
    number("crossing_spacing", [0.3, 1.2], 0.1, |p| &mut thickness(p).crossing_spacing),
];

/// Numbers of a card, without those of a thickness that it has not.
pub fn numbers(proportions: &LoopProportions) -> &'static [Number] {
    if proportions.thickness.is_some() { &NUMBERS } else { &NUMBERS[..8] }
}

/// A step of a difference, in steps that matter; and how far a repeat moves at most before it is in another equilibrium.
const DIFFERENCE: f64 = 0.01;
const JUMP: f64 = 0.03;
/// Weight of a step that matters away from where the fit began.
const PRIOR: f64 = 0.01;

type Equilibria = Vec<Vec<TileEquilibrium>>;

/// The fit: the first swatch is stockinette.
pub struct Fit<'a> {
    swatches: &'a [&'a Swatch],
    numbers: &'static [Number],
    start: LoopProportions,
    first: Vec<f64>,
}

impl<'a> Fit<'a> {
    pub fn new(swatches: &'a [&'a Swatch], start: LoopProportions) -> Self {
        let numbers = numbers(&start);
        let first = numbers.iter().map(|number| *(number.place)(&mut start.clone())).collect();
        Self { swatches, numbers, start, first }
    }

    /// The card after so many rounds, with the root mean square of its residuals.
    pub fn run(&self, rounds: usize) -> (LoopProportions, f64) {
        let mut x = self.first.clone();
        let mut at = self.relax(&x, None);
        let mut residuals = self.residuals(&x, &at);
        let mut damping = 0.01;
        for round in 0..rounds {
            let columns: Vec<Vec<f64>> = (0..x.len()).map(|i| self.slope(i, &x, &at, &residuals)).collect();
            let mut improved = false;
            for _ in 0..6 {
                let trial = self.step(&x, &residuals, &columns, damping);
                let found = self.relax(&trial, Some(&at));
                let new = self.residuals(&trial, &found);
                if square(&new) < square(&residuals) {
                    improved = square(&new) < 0.999 * square(&residuals);
                    (x, at, residuals, damping) = (trial, found, new, f64::max(0.3 * damping, 1e-5));
                    break;
                }
                damping *= 4.0;
            }
            eprintln!("round {round}: {:.4}", self.error(&residuals));
            if !improved {
                break;
            }
        }
        // What was followed from equilibrium to equilibrium need not be the lowest.
        let error = self.error(&self.residuals(&x, &self.relax(&x, None)));
        (self.card(&x), error)
    }

    fn card(&self, x: &[f64]) -> LoopProportions {
        let mut card = self.start.clone();
        for (number, x) in self.numbers.iter().zip(x) {
            *(number.place)(&mut card) = *x;
        }
        card
    }

    fn relax(&self, x: &[f64], near: Option<&Equilibria>) -> Equilibria {
        let card = self.card(x);
        let swatches = self.swatches.par_iter().enumerate();
        swatches.map(|(i, swatch)| relaxed(&swatch.repeat, &card, near.map(|near| &near[i][..]))).collect()
    }

    /// Logarithms of model over measured: the shape of stockinette, widths and heights relative to it, and the prior.
    fn residuals(&self, x: &[f64], at: &Equilibria) -> Vec<f64> {
        let spacing: Vec<[f64; 2]> = at.iter().map(|found| spacing(found)).collect();
        let [w, h] = spacing[0];
        let mut out = vec![0.7 * (w - h - (STOCKINETTE[0] / STOCKINETTE[1]).ln())];
        for (swatch, size) in self.swatches.iter().zip(&spacing).skip(1) {
            out.push(swatch.weight * (size[0] - w - (swatch.width / STOCKINETTE[0]).ln()));
            out.push(swatch.weight * (size[1] - h - (swatch.height / STOCKINETTE[1]).ln()));
        }
        let moved = x.iter().zip(&self.first).zip(self.numbers);
        out.extend(moved.map(|((x, first), number)| PRIOR * (x - first) / number.step));
        out
    }

    /// Root mean square without the prior.
    fn error(&self, residuals: &[f64]) -> f64 {
        let count = 2 * self.swatches.len() - 1;
        (square(&residuals[..count]) / count as f64).sqrt()
    }

    /// Change of the residuals by a step of a number.
    fn slope(&self, i: usize, x: &[f64], at: &Equilibria, residuals: &[f64]) -> Vec<f64> {
        let number = &self.numbers[i];
        let ahead = DIFFERENCE * number.step;
        let change = if x[i] + ahead > number.bounds[1] { -ahead } else { ahead };
        let mut moved = x.to_vec();
        moved[i] += change;
        let mut found = self.relax(&moved, Some(at));
        for (found, at) in found.iter_mut().flatten().zip(at.iter().flatten()) {
            let apart = |a: f64, b: f64| (a / b).ln().abs();
            // One that jumped says nothing of the slope.
            if apart(found.wale_spacing, at.wale_spacing).max(apart(found.course_spacing, at.course_spacing)) > JUMP {
                found.clone_from(at);
            }
        }
        let new = self.residuals(&moved, &found);
        new.iter().zip(residuals).map(|(new, old)| (new - old) * number.step / change).collect()
    }

    /// A damped step within the bounds: a number at a bound that would leave is held there.
    fn step(&self, x: &[f64], residuals: &[f64], columns: &[Vec<f64>], damping: f64) -> Vec<f64> {
        let n = x.len();
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut held = vec![false; n];
        loop {
            let mut system = SmallSystem::default();
            system.clear(n);
            for i in 0..n {
                for j in 0..n {
                    let value = product(&columns[i], &columns[j]);
                    let damped = if i == j { value + damping * (value + 1e-4) } else { value };
                    let alone = if i == j { 1.0 } else { 0.0 };
                    system.matrix[i * n + j] = if held[i] || held[j] { alone } else { damped };
                }
                system.right_side[i] = if held[i] { 0.0 } else { -product(&columns[i], residuals) };
            }
            assert!(system.solve(), "damped normal equations are positive definite");
            let moved: Vec<f64> =
                (0..n).map(|i| x[i] + self.numbers[i].step * system.right_side[i].clamp(-1.0, 1.0)).collect();
            let leaves = |i: &usize| {
                let [low, high] = self.numbers[*i].bounds;
                !held[*i] && ((moved[*i] < low && x[*i] <= low) || (moved[*i] > high && x[*i] >= high))
            };
            match (0..n).find(leaves) {
                Some(i) => held[i] = true,
                None => {
                    let within = moved.iter().zip(self.numbers).map(|(x, n)| x.clamp(n.bounds[0], n.bounds[1]));
                    return within.collect();
                }
            }
        }
    }
}

fn square(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum()
}
