//! Signed distance to rigid shapes.

use glam::DVec3;

use crate::model::{Obstacle, Shape};

/// Signed distance to a shape \[m\], negative inside, and the outward unit normal at the nearest surface point.
#[must_use]
pub fn signed_distance(shape: &Shape, x: DVec3) -> (f64, DVec3) {
    match *shape {
        Shape::Plane { point, normal } => ((x - point).dot(normal), normal),
        Shape::Sphere { center, radius } => round(x - center, radius),
        Shape::Capsule { a, b, radius } => {
            let axis = b - a;
            let s = ((x - a).dot(axis) / axis.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
            round(x - (a + axis * s), radius)
        }
        Shape::Block { center, half_size, rotation } => {
            let local = rotation.inverse() * (x - center);
            let beyond = local.abs() - half_size;
            let (distance, normal) = if beyond.max_element() > 0.0 {
                let out = beyond.max(DVec3::ZERO) * local.signum();
                (out.length(), out.normalize())
            } else {
                // Inside: leave by the nearest face.
                let axis = (0..3).fold(0, |best, k| if beyond[k] > beyond[best] { k } else { best });
                let mut normal = DVec3::ZERO;
                normal[axis] = local[axis].signum();
                (beyond[axis], normal)
            };
            (distance, rotation * normal)
        }
    }
}

fn round(from_core: DVec3, radius: f64) -> (f64, DVec3) {
    let length = from_core.length();
    (length - radius, from_core.try_normalize().unwrap_or(DVec3::Z))
}

/// Signed distance and normal of an obstacle as it stands at a time.
#[must_use]
pub fn obstacle_distance(obstacle: &Obstacle, x: DVec3, time: f64) -> (f64, DVec3) {
    let (distance, normal) = signed_distance(&obstacle.shape, to_rest_frame(obstacle, x, time));
    (distance, obstacle.motion.pose(time).rotation * normal)
}

/// A world point in the frame in which the obstacle is at its initial place.
#[must_use]
pub fn to_rest_frame(obstacle: &Obstacle, x: DVec3, time: f64) -> DVec3 {
    let pose = obstacle.motion.pose(time);
    let pivot = obstacle.motion.pivot;
    pivot + pose.rotation.inverse() * (x - pose.translation - pivot)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::motion::{Key, Motion};
    use glam::DQuat;

    #[test]
    fn distances_and_normals_agree_with_differences() {
        let shapes = [
            Shape::Plane { point: DVec3::new(0.1, 0.2, 0.3), normal: DVec3::new(0.6, 0.0, 0.8) },
            Shape::Sphere { center: DVec3::new(0.1, 0.2, 0.3), radius: 0.7 },
            Shape::Capsule { a: DVec3::ZERO, b: DVec3::new(1.0, 0.5, 0.0), radius: 0.2 },
            Shape::Block {
                center: DVec3::ONE,
                half_size: DVec3::new(0.3, 0.5, 0.9),
                rotation: DQuat::from_rotation_x(0.4),
            },
        ];
        let points = [DVec3::new(1.3, -0.4, 0.9), DVec3::new(1.1, 1.05, 1.2), DVec3::new(-0.6, 0.3, 2.0)];
        for shape in shapes {
            for x in points {
                let (_, normal) = signed_distance(&shape, x);
                assert!((normal.length() - 1.0).abs() < 1e-12);
                for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                    let h = 1e-6;
                    let slope =
                        (signed_distance(&shape, x + axis * h).0 - signed_distance(&shape, x - axis * h).0) / (2.0 * h);
                    assert!((slope - normal.dot(axis)).abs() < 1e-6, "{shape:?} {x}");
                }
            }
        }
    }

    #[test]
    fn an_obstacle_takes_its_surface_along() {
        let keys = vec![
            Key { time: 0.0, rotation: DVec3::ZERO, translation: DVec3::ZERO },
            Key { time: 1.0, rotation: DVec3::new(0.0, 0.0, 1.0), translation: DVec3::new(0.0, 0.0, 2.0) },
        ];
        let motion = Motion { keys, pivot: DVec3::X };
        let shape = Shape::Sphere { center: DVec3::ZERO, radius: 0.5 };
        let obstacle = Obstacle { name: String::new(), shape, motion, friction_coefficient: 0.0 };
        let moved_center = obstacle.motion.place(DVec3::ZERO, 1.0);
        let (distance, normal) = obstacle_distance(&obstacle, moved_center + DVec3::Y, 1.0);
        assert!((distance - 0.5).abs() < 1e-12 && (normal - DVec3::Y).length() < 1e-12);
    }
}
