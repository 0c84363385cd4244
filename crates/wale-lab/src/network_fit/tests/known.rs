//! Straight yarns, of which the answer is known, and stretches that cannot be.

use std::f64::consts::FRAC_PI_4;

use glam::DVec3;
use wale::dynamics::stretched_tile::{StretchError, TileReference};
use wale::dynamics::tile_equilibrium::{TileEquilibrium, TileSettings};
use wale::model::{LoopInfo, LoopProportions, Network, NodeId, PassId, PassKind, SegmentKind, YarnRole};

use super::{LOOP_LENGTH, knit_of, pulled, yarn};

/// Length and distance of the straight yarns \[m\].
const LENGTH: f64 = 4e-3;
const APART: f64 = 2.5e-3;

/// Straight yarns along x side by side, of two nodes each, that do not slide.
fn straight() -> TileReference {
    let network = Network {
        pass_node: vec![NodeId::new(0), NodeId::new(1)],
        pass_image: vec![[0; 2]; 2],
        pass_kind: vec![PassKind::Crossing; 2],
        pass_slides: vec![false; 2],
        segment_kind: vec![SegmentKind::Interlacing; 2],
        segment_share: vec![1; 2],
        arc_length: vec![0.0, 0.4 * LENGTH],
        yarn_start: vec![0, 2],
        yarn_closure: vec![Some(([1, 0], LENGTH))],
        yarn_color: vec![[0; 3]],
        yarn_kind: vec![0],
        yarn_role: vec![YarnRole::Knitted],
        stack_start: vec![0, 1, 2],
        stack_pass: vec![PassId::new(0), PassId::new(1)],
        position: vec![DVec3::ZERO, DVec3::X * (0.4 * LENGTH)],
        front: vec![DVec3::Z; 2],
        chart_place: vec![[0.0; 2]; 2],
        loops: Vec::<LoopInfo>::new(),
        chart_size: [1, 1],
        periods: Some([DVec3::X * LENGTH, DVec3::Y * APART]),
        ..Network::default()
    };
    let card = LoopProportions::default().card(&yarn(), LOOP_LENGTH);
    let mut coordinates = wale::fabric::TileCoordinates::new(&network).initial(&network);
    let n = coordinates.len();
    coordinates[n - 2..].copy_from_slice(&[LENGTH, APART]);
    let rest = TileEquilibrium {
        coordinates,
        wale_spacing: LENGTH,
        course_spacing: APART,
        energy: 0.0,
        iterations: 0,
        residual: 0.0,
        converged: true,
    };
    TileReference::new(&network, &yarn(), &card, &TileSettings::default(), rest).unwrap()
}

#[test]
fn straight_yarns_bear_what_a_bundle_of_springs_does() {
    let (reference, k) = (straight(), yarn().stretch_stiffness);
    let (_, along) = pulled(&reference, 0.0, 0.1, Some(0.0));
    assert!((along.stress - k * 0.1 / APART).abs() < 1e-6 * along.stress, "{along:?}");
    assert!(along.stress_across.abs() < 1e-9 * along.stress);
    let (_, across) = pulled(&reference, std::f64::consts::FRAC_PI_2, 0.1, Some(0.0));
    assert!(across.stress.abs() < 1e-9 * along.stress);
    // On the bias a yarn turns too: its end goes to (1 + s/2, s/2) for one of its lengths.
    let (s, c) = (0.1, 0.03);
    let (_, bias) = pulled(&reference, FRAC_PI_4, s, Some(c / s));
    let end = [1.0 + 0.5 * (s - c), 0.5 * (s + c)];
    let length = end[0].hypot(end[1]);
    let tension = k * (length - 1.0) / APART;
    let wanted = [0.5 * (end[0] + end[1]) / length, 0.5 * (end[1] - end[0]) / length].map(|rate| rate * tension);
    assert!((bias.stress - wanted[0]).abs() < 1e-6 * wanted[0].abs(), "{bias:?} {wanted:?}");
    assert!((bias.stress_across - wanted[1]).abs() < 1e-6 * wanted[1].abs(), "{bias:?} {wanted:?}");
}

#[test]
fn stretches_that_cannot_be_are_told() {
    let reference = straight();
    let (mut tile, _) = pulled(&reference, 0.0, 0.02, Some(0.0));
    for (stretch, compression) in [(-1.0, 0.0), (f64::NAN, 0.0), (0.1, 1.0), (0.1, f64::INFINITY)] {
        assert!(matches!(tile.solve(stretch, compression), Err(StretchError::Deformation { .. })));
    }
    assert!(tile.solve(0.03, 0.0).is_ok());
    let (network, yarns, card) = knit_of(1, 1, false);
    let mut rest = reference.rest().clone();
    assert!(matches!(
        TileReference::new(&network, &yarns, &card, &TileSettings::default(), rest.clone()),
        Err(StretchError::NotRelaxed { .. })
    ));
    rest.converged = false;
    assert!(TileReference::new(&network, &yarns, &card, &TileSettings::default(), rest).is_err());
}
