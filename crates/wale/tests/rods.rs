//! One yarn alone against what is known of rods and ropes: the whole chain of network, grips, steps and solver.

mod rod;

use glam::DVec3;
use rod::{BLOCK, EI, LENGTH, grip, place, settle, simulation, still};
use wale::model::Drive;

#[test]
fn elastica() {
    // Cantilever with a dead load P at its tip: deflection w/L and shortening u/L by PL²/EI.
    for (alpha, deflection, shortening) in [(1.0, 0.301_720_77, 0.056_433_24), (5.0, 0.713_791_52, 0.387_628_36)] {
        let error = |segments: usize| {
            let step = LENGTH / segments as f64;
            let mut simulation = simulation(segments, |scene| {
                scene.yarn.mass_damping = 5.0;
                scene.plan.simulation.largest_step = 0.05;
                scene.plan.simulation.frame_rate = 1.0;
                scene.plan.simulation.duration = 100.0;
                // The clamp is at the middle of the first segment: a discrete bend stands for half a segment to each
                // side, so that a rod held by two nodes begins half a segment after the first.
                scene.plan.grips = vec![
                    grip("clamp", 0.0, step, still()),
                    grip(
                        "load",
                        LENGTH,
                        LENGTH,
                        Drive::Force { force: DVec3::Z * (alpha * EI / (LENGTH - 0.5 * step).powi(2)), ramp: 0.5 },
                    ),
                ];
            });
            settle(&mut simulation, 20.0);
            let free = LENGTH - 0.5 * step;
            let tip = place(&simulation, segments);
            let (w, u) = (tip.z / free, (LENGTH - tip.x) / free);
            println!("elastica {alpha} in {segments}: w/L {w:.5} of {deflection:.5}, u/L {u:.5} of {shortening:.5}");
            (w / deflection - 1.0).abs().max((u / shortening - 1.0).abs())
        };
        let (coarse, fine) = (error(20), error(40));
        assert!(fine < 1e-3, "{alpha}: {fine}");
        assert!(coarse / fine > 3.0, "second order: {coarse} {fine}");
    }
}

#[test]
fn a_rod_buckles_at_euler_s_load() {
    // A cantilever pushed along itself with a hair of side load: nearly straight below π²EI/4L², far out above it.
    let sideways = |share: f64| {
        let segments = 40;
        let step = LENGTH / segments as f64;
        let free = LENGTH - 0.5 * step;
        let critical = std::f64::consts::PI.powi(2) * EI / (4.0 * free * free);
        let mut simulation = simulation(segments, |scene| {
            scene.yarn.mass_damping = 5.0;
            scene.plan.simulation.largest_step = 1.0;
            scene.plan.simulation.frame_rate = 1.0;
            scene.plan.simulation.duration = 2000.0;
            let force = DVec3::new(-share * critical, 0.0, 1e-5 * critical);
            scene.plan.grips = vec![
                grip("clamp", 0.0, step, still()),
                grip("load", LENGTH, LENGTH, Drive::Force { force, ramp: 0.5 }),
            ];
        });
        settle(&mut simulation, 1000.0);
        place(&simulation, segments).z / LENGTH
    };
    let (below, above) = (sideways(0.99), sideways(1.01));
    println!("sideways: {below:.4} below, {above:.4} above the critical load");
    assert!(below < 0.01 && above > 0.1);
}

#[test]
fn a_chain_hangs_and_swings_as_it_should() {
    // First frequency of a hanging chain: ω √(L/g) = 1.202413; the bending stiffness is made negligible.
    let segments = 60;
    let tilt = 0.01;
    let mut simulation = simulation(segments, |scene| {
        scene.yarn.bending_stiffness = 1e-13;
        scene.plan.simulation.gravity = DVec3::X * 9.81;
        scene.plan.simulation.largest_step = 2e-4;
        scene.plan.simulation.frame_rate = 1.0;
        scene.plan.simulation.duration = 10.0;
        scene.plan.grips = vec![grip("top", 0.0, 0.0, still())];
    });
    // First mode: J₀(2ω √(s/g)), s from the free end; given as a velocity.
    let omega = 1.202_413 * (9.81 / LENGTH).sqrt();
    let bessel = |x: f64| {
        (1..20)
            .fold((1.0, 1.0), |(sum, term), k| {
                let term = -term * x * x / (4.0 * f64::from(k * k));
                (sum + term, term)
            })
            .0
    };
    let mut state = simulation.state().clone();
    for k in 1..=segments {
        let s = LENGTH * (1.0 - k as f64 / segments as f64);
        state.velocities[BLOCK * k + 2] = tilt * LENGTH * omega * bessel(2.0 * omega * (s / 9.81).sqrt());
    }
    assert!(simulation.restore(state));
    // Half a period later the tip comes back through the middle.
    let mut crossing = None;
    while crossing.is_none() {
        let before = (simulation.state().time, place(&simulation, segments).z);
        simulation.step().unwrap();
        let after = (simulation.state().time, place(&simulation, segments).z);
        if before.1 > 0.0 && after.1 <= 0.0 {
            crossing = Some(before.0 + (after.0 - before.0) * before.1 / (before.1 - after.1));
        }
        assert!(after.0 < 1.0, "it does not swing");
    }
    let measured = std::f64::consts::PI / crossing.unwrap() / (9.81 / LENGTH).sqrt();
    println!("hanging chain: {measured:.5} of 1.20241");
    assert!((measured / 1.202_413 - 1.0).abs() < 0.01);
}

/// Orders of convergence between errors at 25, 50, 100 and 200 segments.
fn orders(errors: &[f64]) -> Vec<f64> {
    errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect()
}

#[test]
fn bends_of_a_circle_hold_the_moment_of_a_rod() {
    // A rod laid into a closed circle with both ends clamped, disturbed, and left to settle: it is the circle that an end
    // moment of 2πEI/L would roll it up to, and its clamps hold that moment.
    let errors: Vec<f64> = [25, 50, 100, 200]
        .into_iter()
        .map(|segments| {
            let step = LENGTH / segments as f64;
            let radius = LENGTH / std::f64::consts::TAU;
            let on_circle = |k: f64| {
                let angle = std::f64::consts::TAU * (k - 0.5) / (segments as f64 - 1.0);
                DVec3::new(angle.sin(), 0.0, 1.0 - angle.cos()) * radius
            };
            let mut network = rod::rod(segments);
            for (k, x) in network.position.iter_mut().enumerate() {
                *x = on_circle(k as f64);
                // Bumps, away from the clamps.
                if k > 1 && k + 2 < network.arc_length.len() {
                    *x += DVec3::new(0.0, 0.0, 0.002 * (9.0 * k as f64 * step / LENGTH).sin());
                }
            }
            let places = network.position.clone();
            let mut simulation = rod::yarns(network, |scene| {
                scene.yarn.mass_damping = 5.0;
                scene.plan.simulation.largest_step = 0.05;
                scene.plan.simulation.frame_rate = 1.0;
                scene.plan.simulation.duration = 100.0;
                let clamp = |name: &str, ends: [usize; 2]| {
                    let mut clamp = grip(name, 0.0, 0.0, still());
                    let (a, b) = (places[ends[0]], places[ends[1]]);
                    let margin = DVec3::splat(1e-7);
                    clamp.nodes = wale::model::Selection::Region { low: a.min(b) - margin, high: a.max(b) + margin };
                    clamp
                };
                scene.plan.grips = vec![clamp("first", [0, 1]), clamp("last", [segments - 1, segments])];
            });
            settle(&mut simulation, 20.0);
            // Bends hold k_b θ/Δu times two: the middle of the rod, far from the clamps.
            let middle = segments / 2;
            let (a, b) = (
                place(&simulation, middle) - place(&simulation, middle - 1),
                place(&simulation, middle + 1) - place(&simulation, middle),
            );
            let moment = EI * a.angle_between(b) / step;
            let expected = std::f64::consts::TAU * EI / LENGTH;
            let center = DVec3::Z * radius;
            let round = (0..=segments)
                .map(|k| (place(&simulation, k).distance(center) / radius - 1.0).abs())
                .fold(0.0, f64::max);
            println!("circle of {segments}: moment {:.5} of 1, out of round by {round:.1e} radii", moment / expected);
            (moment / expected - 1.0).abs().max(round)
        })
        .collect();
    println!("orders {:?}", orders(&errors));
    assert!(errors[3] < 1e-2);
}

#[test]
fn a_clamped_rod_swings_at_its_two_first_frequencies() {
    for (beta, expected) in [(1.875_104_07_f64, 3.516_015), (4.694_091_13, 22.034_492)] {
        let errors: Vec<f64> = [25, 50, 100, 200]
            .into_iter()
            .map(|segments| {
                let step = LENGTH / segments as f64;
                let free = LENGTH - 0.5 * step;
                let unit = (EI / (rod::DENSITY * free.powi(4))).sqrt();
                let mut simulation = simulation(segments, |scene| {
                    scene.plan.simulation.largest_step = 5e-4 / expected;
                    scene.plan.simulation.frame_rate = 1e-3;
                    scene.plan.simulation.duration = 1e3;
                    scene.plan.grips = vec![grip("clamp", 0.0, step, still())];
                });
                // The mode's shape, given as a velocity.
                let share = (beta.cosh() + beta.cos()) / (beta.sinh() + beta.sin());
                let mode = |x: f64| {
                    let x = beta * x;
                    x.cosh() - x.cos() - share * (x.sinh() - x.sin())
                };
                let mut state = simulation.state().clone();
                for k in 2..=segments {
                    let x = (k as f64 - 0.5) * step / free;
                    state.velocities[BLOCK * k + 2] = 1e-3 * LENGTH * mode(x) * expected * unit;
                }
                assert!(simulation.restore(state));
                let outwards = mode(1.0).signum();
                let crossing = loop {
                    let before = (simulation.state().time, outwards * place(&simulation, segments).z);
                    simulation.step().unwrap();
                    let after = (simulation.state().time, outwards * place(&simulation, segments).z);
                    if before.1 > 0.0 && after.1 <= 0.0 {
                        break before.0 + (after.0 - before.0) * before.1 / (before.1 - after.1);
                    }
                    assert!(after.0 < 10.0, "it does not swing");
                };
                let measured = std::f64::consts::PI / crossing / unit;
                println!("clamped rod of {segments}: (βL)² {measured:.5} of {expected:.5}");
                (measured / expected - 1.0).abs()
            })
            .collect();
        println!("orders {:?}", orders(&errors));
        assert!(errors[3] < 0.01, "{errors:?}");
    }
}
