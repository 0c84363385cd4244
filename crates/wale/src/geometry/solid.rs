//! Obstacles as they are drawn: simple solids with a place and a colour.

use glam::{DQuat, DVec3};

/// The form of a solid in its own axes, centred at its own origin. Lengths in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SolidShape {
    /// The half space below its own `z = 0`; the surface faces its own `+z`.
    Plane,
    /// A ball.
    Sphere {
        /// Radius \[m\].
        radius: f64,
    },
    /// All points within `radius` of a straight piece along its own `z`.
    Capsule {
        /// Radius \[m\].
        radius: f64,
        /// Half the length of the straight piece \[m\].
        half_length: f64,
    },
    /// A box with edges along its own axes.
    Box {
        /// Half of each edge \[m\].
        half_extents: DVec3,
    },
}

/// A solid at its place at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solid {
    /// Form in its own axes.
    pub shape: SolidShape,
    /// Rotation from its own axes to the world's.
    pub rotation: DQuat,
    /// Where its own origin is \[m\].
    pub position: DVec3,
    /// Colour, sRGB.
    pub color: [u8; 3],
}

impl Solid {
    /// The grey that obstacles have unless told otherwise.
    pub const GREY: [u8; 3] = [186, 188, 194];

    /// A solid at a place, unrotated and grey.
    #[must_use]
    pub fn new(shape: SolidShape, position: DVec3) -> Self {
        Self { shape, rotation: DQuat::IDENTITY, position, color: Self::GREY }
    }

    /// The solid turned so that its own `+z` points along `axis` (unchanged for a zero axis).
    #[must_use]
    pub fn pointing(mut self, axis: DVec3) -> Self {
        if let Some(axis) = axis.try_normalize() {
            self.rotation = DQuat::from_rotation_arc(DVec3::Z, axis);
        }
        self
    }

    /// How far a point is above the solid's own `z = 0`: outside a plane if it is positive \[m\].
    #[must_use]
    pub fn height(&self, at: DVec3) -> f64 {
        (at - self.position).dot(self.rotation * DVec3::Z)
    }

    /// Corners of a box around the solid; none for a plane, which has no end.
    #[must_use]
    pub fn extent_points(&self) -> Vec<DVec3> {
        let half = match self.shape {
            SolidShape::Plane => return Vec::new(),
            SolidShape::Sphere { radius } => DVec3::splat(radius),
            SolidShape::Capsule { radius, half_length } => DVec3::new(radius, radius, radius + half_length),
            SolidShape::Box { half_extents } => half_extents,
        };
        // A ball looks the same from everywhere: its box need not turn with it.
        let rotation = match self.shape {
            SolidShape::Sphere { .. } => DQuat::IDENTITY,
            _ => self.rotation,
        };
        (0..8)
            .map(|i| {
                let sign = |bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
                self.position + rotation * (half * DVec3::new(sign(0), sign(1), sign(2)))
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_capsule_turned_to_x_reaches_along_x() {
        let solid = Solid::new(SolidShape::Capsule { radius: 1.0, half_length: 3.0 }, DVec3::new(10.0, 0.0, 0.0))
            .pointing(DVec3::X);
        let reach = |axis: DVec3| solid.extent_points().iter().map(|p| p.dot(axis)).fold(f64::NEG_INFINITY, f64::max);
        assert!((reach(DVec3::X) - 14.0).abs() < 1e-12);
        assert!((reach(DVec3::Y) - 1.0).abs() < 1e-12);
    }
}
