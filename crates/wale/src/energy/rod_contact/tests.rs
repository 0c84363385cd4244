//! Contact of rods: derivatives, known answers and what does not act.

use super::super::element::testing::{Random, check, check_blend};
use super::super::rigid_motion::check_rigid_motion;
use super::*;

const READINGS: [ContactReading; 3] =
    [ContactReading::SquareOfBarrier, ContactReading::Barrier, ContactReading::BarrierOfSquare];

fn element(reading: ContactReading) -> RodContact {
    let phases = [ContactPhase { radius: 0.5, stiffness: 2.0 }, ContactPhase { radius: 0.2, stiffness: 30.0 }];
    RodContact { phases, reading, rest_area: 0.7 }
}

/// Two edges that cross each other about so far apart.
fn crossing(random: &mut Random, apart: f64) -> [f64; 12] {
    let mut q = [-0.5, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, -0.5, apart, 0.0, 0.5, apart];
    q.iter_mut().for_each(|x| *x += 0.05 * random.next());
    q
}

#[test]
fn derivatives() {
    let mut random = Random::new(53);
    for reading in READINGS {
        for apart in [0.25, 0.35, 0.55, 0.7] {
            for _ in 0..5 {
                let q = crossing(&mut random, apart);
                check(&element(reading), &q, 0.02);
                check_blend(&element(reading), &q, 1e-9);
                check_rigid_motion(&element(reading), &q);
                let local = element(reading).convex(&q);
                let (energy, gradient) = element(reading).gradient(&q);
                let size = gradient.iter().fold(0.0f64, |m, g| m.max(g.abs()));
                assert!((energy - local.energy).abs() < 1e-14 * energy);
                assert!(gradient.iter().zip(&local.gradient).all(|(a, b)| (a - b).abs() < 1e-13 * size));
            }
        }
    }
}

#[test]
fn the_gradient_follows_the_outer_radius() {
    let mut random = Random::new(55);
    for reading in READINGS {
        for apart in [0.25, 0.5, 0.7] {
            let (q, element) = (crossing(&mut random, apart), element(reading));
            let at = |radius: f64| {
                let outer = ContactPhase { radius, ..element.phases[0] };
                RodContact { phases: [outer, element.phases[1]], ..element }.gradient(&q).1
            };
            let (up, down, slope) = (at(0.5 + 1e-6), at(0.5 - 1e-6), element.gradient_by_outer_radius(&q));
            let size = slope.iter().fold(0.0f64, |m, s| m.max(s.abs()));
            assert!(size > 0.0, "{reading:?} {apart}");
            let energy = |radius: f64| {
                let outer = ContactPhase { radius, ..element.phases[0] };
                RodContact { phases: [outer, element.phases[1]], ..element }.gradient(&q).0
            };
            let (expected, found) =
                ((energy(0.5 + 1e-6) - energy(0.5 - 1e-6)) / 2e-6, element.energy_by_outer_radius(&q));
            assert!((expected - found).abs() < 1e-6 * found.abs(), "{expected} {found}");
            assert!(slope.iter().enumerate().all(|(i, s)| ((up[i] - down[i]) / 2e-6 - s).abs() < 1e-5 * size));
        }
    }
}

#[test]
fn each_reading_has_its_known_answer() {
    // f(½) = ¼ ln 2; parallel edges at distance ½·2R, all points alike only for edges of no length.
    let ln2 = std::f64::consts::LN_2;
    let q = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.5];
    let expected = [(0.25 * ln2).powi(2), 0.25 * ln2, 0.5625 * (2.0 * ln2)];
    for (reading, expected) in READINGS.into_iter().zip(expected) {
        let energy = element(reading).energy(&q);
        assert!((energy - 2.0 * 0.7 * expected).abs() < 1e-14, "{reading:?} {energy}");
    }
}

#[test]
fn contacts_set_in_as_their_readings_say() {
    // The powers of 1 − x at the onset: halving it divides the energy by 2⁶, 2³, 2³.
    for (reading, power) in READINGS.into_iter().zip([6, 3, 3]) {
        let at = |over: f64| reading.profile(1.0 - over)[0];
        let ratio = at(2e-4) / at(1e-4);
        assert!((ratio / 2f64.powi(power) - 1.0).abs() < 1e-3, "{reading:?} {ratio}");
    }
}

#[test]
fn edges_out_of_reach_are_free_and_touching_centrelines_finite() {
    let far = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.1, 0.0, 1.0, 1.1, 0.0];
    let through = [-0.5, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, -0.5, 0.0, 0.0, 0.5, 0.0];
    for reading in READINGS {
        assert!(element(reading).energy(&far) == 0.0 && element(reading).gradient(&far).1 == [0.0; 12]);
        let mut local = Local::zero();
        element(reading).add_blended(&through, 0.0, &mut local);
        assert!(local.energy.is_finite() && local.energy > 0.0);
        assert!(local.gradient.iter().chain(local.hessian.iter().flatten()).all(|x| x.is_finite()));
        // The straight line goes on where the barrier ends.
        let (low, high) = (reading.profile(NEAREST * (1.0 - 1e-9)), reading.profile(NEAREST));
        assert!((low[0] / high[0] - 1.0).abs() < 1e-8 && low[1] == high[1]);
    }
}

#[test]
fn pairs_skipped_by_their_balls_have_no_energy() {
    let mut random = Random::new(54);
    let contact = element(ContactReading::Barrier);
    let (mut skipped, mut kept) = (0, 0);
    for _ in 0..2000 {
        let q: [f64; 12] = std::array::from_fn(|k| random.next() * if k < 6 { 1.0 } else { 2.0 });
        if Pair::new(&q, contact.reach()).apart() {
            skipped += 1;
            assert_eq!(contact.energy(&q), 0.0);
        } else {
            kept += 1;
        }
    }
    assert!(skipped > 50 && kept > 50, "{skipped} {kept}");
}
