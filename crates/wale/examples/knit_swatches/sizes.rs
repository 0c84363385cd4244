//! Relaxed sizes of patterns relative to stockinette, by periodic tiles without friction.

use rayon::prelude::*;
use wale::dynamics::tile_equilibrium::{TileEquilibrium, TileSettings, relax_from_starts, relax_tile_from};
use wale::model::{LoopProportions, YarnCard};
use wale::pattern::{Chart, knit};

/// Measured relaxed size of stockinette \[mm\]: the mean of its four swatches, one of them shown from its purl side.
pub const STOCKINETTE: [f64; 2] = [99.25, 81.0];
/// Starts of a repeat; one for a repeat of more than [`MANY_LOOPS`], whose patches average over what starts differ in.
const STARTS: usize = 4;
const MANY_LOOPS: usize = 50;
const SETTINGS: TileSettings = TileSettings { bed: 10.0, noise: 0.01, seed: 1, max_iterations: 1500, tolerance: 1e-4 };

/// Everything is in proportion to the loop: lengths in loops, forces in `k_b/ℓ²`.
fn yarn() -> YarnCard {
    YarnCard {
        linear_density: 1.0,
        radius: 0.05,
        stretch_stiffness: 3e4,
        bending_stiffness: 1.0,
        friction_coefficient: 0.0,
        mass_damping: 0.0,
        stiffness_damping: 0.0,
        loose_ends: false,
        plies: 2,
        twist: 0.0,
    }
}

/// Equilibria of a repeat, the lowest first; those found from `near` where there are some.
pub fn relaxed(chart: &Chart, proportions: &LoopProportions, near: Option<&[TileEquilibrium]>) -> Vec<TileEquilibrium> {
    let yarn = yarn();
    let card = proportions.card(&yarn, 1.0);
    let tile = knit::tile(chart, &card).expect("the repeat of a chart of knits and purls has no end");
    let starts = if chart.loop_count() > MANY_LOOPS { 1 } else { STARTS };
    let Some(near) = near else { return relax_from_starts(&tile, &yarn, &card, &SETTINGS, starts) };
    let again = |at: &TileEquilibrium| relax_tile_from(&tile, &yarn, &card, &SETTINGS, at.coordinates.clone());
    let found: Vec<TileEquilibrium> = near.par_iter().map(again).collect();
    if found.iter().all(|at| at.converged) { found } else { relaxed(chart, proportions, None) }
}

/// Logarithms of wale and course spacing of the lowest equilibrium. A tile that has folded up has some size too.
pub fn spacing(found: &[TileEquilibrium]) -> [f64; 2] {
    let lowest = found.iter().min_by(|a, b| (!a.converged).cmp(&!b.converged).then(a.energy.total_cmp(&b.energy)));
    let lowest = lowest.expect("at least one start");
    [lowest.wale_spacing, lowest.course_spacing].map(|spacing| spacing.max(0.02).ln())
}
