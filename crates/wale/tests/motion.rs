//! What a moving fabric must do whatever it is knitted of.

use std::path::Path;

use glam::DVec3;
use wale::model::{Network, NodeId};
use wale::scene::Scene;
use wale::simulation::{Simulation, Start};

const BLOCK: usize = 5;

fn scene(text: &str) -> Scene {
    let text = format!("schema = 1\n[fabric.chart]\n{text}\n");
    Scene::from_text(&text, "test").unwrap()
}

fn simulation(scene: &Scene) -> Simulation {
    let start = Start::new(&scene.structure, &scene.yarns, &scene.fabric, true);
    Simulation::new(start.network, &scene.yarns, &scene.fabric, scene.plan.clone())
}

/// Angular momentum and moment of inertia about z, each node of mass one.
fn spin(simulation: &Simulation, network: &Network) -> (f64, f64) {
    let state = simulation.state();
    let nodes = network.node_count();
    let x = |k: usize| DVec3::from_slice(&state.coordinates[BLOCK * k..]);
    let v = |k: usize| DVec3::from_slice(&state.velocities[BLOCK * k..]);
    let middle = (0..nodes).map(x).sum::<DVec3>() / nodes as f64;
    let (mut momentum, mut inertia) = (0.0, 0.0);
    for k in 0..nodes {
        let r = x(k) - middle;
        momentum += r.cross(v(k)).z;
        inertia += r.x * r.x + r.y * r.y;
    }
    (momentum, inertia)
}

#[test]
fn a_turning_fabric_keeps_turning() {
    // A quarter of a turn at 20 rad/s, with the damping of the preset and without any.
    let spins = |damping: f64| {
        let mut scene =
            scene("pattern = \"garter\"\ncolumns = 8\nrows = 8\n[simulation]\ngravity = 0\nlargest_step = \"1 ms\"");
        scene.yarns.first_mut().stiffness_damping = damping;
        scene.yarns.first_mut().mass_damping = 0.0;
        let mut simulation = simulation(&scene);
        let network = simulation.network().clone();
        // The layout first finds its own shape: snaps of whole loops in a step are another matter.
        while simulation.state().time < 0.05 {
            simulation.step().unwrap();
        }
        let mut state = simulation.state().clone();
        state.velocities.fill(0.0);
        for k in 0..network.node_count() {
            let x = DVec3::from_slice(&state.coordinates[BLOCK * k..]);
            let v = DVec3::new(0.0, 0.0, 20.0).cross(x);
            state.velocities[BLOCK * k..BLOCK * k + 3].copy_from_slice(&v.to_array());
        }
        assert!(simulation.restore(state));
        let before = spin(&simulation, &network);
        while simulation.state().time < 0.05 + 0.08 {
            simulation.step().unwrap();
        }
        (before.0 / before.1, spin(&simulation, &network).0 / before.0)
    };
    let ((before, free), (_, damped)) = (spins(0.0), spins(0.05));
    println!(
        "of {before:.1} rad/s a quarter of a turn leaves {free:.3} undamped, {damped:.3} damped, in angular momentum"
    );
    assert!((before - 20.0).abs() < 1.0 && free > 0.85);
    assert!(damped > 0.99 * free, "damping takes the spin away: {free} {damped}");
}

#[test]
fn a_free_fabric_falls_as_a_stone() {
    let run = |gravity: f64| {
        let mut scene =
            scene("pattern = \"stockinette\"\ncolumns = 6\nrows = 6\n[simulation]\nlargest_step = \"1 ms\"");
        scene.yarns.first_mut().mass_damping = 0.0;
        // The layout first finds its own shape.
        scene.plan.simulation.gravity = DVec3::ZERO;
        let mut settled = simulation(&scene);
        while settled.state().time < 0.05 {
            settled.step().unwrap();
        }
        let mut state = settled.state().clone();
        state.velocities.fill(0.0);
        scene.plan.simulation.gravity = DVec3::new(0.0, 0.0, -gravity);
        let mut simulation = simulation(&scene);
        assert!(simulation.restore(state));
        let nodes = simulation.network().node_count();
        let mass = |s: &Simulation, k: usize| s.system().yarn_at(NodeId::new(k));
        let total: f64 = (0..nodes).map(|k| mass(&simulation, k)).sum();
        let height =
            |s: &Simulation| (0..nodes).map(|k| mass(s, k) * s.state().coordinates[BLOCK * k + 2]).sum::<f64>() / total;
        let before = height(&simulation);
        let mut expected = 0.0;
        let mut speed = 0.0;
        while simulation.state().time < 0.05 + 0.1 - 1e-9 {
            let h = simulation.step().unwrap().step_size;
            speed += gravity * h;
            expected += speed * h;
        }
        (before - height(&simulation), expected)
    };
    let ((drift, _), (fallen, expected)) = (run(0.0), run(9.81));
    println!("without weight {:.3} mm; fallen {:.3} mm of {:.3} mm", 1e3 * drift, 1e3 * fallen, 1e3 * expected);
    assert!(((fallen - drift) / expected - 1.0).abs() < 5e-4, "{fallen} {drift} {expected}");
}

#[test]
fn the_same_bits_on_any_number_of_threads() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/stockinette-curl.toml");
    let scene = Scene::read(&path).unwrap();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut simulation = simulation(&scene);
            for _ in 0..6 {
                simulation.step().unwrap();
            }
            simulation.state().clone()
        })
    };
    let one = run(1);
    for threads in [2, 4] {
        let other = run(threads);
        assert!(one.coordinates == other.coordinates && one.velocities == other.velocities, "{threads} threads");
        assert!(one.anchors == other.anchors);
    }
}

/// So many rows and columns of yarns with thick contacts, free and without weight.
fn thick(pattern: &str, size: u32, more: &str) -> Simulation {
    simulation(&scene(&format!(
        "pattern = \"{pattern}\"\ncolumns = {size}\nrows = {size}\n[fabric]\ncontacts = \"thick\"\n{more}\n[simulation]\ngravity = 0"
    )))
}

#[test]
fn thick_contacts_move_as_others_do() {
    let mut simulation = thick("rib 1x1", 6, "");
    while simulation.state().time < 0.1 {
        let report = simulation.step().unwrap();
        assert!(report.largest_stretch < 1.1, "{}", report.largest_stretch);
    }
    let report = simulation.step().unwrap();
    let of = |kind: &str| report.energies.iter().find(|(name, _)| *name == kind).map_or(0.0, |(_, energy)| *energy);
    assert!(of("stretch") > 0.0 && of("bending") > 0.0);
}

#[test]
fn thick_contacts_without_a_distance_stay_in_their_nodes() {
    let mut simulation = thick("garter", 4, "contact_distance = 0");
    while simulation.state().time < 0.02 {
        let report = simulation.step().unwrap();
        assert!(report.largest_stretch < 1.1 && report.energies.iter().all(|(_, energy)| energy.is_finite()));
    }
}
