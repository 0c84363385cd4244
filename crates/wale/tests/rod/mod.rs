//! Yarns of a test's own making, in a simulation like any other.
#![allow(dead_code)]

use glam::DVec3;
use wale::model::{Drive, Grip, Motion, Network, NodeId, PassId, PassKind, SegmentKind, Selection, YarnRole};
use wale::scene::Scene;
use wale::simulation::Simulation;

pub const BLOCK: usize = 5;
/// Length of the rods \[m\].
pub const LENGTH: f64 = 0.1;
/// Their bending stiffness \[N·m²\].
pub const EI: f64 = 1e-7;

/// Their mass a length \[kg/m\].
pub const DENSITY: f64 = 1e-3;

/// A straight yarn along x from the origin, one node at each end of `segments` segments.
pub fn rod(segments: usize) -> Network {
    let along: Vec<f64> = (0..=segments).map(|k| LENGTH * k as f64 / segments as f64).collect();
    let places = along.iter().map(|&x| DVec3::X * x).collect();
    network(places, &[Yarn { nodes: (0..=segments).collect(), arc_length: along, slides: vec![false; segments + 1] }])
}

/// A scene whose yarn is the rod, hardly extensible, without gravity and damping.
fn scene() -> Scene {
    let text = "schema = 1\n[fabric.chart]\npattern = \"garter\"\ncolumns = 4\nrows = 4\n[simulation]\ngravity = 0\nself_contact = false\nnewton_tolerance = 1e-6\nnewton_iterations = 100";
    let mut scene = Scene::from_text(text, "rod").unwrap();
    scene.yarns.first_mut().bending_stiffness = EI;
    scene.yarns.first_mut().stretch_stiffness = 1e7 * EI / (LENGTH * LENGTH);
    scene.yarns.first_mut().linear_density = DENSITY * scene.fabric.path_ratio(YarnRole::Knitted);
    scene.yarns.first_mut().mass_damping = 0.0;
    scene.yarns.first_mut().stiffness_damping = 0.0;
    scene
}

/// A straight rod; `change` makes the plan.
pub fn simulation(segments: usize, change: impl FnOnce(&mut Scene)) -> Simulation {
    yarns(rod(segments), change)
}

pub fn grip(name: &str, from: f64, to: f64, drive: Drive) -> Grip {
    let margin = DVec3::new(1e-6, 1.0, 1.0);
    let nodes = Selection::Region { low: DVec3::X * from - margin, high: DVec3::X * to + margin };
    Grip { name: name.to_owned(), nodes, axes: [true; 3], drive, from: 0.0, until: None }
}

pub fn still() -> Drive {
    Drive::Follow(Motion::default())
}

pub fn place(simulation: &Simulation, node: usize) -> DVec3 {
    DVec3::from_slice(&simulation.state().coordinates[BLOCK * node..])
}

/// Steps through heavily damped time until nothing moves.
pub fn settle(simulation: &mut Simulation, time: f64) {
    while simulation.state().time < time {
        simulation.step().unwrap();
    }
}

/// A yarn of one's own making.
pub struct Yarn {
    /// Node of each pass.
    pub nodes: Vec<usize>,
    /// Arc length of each pass \[m\].
    pub arc_length: Vec<f64>,
    /// Whether it slides there.
    pub slides: Vec<bool>,
}

/// A network of yarns over nodes at these places.
pub fn network(places: Vec<DVec3>, yarns: &[Yarn]) -> Network {
    let mut network = Network { yarn_start: vec![0], ..Network::default() };
    let mut stacks = vec![Vec::new(); places.len()];
    for yarn in yarns {
        for (k, &node) in yarn.nodes.iter().enumerate() {
            stacks[node].push(PassId::new(network.pass_node.len()));
            network.pass_node.push(NodeId::new(node));
            network.pass_image.push([0, 0]);
            network.pass_kind.push(PassKind::Edge);
            network.pass_slides.push(yarn.slides[k]);
            network.segment_kind.push(SegmentKind::Edge);
            network.segment_share.push(1);
            network.arc_length.push(yarn.arc_length[k]);
        }
        network.yarn_start.push(u32::try_from(network.pass_node.len()).unwrap());
        network.yarn_closure.push(None);
        network.yarn_kind.push(0);
        network.yarn_role.push(YarnRole::Knitted);
        network.yarn_color.push([200, 180, 160]);
    }
    network.chart_place = (0..places.len()).map(|k| [k as f64, 0.0]).collect();
    network.chart_size = [1, u32::try_from(places.len()).unwrap()];
    network.front = vec![DVec3::Z; places.len()];
    network.position = places;
    network.set_stacks(&stacks);
    network
}

/// The simulation of such a network at its own place, without gravity, damping, and contact of yarns with each other.
pub fn yarns(network: Network, change: impl FnOnce(&mut Scene)) -> Simulation {
    let mut scene = scene();
    let (low, high) = network
        .position
        .iter()
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
    scene.plan.placement.center = 0.5 * (low + high);
    change(&mut scene);
    Simulation::new(network, &scene.yarns, &scene.fabric, scene.plan.clone())
}
