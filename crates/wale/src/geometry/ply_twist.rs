//! The plies of a yarn: thinner curves wound around its centre line, so that a picture looks like yarn.

use std::f64::consts::{PI, TAU};

use super::Curve;
use super::parallel_transport::transported_frames;

/// Straight pieces that a turn of a ply is drawn with, at least.
const PIECES_PER_TURN: f64 = 12.0;

/// `plies` curves twisted about a yarn by `twist` \[turns/m of rest length\], positive for Z twist (a right-handed
/// helix).
///
/// Each ply touches its two neighbours and the yarn's surface from inside: with the ply's centre at `a` from the yarn's
/// and its radius `r`, `r = a sin(π/n)` and `a + r = R`. One ply is the yarn itself. Twist follows the rest arc
/// length, so plies are drawn along when the yarn slides.
#[must_use]
pub fn ply_curves(yarn: &Curve, plies: u32, twist: f64) -> Vec<Curve> {
    if plies <= 1 {
        return vec![yarn.clone()];
    }
    // Twist that is no number is drawn as none.
    let twist = if twist.is_finite() { twist } else { 0.0 };
    let share = (PI / f64::from(plies)).sin();
    let center_distance = yarn.radius / (1.0 + share);
    let fine = refined(yarn, twist);
    let frames = transported_frames(&fine.points);
    (0..plies)
        .map(|ply| {
            let phase = TAU * f64::from(ply) / f64::from(plies);
            let points = fine
                .points
                .iter()
                .zip(&frames)
                .zip(&fine.arc_length)
                .map(|((point, (tangent, normal)), arc_length)| {
                    let (sin, cos) = (phase + TAU * twist * arc_length).sin_cos();
                    *point + (*normal * cos + tangent.cross(*normal) * sin) * center_distance
                })
                .collect();
            Curve { points, radius: center_distance * share, ..fine.clone() }
        })
        .collect()
}

/// The curve with points added where the twist turns too far between two points.
fn refined(curve: &Curve, twist: f64) -> Curve {
    let mut fine = Curve {
        points: Vec::with_capacity(curve.points.len()),
        arc_length: Vec::with_capacity(curve.points.len()),
        pass: Vec::with_capacity(curve.points.len()),
        ..*curve
    };
    for i in 0..curve.points.len() {
        let next = (i + 1).min(curve.points.len() - 1);
        let rest = curve.arc_length[next] - curve.arc_length[i];
        let pieces = (rest * twist).abs() * PIECES_PER_TURN;
        // The cap bounds what absurd twists or slack yarns can ask for.
        let pieces = if pieces.is_finite() { pieces.ceil().clamp(1.0, 64.0) } else { 1.0 };
        let pieces = if next == i { 1 } else { pieces as usize };
        for k in 0..pieces {
            let t = k as f64 / pieces as f64;
            fine.points.push(curve.points[i].lerp(curve.points[next], t));
            fine.arc_length.push(curve.arc_length[i] + rest * t);
            fine.pass.push(curve.pass[i]);
        }
    }
    fine
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn straight() -> Curve {
        Curve {
            points: (0..=10).map(|i| DVec3::Z * f64::from(i) * 1e-3).collect(),
            arc_length: (0..=10).map(|i| f64::from(i) * 1e-3).collect(),
            pass: (0..=10).collect(),
            radius: 0.5e-3,
            color: [1, 2, 3],
        }
    }

    #[test]
    fn plies_touch_each_other_and_the_yarn_surface() {
        for n in 2..6 {
            let plies = ply_curves(&straight(), n, 250.0);
            assert_eq!(plies.len(), n as usize);
            for (k, ply) in plies.iter().enumerate() {
                let next = &plies[(k + 1) % plies.len()];
                for (a, b) in ply.points.iter().zip(&next.points) {
                    assert!((a.distance(*b) - 2.0 * ply.radius).abs() < 1e-12);
                    assert!((a.truncate().length() + ply.radius - 0.5e-3).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn positive_twist_is_a_right_handed_helix_with_the_asked_turns() {
        let ply = &ply_curves(&straight(), 3, 250.0)[0];
        let turned: f64 = ply.points.windows(2).map(|w| w[0].truncate().angle_to(w[1].truncate())).sum();
        // 250 turns/m over 10 mm; counter-clockwise seen against the direction of travel.
        assert!((turned - 2.5 * TAU).abs() < 1e-9, "{turned}");
        assert!(ply.points.len() > 30);
    }

    #[test]
    fn one_ply_is_the_yarn_and_absurd_twists_are_bounded() {
        assert_eq!(ply_curves(&straight(), 1, 100.0), vec![straight()]);
        assert_eq!(ply_curves(&straight(), 0, 100.0).len(), 1);
        for twist in [1e300, f64::INFINITY, f64::NAN] {
            assert!(ply_curves(&straight(), 2, twist)[0].points.len() <= 641);
        }
        assert!(ply_curves(&Curve::default(), 2, 100.0)[0].points.is_empty());
    }
}
