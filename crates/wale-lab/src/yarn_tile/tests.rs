//! What a tile in equilibrium must obey.

use wale::energy::{ContactPhase, ContactReading, Element};
use wale::pattern::weave::Draft;

use super::sticks::sticks;
use super::test_tiles::{basket, stockinette, straight};
use super::*;

/// A yarn of a millimetre's radius or so, soft enough that contact and bending both matter.
fn material(tile: &YarnTile) -> RodMaterial {
    RodMaterial { reading: ContactReading::Barrier, ..RodMaterial::solid_rod(tile.radius(), 1e6, 1e3) }
}

fn settings() -> EquilibriumSettings {
    EquilibriumSettings { tolerance: 1e-9, ..EquilibriumSettings::default() }
}

fn rest(solver: &mut TileSolver, deformation: &CoarseDeformation) -> TileEquilibrium {
    let found = solver.solve(deformation).unwrap();
    assert!(found.converged, "{} left after {}", found.residual, found.iterations);
    found
}

#[test]
fn straight_yarns_stretch_and_bend_as_closed_forms_say() {
    let tile = straight(10);
    let material = RodMaterial { stiff_stretch: 40.0, onset: 0.02, ..material(&tile) };
    let spacing = tile.periods()[1];
    let mut solver = TileSolver::new(&tile, &material, settings()).unwrap();
    // Yarns side by side at a distance: the tension of one over their spacing, in each phase.
    for (stretch, tension) in [(0.01, material.soft_stretch * 0.01), (0.05, material.soft_stretch * 0.02 + 40.0 * 0.03)]
    {
        let found = rest(&mut solver, &CoarseDeformation::stretched(0.0, stretch, 0.0));
        assert!((found.stress.stretch / (tension / spacing) - 1.0).abs() < 1e-9, "{:?}", found.stress);
        assert!(found.stress.compression.abs() < 1e-9 * found.stress.stretch);
    }
    let stiffness = bending_stiffness(&tile, &material, settings(), &CoarseDeformation::REST, 5.0).unwrap();
    assert!((stiffness / (material.bending / spacing) - 1.0).abs() < 1e-3, "{stiffness}");
}

#[test]
fn stress_at_the_border_is_the_slope_of_the_energy() {
    for tile in [stockinette(), basket()] {
        let material = material(&tile);
        for (angle, curvature) in [(0.0, 0.0), (0.7, 0.0), (1.2, 30.0)] {
            let mut solver = TileSolver::new(&tile, &material, settings()).unwrap();
            let (s, c, h) = (0.06, 0.03, 1e-4);
            let at = |s: f64, c: f64| CoarseDeformation::stretched(angle, s, c).bent(curvature);
            let stress = rest(&mut solver, &at(s, c)).stress;
            let mut density = |s: f64, c: f64| rest(&mut solver, &at(s, c)).energy_density;
            // Fourth order, so that the step may be long against round-off.
            let mut slope = |ds: f64, dc: f64| {
                let mut pair = |k: f64| density(s + k * ds, c + k * dc) - density(s - k * ds, c - k * dc);
                (8.0 * pair(1.0) - pair(2.0)) / (12.0 * h)
            };
            let expected = [slope(h, 0.0), slope(0.0, h)];
            let size = expected[0].hypot(expected[1]);
            let error = (stress.stretch - expected[0]).hypot(stress.compression - expected[1]) / size;
            assert!(error < 1e-5, "{angle} {curvature}: {stress:?} {expected:?}");
            assert!(stress.reaction[0].hypot(stress.reaction[1]) < 0.2 * size, "{stress:?}");
        }
    }
}

#[test]
fn doubling_a_tile_changes_neither_energy_nor_stress() {
    for tile in [stockinette(), basket()] {
        let material = material(&tile);
        let deformation = CoarseDeformation::stretched(0.4, 0.05, 0.02);
        let once = rest(&mut TileSolver::new(&tile, &material, settings()).unwrap(), &deformation);
        for counts in [[2, 1], [1, 2], [2, 2]] {
            let mut solver = TileSolver::new(&tile.repeated(counts).unwrap(), &material, settings()).unwrap();
            let twice = rest(&mut solver, &deformation);
            assert!((twice.energy_density / once.energy_density - 1.0).abs() < 1e-6, "{counts:?}");
            assert!((twice.stress.stretch / once.stress.stretch - 1.0).abs() < 1e-6, "{counts:?}");
            assert!((twice.stress.compression / once.stress.compression - 1.0).abs() < 1e-6, "{counts:?}");
        }
    }
}

#[test]
fn free_compression_is_that_of_least_energy() {
    for tile in [stockinette(), basket()] {
        let material = material(&tile);
        for angle in [0.0, std::f64::consts::FRAC_PI_4] {
            let start = CoarseDeformation::stretched(angle, 0.05, 0.0);
            let mut free = TileSolver::free_compression(&tile, &material, settings()).unwrap();
            let found = rest(&mut free, &start);
            let (c, scale) = (found.deformation.compression(), found.stress.stretch.abs());
            assert!((found.deformation.stretch() - 0.05).abs() < 1e-12);
            assert!(found.stress.compression.abs() < 1e-6 * scale, "{:?}", found.stress);
            let mut held = TileSolver::new(&tile, &material, settings()).unwrap();
            let mut density = |c: f64| rest(&mut held, &CoarseDeformation::stretched(angle, 0.05, c)).energy_density;
            let [less, least, more] = [c - 2e-3, c, c + 2e-3].map(&mut density);
            assert!(less > least && more > least, "{less} {least} {more}");
            // The parabola through the three has its bottom there.
            let bottom = 0.5 * 2e-3 * (less - more) / (less - 2.0 * least + more);
            assert!(bottom.abs() < 1e-4, "{bottom}");
            assert!((least / found.energy_density - 1.0).abs() < 1e-9);
        }
    }
}

#[test]
fn bending_stiffness_does_not_depend_on_how_much_is_bent() {
    for tile in [stockinette(), basket()] {
        let material = RodMaterial { reading: ContactReading::SquareOfBarrier, ..material(&tile) };
        let stiffness = [8.0, 4.0].map(|curvature| {
            bending_stiffness(&tile, &material, settings(), &CoarseDeformation::REST, curvature).unwrap()
        });
        assert!(stiffness[0] > 0.0 && (stiffness[0] / stiffness[1] - 1.0).abs() < 0.05, "{stiffness:?}");
    }
}

/// How often, and in which sense, yarns of a tile cross each other seen from above: what changes when one passes another.
fn crossings(tile: &YarnTile, found: &TileEquilibrium) -> Vec<i32> {
    let place = |vertex: u32, shift: [i32; 2]| {
        let [x, y, z] = tile.image(vertex, shift);
        let [x, y] = coarse::times(&found.deformation.plane, [x, y]);
        let u = found.displacement[vertex as usize];
        [x + u[0], y + u[1], z + u[2]]
    };
    let segment = |edge: usize, shift: [i32; 2]| {
        let e = tile.edges()[edge];
        [place(e.ends[0], shift), place(e.ends[1], [shift[0] + e.shift[0], shift[1] + e.shift[1]])]
    };
    let mut signs = Vec::new();
    for first in 0..tile.edges().len() {
        let mut sum = 0;
        for second in 0..tile.edges().len() {
            for i in -2..=2 {
                for j in -2..=2 {
                    let ([a, b], [c, d]) = (segment(first, [0, 0]), segment(second, [i, j]));
                    let ([ux, uy], [vx, vy]) = ([b[0] - a[0], b[1] - a[1]], [d[0] - c[0], d[1] - c[1]]);
                    let below = ux * vy - uy * vx;
                    let s = ((c[0] - a[0]) * vy - (c[1] - a[1]) * vx) / below;
                    let t = ((c[0] - a[0]) * uy - (c[1] - a[1]) * ux) / below;
                    if (0.0..1.0).contains(&s) && (0.0..1.0).contains(&t) {
                        let over = a[2] + s * (b[2] - a[2]) > c[2] + t * (d[2] - c[2]);
                        sum += if over { 1 } else { -1 };
                    }
                }
            }
        }
        signs.push(sum);
    }
    signs
}

#[test]
fn yarns_do_not_pass_through_each_other_when_squeezed() {
    let tile = basket();
    // No inner phase that is worth the name, and large steps of strain.
    let mut material = material(&tile);
    material.contact[1] = ContactPhase { radius: 0.05 * tile.radius(), stiffness: 1.0 };
    let mut solver = TileSolver::new(&tile, &material, EquilibriumSettings::default()).unwrap();
    let first = rest(&mut solver, &CoarseDeformation::REST);
    let count = |found: &TileEquilibrium| crossings(&tile, found).iter().filter(|&&sign| sign > 0).count();
    let above = count(&first);
    assert_eq!(above, 4, "each yarn crosses above the other twice");
    for stretch in [0.2, 0.5, 0.3, 0.0] {
        let found = solver.solve(&CoarseDeformation::stretched(0.0, stretch, 0.0)).unwrap();
        assert_eq!(count(&found), above, "{stretch}");
    }
}

#[test]
fn rest_shapes_take_the_stress_away() {
    for tile in [stockinette(), basket()] {
        let report = estimate_rest_shapes(&tile, &material(&tile), &RestShapeSettings::default()).unwrap();
        let last = *report.stress.last().unwrap();
        assert!(report.equilibrium.converged);
        assert!(last < 1e-2 * report.stress_before, "{} {:?}", report.stress_before, report.stress);
        for (rest, length) in report.tile.rest().lengths.iter().zip(tile.lengths()) {
            assert!((rest / length - 1.0).abs() < 0.2 + 1e-12);
        }
        assert!(report.moved < 2.0 * tile.radius());
    }
}

#[test]
fn the_contact_radius_is_the_least_with_which_all_edges_touch() {
    // Warp and weft lie 1.9 radii apart where they cross; edges between crossings are farther from each other.
    let tile = basket();
    let radius = contact_radius(&tile);
    let material = |radius: f64| {
        let contact = [ContactPhase { radius, stiffness: 1.0 }; 2];
        RodMaterial { contact, ..material(&tile) }
    };
    // Not every edge has a force with a little less, every one has with a little more: looked at from segment to segment.
    let touching = |radius: f64| {
        let followers = neighbours::Followers::new(&tile, std::f64::consts::PI * tile.radius());
        let pairs = neighbours::near_pairs(
            &tile,
            &CoarseDeformation::REST,
            tile.vertices(),
            &followers,
            material(radius).reach(),
        );
        (0..tile.edges().len() as u32).all(|edge| pairs.iter().any(|p| p.first == edge || p.second == edge))
    };
    assert!(!touching(0.999 * radius) && touching(1.001 * radius), "{radius}");
}

#[test]
fn the_same_bits_on_any_number_of_threads() {
    let tile = stockinette();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut solver = TileSolver::free_compression(&tile, &material(&tile), settings()).unwrap();
            rest(&mut solver, &CoarseDeformation::stretched(0.2, 0.04, 0.0))
        })
    };
    assert_eq!(run(1), run(2));
}

#[test]
fn impossible_materials_are_errors() {
    let tile = straight(4);
    let good = material(&tile);
    let with_radius = |radius: f64| RodMaterial { contact: [ContactPhase { radius, stiffness: 1.0 }; 2], ..good };
    for material in [
        RodMaterial { soft_stretch: 0.0, ..good },
        RodMaterial { bending: f64::NAN, ..good },
        RodMaterial { onset: -0.1, ..good },
        with_radius(0.0),
        with_radius(1.0),
        with_radius(f64::NAN),
    ] {
        let error = TileSolver::new(&tile, &material, settings()).expect_err("no material");
        assert!(matches!(error, TileError::Material { .. }), "{error}");
    }
}

#[test]
fn impossible_deformations_are_errors() {
    let tile = straight(4);
    let mut solver = TileSolver::new(&tile, &material(&tile), settings()).unwrap();
    for deformation in [
        CoarseDeformation::stretched(0.0, -1.5, 0.0),
        CoarseDeformation::stretched(0.0, f64::NAN, 0.0),
        CoarseDeformation::REST.bent(f64::INFINITY),
    ] {
        assert!(matches!(solver.solve(&deformation), Err(TileError::Deformation { .. })));
    }
    assert!(solver.solve(&CoarseDeformation::REST).is_ok());
}

#[test]
fn slopes_by_the_material_are_those_of_differences() {
    // Yarns slide along themselves at next to no cost: where they stop is only as sharp as the tolerance over that.
    let sharp = EquilibriumSettings { tolerance: 1e-13, anchor: 1e-2, ..settings() };
    // The straight yarns of the weave, symmetric as they are drawn, balance on a ridge at large stretch.
    for (tile, stretch) in [(stockinette(), 0.08), (basket(), 0.02)] {
        let base = material(&tile);
        let holding = base.bending / tile.radius().powi(4) * 1e-2;
        let material = RodMaterial { stiff_stretch: 3.0 * base.soft_stretch, onset: 1e-3, holding, ..base };
        for (free, angle) in [(false, 0.0), (false, 0.7), (true, 0.0), (true, 0.7)] {
            let deformation = CoarseDeformation::stretched(angle, stretch, 0.02);
            let make = if free { TileSolver::free_compression } else { TileSolver::new };
            let mut solver = make(&tile, &material, sharp).unwrap();
            let at = rest(&mut solver, &deformation);
            let slopes = solver.slopes().unwrap();
            assert!(slopes.stable);
            let values = material.parameters();
            for k in 0..RodParameter::COUNT {
                let near = |factor: f64| {
                    let mut changed = values;
                    changed[k] *= factor;
                    let mut solver = make(&tile, &material.with_parameters(changed), sharp).unwrap();
                    solver.place(&at.deformation, &at.displacement).unwrap();
                    let found = rest(&mut solver, &at.deformation);
                    [found.stress.stretch, found.deformation.compression()]
                };
                let h = 1e-4;
                let (up, down) = (near(1.0 + h), near(1.0 - h));
                let name = RodParameter::NAMES[k];
                for (i, slope) in [slopes.stress[k], slopes.compression[k]].into_iter().enumerate() {
                    let (expected, found) = ((up[i] - down[i]) / (2.0 * h), slope * values[k]);
                    let size = if i == 0 { at.stress.stretch.abs() } else { 0.02 };
                    assert!(
                        (expected - found).abs() < 1e-3 * found.abs() + 2e-5 * size,
                        "{name} {free} {angle} {i}: {found} {expected}"
                    );
                }
                assert!(slopes.stress[k] != 0.0, "{name}");
            }
        }
    }
}

#[test]
fn yarns_stick_where_they_touch() {
    // The harder they stick the less they slide along each other in a stretched tile, and the more force that takes; the drawn tile is at rest.
    let tile = stockinette();
    let deformation = CoarseDeformation::stretched(0.0, 0.1, 0.0);
    let unit = sticks(&tile, &RodMaterial { holding: 1.0, ..material(&tile) });
    assert!(unit.elements.len() > 20, "{}", unit.elements.len());
    let slid = |solver: &TileSolver| -> f64 {
        let places = unit.elements.iter().zip(&unit.stencils);
        places
            .map(|(element, stencil)| element.gradient(&solver.system.frame(&solver.displacement).positions(stencil)).0)
            .sum()
    };
    let pulled = |holding: f64| {
        let material = RodMaterial { holding, ..material(&tile) };
        let mut solver = TileSolver::new(&tile, &material, settings()).unwrap();
        assert!(slid(&solver) < 1e-20);
        let found = rest(&mut solver, &deformation);
        (slid(&solver), found.stress.stretch)
    };
    let stiffness = material(&tile).bending / tile.radius().powi(4);
    let all = [0.0, 1e-2 * stiffness, stiffness, 1e3 * stiffness].map(pulled);
    assert!(all.windows(2).all(|pair| pair[1].0 < pair[0].0 && pair[1].1 > pair[0].1), "{all:?}");
    // What is left is what an even stretch asks of yarns that touch in several places.
    assert!(all[3].0 < 0.1 * all[0].0, "{all:?}");
}

#[test]
fn slopes_of_bending_stiffness_are_those_of_differences() {
    let tile = stockinette();
    let base = material(&tile);
    let holding = base.bending / tile.radius().powi(4) * 1e-1;
    let material = RodMaterial { stiff_stretch: 3.0 * base.soft_stretch, onset: 1e-3, holding, ..base };
    let sharp = EquilibriumSettings { tolerance: 1e-12, anchor: 1e-2, ..settings() };
    let at = |material: &RodMaterial| bending_answer(&tile, material, sharp, &CoarseDeformation::REST, 10.0).unwrap();
    let found = at(&material);
    let plain = bending_stiffness(&tile, &material, sharp, &CoarseDeformation::REST, 10.0).unwrap();
    assert!((found.stiffness / plain - 1.0).abs() < 1e-6);
    for k in 0..RodParameter::COUNT {
        let near = |factor: f64| {
            let mut changed = material.parameters();
            changed[k] *= factor;
            at(&material.with_parameters(changed)).stiffness
        };
        let (expected, slope) = ((near(1.001) - near(0.999)) / 2e-3, found.slope[k] * material.parameters()[k]);
        let name = RodParameter::NAMES[k];
        assert!((expected - slope).abs() < 2e-2 * slope.abs() + 1e-4 * found.stiffness, "{name}: {slope} {expected}");
    }
}

#[test]
fn woven_yarns_that_are_pulled_straight_do_not_zigzag() {
    // Were only sizes of curvatures compared, these would be no minima, and the shaken tile would have 7 to 23 % less stress.
    let radius = 0.25e-3;
    let drawn = tile_of_draft(&Draft::plain(), radius, [1.1e-3, 1.2e-3], [2.0 * radius; 2]).unwrap();
    let touching = contact_radius(&drawn);
    let rod = RodMaterial { reading: ContactReading::Barrier, ..RodMaterial::solid_rod(touching, 1.0, 0.0) };
    let bending = 0.5 * 25.0 * touching * touching;
    let holding = 0.004 * bending / touching.powi(4);
    let material = rod.with_parameters([8.0, 100.0, 0.05, bending, 1.05 * touching, 5.0 / touching, holding]);
    let rests =
        RestShapeSettings { early_rounds: 0, growing_rounds: 8, late_rounds: 10, ..RestShapeSettings::default() };
    let tile = estimate_rest_shapes(&drawn, &material, &rests).unwrap().tile;
    let mut solver = TileSolver::free_compression(&tile, &material, settings()).unwrap();
    for percent in [1.0, 2.0, 3.0] {
        let found = rest(&mut solver, &CoarseDeformation::stretched(0.0, 0.01 * percent, 0.0));
        assert!(solver.slopes().unwrap().stable, "{percent} %");
        let shaken: Vec<[f64; 3]> = (0u32..)
            .zip(&found.displacement)
            .map(|(k, u)| std::array::from_fn(|i| u[i] + 1e-6 * (f64::from(7 * k) + 2.3 * i as f64).sin()))
            .collect();
        let mut other = TileSolver::free_compression(&tile, &material, settings()).unwrap();
        other.place(&found.deformation, &shaken).unwrap();
        let again = rest(&mut other, &found.deformation);
        assert!((again.stress.stretch / found.stress.stretch - 1.0).abs() < 1e-6, "{percent} %: {again:?}");
    }
}
