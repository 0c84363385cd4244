use super::*;
use crate::fabric::PlaneMap;
use crate::pattern::weave::{self, Draft};
use crate::scene::Scene;

#[test]
fn threads_that_are_sheared_would_gather_in_groups_if_nothing_rubbed() {
    let text = "schema = 1\n[yarn]\nlinear_density = \"20 tex\"\ndiameter = \"0.16 mm\"\nstretch_stiffness = \"10 N\"\n\
        bending_stiffness = 1e-9\n[fabric.weave]\npattern = \"plain\"\nends = 2\npicks = 2\nend_spacing = \"0.5 mm\"\n\
        pick_spacing = \"0.5 mm\"\n";
    let scene = Scene::from_text(text, "scene.toml").unwrap();
    let (pitch, period) = (0.5e-3, 1e-3);
    let network = weave::tile(&Draft::plain(), [pitch; 2]).unwrap();
    // Sheared by 0.4 rad, its threads as long as they were: columns are periods.
    let shear = 0.4f64;
    let map =
        PlaneMap { base: [[period, period * shear.sin()], [0.0, period * shear.cos()]], rates: [[[0.0; 2]; 2]; 2] };
    let places: Vec<[f64; 2]> = network.position.iter().map(|x| [x.x / period, x.y / period]).collect();
    let coordinates = TileCoordinates::with_plane(&network, &places, &map);
    let mut system =
        TileSystem::with(&network, &scene.yarns, &scene.fabric, 0.0, coordinates, [true; 2], Contacts::default())
            .unwrap();
    let own = system.coordinates.own().clone();
    // The second pick goes along the warp, which slides through it, and to its side.
    let mut energy = |along: f64, aside: f64| {
        let mut unknowns = vec![0.0; own.len() + 2];
        for pass in 0..network.pass_count() {
            unknowns[own.slot(PassId::new(pass))] = network.arc_length[pass];
        }
        for crossing in network.crossings.iter().filter(|crossing| crossing.node.index() >= 2) {
            let place = BLOCK * crossing.node.index();
            unknowns[place] = pitch * (along * shear.sin() - aside * shear.cos());
            unknowns[place + 1] = pitch * (along * shear.cos() + aside * shear.sin());
            unknowns[own.slot(crossing.warp)] += pitch * along;
        }
        system.energy(&unknowns)
    };
    let even = energy(0.0, 0.0);
    assert!(even > 0.0 && (energy(0.3, 0.0) / even - 1.0).abs() < 1e-9, "a straight thread lies anywhere");
    assert!(energy(0.0, 0.04) > even && energy(0.0, -0.04) > even);
    let grouped = [-0.04, 0.04].map(|aside| energy(0.3, aside) / even - 1.0);
    assert!(grouped.iter().any(|&change| change < -0.01), "{grouped:?}");
}
