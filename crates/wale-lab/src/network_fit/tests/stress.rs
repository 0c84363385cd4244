//! Stress against energy, mirror images and doubled tiles.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use wale::dynamics::stretched_tile::TileReference;
use wale::dynamics::tile_equilibrium::{TileSettings, relax_tile};

use super::{knit_of, pulled, relaxed, tight};

/// Angles along which tests pull: course, bias and wale.
const ANGLES: [f64; 3] = [0.0, 0.6, FRAC_PI_2];

#[test]
fn a_tile_at_rest_bears_no_stress_along_its_periods() {
    for thick in [false, true] {
        let reference = relaxed(1, 1, thick);
        for angle in [0.0, FRAC_PI_2] {
            let (_, found) = pulled(&reference, angle, 0.0, Some(0.0));
            let (_, stretched) = pulled(&reference, angle, 0.02, None);
            assert!(found.stress.abs().max(found.stress_across.abs()) < 1e-6 * stretched.stress, "{found:?}");
            assert!(stretched.stress > 0.0 && stretched.stress_across.abs() < 1e-6 * stretched.stress);
        }
    }
}

#[test]
fn loops_that_lean_bear_shear_and_their_mirror_image_bears_the_opposite() {
    let (network, yarns, card) = knit_of(1, 1, true);
    let [left, right] = [1, 4].map(|seed| {
        let settings = TileSettings { seed, ..tight(&card) };
        let rest = relax_tile(&network, &yarns, &card, &settings);
        let reference = TileReference::new(&network, &yarns, &card, &settings, rest).unwrap();
        // Without stress along the periods, stress on the bias is shear.
        pulled(&reference, FRAC_PI_4, 0.0, Some(0.0)).1
    });
    assert!((left.energy_density / right.energy_density - 1.0).abs() < 1e-9);
    assert!((left.stress - left.stress_across).abs() < 1e-6 * left.stress.abs(), "{left:?}");
    assert!(left.stress.abs() > 0.1 && (left.stress + right.stress).abs() < 1e-6 * left.stress.abs(), "{right:?}");
}

#[test]
fn stress_is_the_central_difference_of_the_energy() {
    for thick in [false, true] {
        let reference = relaxed(1, 1, thick);
        for angle in ANGLES {
            let (stretch, h) = (0.1, 2.5e-4);
            let (mut tile, free) = pulled(&reference, angle, stretch, None);
            tile.hold_compression(true);
            let held = tile.solve(stretch, free.compression).unwrap();
            assert!((held.stress - free.stress).abs() < 1e-9 * free.stress, "{angle}: {held:?} {free:?}");
            let [low, high] = [-h, h].map(|d| tile.solve(stretch + d, free.compression).unwrap().energy_density);
            let [lower, higher] =
                [-2.0 * h, 2.0 * h].map(|d| tile.solve(stretch + d, free.compression).unwrap().energy_density);
            let difference = (8.0 * (high - low) - (higher - lower)) / (12.0 * h);
            assert!((difference / free.stress - 1.0).abs() < 1e-5, "{angle}: {difference} {}", free.stress);
            let [narrow, wide] = [h, -h].map(|d| tile.solve(stretch, free.compression + d).unwrap().energy_density);
            assert!((narrow - wide).abs() / (2.0 * h) < 1e-3 * free.stress, "energy is least across");
        }
    }
}

#[test]
fn a_doubled_tile_bears_the_same() {
    let one = relaxed(1, 1, true);
    for (columns, rows) in [(2, 1), (1, 2)] {
        let more = relaxed(columns, rows, true);
        assert!((more.area() / one.area() - (columns * rows) as f64).abs() < 1e-5, "{:?}", more.periods());
        // Farther along the bias the doubled tile leaves for an equilibrium in which its loops differ.
        for (angle, stretch) in [(0.0, 0.12), (0.6, 0.03), (FRAC_PI_2, 0.12)] {
            let [(_, a), (_, b)] = [&one, &more].map(|reference| pulled(reference, angle, stretch, None));
            assert!((b.stress / a.stress - 1.0).abs() < 1e-5, "{angle}: {a:?} {b:?}");
            assert!((b.compression - a.compression).abs() < 1e-6);
        }
    }
}
