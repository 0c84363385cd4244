//! Yarns as chains of capsules, with what shading needs at each point: tangent, a normal that does not spin, colour.

use glam::{DVec3, Vec3};

use super::bvh::{Bounds, Bvh, Ray};
use crate::geometry::{Curve, parallel_transport::transported_frames};

/// A point of a yarn's centre line as the caster sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct TubePoint {
    pub position: Vec3,
    pub tangent: Vec3,
    /// Unit normal carried along the curve without spin; ply twist is measured from it.
    pub normal: Vec3,
    /// Rest arc length \[m\].
    pub arc_length: f64,
    /// Linear colour.
    pub color: Vec3,
}

/// One straight piece: what every ray that comes near reads.
#[derive(Clone, Copy, Debug)]
pub(super) struct Capsule {
    pub a: Vec3,
    pub b: Vec3,
    pub radius: f32,
    /// The piece's first point; its second is the next.
    pub first: u32,
}

/// All yarns of a picture, relative to an origin near them so that single precision suffices.
#[derive(Debug, Default)]
pub(super) struct Tubes {
    pub points: Vec<TubePoint>,
    /// In the order of the tree's leaves.
    pub capsules: Vec<Capsule>,
    bvh: Bvh,
}

/// Where a ray meets a yarn.
#[derive(Clone, Copy, Debug)]
pub(super) struct TubeHit {
    pub distance: f32,
    pub capsule: u32,
}

impl Tubes {
    /// Lays the curves out about `origin`; `colors` gives the linear colour of each point of each curve.
    /// Points that are not finite end a piece: what can be drawn is drawn.
    pub fn new(curves: &[Curve], colors: &[Vec<Vec3>], origin: DVec3) -> Self {
        let mut tubes = Self::default();
        for (curve, colors) in curves.iter().zip(colors) {
            let mut piece: Vec<usize> = Vec::new();
            for (i, point) in curve.points.iter().enumerate() {
                if !point.is_finite() {
                    tubes.push_piece(curve, colors, &piece, origin);
                    piece.clear();
                } else if piece.last().is_none_or(|&j| curve.points[j] != *point) {
                    piece.push(i);
                }
            }
            tubes.push_piece(curve, colors, &piece, origin);
        }
        let bounds = |c: &Capsule| Bounds { min: c.a.min(c.b) - c.radius, max: c.a.max(c.b) + c.radius };
        let boxes: Vec<Bounds> = tubes.capsules.iter().map(bounds).collect();
        let (bvh, order) = Bvh::new(&boxes);
        tubes.capsules = order.iter().map(|i| tubes.capsules[*i as usize]).collect();
        tubes.bvh = bvh;
        tubes
    }

    fn push_piece(&mut self, curve: &Curve, colors: &[Vec3], piece: &[usize], origin: DVec3) {
        if piece.len() < 2 {
            return;
        }
        let places: Vec<DVec3> = piece.iter().map(|&i| curve.points[i] - origin).collect();
        let frames = transported_frames(&places);
        for (k, &i) in piece.iter().enumerate() {
            if k + 1 < piece.len() {
                self.capsules.push(Capsule {
                    a: places[k].as_vec3(),
                    b: places[k + 1].as_vec3(),
                    radius: curve.radius as f32,
                    first: self.points.len() as u32,
                });
            }
            self.points.push(TubePoint {
                position: places[k].as_vec3(),
                tangent: frames[k].0.as_vec3(),
                normal: frames[k].1.as_vec3(),
                arc_length: curve.arc_length.get(i).copied().unwrap_or(0.0),
                color: colors[i],
            });
        }
    }

    /// The nearest yarn nearer than `limit`.
    pub fn closest(&self, ray: Ray, limit: f32) -> Option<TubeHit> {
        self.bvh
            .closest(ray, limit, |c, limit| self.test(ray, c, limit))
            .map(|hit| TubeHit { distance: hit.distance, capsule: hit.primitive })
    }

    /// Whether a yarn is met nearer than `limit`.
    pub fn any(&self, ray: Ray, limit: f32) -> bool {
        self.bvh.any(ray, limit, |c, limit| self.test(ray, c, limit))
    }

    fn test(&self, ray: Ray, capsule: u32, limit: f32) -> Option<f32> {
        let c = &self.capsules[capsule as usize];
        capsule_entry(ray, c.a, c.b, c.radius).filter(|&t| t < limit)
    }
}

/// Distance at which a ray enters a capsule from outside; `None` if it misses or starts inside.
pub(super) fn capsule_entry(ray: Ray, a: Vec3, b: Vec3, radius: f32) -> Option<f32> {
    // Solve near the capsule: differences of squared distances from a far camera lose all digits of a thin yarn.
    let shift = (0.5 * (a + b) - ray.origin).dot(ray.direction);
    let origin = ray.origin + shift * ray.direction;
    let axis = b - a;
    let from_a = origin - a;
    let axis_axis = axis.length_squared();
    let axis_ray = axis.dot(ray.direction);
    let axis_from = axis.dot(from_a);
    let from_ray = from_a.dot(ray.direction);
    let qa = axis_axis - axis_ray * axis_ray;
    let mut cap = if axis_ray < 0.0 { b } else { a };
    if qa > 1e-6 * axis_axis {
        let qb = axis_axis * from_ray - axis_from * axis_ray;
        let qc = axis_axis * from_a.length_squared() - axis_from * axis_from - radius * radius * axis_axis;
        let h = qb * qb - qa * qc;
        if h < 0.0 {
            return None;
        }
        let t = (-qb - h.sqrt()) / qa;
        let along = axis_from + t * axis_ray;
        if along > 0.0 && along < axis_axis {
            return (t + shift > 0.0).then_some(t + shift);
        }
        cap = if along <= 0.0 { a } else { b };
    }
    let from_cap = origin - cap;
    let qb = from_cap.dot(ray.direction);
    let h = qb * qb - (from_cap.length_squared() - radius * radius);
    if h < 0.0 {
        return None;
    }
    let t = shift - qb - h.sqrt();
    (t > 0.0).then_some(t)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distance by walking the ray with the capsule's signed distance.
    fn traced(ray: Ray, a: Vec3, b: Vec3, radius: f32) -> Option<f32> {
        let mut t = 0.0f64;
        let d = |p: DVec3| {
            let (a, axis) = (a.as_dvec3(), (b - a).as_dvec3());
            let s = ((p - a).dot(axis) / axis.length_squared()).clamp(0.0, 1.0);
            (p - a - s * axis).length() - f64::from(radius)
        };
        for _ in 0..2000 {
            let gap = d(ray.origin.as_dvec3() + t * ray.direction.as_dvec3());
            if gap < 1e-7 {
                return Some(t as f32);
            }
            t += gap;
            if t > 100.0 {
                return None;
            }
        }
        None
    }

    #[test]
    fn capsule_entry_agrees_with_walking_by_distance() {
        let (mut hits, mut misses) = (0, 0);
        for i in 0..2000 {
            let f = |k: u32| ((i * 7919 + k * 104_729) % 1009) as f32 / 1009.0 - 0.5;
            let a = Vec3::new(f(1), f(2), f(3));
            let b = a + 0.6 * Vec3::new(f(4), f(5), f(6));
            let origin = 3.0 * Vec3::new(f(7), f(8), 1.0);
            let aim = a.lerp(b, f(9) + 0.5) + 0.5 * Vec3::new(f(10), f(11), f(12));
            let ray = Ray { origin, direction: (aim - origin).normalize() };
            let (found, wanted) = (capsule_entry(ray, a, b, 0.1), traced(ray, a, b, 0.1));
            match (found, wanted) {
                (Some(x), Some(y)) => {
                    assert!((x - y).abs() < 2e-4, "{x} {y}");
                    hits += 1;
                }
                (None, None) => misses += 1,
                // A grazing ray may fall either way within rounding.
                _ => {
                    let t = found.or(wanted).unwrap_or(0.0);
                    assert!((traced(ray, a, b, 0.1001).is_some()) && t > 0.0);
                }
            }
        }
        assert!(hits > 300 && misses > 300);
    }

    #[test]
    fn points_that_are_not_numbers_split_the_yarn() {
        let mut curve = Curve {
            points: (0..10).map(|i| DVec3::X * f64::from(i)).collect(),
            arc_length: (0..10).map(f64::from).collect(),
            radius: 0.1,
            ..Curve::default()
        };
        curve.points[4] = DVec3::NAN;
        let tubes = Tubes::new(&[curve], &[vec![Vec3::ONE; 10]], DVec3::ZERO);
        assert_eq!(tubes.capsules.len(), 3 + 4);
    }
}
