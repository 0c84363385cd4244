//! Slopes against differences.

use wale::dynamics::stretched_tile::{StretchedEquilibrium, TileReference};
use wale::dynamics::tile_equilibrium::relax_tile_from;
use wale::dynamics::tile_stiffness::TileStiffness;

use super::{knit_of, pulled, relaxed, tight};

const P: usize = TileStiffness::COUNT;

/// The tile with one stiffness changed by a factor, relaxed again or not.
fn changed(reference: &TileReference, thick: bool, k: usize, factor: f64, again: bool) -> TileReference {
    let (network, yarns, card) = knit_of(1, 1, thick);
    let settings = tight(&card);
    let mut stiffness = TileStiffness::of(&network, &yarns, &(&card).into());
    stiffness[k] *= factor;
    let (yarns, card) = TileStiffness::with(&network, &yarns, &(&card).into(), stiffness);
    let rest = if again {
        relax_tile_from(&network, &yarns, &card, &settings, reference.rest().coordinates.clone())
    } else {
        reference.rest().clone()
    };
    TileReference::new(&network, &yarns, &card, &settings, rest).unwrap()
}

/// Stress and compression where a stiffness is changed to both sides, and so their slope by its logarithm.
fn difference(run: impl Fn(f64) -> StretchedEquilibrium, h: f64) -> [f64; 2] {
    let [low, high] = [(-h).exp(), h.exp()].map(run);
    [(high.stress - low.stress) / (2.0 * h), (high.compression - low.compression) / (2.0 * h)]
}

#[test]
fn slopes_are_differences_with_the_relaxed_tile_held_and_found_again() {
    for (thick, angle) in [(false, 0.0), (false, 0.6), (true, 0.6)] {
        let reference = relaxed(1, 1, thick);
        let (mut tile, found) = pulled(&reference, angle, 0.1, None);
        let size = reference.size_slopes().unwrap();
        let stiffness = reference.stiffness();
        for again in [false, true] {
            let slopes = tile.slopes(again.then_some(&size)).unwrap();
            assert!(slopes.stable);
            for k in (0..P).filter(|&k| stiffness[k] > 0.0) {
                let run = |factor| pulled(&changed(&reference, thick, k, factor, again), angle, 0.1, None).1;
                let [stress, compression] = difference(run, 1e-3);
                let [by_stress, by_compression] =
                    [slopes.stress[k], slopes.compression[k]].map(|slope| slope * stiffness[k]);
                let name = TileStiffness::all(&(&knit_of(1, 1, thick).2).into())[k].name();
                assert!(
                    (by_stress - stress).abs() < 1e-5 * found.stress,
                    "{name} {again} {angle}: {by_stress} {stress} of {}",
                    found.stress
                );
                assert!(
                    (by_compression - compression).abs() < 1e-5 * found.compression.abs().max(0.01),
                    "{name} {again} {angle}: {by_compression} {compression} of {}",
                    found.compression
                );
            }
        }
    }
}

#[test]
fn twice_the_stiffness_is_twice_the_stress() {
    // Euler: the energy is linear in all stiffnesses, so that the sum of all logarithmic slopes is the stress itself.
    let reference = relaxed(1, 1, true);
    let (mut tile, found) = pulled(&reference, 0.6, 0.1, None);
    let size = reference.size_slopes().unwrap();
    let slopes = tile.slopes(Some(&size)).unwrap();
    let sum = |slopes: [f64; P]| slopes.iter().zip(reference.stiffness()).map(|(d, p)| d * p).sum::<f64>();
    assert!((sum(slopes.stress) - found.stress).abs() < 1e-6 * found.stress);
    assert!(sum(slopes.compression).abs() < 1e-6);
    assert!(size.iter().all(|&row| sum(row).abs() < 1e-6));
}
