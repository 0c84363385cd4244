//! Where a ray meets an obstacle.

use glam::{DVec3, Quat, Vec3};

use super::{bvh::Ray, color_map::to_linear, tube::capsule_entry};
use crate::geometry::{Solid, SolidShape};

/// An obstacle in single precision about the picture's origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlacedSolid {
    shape: SolidShape,
    to_world: Quat,
    position: Vec3,
    color: Vec3,
}

/// Where a ray enters an obstacle.
#[derive(Clone, Copy, Debug)]
pub(super) struct SolidHit {
    pub distance: f32,
    pub normal: Vec3,
    pub color: Vec3,
    /// Whether the solid has no end.
    pub endless: bool,
}

impl PlacedSolid {
    pub fn new(solid: &Solid, origin: DVec3) -> Self {
        Self {
            shape: solid.shape,
            to_world: solid.rotation.as_quat().normalize(),
            position: (solid.position - origin).as_vec3(),
            color: to_linear(solid.color),
        }
    }

    /// The entry into the solid from outside; `None` if the ray misses or starts inside.
    pub fn entry(&self, ray: Ray) -> Option<SolidHit> {
        let to_own = self.to_world.inverse();
        let own = Ray { origin: to_own * (ray.origin - self.position), direction: to_own * ray.direction };
        let at = |t: f32| own.origin + t * own.direction;
        let (distance, normal) = match self.shape {
            SolidShape::Plane => {
                let t = -own.origin.z / own.direction.z;
                (own.direction.z < 0.0 && t > 0.0).then_some((t, Vec3::Z))
            }
            SolidShape::Sphere { radius } => {
                // A capsule of no length, whose cylinder is never met.
                let tiny = 1e-9 * radius as f32 * own.direction;
                capsule_entry(own, -tiny, tiny, radius as f32).map(|t| (t, at(t)))
            }
            SolidShape::Capsule { radius, half_length } => {
                let end = Vec3::Z * half_length as f32;
                capsule_entry(own, -end, end, radius as f32).map(|t| {
                    let p = at(t);
                    (t, p - Vec3::Z * p.z.clamp(-end.z, end.z))
                })
            }
            SolidShape::Box { half_extents } => {
                let half = half_extents.as_vec3();
                let inverse = own.direction.map(|d| if d.abs() < 1e-12 { 1e12 } else { d.recip() });
                let near = (-own.origin * inverse) - half * inverse.abs();
                let far = (-own.origin * inverse) + half * inverse.abs();
                let t = near.max_element();
                (t <= far.min_element() && t > 0.0).then(|| {
                    let axis = if near.x == t {
                        Vec3::X
                    } else if near.y == t {
                        Vec3::Y
                    } else {
                        Vec3::Z
                    };
                    (t, -axis * own.direction.dot(axis).signum())
                })
            }
        }?;
        Some(SolidHit {
            distance,
            normal: self.to_world * normal.normalize_or(Vec3::Z),
            color: self.color,
            endless: self.shape == SolidShape::Plane,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(shape: SolidShape, axis: DVec3, origin: Vec3, direction: Vec3) -> Option<(f32, Vec3)> {
        let solid = Solid::new(shape, DVec3::new(0.0, 0.0, 1.0)).pointing(axis);
        let ray = Ray { origin, direction: direction.normalize() };
        PlacedSolid::new(&solid, DVec3::new(0.0, 0.0, 1.0)).entry(ray).map(|h| (h.distance, h.normal))
    }

    #[test]
    fn known_entries() {
        let near = |found: Option<(f32, Vec3)>, distance: f32, normal: Vec3| {
            let (t, n) = found.expect("a hit");
            assert!((t - distance).abs() < 1e-4 && n.distance(normal) < 1e-3, "{t} {n}");
        };
        let down = -Vec3::Z;
        let from = Vec3::new(0.3, 0.0, 10.0);
        near(entry(SolidShape::Plane, DVec3::Z, from, down), 10.0, Vec3::Z);
        let sphere = SolidShape::Sphere { radius: 0.5 };
        near(entry(sphere, DVec3::X, from, down), 9.6, Vec3::new(0.6, 0.0, 0.8));
        let capsule = SolidShape::Capsule { radius: 0.5, half_length: 2.0 };
        near(entry(capsule, DVec3::X, from, down), 9.5, Vec3::Z);
        near(entry(capsule, DVec3::Z, from, down), 10.0 - 2.4, Vec3::new(0.6, 0.0, 0.8));
        let slab = SolidShape::Box { half_extents: DVec3::new(1.0, 2.0, 0.25) };
        near(entry(slab, DVec3::Z, from, down), 9.75, Vec3::Z);
        near(entry(slab, DVec3::X, Vec3::new(0.2, 0.0, 10.0), down), 9.0, Vec3::Z);
        assert!(entry(slab, DVec3::Z, Vec3::new(1.5, 0.0, 10.0), down).is_none());
        assert!(entry(SolidShape::Plane, -DVec3::Z, from, down).is_none());
    }
}
