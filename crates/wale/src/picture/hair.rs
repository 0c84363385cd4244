//! The fine hair that stands off a spun yarn: short arcs from its surface, placed by chance that follows the yarn.

use std::f64::consts::TAU;

use glam::Vec3;

use super::spun_yarn::unit_hash;
use crate::geometry::{Curve, parallel_transport::transported_frames};

/// Straight pieces of one hair.
const PIECES: usize = 4;
/// Radius of a hair in radii of its yarn.
const THICKNESS: f64 = 0.012;

/// Hairs of all yarns and the linear colour of their points; `density` counts hairs per yarn radius of length.
pub(super) fn hairs(curves: &[Curve], colors: &[Vec<Vec3>], density: f64) -> (Vec<Curve>, Vec<Vec<Vec3>>) {
    let (mut hairs, mut hair_colors) = (Vec::new(), Vec::new());
    for (c, (curve, colors)) in curves.iter().zip(colors).enumerate() {
        if curve.points.len() < 2 || !curve.points.iter().all(|p| p.is_finite()) {
            continue;
        }
        let frames = transported_frames(&curve.points);
        let mut along = vec![0.0];
        for pair in curve.points.windows(2) {
            along.push(along[along.len() - 1] + pair[0].distance(pair[1]));
        }
        let radius = curve.radius;
        let length = along[along.len() - 1];
        let count = (density * length / radius).clamp(0.0, 1e7) as u32;
        for k in 0..count {
            let dice = |n: u32| f64::from(unit_hash(c as u32, k, 100 + n));
            let root = (f64::from(k) + dice(0)) / f64::from(count) * length;
            let angle = TAU * dice(1);
            let reach = radius * (1.2 + 2.6 * dice(2)) * if dice(3) < 0.5 { -1.0 } else { 1.0 };
            let lift = radius * (0.06 + 0.6 * dice(4) * dice(5));
            let swing = 1.6 * (dice(6) - 0.5);
            let mut points = Vec::with_capacity(PIECES + 1);
            let mut place = 0;
            for i in 0..=PIECES {
                let t = i as f64 / PIECES as f64;
                let at = (root + reach * t).clamp(0.0, length);
                place = place_of(&along, at, place);
                let span = along[place + 1] - along[place];
                let s = if span > 0.0 { (at - along[place]) / span } else { 0.0 };
                let center = curve.points[place].lerp(curve.points[place + 1], s);
                let normal = frames[place].1.lerp(frames[place + 1].1, s);
                let side = frames[place].0.cross(normal);
                let (sin, cos) = (angle + swing * t).sin_cos();
                let height = 0.96 * radius + lift * (1.0 - (1.0 - t) * (1.0 - t));
                points.push(center + height * (cos * normal + sin * side));
            }
            let color = colors[place_of(&along, root, 0)];
            hair_colors.push(vec![color; points.len()]);
            hairs.push(Curve {
                arc_length: vec![0.0; points.len()],
                pass: vec![0; points.len()],
                points,
                radius: THICKNESS * radius,
                color: curve.color,
            });
        }
    }
    (hairs, hair_colors)
}

/// The piece of a rising list that holds `at`, sought by halving.
fn place_of(along: &[f64], at: f64, guess: usize) -> usize {
    let last = along.len() - 2;
    if along[guess] <= at && at <= along[guess + 1] {
        return guess;
    }
    along.partition_point(|a| *a <= at).saturating_sub(1).min(last)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn hairs_start_at_the_surface_and_stay_near_it() {
        let curve = Curve {
            points: (0..50).map(|i| DVec3::X * f64::from(i) * 1e-3).collect(),
            arc_length: (0..50).map(|i| f64::from(i) * 1e-3).collect(),
            pass: vec![0; 50],
            radius: 1e-3,
            color: [9, 9, 9],
        };
        let colors = vec![vec![Vec3::ONE; 50]];
        let (found, found_colors) = hairs(std::slice::from_ref(&curve), &colors, 2.0);
        assert_eq!(found.len(), 98);
        assert_eq!(found.len(), found_colors.len());
        let away = |p: DVec3| p.reject_from(DVec3::X).length() / curve.radius;
        for hair in &found {
            assert!((away(hair.points[0]) - 0.96).abs() < 0.01);
            assert!(hair.points.iter().all(|p| away(*p) < 1.9 && away(*p) > 0.9));
        }
        // The same yarn grows the same hair.
        assert_eq!(hairs(&[curve], &colors, 2.0).0, found);
    }
}
