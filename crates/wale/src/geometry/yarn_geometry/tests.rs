//! How yarns are drawn.

use super::*;
use crate::geometry::sample_fabric::plain_weave;
use crate::model::{KnitCard, NodeId};
use crate::pattern::{Chart, Working, knit};
use glam::{DQuat, EulerRot};

fn frame_of(network: &Network) -> Frame {
    Frame { time: 0.0, positions: network.position.clone(), sliding: network.arc_length.clone() }
}

/// The point of a curve at a pass: the first one that carries it.
fn at_pass(curves: &[Curve], pass: usize) -> (DVec3, f64) {
    curves
        .iter()
        .find_map(|curve| {
            let i = curve.pass.iter().position(|p| *p as usize == pass)?;
            Some((curve.points[i], curve.arc_length[i]))
        })
        .expect("every pass is drawn")
}

#[test]
fn stacks_are_drawn_front_to_back_one_diameter_apart() {
    let network = plain_weave(5, 4, 2e-3);
    let settings = CurveSettings::new(0.3e-3);
    let curves = curves(&network, &frame_of(&network), &settings);
    assert_eq!(curves.len(), 9);
    for node in 0..20 {
        let stack = network.stack(NodeId::new(node));
        assert_eq!(stack.len(), 2);
        let (front, u) = at_pass(&curves, stack[0].index());
        let (back, _) = at_pass(&curves, stack[1].index());
        assert!(front.distance(network.position[node] + DVec3::Z * 0.3e-3) < 1e-12);
        assert!(back.distance(network.position[node] - DVec3::Z * 0.3e-3) < 1e-12);
        assert_eq!(u, network.arc_length[stack[0].index()]);
    }
    for curve in &curves {
        assert!(curve.arc_length.windows(2).all(|w| w[0] < w[1]));
        assert!(curve.pass.windows(2).all(|w| w[0] <= w[1]));
    }
}

#[test]
fn drawing_moves_with_the_fabric() {
    let network = plain_weave(4, 4, 2e-3);
    let settings = CurveSettings::new(0.3e-3);
    let mut frame = frame_of(&network);
    for (i, x) in frame.positions.iter_mut().enumerate() {
        // A fixed irregular crumple.
        *x += DVec3::new((i as f64 * 1.7).sin(), (i as f64 * 2.3).cos(), (i as f64).sin()) * 0.4e-3;
    }
    let still = curves(&network, &frame, &settings);
    let turn = DQuat::from_euler(EulerRot::XYZ, 2.5, -0.7, 4.0);
    let shift = DVec3::new(0.1, 0.2, -0.3);
    for x in &mut frame.positions {
        *x = turn * *x + shift;
    }
    let moved = curves(&network, &frame, &settings);
    for (a, b) in still.iter().zip(&moved) {
        for (x, y) in a.points.iter().zip(&b.points) {
            assert!((turn * *x + shift).distance(*y) < 1e-12);
        }
    }
}

#[test]
fn collapsed_fabrics_are_finite() {
    let network = plain_weave(3, 3, 2e-3);
    let mut frame = frame_of(&network);
    frame.positions.fill(DVec3::ONE);
    frame.sliding.fill(0.0);
    for curve in curves(&network, &frame, &CurveSettings::new(0.3e-3)) {
        assert!(curve.points.iter().all(|p| p.is_finite()));
    }
}

#[test]
fn a_closed_yarn_meets_its_next_period_smoothly() {
    let mut network = plain_weave(2, 1, 1e-3);
    // Keep the weft alone, without its free ends, and close it on its neighbour along the course.
    network.pass_node = vec![NodeId(0), NodeId(1)];
    network.pass_image = vec![[0, 0]; 2];
    network.arc_length = vec![0.0, 1e-3];
    network.yarn_start = vec![0, 2];
    network.yarn_closure = vec![Some(([1, 0], 2.5e-3))];
    network.yarn_color.truncate(1);
    network.yarn_kind.truncate(1);
    network.yarn_role.truncate(1);
    network.position = vec![DVec3::ZERO, DVec3::new(1e-3, 0.5e-3, 0.0)];
    network.front.truncate(2);
    network.set_stacks(&[vec![crate::model::PassId(0)], vec![crate::model::PassId(1)]]);
    let periods = [DVec3::X * 2e-3, DVec3::Y * 2e-3];
    let settings = CurveSettings { periods: Some(periods), ..CurveSettings::new(0.2e-3) };
    let curve = &curves(&network, &frame_of(&network), &settings)[0];
    let n = curve.points.len();
    assert!(curve.points[n - 1].distance(curve.points[0] + periods[0]) < 1e-15);
    assert!((curve.arc_length[n - 1] - 2.5e-3).abs() < 1e-15);
    // The two neighbours of the seam are mirror images here: the curve has its crest on the seam.
    let (left, right) = (curve.points[n - 2] - periods[0], curve.points[1]);
    assert!((left.x + right.x).abs() < 1e-12 && (left.y - right.y).abs() < 1e-12);
}

/// Smallest distance of the two yarns within a stitch contact, over all contacts, in yarn diameters.
fn clearance(network: &Network, radius: f64, clasp: f64) -> f64 {
    let settings = CurveSettings { clasp, samples_per_segment: 16, ..CurveSettings::new(radius) };
    let curves = curves(network, &frame_of(network), &settings);
    let passes = Passes::new(network);
    let piece = |[a, b]: [crate::model::PassId; 2]| -> Vec<DVec3> {
        let first = passes.earlier(a, b).expect("a contact's passes are neighbours");
        curves
            .iter()
            .flat_map(|c| c.points.iter().zip(&c.pass))
            .filter(|(_, p)| **p as usize == first)
            .map(|(x, _)| *x)
            .collect()
    };
    let mut least = f64::INFINITY;
    for stitch in &network.stitches {
        let (a, b) = (piece(stitch.passes[0]), piece(stitch.passes[1]));
        assert!(a.len() >= 16 && b.len() >= 16);
        for (x, y) in a.iter().flat_map(|x| b.iter().map(move |y| (x, y))) {
            least = least.min(x.distance(*y) / (2.0 * radius));
        }
    }
    least
}

#[test]
fn clasped_yarns_go_around_each_other_and_not_through() {
    let card = KnitCard {
        loop_length: 10e-3,
        path_ratio: 1.0,
        transition_length: 0.1,
        stitch_length: 1.07e-3,
        wale_spacing: 3.2e-3,
        course_spacing: 2.4e-3,
        wrapping_stiffness: 0.0,
        wrapping_angle_course: 0.0,
        wrapping_angle_leg: 0.0,
        bend_angle_foot_head: 0.0,
        bend_angle_leg: 0.0,
        length_stiffness: 0.0,
        spacing_stiffness: 0.0,
        spacing_leg: 0.0,
        spacing_head_sinker: 0.0,
        thickness: None,
        anchor_stiffness: 0.0,
        residual_compression: 0.0,
    };
    // Knits and purls, left and right: all four signs of wrapping.
    let chart = Chart::rib(1, 1).expect("a rib").repeat(2, 3).expect("it is small");
    let network = knit::fabric(&chart, Working::default(), &card);
    let (led, straight) = (clearance(&network, 0.3e-3, 1.0), clearance(&network, 0.3e-3, 0.0));
    assert!(led > 0.75, "{led}");
    assert!(straight < 0.5, "{straight}");
    let wrong_way = clearance(&network, 0.3e-3, -1.0);
    assert!(wrong_way < led, "{wrong_way} {led}");
}
