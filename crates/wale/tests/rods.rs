//! One yarn alone against what is known of rods and ropes: the whole chain of network, grips, steps and solver.

mod rod;

use glam::DVec3;
use rod::{BLOCK, EI, LENGTH, grip, place, settle, simulation, still};
use wale::dynamics::workspace::Workspace;
use wale::model::Drive;
use wale_numerics::block_matrix::BlockMatrix;
use wale_numerics::sparse_cholesky::{BlockOrder, SparseCholesky};

/// Segments of the rods of every case.
const SEGMENTS: [usize; 4] = [25, 50, 100, 200];

/// Orders of convergence between errors at these numbers of segments.
fn orders(errors: &[f64]) -> Vec<f64> {
    errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect()
}

/// Prints errors and their orders, and checks the last error and that all orders are about two.
fn check_second_order(name: &str, errors: &[f64], tolerance: f64) {
    let orders = orders(errors);
    println!("{name}: errors {errors:?}, orders {orders:.2?}");
    assert!(errors[errors.len() - 1] < tolerance, "{name}: {errors:?}");
    assert!(orders.iter().all(|&order| order >= 1.8), "{name}: {orders:?}");
}

#[test]
fn elastica() {
    // Cantilever with a dead load P at its tip: deflection w/L and shortening u/L by PL²/EI.
    for (alpha, deflection, shortening) in [
        (0.5, 0.162_143_58, 0.015_918_96),
        (1.0, 0.301_720_77, 0.056_433_24),
        (5.0, 0.713_791_52, 0.387_628_36),
        (10.0, 0.810_609_02, 0.554_995_60),
    ] {
        let errors = SEGMENTS.map(|segments| {
            let step = LENGTH / segments as f64;
            let free = LENGTH - 0.5 * step;
            let mut simulation = simulation(segments, |scene| {
                scene.yarns.first_mut().mass_damping = 5.0;
                scene.plan.simulation.largest_step = 0.5;
                scene.plan.simulation.frame_rate = 1.0;
                scene.plan.simulation.duration = 100.0;
                // The clamp is at the middle of the first segment: a discrete bend stands for half a segment to each
                // side, so that a rod held by two nodes begins half a segment after the first.
                let force = DVec3::Z * (alpha * EI / (free * free));
                scene.plan.grips = vec![
                    grip("clamp", 0.0, step, still()),
                    grip("load", LENGTH, LENGTH, Drive::Force { force, ramp: 0.5 }),
                ];
            });
            settle(&mut simulation, 40.0);
            let tip = place(&simulation, segments);
            let (w, u) = (tip.z / free, (LENGTH - tip.x) / free);
            (w / deflection - 1.0).abs().max((u / shortening - 1.0).abs())
        });
        check_second_order(&format!("elastica {alpha}"), &errors, 1e-3);
    }
}

/// Whether a straight rod along x is stable under compression: the exact matrix of the coordinates that are free at
/// their places is positive definite. `compression` gives the force in each segment \[N\].
fn is_stable(segments: usize, compression: &dyn Fn(usize) -> f64, free: &dyn Fn(usize) -> [bool; 3]) -> bool {
    let simulation = simulation(segments, |_| ());
    let system = simulation.system();
    let mut q = simulation.state().coordinates.clone();
    for k in 0..segments {
        let stretch_stiffness = 1e7 * EI / (LENGTH * LENGTH);
        q[BLOCK * (k + 1)] = q[BLOCK * k] + LENGTH / segments as f64 * (1.0 - compression(k) / stretch_stiffness);
    }
    let mut slots = vec![false; q.len()];
    for node in 0..=segments {
        slots[BLOCK * node..BLOCK * node + 3].copy_from_slice(&free(node));
    }
    let mut matrix = BlockMatrix::<f64>::zeros(system.pattern().clone());
    let mut gradient = vec![0.0; q.len()];
    system.linearise(&q, 0.0, &mut gradient, &mut matrix, &mut Workspace::default());
    let held = |(slot, g): (usize, &f64)| !slots[slot] || slot % BLOCK == 0 || g.abs() < 1e-12;
    assert!(gradient.iter().enumerate().all(held), "straight is an equilibrium");
    let mut cholesky = SparseCholesky::new(system.pattern().clone(), &slots, BlockOrder::MinimumDegree).unwrap();
    cholesky.factor(&matrix, 0.0).is_ok()
}

/// The load at which stability is lost, between 0 and twice the expected one.
fn critical(expected: f64, is_stable: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (0.0, 2.0 * expected);
    assert!(is_stable(low) && !is_stable(high));
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if is_stable(middle) { low = middle } else { high = middle }
    }
    low
}

#[test]
fn rods_lose_their_stability_at_the_known_loads() {
    use std::f64::consts::PI;
    // Held ends begin half a segment from the last free node (see `elastica`).
    let clamped = |free: [bool; 3], node: usize, last: usize, both: bool| {
        let end = node < 2 || both && node + 1 >= last;
        if node == 0 {
            [false; 3]
        } else if end {
            [true, false, false]
        } else {
            free
        }
    };
    let all = [true; 3];
    type Case<'a> = (&'a str, f64, f64, &'a dyn Fn(usize, usize) -> [bool; 3], bool);
    let cases: [Case; 4] = [
        (
            "pinned",
            PI * PI,
            0.0,
            &|node, last| {
                if node == 0 {
                    [false; 3]
                } else if node == last {
                    [true, false, false]
                } else {
                    all
                }
            },
            false,
        ),
        ("clamped", 4.0 * PI * PI, 1.0, &|node, last| clamped(all, node, last, true), false),
        ("cantilever", PI * PI / 4.0, 0.5, &|node, last| clamped(all, node, last, false), false),
        ("heavy column", 7.837_347, 0.5, &|node, last| clamped(all, node, last, false), true),
    ];
    for (name, expected, held, free, heavy) in cases {
        let errors = SEGMENTS.map(|segments| {
            let length = LENGTH * (1.0 - held / segments as f64);
            let unit = if heavy { EI / length.powi(3) } else { EI / (length * length) };
            // A column carries what is above the middle of each of its segments.
            let force = |load: f64, k: usize| {
                if heavy { load * (LENGTH - (k as f64 + 0.5) * LENGTH / segments as f64) } else { load }
            };
            let load = critical(expected * unit, |load| {
                is_stable(segments, &|k| force(load, k), &|node| free(node, segments))
            });
            (load / unit / expected - 1.0).abs()
        });
        check_second_order(name, &errors, 1e-2);
    }
}

#[test]
fn a_moment_rolls_a_rod_up_to_a_circle() {
    // A closed polygon needs nothing but the moment 2πEI/L at its ends: forces on the two last nodes at each.
    for segments in SEGMENTS {
        let (step, turn) = (LENGTH / segments as f64, std::f64::consts::TAU / segments as f64);
        let mut network = rod::rod(segments);
        let mut at = DVec3::ZERO;
        for (k, x) in network.position.iter_mut().enumerate() {
            *x = at;
            at += step * DVec3::new((turn * k as f64).cos(), 0.0, (turn * k as f64).sin());
        }
        assert!(network.position[segments].length() < 1e-12 * LENGTH, "the tip is back at the origin");
        let simulation = rod::yarns(network, |_| ());
        let q = &simulation.state().coordinates;
        let mut forces = vec![0.0; q.len()];
        simulation.system().gradient(q, &mut forces, &mut Workspace::default());
        let force = |node: usize| DVec3::from_slice(&forces[BLOCK * node..]);
        let moment = std::f64::consts::TAU * EI / LENGTH;
        for node in 2..segments - 1 {
            assert!(
                force(node).length() < 1e-9 * moment / step,
                "node {node} of {segments}: {:e}",
                force(node).length()
            );
        }
        for [inner, outer] in [[1, 0], [segments - 1, segments]] {
            let arm = place(&simulation, outer) - place(&simulation, inner);
            assert!((force(inner) + force(outer)).length() < 1e-9 * moment / step, "a pure moment");
            let share = arm.cross(force(outer)).length() / moment;
            assert!((share - 1.0).abs() < 1e-6, "{segments} segments: {share} of the moment");
        }
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
            scene.yarns.first_mut().mass_damping = 5.0;
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
    // Frequencies of a hanging chain, ω √(L/g); the bending stiffness is made negligible.
    for expected in [1.202_413, 2.760_039] {
        let errors = SEGMENTS.map(|segments| {
            let mut simulation = simulation(segments, |scene| {
                scene.yarns.first_mut().bending_stiffness = 1e-13;
                scene.plan.simulation.gravity = DVec3::X * 9.81;
                scene.plan.simulation.largest_step = 6e-2 / segments as f64 / expected;
                scene.plan.simulation.frame_rate = 1.0;
                scene.plan.simulation.duration = 10.0;
                scene.plan.grips = vec![grip("top", 0.0, 0.0, still())];
            });
            // A mode: J₀(2ω √(s/g)), s from the free end; given as a velocity.
            let omega = expected * (9.81 / LENGTH).sqrt();
            let bessel = |x: f64| {
                (1..30)
                    .fold((1.0, 1.0), |(sum, term), k| {
                        let term = -term * x * x / (4.0 * f64::from(k * k));
                        (sum + term, term)
                    })
                    .0
            };
            let mut state = simulation.state().clone();
            for k in 1..=segments {
                let s = LENGTH * (1.0 - k as f64 / segments as f64);
                state.velocities[BLOCK * k + 2] = 1e-3 * LENGTH * omega * bessel(2.0 * omega * (s / 9.81).sqrt());
            }
            assert!(simulation.restore(state));
            // Half a period later the tip comes back through the middle.
            let crossing = loop {
                let before = (simulation.state().time, place(&simulation, segments).z);
                simulation.step().unwrap();
                let after = (simulation.state().time, place(&simulation, segments).z);
                if before.1 > 0.0 && after.1 <= 0.0 {
                    break before.0 + (after.0 - before.0) * before.1 / (before.1 - after.1);
                }
                assert!(after.0 < 1.0, "it does not swing");
            };
            let measured = std::f64::consts::PI / crossing / (9.81 / LENGTH).sqrt();
            (measured / expected - 1.0).abs()
        });
        println!("chain {expected}: errors {errors:?}, orders {:.2?}", orders(&errors));
        assert!(errors[3] < 0.01, "{expected}: {errors:?}");
    }
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
            // A closed polygon of sides of the segments' length.
            let turn = std::f64::consts::TAU / segments as f64;
            let circumradius = 0.5 * step / (0.5 * turn).sin();
            let on_circle = |k: f64| {
                let angle = turn * k;
                DVec3::new(angle.sin(), 0.0, 1.0 - angle.cos()) * circumradius
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
                scene.yarns.first_mut().mass_damping = 5.0;
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
            let center = DVec3::Z * circumradius;
            let round = (0..=segments)
                .map(|k| (place(&simulation, k).distance(center) / radius - 1.0).abs())
                .fold(0.0, f64::max);
            println!("circle of {segments}: moment {:.5} of 1, out of round by {round:.1e} radii", moment / expected);
            (moment / expected - 1.0).abs().max(round)
        })
        .collect();
    check_second_order("circle", &errors, 1e-3);
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
                    // Steps shrink with the segments: both errors are of second order.
                    scene.plan.simulation.largest_step = 5e-4 / expected * 100.0 / segments as f64;
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
                    state.velocities[BLOCK * k + 2] = 1e-4 * LENGTH * mode(x) * expected * unit;
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
        check_second_order(&format!("clamped rod {expected}"), &errors, 0.01);
    }
}
