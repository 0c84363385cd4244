//! Woven fabrics against known answers.

mod shared;

use std::path::Path;

use glam::DVec3;
use shared::shared;
use wale::dynamics::system::System;
use wale::dynamics::workspace::Workspace;
use wale::measure::Census;
use wale::model::{Network, NodeId, SegmentKind, YarnId, YarnRole};
use wale::pattern::weave::read_wif;
use wale::scene::Scene;
use wale::simulation::{Simulation, Start};

/// A scene of a weave: what the weave says, then everything else.
fn scene(weave: &str, rest: &str) -> Scene {
    let text = format!(
        "schema = 1\n[yarn]\nlinear_density = \"20 tex\"\ndiameter = \"0.16 mm\"\nstretch_stiffness = \"10 N\"\n\
         bending_stiffness = 1e-9\nfriction = 0.3\n[fabric.weave]\n{weave}\n{rest}"
    );
    Scene::from_text(&text, "weave.toml").unwrap_or_else(|error| panic!("{error}"))
}

fn network(scene: &Scene) -> Network {
    Start::new(&scene.structure, &scene.yarns, &scene.fabric, false).network
}

fn energy(system: &System, network: &Network, positions: &[DVec3], kind: &str) -> f64 {
    let q = system.coordinates.gather(positions, &network.arc_length);
    let energies = system.energies(&q, &mut Workspace::default());
    energies.iter().find(|(name, _)| *name == kind).unwrap().1
}

#[test]
fn areal_mass_of_a_shirting() {
    // 24 × 24 /cm of 20 tex with 8 % crimp: 103.68 g/m².
    let scene = scene(
        "pattern = \"plain\"\nends = 50\npicks = 40\nend_count = \"24 /cm\"\npick_count = \"24 /cm\"\n\
         selvedge = \"cut\"\ncrimp = [0.08, 0.08]",
        "",
    );
    let census = Census::of(&network(&scene), &scene.yarns, &scene.fabric);
    let area = (50.0 / 2400.0) * (40.0 / 2400.0);
    assert!((1e3 * census.mass_kg / area - 103.68).abs() < 1e-9, "{census:?}");
    // What the simulation weighs is what the census says.
    let system = System::new(&network(&scene), &scene.yarns, &scene.fabric);
    assert!((system.mass() / census.mass_kg - 1.0).abs() < 1e-12);
}

#[test]
fn a_trellis_does_not_stretch() {
    let scene = scene(
        "pattern = \"twill 2/1\"\nends = 9\npicks = 7\nend_spacing = \"0.5 mm\"\npick_spacing = \"0.4 mm\"\n\
         selvedge = \"cut\"\nshear_stiffness = \"3 mN\"\nshear_jamming_angle = \"60 deg\"",
        "",
    );
    let network = network(&scene);
    let system = System::new(&network, &scene.yarns, &scene.fabric);
    for sheared in [0.1f64, 0.5, 1.0] {
        let warp = DVec3::new(sheared.sin(), sheared.cos(), 0.0);
        let positions: Vec<DVec3> = network.position.iter().map(|x| DVec3::X * x.x + warp * x.y).collect();
        assert!(energy(&system, &network, &positions, "stretch").abs() < 1e-20);
        assert!(energy(&system, &network, &positions, "bending").abs() < 1e-20);
        // ½ k_x p φ² of a crossing's four pairs; those at edges have two, at corners one.
        let pairs = 4.0 * (9.0 - 1.0) * (7.0 - 1.0);
        let expected = pairs / 4.0 * 0.5 * 3e-3 * 0.45e-3 * sheared * sheared;
        let shear = energy(&system, &network, &positions, "shear");
        assert!((shear / expected - 1.0).abs() < 1e-9, "{sheared}: {shear} {expected}");
    }
}

#[test]
fn pulled_along_the_warp_it_is_as_stiff_as_its_ends() {
    let scene = scene(
        "pattern = \"plain\"\nends = 8\npicks = 16\nend_spacing = \"0.5 mm\"\npick_spacing = \"0.5 mm\"\nselvedge = \"cut\"",
        "[simulation]\nduration = \"0.4 s\"\ngravity = [0, 0, 0]\nfriction = false\nlargest_step = \"10 ms\"\n\
         [[grip]]\nname = \"foot\"\nselect = { edge = \"bottom\" }\n\
         [[grip]]\nname = \"head\"\nselect = { edge = \"top\" }\n\
         motion = { keys = [{ time = 0, translation = [0, 0, 0] }, { time = 0.2, translation = [0, 7.5e-5, 0] }] }\n",
    );
    let mut simulation = Simulation::new(network(&scene), &scene.yarns, &scene.fabric, scene.plan.clone());
    let mut force = 0.0;
    while !simulation.finished() {
        force = simulation.step().unwrap().grips[1].force.y;
    }
    // 8 ends of 10 N, held at the ends of their fringes and free to slide: 75 µm over 16 picks of 0.5 mm.
    let expected = 8.0 * 10.0 * 75e-6 / (16.0 * 0.5e-3);
    assert!((force.abs() / expected - 1.0).abs() < 1e-6, "{force}");
}

/// Yarn between two crossings of a warp end is taken away: where it interlaces, its picks touch at Peirce's distance; where it floats,
/// they are pushed together under it, until a barrier keeps the yarn from vanishing.
#[test]
fn neighbours_touch_where_a_yarn_interlaces_and_not_under_a_float() {
    let scene = scene(
        "pattern = \"twill 2/2\"\nends = 8\npicks = 8\nend_spacing = \"0.5 mm\"\npick_spacing = \"0.5 mm\"\nselvedge = \"cut\"",
        "",
    );
    let card = scene.fabric.woven().unwrap();
    let (touching, vanishing) = (card.interlacing_spacing[0], card.float_spacing[0]);
    assert!(vanishing < 0.7 * touching && touching < 0.5e-3, "{card:?}");
    let network = network(&scene);
    let system = System::new(&network, &scene.yarns, &scene.fabric);
    let end = (0..network.yarn_count()).filter(|yarn| network.yarn_role[*yarn] == YarnRole::Warp).nth(3).unwrap();
    let passes = network.yarn_passes(YarnId::new(end));
    let spacing = |kind: SegmentKind, length: f64| {
        let mut inside = passes.clone().skip(2).take(passes.len() - 5);
        let first = inside.find(|pass| network.segment_kind[*pass] == kind).unwrap();
        // All that comes after it goes along, so that no other segment changes.
        let mut sliding = network.arc_length.clone();
        let by = sliding[first + 1] - sliding[first] - length;
        sliding[first + 1..passes.end].iter_mut().for_each(|u| *u -= by);
        let q = system.coordinates.gather(&network.position, &sliding);
        system.energies(&q, &mut Workspace::default()).iter().find(|(name, _)| *name == "spacing").unwrap().1
    };
    // −k d (x − 1)² ln x at half the distance, above what the free ends store.
    let at_rest = spacing(SegmentKind::Interlacing, 0.5e-3);
    let expected = |distance: f64| scene.fabric.spacing_stiffness() * distance * 0.25 * 2.0f64.ln();
    let stored = spacing(SegmentKind::Interlacing, 0.5 * touching) - at_rest;
    assert!((stored / expected(touching) - 1.0).abs() < 1e-9, "{stored}");
    assert_eq!(spacing(SegmentKind::Interlacing, 1.01 * touching), at_rest);
    assert_eq!(spacing(SegmentKind::Float, 0.75 * touching), at_rest, "nothing holds the picks under a float apart");
    let stored = spacing(SegmentKind::Float, 0.5 * vanishing) - at_rest;
    assert!((stored / expected(vanishing) - 1.0).abs() < 1e-9, "{stored}");
}

#[test]
fn a_strip_bends_as_its_warp_does() {
    // A cantilever of 60 picks under a small gravity: w L⁴/8 n EI.
    let (picks, pitch, gravity) = (60usize, 0.5e-3, 0.02);
    let scene = scene(
        &format!(
            "pattern = \"plain\"\nends = 6\npicks = {picks}\nend_spacing = {pitch}\npick_spacing = {pitch}\nselvedge = \"cut\""
        ),
        &format!(
            "[simulation]\nduration = \"3 s\"\ngravity = [0, 0, -{gravity}]\nfriction = false\nlargest_step = \"20 ms\"\n\
             [[grip]]\nname = \"clamp\"\nselect = {{ edge = \"bottom\", depth = 2 }}\n"
        ),
    );
    let mut scene = scene;
    scene.yarns.first_mut().mass_damping = 12.0;
    let start = network(&scene);
    let mut simulation = Simulation::new(start.clone(), &scene.yarns, &scene.fabric, scene.plan.clone());
    while !simulation.finished() {
        simulation.step().unwrap();
    }
    let tips = (0..start.node_count()).filter(|&node| {
        let pass = start.stack(NodeId::new(node))[0];
        let yarn = start.pass_yarn()[pass.index()].index();
        start.yarn_role[yarn] == YarnRole::Warp && start.position[node].y > (picks as f64 - 1.0) * pitch
    });
    let frame = simulation.frame();
    let tips: Vec<f64> = tips.map(|node| -frame.positions[node].z).collect();
    assert_eq!(tips.len(), 6);
    let sag = tips.iter().sum::<f64>() / 6.0;
    // From the middle of the clamped segment to the end of the fringe.
    let length = (picks as f64 - 1.0) * pitch;
    let width = 6.0 * pitch;
    let areal = simulation.system().mass() / (width * picks as f64 * pitch);
    let expected = areal * width * gravity * length.powi(4) / (8.0 * 6.0 * 1e-9);
    assert!(expected < 0.05 * length, "small: {expected}");
    assert!((sag / expected - 1.0).abs() < 0.03, "{sag} {expected}");
}

#[test]
fn different_yarns_have_their_own_mass_and_stiffness() {
    let scene = scene(
        "pattern = \"plain\"\nends = 5\npicks = 5\nend_spacing = \"0.6 mm\"\npick_spacing = \"0.6 mm\"\nselvedge = \"cut\"",
        "[yarns.weft]\nlinear_density = \"60 tex\"\ndiameter = \"0.28 mm\"\nstretch_stiffness = \"30 N\"\n",
    );
    let network = network(&scene);
    let census = Census::of(&network, &scene.yarns, &scene.fabric);
    let card = scene.fabric.woven().unwrap();
    let length = [0, 1].map(|k| 5.0 * 5.0 * 0.6e-3 * (1.0 + card.crimp[k]));
    for (k, tex) in [(0, 20e-6), (1, 60e-6)] {
        assert!((census.yarn_masses_kg[k] / (length[k] * tex) - 1.0).abs() < 1e-9, "{census:?}");
    }
    // Pulled by 1 %, the weft stores three times as much as the warp.
    let system = System::new(&network, &scene.yarns, &scene.fabric);
    let stretched = |by: DVec3| {
        let positions: Vec<DVec3> = network.position.iter().map(|x| *x * by).collect();
        energy(&system, &network, &positions, "stretch")
    };
    let (along_weft, along_warp) = (stretched(DVec3::new(1.01, 1.0, 1.0)), stretched(DVec3::new(1.0, 1.01, 1.0)));
    assert!((along_weft / along_warp - 3.0).abs() < 1e-9);
}

#[test]
fn collected_drafts_are_read() {
    let Some(folder) = shared("wif") else { return };
    let mut count = 0;
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path: &Path = &entry.unwrap().path();
        let bytes = std::fs::read(path).unwrap();
        count += 1;
        match read_wif(&bytes) {
            Ok(wif) => {
                let [warp, weft] = wif.draft.longest_floats();
                println!(
                    "{}: {} × {}, floats {warp} {weft}, {:?}",
                    path.display(),
                    wif.draft.ends(),
                    wif.draft.picks(),
                    wif.remarks
                );
            }
            Err(error) => panic!("{}: {error}", path.display()),
        }
    }
    assert_eq!(count, 10);
}

#[test]
fn a_fabric_that_has_lost_contacts_is_taken_up_to_the_same_bits() {
    let scene = scene(
        "pattern = \"plain\"\nends = 4\npicks = 4\nend_spacing = \"0.6 mm\"\npick_spacing = \"0.6 mm\"\nselvedge = \"cut\"",
        "[simulation]\nduration = \"1 s\"\ngravity = [0, 0, 0]\n\
         [[grip]]\nname = \"still\"\nselect = { edge = \"top\" }\n\
         [[grip]]\nname = \"pick\"\nselect = { yarn_end = { yarn = \"weft\", number = 1, end = \"last\" } }\n\
         motion = { velocity = [\"10 mm/s\", 0, 0] }\n",
    );
    let new = || Simulation::new(network(&scene), &scene.yarns, &scene.fabric, scene.plan.clone());
    let out = |simulation: &Simulation| simulation.network().pulled_out.iter().filter(|out| **out).count();
    let mut first = new();
    while out(&first) < 2 {
        first.step().unwrap();
        assert!(!first.finished(), "no contact was left");
    }
    let mut second = new();
    assert!(second.restore(first.state().clone()));
    assert_eq!(second.network().pulled_out, first.network().pulled_out);
    for _ in 0..20 {
        first.step().unwrap();
        second.step().unwrap();
    }
    assert_eq!(first.state(), second.state());
    // Back to where nothing had been pulled out yet.
    let untouched = new().state().clone();
    assert!(second.restore(untouched));
    assert_eq!(out(&second), 0);
}
