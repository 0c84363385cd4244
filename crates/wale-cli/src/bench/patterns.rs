//! Patterns side by side: what a step costs for a stitch of each.
//!
//! Swatches of as many stitches fall at the same time, a step of each in turn, so that whatever else the machine does falls on
//! all of them alike; of the times of a swatch the median counts.

use serde::Serialize;
use wale::model::LinearSolver;

use super::swatch::{Falling, falling};
use crate::exit::Failure;

/// A pattern beside the others.
#[derive(Clone, Debug, Serialize)]
pub struct Compared {
    /// Its name.
    pub pattern: String,
    /// Stitches that are worked, of all kinds.
    pub stitches: usize,
    /// Loops: a stitch that is an increase makes several, a decrease takes several.
    pub loops: usize,
    /// Part of the stitches that are neither knits nor purls.
    pub special_part: f64,
    /// Nodes.
    pub nodes: usize,
    /// Median of the wall time of a step \[s\].
    pub step_s: f64,
    /// Nodes times steps a second.
    pub node_steps_per_s: f64,
    /// Newton iterations a step.
    pub newton_iterations: f64,
    /// Iterations of the linear solver a step.
    pub linear_iterations: f64,
    /// Wall time of a step for a stitch, over that of the first pattern.
    pub stitch_cost: f64,
    /// Wall time of a step for a loop, over that of the first pattern.
    pub loop_cost: f64,
    /// Wall time for a stitch of a step as hard as the first pattern's: the median, over the steps, of the time for an iteration
    /// of Newton's method, over that of the first pattern.
    pub iteration_cost: f64,
    /// What a stitch that is neither knit nor purl costs over one of the first pattern, if all others cost what those do.
    pub special_cost: Option<f64>,
}

/// Measures patterns; the first is what the others are compared to.
///
/// # Errors
/// When there is no such pattern, or a step fails.
pub fn compare(patterns: &[&str], nodes: u32, steps: usize) -> Result<Vec<Compared>, Failure> {
    let mut swatches: Vec<Falling> = patterns
        .iter()
        .map(|pattern| falling(pattern, nodes, LinearSolver::ConjugateGradient))
        .collect::<Result<_, _>>()?;
    let mut times: Vec<Vec<(f64, [usize; 2])>> = vec![Vec::with_capacity(steps); swatches.len()];
    for turn in 0..steps {
        for at in 0..swatches.len() {
            // Who follows whom changes from turn to turn only at the ends; caches hold none of the swatches anyhow.
            let at = (at + turn) % swatches.len();
            times[at].push(swatches[at].timed_step()?);
        }
    }
    let mut compared: Vec<Compared> = Vec::with_capacity(patterns.len());
    for ((pattern, swatch), times) in patterns.iter().zip(&swatches).zip(&times) {
        let [stitches, special] = swatch.stitches();
        let step_s = median(times.iter().map(|(time, _)| *time));
        let iteration_s = median(times.iter().map(|(time, [newton, _])| time / (*newton).max(1) as f64));
        let mean = |which: usize| times.iter().map(|(_, count)| count[which]).sum::<usize>() as f64 / steps as f64;
        let loops = swatch.loops();
        let a_stitch = [step_s, iteration_s].map(|time| time / stitches as f64);
        let special_part = special as f64 / stitches as f64;
        // The first pattern's are kept as they are until all are there.
        compared.push(Compared {
            pattern: (*pattern).to_owned(),
            stitches,
            loops,
            special_part,
            nodes: swatch.nodes(),
            step_s,
            node_steps_per_s: swatch.nodes() as f64 / step_s,
            newton_iterations: mean(0),
            linear_iterations: mean(1),
            stitch_cost: a_stitch[0],
            loop_cost: step_s / loops as f64,
            iteration_cost: a_stitch[1],
            special_cost: None,
        });
    }
    let costs = |of: &Compared| [of.stitch_cost, of.loop_cost, of.iteration_cost];
    let first = compared.first().map_or([1.0; 3], costs);
    for pattern in &mut compared {
        pattern.stitch_cost /= first[0];
        pattern.loop_cost /= first[1];
        pattern.iteration_cost /= first[2];
        let part = pattern.special_part;
        pattern.special_cost = (part > 0.0).then(|| (pattern.stitch_cost - (1.0 - part)) / part);
    }
    Ok(compared)
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    match values.len() {
        0 => f64::NAN,
        n if n % 2 == 1 => values[n / 2],
        n => 0.5 * (values[n / 2 - 1] + values[n / 2]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians() {
        assert_eq!(median([3.0, 1.0, 2.0].into_iter()), 2.0);
        assert_eq!(median([4.0, 1.0, 2.0, 3.0].into_iter()), 2.5);
        assert!(median(std::iter::empty()).is_nan());
    }

    #[test]
    fn swatches_side_by_side_have_the_same_number_of_stitches() {
        let compared = compare(&["stockinette", "mesh"], 1600, 2).unwrap_or_else(|failure| panic!("{failure:?}"));
        assert_eq!(compared[0].stitches, compared[1].stitches);
        assert_eq!((compared[0].stitch_cost, compared[0].loop_cost, compared[0].special_cost), (1.0, 1.0, None));
        // Every stitch of these two makes one loop.
        assert!(compared.iter().all(|pattern| pattern.loops == pattern.stitches), "{compared:?}");
        assert_eq!(compared[1].special_part, 0.5);
        assert!(compared[1].special_cost.is_some_and(f64::is_finite));
    }
}
