//! One yarn alone against what is known of rods and ropes: the whole chain of network, grips, steps and solver.

use glam::DVec3;
use wale::model::{Drive, Grip, Motion, Network, NodeId, PassId, PassKind, SegmentKind, Selection};
use wale::scene::Scene;
use wale::simulation::Simulation;

const BLOCK: usize = 5;
/// Length of the rods \[m\].
const LENGTH: f64 = 0.1;
/// Their bending stiffness \[N·m²\].
const EI: f64 = 1e-7;

/// A straight yarn along x from the origin, one node at each end of `segments` segments.
fn rod(segments: usize) -> Network {
    let mut network = Network { yarn_start: vec![0], ..Network::default() };
    let mut stacks = Vec::new();
    for k in 0..=segments {
        let x = LENGTH * k as f64 / segments as f64;
        network.position.push(DVec3::X * x);
        stacks.push(vec![PassId::new(k)]);
        network.pass_node.push(NodeId::new(k));
        network.pass_image.push([0, 0]);
        network.pass_kind.push(PassKind::Edge);
        network.pass_slides.push(false);
        network.segment_kind.push(SegmentKind::Edge);
        network.arc_length.push(x);
        network.chart_place.push([k as f64, 0.0]);
    }
    network.yarn_start.push(u32::try_from(segments + 1).unwrap());
    network.yarn_closure.push(None);
    network.yarn_color.push([200, 180, 160]);
    network.front = vec![DVec3::Z; segments + 1];
    network.chart_size = [1, u32::try_from(segments).unwrap()];
    network.set_stacks(&stacks);
    network
}

/// A scene whose yarn is the rod, hardly extensible; `change` makes the plan.
fn simulation(segments: usize, change: impl FnOnce(&mut Scene)) -> Simulation {
    let text = "schema = 1\n[fabric.chart]\npattern = \"garter\"\ncolumns = 4\nrows = 4\n[simulation]\ngravity = 0\nself_contact = false\nnewton_tolerance = 1e-6\nnewton_iterations = 100";
    let mut scene = Scene::from_text(text, "rod").unwrap();
    scene.yarn.bending_stiffness = EI;
    scene.yarn.stretch_stiffness = 1e7 * EI / (LENGTH * LENGTH);
    scene.yarn.linear_density = 1e-3 * scene.fabric.path_ratio;
    scene.yarn.mass_damping = 0.0;
    scene.yarn.stiffness_damping = 0.0;
    scene.plan.placement.center = DVec3::X * 0.5 * LENGTH;
    change(&mut scene);
    Simulation::new(rod(segments), &scene.yarn, &scene.fabric, scene.plan.clone())
}

fn grip(name: &str, from: f64, to: f64, drive: Drive) -> Grip {
    let margin = DVec3::new(1e-6, 1.0, 1.0);
    let nodes = Selection::Region { low: DVec3::X * from - margin, high: DVec3::X * to + margin };
    Grip { name: name.to_owned(), nodes, axes: [true; 3], drive, from: 0.0, until: None }
}

fn still() -> Drive {
    Drive::Follow(Motion::default())
}

fn place(simulation: &Simulation, node: usize) -> DVec3 {
    DVec3::from_slice(&simulation.state().coordinates[BLOCK * node..])
}

/// Steps through heavily damped time until nothing moves.
fn settle(simulation: &mut Simulation, time: f64) {
    while simulation.state().time < time {
        simulation.step().unwrap();
    }
}

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
