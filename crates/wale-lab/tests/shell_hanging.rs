//! Pieces of any outline, held anywhere, under their own weight.

use wale::energy::{BendingStiffness, MembraneStiffness};
use wale::fabric::coordinates::BLOCK;
use wale_lab::shell::polygon::mesh_polygon;
use wale_lab::shell::rest::come_to_rest;
use wale_lab::shell::{RestSettings, ShellCard, ShellError, ShellSystem, TriangleMesh};

const AREAL_MASS: f64 = 0.2;
const GRAVITY: f64 = 9.81;

fn card() -> ShellCard {
    let membrane =
        MembraneStiffness { xx: 200.0, xy: 20.0, yy: 150.0, ss: 30.0, n1: 2.0, n2: 4.0, ..MembraneStiffness::NONE };
    ShellCard { membrane, bending: BendingStiffness { weft: 4e-6, bias: 3e-6, warp: 2e-6 }, areal_mass: AREAL_MASS }
}

/// An L-shaped piece.
fn piece() -> TriangleMesh {
    let outline = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.04], [0.04, 0.04], [0.04, 0.1], [0.0, 0.1]];
    mesh_polygon(&outline, 0.008).unwrap()
}

#[test]
fn a_piece_held_along_one_side_hangs_by_its_weight() {
    let mesh = piece();
    let held: Vec<[bool; 3]> = mesh.points.iter().map(|[x, _]| [*x < 0.009; 3]).collect();
    let mut system = ShellSystem::new(&mesh, &card(), 0.3, [0.0, 0.0, -GRAVITY], &held).unwrap();
    let mut q = mesh.laid_flat();
    let report = come_to_rest(&mut system, &mut q, &RestSettings::default()).unwrap();
    assert!(report.residual <= 1e-9);
    system.linearise(&q, 0.0);
    // What holds it bears its whole weight, and nothing sideways.
    let of = |axis: usize| -> f64 {
        (0..mesh.points.len()).filter(|&v| held[v][axis]).map(|v| system.gradient()[BLOCK * v + axis]).sum()
    };
    let free: f64 = (0..mesh.points.len()).map(|v| system.gradient()[BLOCK * v + 2]).sum();
    let weight = AREAL_MASS * GRAVITY * mesh.areas().sum::<f64>();
    assert!((of(2) / weight - 1.0).abs() < 1e-6 && (free / weight - 1.0).abs() < 1e-6, "{} {weight}", of(2));
    assert!(of(0).abs() < 1e-6 * weight && of(1).abs() < 1e-6 * weight);
    let lowest = (0..mesh.points.len()).map(|v| q[BLOCK * v + 2]).fold(0.0, f64::min);
    assert!(lowest < -0.02, "{lowest}");
}

#[test]
fn a_piece_that_nothing_holds_is_an_error_and_no_panic() {
    let mesh = piece();
    let held = vec![[false; 3]; mesh.points.len()];
    let mut system = ShellSystem::new(&mesh, &card(), 0.0, [0.0, 0.0, -GRAVITY], &held).unwrap();
    let settings = RestSettings { max_iterations: 30, ..RestSettings::default() };
    let error = come_to_rest(&mut system, &mut mesh.laid_flat(), &settings).unwrap_err();
    assert!(matches!(error, ShellError::NotAtRest { .. }), "{error}");
}
