//! Obstacles of a plan as solids at a time.

use glam::DQuat;

use super::{Solid, SolidShape};
use crate::model::{Obstacle, Shape};

/// An obstacle where its motion has carried it at a time \[s\].
#[must_use]
pub fn solid_at(obstacle: &Obstacle, time: f64) -> Solid {
    let turn = obstacle.motion.pose(time).rotation;
    let place = |point| obstacle.motion.place(point, time);
    match obstacle.shape {
        Shape::Plane { point, normal } => Solid::new(SolidShape::Plane, place(point)).pointing(turn * normal),
        Shape::Sphere { center, radius } => Solid::new(SolidShape::Sphere { radius }, place(center)),
        Shape::Capsule { a, b, radius } => {
            let half_length = 0.5 * a.distance(b);
            Solid::new(SolidShape::Capsule { radius, half_length }, place(0.5 * (a + b))).pointing(turn * (b - a))
        }
        Shape::Block { center, half_size, rotation } => {
            let solid = Solid::new(SolidShape::Box { half_extents: half_size }, place(center));
            Solid { rotation: turned(turn, rotation), ..solid }
        }
    }
}

fn turned(turn: DQuat, rotation: DQuat) -> DQuat {
    (turn * rotation).normalize()
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::model::Motion;
    use crate::model::motion::Key;

    /// A quarter turn about z through (1, 0, 0) and a way up, done at one second.
    fn turning(shape: Shape) -> Obstacle {
        let quarter = DVec3::Z * std::f64::consts::FRAC_PI_2;
        let keys = vec![
            Key { time: 0.0, rotation: DVec3::ZERO, translation: DVec3::ZERO },
            Key { time: 1.0, rotation: quarter, translation: DVec3::Z },
        ];
        Obstacle { name: "a".into(), shape, motion: Motion { keys, pivot: DVec3::X }, friction_coefficient: 0.0 }
    }

    #[test]
    fn solids_go_with_their_obstacles() {
        let center = DVec3::new(2.0, 0.0, 0.0);
        let sphere = turning(Shape::Sphere { center, radius: 0.5 });
        assert_eq!(solid_at(&sphere, 0.0).position, center);
        assert!(solid_at(&sphere, 1.0).position.distance(DVec3::new(1.0, 1.0, 1.0)) < 1e-12);

        let capsule = turning(Shape::Capsule { a: center, b: center + 2.0 * DVec3::X, radius: 0.1 });
        let solid = solid_at(&capsule, 1.0);
        assert!((solid.rotation * DVec3::Z).distance(DVec3::Y) < 1e-12);
        assert!(solid.position.distance(DVec3::new(1.0, 2.0, 1.0)) < 1e-12);
        assert_eq!(solid.shape, SolidShape::Capsule { radius: 0.1, half_length: 1.0 });

        let plane = turning(Shape::Plane { point: center, normal: DVec3::X });
        assert!((solid_at(&plane, 1.0).rotation * DVec3::Z).distance(DVec3::Y) < 1e-12);

        let block = turning(Shape::Block { center, half_size: DVec3::ONE, rotation: DQuat::IDENTITY });
        assert!((solid_at(&block, 1.0).rotation * DVec3::X).distance(DVec3::Y) < 1e-12);
    }
}
