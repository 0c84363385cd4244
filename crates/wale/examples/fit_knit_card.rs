//! Fits the proportions of the default knit card to the sizes of measured swatches: width and height relative to
//! stockinette, found on periodic tiles without friction.
//!
//! `cargo run -p wale --example fit_knit_card -- [EVALUATIONS]`: with no evaluations it prints the table of the card as
//! it stands. Measured: KnitDB (Hofmann et al. 2019), 60 × 60 stitches of one yarn, width and height in millimetres.

use std::cell::RefCell;

use cobyla::{RhoBeg, StopTols, minimize};
use wale::dynamics::tile_equilibrium::{TileEquilibrium, TileSettings, relax_tile};
use wale::model::{LoopProportions, YarnCard};
use wale::pattern::{Chart, knit};

/// Where a number lies in the card.
type Place = fn(&mut LoopProportions) -> &mut f64;

/// Names, bounds and places of what is fitted.
const FITTED: [(&str, [f64; 2], Place); 8] = [
    ("stitch_length", [0.06, 0.14], |p| &mut p.stitch_length),
    ("wrapping", [0.2, 40.0], |p| &mut p.wrapping),
    ("wrapping_angle_course", [0.5, 3.0], |p| &mut p.wrapping_angle_course),
    ("wrapping_angle_leg", [0.5, 3.0], |p| &mut p.wrapping_angle_leg),
    ("bend_angle_foot_head", [0.0, 1.4], |p| &mut p.bend_angle_foot_head),
    ("bend_angle_leg", [0.0, 1.5], |p| &mut p.bend_angle_leg),
    ("spacing_leg", [0.03, 0.25], |p| &mut p.spacing_leg),
    ("spacing_head_sinker", [0.03, 0.20], |p| &mut p.spacing_head_sinker),
];
/// Starts from which each tile is relaxed: equilibria are not unique, and a card for which they differ is worse.
const STARTS: u64 = 2;
/// What a card costs whose tile cannot be relaxed.
const FAILED: f64 = 9.0;

struct Swatch {
    name: &'static str,
    chart: Chart,
    width: f64,
    height: f64,
    /// Part in the sum; a swatch whose measured size depends on how it was laid flat counts less.
    weight: f64,
}

fn swatches() -> Vec<Swatch> {
    let of = |name, chart, width, height, weight| Swatch { name, chart, width, height, weight };
    vec![
        of("stockinette", Chart::stockinette(), 99.25, 81.0, 0.5),
        of("garter", Chart::garter(), 111.0, 64.0, 1.0),
        of("rib 1x1", Chart::rib(1, 1).expect("a rib"), 71.0, 103.0, 1.0),
        of("rib 2x2", Chart::rib(2, 2).expect("a rib"), 60.5, 94.8, 1.0),
        of("seed", Chart::seed(), 119.0, 84.0, 1.0),
        of("moss", Chart::moss(), 102.0, 102.5, 1.0),
        of("welting 2+2", Chart::welting(2, 2).expect("a welting"), 111.0, 56.0, 1.0),
        of("rib 5x5", Chart::rib(5, 5).expect("a rib"), 93.0, 86.0, 0.4),
    ]
}

fn relaxed(chart: &Chart, proportions: &LoopProportions) -> Option<(TileEquilibrium, f64)> {
    // Everything is in proportion to the loop: lengths in loops, forces in k_b/ℓ².
    let yarn = YarnCard {
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
    };
    let card = proportions.card(&yarn, 1.0);
    let tile = knit::tile(chart, &card).expect("a repeat");
    let run = |seed| relax_tile(&tile, &yarn, &card, &TileSettings { seed, tolerance: 1e-4, ..Default::default() });
    let runs: Vec<_> = (1..=STARTS).map(run).collect();
    let best = runs.iter().min_by(|a, b| a.energy.total_cmp(&b.energy))?.clone();
    if !(best.wale_spacing > 0.0 && best.course_spacing > 0.0 && best.residual < 1e-2) {
        return None;
    }
    let apart = |run: &TileEquilibrium| {
        (run.wale_spacing / best.wale_spacing).ln().powi(2) + (run.course_spacing / best.course_spacing).ln().powi(2)
    };
    let spread = runs.iter().map(apart).sum::<f64>() / STARTS as f64;
    Some((best, spread))
}

/// Root of the weighted mean square of the logarithms of model over measured.
fn cost(proportions: &LoopProportions, print: bool) -> f64 {
    // The yarn of a loop has to hold its four contacts and the spaces between them.
    if 4.0 * proportions.stitch_length + 2.0 * (proportions.spacing_leg + proportions.spacing_head_sinker) > 1.35 {
        return FAILED;
    }
    let (mut sum, mut weights) = (0.0, 0.0);
    let mut reference = None;
    for swatch in swatches() {
        let Some((tile, spread)) = relaxed(&swatch.chart, proportions) else { return FAILED };
        let (w, h) = (tile.wale_spacing, tile.course_spacing);
        let Some((w0, h0, width0, height0)) = reference else {
            reference = Some((w, h, swatch.width, swatch.height));
            let shape = (w / h / (swatch.width / swatch.height)).ln();
            sum += swatch.weight * shape * shape;
            weights += swatch.weight;
            continue;
        };
        let (ew, eh) = ((w / w0) / (swatch.width / width0), (h / h0) / (swatch.height / height0));
        sum += swatch.weight * (ew.ln().powi(2) + eh.ln().powi(2) + 0.5 * spread);
        weights += 2.0 * swatch.weight;
        if print {
            println!(
                "{:<12} {:.3} {:.3} against {:.3} {:.3}, error {:+.1} {:+.1} %, starts apart by {:.3}",
                swatch.name,
                w / w0,
                h / h0,
                swatch.width / width0,
                swatch.height / height0,
                100.0 * (ew - 1.0),
                100.0 * (eh - 1.0),
                spread.sqrt()
            );
        }
    }
    (sum / weights).sqrt()
}

fn main() {
    let evaluations: usize = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(0);
    let start = LoopProportions::default();
    println!("width and height relative to stockinette, model against measured:");
    println!("rms of the logarithms {:.4}", cost(&start, true));
    if evaluations == 0 {
        return;
    }
    // Each number runs from 0 to 1 between its bounds.
    let with = |x: &[f64]| {
        let mut proportions = start.clone();
        for ((_, [low, high], place), x) in FITTED.iter().zip(x) {
            *place(&mut proportions) = low + (high - low) * x.clamp(0.0, 1.0);
        }
        proportions
    };
    let first: Vec<f64> =
        FITTED.iter().map(|(_, [low, high], place)| (*place(&mut start.clone()) - low) / (high - low)).collect();
    let best = RefCell::new((FAILED, first.clone()));
    let objective = |x: &[f64], _: &mut ()| {
        let value = cost(&with(x), false);
        if value < best.borrow().0 {
            eprintln!("{value:.4} {x:.4?}");
            best.replace((value, x.to_vec()));
        }
        value
    };
    let bounds = vec![(0.0, 1.0); FITTED.len()];
    // No constraints but the bounds.
    let none: [fn(&[f64], &mut ()) -> f64; 0] = [];
    let stop = StopTols { xtol_abs: vec![1e-4; FITTED.len()], ..StopTols::default() };
    let ended = minimize(objective, &first, &bounds, &none, (), evaluations, RhoBeg::All(0.05), Some(stop));
    println!("ended: {}", if ended.is_ok() { "converged or out of evaluations" } else { "stopped early" });
    let fitted = with(&best.borrow().1);
    println!("rms of the logarithms {:.4}", cost(&fitted, true));
    for (name, _, place) in FITTED {
        println!("{name} = {:.4}", place(&mut fitted.clone()));
    }
}
