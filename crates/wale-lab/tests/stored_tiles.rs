//! Tiles of an independent simulator are read and come to rest. Skipped, and said so, where `../shared/data` is not there.

#[path = "../../wale/tests/shared/mod.rs"]
mod shared;

use shared::shared;
use wale::energy::ContactReading;
use wale_lab::yarn_tile::{
    CoarseDeformation, EquilibriumSettings, RestShapeSettings, RodMaterial, TileSolver, YarnTile, contact_radius,
    estimate_rest_shapes, read_pattern,
};

fn pattern(name: &str) -> Option<YarnTile> {
    let path = shared(&format!("yarn-tiles-madypg/{name}"))?;
    let text = std::fs::read_to_string(path).unwrap();
    Some(read_pattern(name, &text).unwrap_or_else(|error| panic!("{error}")))
}

#[test]
fn all_patterns_read_with_the_rest_lengths_of_their_edges() {
    // Drawn near their equilibrium: no edge is stretched by more than a tenth, so rest lengths stand with the right edges.
    for (name, vertices, yarns) in
        [("stocktiny.pyp", 13, 1), ("stockinette.pyp", 100, 2), ("basket.pyp", 80, 8), ("satin.pyp", 130, 10)]
    {
        let Some(tile) = pattern(name) else { return };
        assert_eq!((tile.vertex_count(), tile.yarn_count()), (vertices, yarns), "{name}");
        for (length, rest) in tile.lengths().iter().zip(&tile.rest().lengths) {
            assert!((length / rest - 1.0).abs() < 0.1, "{name}: {length} {rest}");
        }
        let radius = contact_radius(&tile) / tile.radius();
        assert!((0.5..2.0).contains(&radius), "{name}: {radius}");
    }
}

#[test]
fn stockinette_follows_a_path_of_strain() {
    let Some(tile) = pattern("stockinette.pyp") else { return };
    // As near to the contact of the simulator that stored it as this model comes.
    let material =
        RodMaterial { reading: ContactReading::Barrier, ..RodMaterial::solid_rod(tile.radius(), 1e6, 2.3e3) };
    let mut solver = TileSolver::free_compression(&tile, &material, EquilibriumSettings::default()).unwrap();
    let mut least = None;
    let (mut compression, mut last) = (0.0, f64::NEG_INFINITY);
    for step in 0..6 {
        let stretch = 0.04 * f64::from(step);
        let found = solver.solve(&CoarseDeformation::stretched(0.0, stretch, compression)).unwrap();
        assert!(found.converged, "{stretch}: {}", found.residual);
        assert!(found.stress.stretch > last, "{stretch}: stretching costs ever more");
        (compression, last) = (found.deformation.compression(), found.stress.stretch);
        println!("{stretch} {compression} {last}");
        least.get_or_insert(compression);
    }
    assert!(
        least.is_some_and(|least| compression > least),
        "what is stretched becomes narrower: {compression} {least:?}"
    );
}

#[test]
fn rest_shapes_take_most_of_the_stress_of_stockinette_away() {
    let Some(tile) = pattern("stockinette.pyp") else { return };
    // As [Sperl2022] has it: radii from the radius at which all edges touch.
    let radius = contact_radius(&tile);
    let material = RodMaterial { reading: ContactReading::Barrier, ..RodMaterial::solid_rod(radius, 1e6, 1e2) };
    let report = estimate_rest_shapes(&tile, &material, &RestShapeSettings::default()).unwrap();
    assert!(report.equilibrium.converged);
    // It falls to an eighth, and comes back a little as contacts open further.
    assert!(report.stress.iter().all(|&stress| stress < 0.45 * report.stress_before), "{:?}", report.stress);
    let least = report.stress.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(least < 0.2 * report.stress_before, "{:?}", report.stress);
    assert!(report.moved < 2.0 * radius, "{}", report.moved);
}
