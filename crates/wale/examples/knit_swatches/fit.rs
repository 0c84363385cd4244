//! Fit of a card to sizes: Gauss–Newton steps, with the slopes of every size by every number at equilibrium, or by differences where
//! what comes off its needles is held by friction.

use rayon::prelude::*;
use wale::dynamics::tile_equilibrium::TileEquilibrium;
use wale::dynamics::tile_sensitivity::TileSensitivity;
use wale::model::{LoopProportions, Thickness, YarnCard};
use wale_numerics::dense::SmallSystem;

use super::sizes::{Model, STOCKINETTE, spacing};
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
pub const NUMBERS: [Number; 14] = [
    number("stitch_length", [0.05, 0.13], 0.02, |p| &mut p.stitch_length),
    number("wrapping", [0.0, 30.0], 1.0, |p| &mut p.wrapping),
    number("wrapping_angle_course", [0.0, 3.0], 0.4, |p| &mut p.wrapping_angle_course),
    number("wrapping_angle_leg", [0.0, 3.0], 0.4, |p| &mut p.wrapping_angle_leg),
    number("bend_angle_foot_head", [0.0, 1.5], 0.3, |p| &mut p.bend_angle_foot_head),
    number("bend_angle_leg", [0.0, 1.5], 0.3, |p| &mut p.bend_angle_leg),
    number("spacing_leg", [0.02, 1.0], 0.05, |p| &mut p.spacing_leg),
    number("spacing_head_sinker", [0.02, 0.4], 0.03, |p| &mut p.spacing_head_sinker),
    number("contact_distance", [0.0, 0.15], 0.02, |p| &mut thickness(p).contact_distance),
    number("leg_distance", [0.0, 0.40], 0.03, |p| &mut thickness(p).leg_distance),
    number("leg_stiffness", [10.0, 1000.0], 50.0, |p| &mut thickness(p).leg_stiffness),
    number("crossing_spacing", [0.3, 1.2], 0.1, |p| &mut thickness(p).crossing_spacing),
    number("facing_distance", [0.0, 0.5], 0.03, |p| &mut thickness(p).facing_distance),
    number("spacing_stiffness", [2.0, 2000.0], 30.0, |p| p.spacing_stiffness.get_or_insert(2000.0)),
];

/// Numbers of a card, without those of a thickness that it has not.
pub fn numbers(proportions: &LoopProportions) -> &'static [Number] {
    if proportions.thickness.is_some() { &NUMBERS } else { &NUMBERS[..8] }
}

/// A step of a difference, in steps that matter: of slopes at equilibrium, and of what comes off its needles, where a contact that slides or
/// does not makes sizes jump by as much as smaller steps would change them.
const DIFFERENCE: f64 = 1e-3;
const DIFFERENCE_OFF_NEEDLES: f64 = 0.3;
/// Longest step of a number, in steps that matter: further away a repeat is soon in another equilibrium.
const LONGEST: f64 = 0.5;
/// Weight of a step that matters away from where the fit began.
const PRIOR: f64 = 0.01;

type Equilibria = Vec<Vec<TileEquilibrium>>;

/// The fit: the first swatch is stockinette.
pub struct Fit<'a> {
    swatches: &'a [&'a Swatch],
    numbers: &'static [Number],
    start: Model,
    first: Vec<f64>,
}

impl<'a> Fit<'a> {
    /// Of the proportions and with the settings of a model.
    pub fn new(swatches: &'a [&'a Swatch], start: Model) -> Self {
        let numbers = numbers(&start.proportions);
        let first = numbers.iter().map(|number| *(number.place)(&mut start.proportions.clone())).collect();
        Self { swatches, numbers, start, first }
    }

    /// The card after so many rounds, with the root mean square of its residuals.
    pub fn run(&self, rounds: usize) -> (LoopProportions, f64) {
        let mut x = self.first.clone();
        let mut at = self.relax(&x, None);
        let mut residuals = self.residuals(&x, &sizes(&at));
        let mut damping = 0.01;
        for round in 0..rounds {
            eprintln!("round {round}: {:.4} {x:.4?}", self.error(&residuals));
            let columns = self.slopes(&x, &at, &residuals);
            let mut improved = false;
            for _ in 0..6 {
                let trial = self.step(&x, &residuals, &columns, damping);
                let mut found = self.relax(&trial, Some(&at));
                let better = |found: &Equilibria| square(&self.residuals(&trial, &sizes(found))) < square(&residuals);
                if self.start.needles.is_none() && better(&found) {
                    // What was followed from equilibrium to equilibrium need not be the lowest.
                    found = lowest(found, self.relax(&trial, None));
                }
                if better(&found) {
                    let new = self.residuals(&trial, &sizes(&found));
                    improved = square(&new) < 0.999 * square(&residuals);
                    (x, at, residuals, damping) = (trial, found, new, f64::max(0.3 * damping, 1e-5));
                    break;
                }
                damping *= 4.0;
            }
            if !improved {
                break;
            }
        }
        (self.model(&x).proportions, self.error(&residuals))
    }

    fn model(&self, x: &[f64]) -> Model {
        let mut model = self.start.clone();
        for (number, x) in self.numbers.iter().zip(x) {
            *(number.place)(&mut model.proportions) = *x;
        }
        model
    }

    fn relax(&self, x: &[f64], near: Option<&Equilibria>) -> Equilibria {
        let model = self.model(x);
        let swatches = self.swatches.par_iter().enumerate().with_max_len(1);
        swatches
            .map(|(i, swatch)| match near {
                Some(near) => model.relaxed_from(&swatch.repeat, &near[i]),
                None => model.relaxed(&swatch.repeat),
            })
            .collect()
    }

    /// Logarithms of model over measured: the shape of stockinette, widths and heights relative to it, and the prior.
    fn residuals(&self, x: &[f64], spacing: &[[f64; 2]]) -> Vec<f64> {
        let [w, h] = spacing[0];
        let mut out = vec![0.7 * (w - h - (STOCKINETTE[0] / STOCKINETTE[1]).ln())];
        for (swatch, size) in self.swatches.iter().zip(spacing).skip(1) {
            out.push(size[0] - w - (swatch.width / STOCKINETTE[0]).ln());
            out.push(size[1] - h - (swatch.height / STOCKINETTE[1]).ln());
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

    /// Changes of the residuals by a step of each number.
    fn slopes(&self, x: &[f64], at: &Equilibria, residuals: &[f64]) -> Vec<Vec<f64>> {
        let moved: Vec<Vec<f64>> = (0..x.len())
            .map(|i| {
                let mut moved = x.to_vec();
                moved[i] += self.difference(i, x);
                moved
            })
            .collect();
        let slope = |(i, moved): (usize, &Vec<f64>), sizes: &[[f64; 2]]| -> Vec<f64> {
            let new = self.residuals(moved, sizes);
            let steps = self.numbers[i].step / self.difference(i, x);
            new.iter().zip(residuals).map(|(new, old)| (new - old) * steps).collect()
        };
        if self.start.needles.is_some() {
            let found = |(i, moved)| slope((i, moved), &sizes(&self.relax(moved, None)));
            return moved.par_iter().enumerate().with_max_len(1).map(found).collect();
        }
        let models: Vec<Model> = moved.iter().map(|moved| self.model(moved)).collect();
        let here = self.model(x);
        let of = |(k, swatch): (usize, &&Swatch)| -> Vec<[f64; 2]> {
            let (tile, lowest) = (here.tile(&swatch.repeat), &at[k][0]);
            // One that is about to leave for another equilibrium says nothing of the slope.
            let Some(there) = TileSensitivity::new(&tile, &YarnCard::unit(), &here.card(), &here.settings, lowest)
            else {
                return vec![[0.0; 2]; x.len()];
            };
            let change = |model: &Model| {
                there.change(&model.tile(&swatch.repeat), &YarnCard::unit(), &model.card(), &model.settings, lowest)
            };
            models.iter().map(change).collect()
        };
        let changes: Vec<Vec<[f64; 2]>> = self.swatches.par_iter().enumerate().with_max_len(1).map(of).collect();
        let base = sizes(at);
        let at_moved = |i: usize| -> Vec<[f64; 2]> {
            let of_swatch = |(base, change): (&[f64; 2], &Vec<[f64; 2]>)| [0, 1].map(|k| base[k] + change[i][k]);
            base.iter().zip(&changes).map(of_swatch).collect()
        };
        moved.iter().enumerate().map(|(i, moved)| slope((i, moved), &at_moved(i))).collect()
    }

    /// A small change of a number that stays within its bounds.
    fn difference(&self, i: usize, x: &[f64]) -> f64 {
        let Number { bounds, step, .. } = &self.numbers[i];
        let by = if self.start.needles.is_some() { DIFFERENCE_OFF_NEEDLES } else { DIFFERENCE };
        let ahead = by * step;
        if x[i] + ahead > bounds[1] { -ahead } else { ahead }
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
                (0..n).map(|i| x[i] + self.numbers[i].step * system.right_side[i].clamp(-LONGEST, LONGEST)).collect();
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

/// The lowest equilibria of both, as many as the first has.
fn lowest(first: Equilibria, second: Equilibria) -> Equilibria {
    let merge = |(mut first, second): (Vec<TileEquilibrium>, Vec<TileEquilibrium>)| {
        let count = first.len();
        first.extend(second);
        first.sort_by(|a, b| (!a.converged).cmp(&!b.converged).then(a.energy.total_cmp(&b.energy)));
        first.dedup_by(|a, b| (a.energy / b.energy - 1.0).abs() < 1e-6);
        first.truncate(count);
        first
    };
    first.into_iter().zip(second).map(merge).collect()
}

fn sizes(at: &Equilibria) -> Vec<[f64; 2]> {
    at.iter().map(|found| spacing(found)).collect()
}

fn square(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum()
}
