//! Relaxed sizes of knitted patterns against measured swatches, with the default card and no friction.
//!
//! Measured: KnitDB (Hofmann et al. 2019), swatches of 60 × 60 stitches in one yarn; width and height in millimetres.
//! Repeats differ by about 4 % in height; stockinette, seed and moss are means of their repeats.

use wale::dynamics::tile_equilibrium::{TileSettings, relax_tile};
use wale::model::{LoopProportions, YarnCard};
use wale::pattern::{Chart, knit};

/// Root mean square of the logarithms of model over measured that the card was fitted to reach.
const BAR: f64 = 0.11;
/// Starts from which each tile is relaxed; equilibria are not unique.
const STARTS: u64 = 3;

#[test]
fn sizes_relative_to_stockinette() {
    let swatches = [
        ("stockinette", Chart::stockinette(), 99.25, 81.0),
        ("garter", Chart::garter(), 111.0, 64.0),
        ("rib 1x1", Chart::rib(1, 1).unwrap(), 71.0, 103.0),
        ("rib 2x2", Chart::rib(2, 2).unwrap(), 60.5, 94.8),
        ("seed", Chart::seed(), 119.0, 84.0),
        ("moss", Chart::moss(), 102.0, 102.5),
        ("welting 2+2", Chart::welting(2, 2).unwrap(), 111.0, 56.0),
    ];
    let yarn = YarnCard {
        linear_density: 1.33e-4,
        radius: 3e-4,
        stretch_stiffness: 3e4 * 1e-9 / 3.6e-5,
        bending_stiffness: 1e-9,
        friction_coefficient: 0.3,
        mass_damping: 0.0,
        stiffness_damping: 0.0,
        loose_ends: false,
        plies: 2,
        twist: 0.0,
    };
    let card = LoopProportions::default().card(&yarn, 6e-3);
    let mut reference = None;
    let mut squares = Vec::new();
    println!("pattern        wale against measured, relative to stockinette: width  height   error %");
    for (name, chart, width, height) in swatches {
        let tile = knit::tile(&chart, &card).unwrap();
        let runs =
            (1..=STARTS).map(|seed| relax_tile(&tile, &yarn, &card, &TileSettings { seed, ..Default::default() }));
        let best = runs.min_by(|a, b| a.energy.total_cmp(&b.energy)).unwrap();
        assert!(best.converged, "{name} did not come to rest: residual {:e}", best.residual);
        let (w, h) = (best.wale_spacing, best.course_spacing);
        let &mut (w0, h0, width0, height0) = reference.get_or_insert((w, h, width, height));
        let (ew, eh) = ((w / w0) / (width / width0), (h / h0) / (height / height0));
        println!(
            "{name:<14} {:.2} {:.2} against {:.2} {:.2}   {:+.0} {:+.0}",
            w / w0,
            h / h0,
            width / width0,
            height / height0,
            100.0 * (ew - 1.0),
            100.0 * (eh - 1.0)
        );
        if name != "stockinette" {
            squares.extend([ew.ln().powi(2), eh.ln().powi(2)]);
        }
    }
    let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    println!("rms of the logarithms: {rms:.3}");
    assert!(rms <= BAR, "rms {rms:.3}");
}
