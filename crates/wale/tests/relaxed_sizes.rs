//! Relaxed sizes of knitted patterns against measured swatches, with cards of point and of thick contacts and no friction.
//!
//! Measured: KnitDB (Hofmann et al. 2019), swatches of 60 × 60 stitches in one yarn; width and height in millimetres.
//! Repeats differ by about 4 % in height; stockinette, seed and moss are means of their repeats.

mod cards;

use wale::dynamics::tile_equilibrium::{TileSettings, relax_from_starts, relax_tile};
use wale::dynamics::tile_sensitivity::TileSensitivity;
use wale::dynamics::tile_shaking::shaken;
use wale::model::{KnitCard, LoopProportions, YarnCard};
use wale::pattern::{Chart, knit};

/// Root mean square of the logarithms of model over measured: what the card of point contacts was fitted to reach, and within what
/// that of thick ones is to predict; of the seven patterns it was fitted to stockinette, 1×1 rib and seed alone.
const BARS: [f64; 2] = [0.11, 0.07];
/// Starts from which each tile is relaxed; equilibria are not unique.
const STARTS: usize = 4;
/// How often the lowest of them is shaken.
const SHAKES: usize = 8;

#[test]
fn sizes_relative_to_stockinette() {
    for (proportions, bar) in [LoopProportions::default(), LoopProportions::thick()].into_iter().zip(BARS) {
        let [rms, worst_known] = compare(&proportions);
        assert!(rms <= bar, "rms {rms:.3}");
        if proportions.thickness.is_some() {
            // What yarns that meet in points cannot do: the sinkers of a 1×1 rib cross its thickness at every wale.
            assert!(worst_known < 0.04, "a pattern that the card was fitted to is {worst_known:.3} off");
        }
    }
}

/// Prints sizes of seven patterns against measured ones; returns the root mean square of the logarithms, and the largest of the
/// 1×1 rib and of seed, which both cards were fitted to.
fn compare(proportions: &LoopProportions) -> [f64; 2] {
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
    let card = proportions.card(&yarn, 6e-3);
    let mut reference = None;
    let mut squares = Vec::new();
    let mut worst_known = 0.0;
    println!("contacts: {}", if card.thickness.is_some() { "thick" } else { "point" });
    println!("pattern        wale against measured, relative to stockinette: width  height   error %");
    for (name, chart, width, height) in swatches {
        let tile = knit::tile(&chart, &card).unwrap();
        let settings = TileSettings::of(&card);
        let best = relax_from_starts(&tile, &yarn, &card, &settings, STARTS).swap_remove(0);
        let best = shaken(&tile, &yarn, &card, &settings, best, SHAKES);
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
        if ["rib 1x1", "seed"].contains(&name) {
            worst_known = f64::max(worst_known, ew.ln().abs().max(eh.ln().abs()));
        }
        if name != "stockinette" {
            squares.extend([ew.ln().powi(2), eh.ln().powi(2)]);
        }
    }
    let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    println!("rms of the logarithms: {rms:.3}");
    [rms, worst_known]
}

/// Munden's constants of relaxed stockinette of a yarn: `Kc = ℓ/C`, `Kw = ℓ/W`, `Ks = Kc Kw`, with the length of real yarn.
fn munden(yarn: &YarnCard, loop_length: f64) -> [f64; 3] {
    let proportions = LoopProportions::default();
    let card = proportions.card(yarn, proportions.path_ratio * loop_length);
    let tile = knit::tile(&Chart::stockinette(), &card).unwrap();
    let relaxed = relax_tile(&tile, yarn, &card, &TileSettings::default());
    assert!(relaxed.converged);
    let [course, wale] = [relaxed.course_spacing, relaxed.wale_spacing].map(|spacing| loop_length / spacing);
    [course, wale, course * wale]
}

#[test]
fn doubling_loop_and_yarn_leaves_mundens_constants_unchanged() {
    let thin = wale::scene::Scene::from_text(
        "schema = 1\n[fabric.chart]\npattern = \"stockinette\"\ncolumns = 2\nrows = 2\n",
        "default.toml",
    );
    let thin = thin.unwrap().yarns.first().clone();
    // Twice as thick of the same stuff: four times the area, sixteen times the second moment.
    let thick = YarnCard {
        radius: 2.0 * thin.radius,
        linear_density: 4.0 * thin.linear_density,
        stretch_stiffness: 4.0 * thin.stretch_stiffness,
        bending_stiffness: 16.0 * thin.bending_stiffness,
        ..thin.clone()
    };
    println!("loop length   yarn     Kc     Kw     Ks   Kc/Kw");
    let table: Vec<[f64; 3]> = [(&thin, 0.015), (&thin, 0.02), (&thick, 0.04)]
        .into_iter()
        .map(|(yarn, length)| {
            let [course, wale, stitch] = munden(yarn, length);
            let thickness = 2e3 * yarn.radius;
            println!(
                "{:>8.1} mm  {thickness:.2} mm  {course:.3}  {wale:.3}  {stitch:.2}  {:.3}",
                1e3 * length,
                course / wale
            );
            [course, wale, stitch]
        })
        .collect();
    for k in 0..3 {
        assert!((table[2][k] / table[1][k] - 1.0).abs() < 0.01, "{table:?}");
    }
    // Fully relaxed plain knit of the literature: Kc 5.5, Kw 4.2, ratio about 1.3.
    let [course, wale, _] = table[1];
    assert!((course / 5.5 - 1.0).abs() < 0.1 && (wale / 4.2 - 1.0).abs() < 0.1, "{course} {wale}");
}

#[test]
fn sizes_follow_the_card_as_relaxing_again_shows() {
    let yarn = cards::cards().0;
    let settings = TileSettings { bed: 30.0, tolerance: 1e-9, ..TileSettings::default() };
    let with = |change: f64| {
        let mut proportions = LoopProportions::thick();
        proportions.bend_angle_leg *= 1.0 + change;
        proportions.spacing_head_sinker *= 1.0 - change;
        proportions.card(&yarn, 6e-3)
    };
    let (card, more, less) = (with(0.0), with(1e-4), with(-1e-4));
    let chart = Chart::rib(1, 1).unwrap();
    let tile = |card: &KnitCard| knit::tile(&chart, card).unwrap();
    let at = relax_tile(&tile(&card), &yarn, &card, &settings);
    let found = TileSensitivity::new(&tile(&card), &yarn, &card, &settings, &at).expect("a rib at rest").change(
        &tile(&more),
        &yarn,
        &more,
        &settings,
        &at,
    );
    let [high, low] = [&more, &less].map(|card| relax_tile(&tile(card), &yarn, card, &settings));
    let expected =
        [0.5 * (high.wale_spacing / low.wale_spacing).ln(), 0.5 * (high.course_spacing / low.course_spacing).ln()];
    for (found, expected) in found.into_iter().zip(expected) {
        assert!(expected.abs() > 1e-6 && (found / expected - 1.0).abs() < 1e-2, "{found:e} {expected:e}");
    }
}
