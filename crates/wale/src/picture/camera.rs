//! The eye: from which side, how far, and where a pixel looks.

use std::str::FromStr;

use glam::DVec3;

/// A side to look from. The fabric's front faces +z, its wales run along +y.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum View {
    /// The right side, wales upright.
    #[default]
    Front,
    /// The wrong side, wales upright.
    Back,
    /// Along the courses, from +x.
    Right,
    /// Along the courses, from −x.
    Left,
    /// Along the wales, from the last course.
    Top,
    /// Along the wales, from the first course.
    Bottom,
    /// As on a table before the viewer: from the right, the first course and above, in perspective.
    ThreeQuarter,
    /// The same of the wrong side: the fabric turned over.
    ThreeQuarterBack,
}

impl View {
    /// The views by name, as users write them.
    pub const NAMES: [(&'static str, Self); 8] = [
        ("front", Self::Front),
        ("back", Self::Back),
        ("right", Self::Right),
        ("left", Self::Left),
        ("top", Self::Top),
        ("bottom", Self::Bottom),
        ("three-quarter", Self::ThreeQuarter),
        ("three-quarter-back", Self::ThreeQuarterBack),
    ];

    /// Direction from the subject to the eye, and the direction that is up in the picture; neither is of unit length.
    #[must_use]
    pub fn directions(self) -> (DVec3, DVec3) {
        let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
        match self {
            Self::Front => (z, y),
            Self::Back => (-z, y),
            Self::Right => (x, y),
            Self::Left => (-x, y),
            Self::Top => (y, z),
            Self::Bottom => (-y, z),
            Self::ThreeQuarter => (DVec3::new(0.42, -0.8, 0.82), z),
            Self::ThreeQuarterBack => (DVec3::new(0.42, -0.8, -0.82), -z),
        }
    }

    /// Where the side of the fabric faces that lies away from the ground in this view.
    #[must_use]
    pub fn ground_normal(self) -> DVec3 {
        match self {
            Self::Back | Self::ThreeQuarterBack => -DVec3::Z,
            _ => DVec3::Z,
        }
    }

    /// The projection that suits the view: parallel along an axis, where lengths can be read off; perspective else.
    #[must_use]
    pub fn projection(self) -> Projection {
        match self {
            Self::ThreeQuarter | Self::ThreeQuarterBack => Projection::Perspective { angle: 24f64.to_radians() },
            _ => Projection::Orthographic,
        }
    }
}

/// A name that is no view.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no view; write one of front, back, right, left, top, bottom, three-quarter, three-quarter-back")]
pub struct UnknownView(pub String);

impl FromStr for View {
    type Err = UnknownView;
    fn from_str(name: &str) -> Result<Self, UnknownView> {
        Self::NAMES
            .iter()
            .find(|(known, _)| *known == name)
            .map(|(_, view)| *view)
            .ok_or_else(|| UnknownView(name.to_owned()))
    }
}

/// How depth becomes picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Parallel rays.
    Orthographic,
    /// Rays from one point; `angle` is the vertical angle of view \[rad\].
    Perspective {
        /// Vertical angle of view \[rad\].
        angle: f64,
    },
}

/// An eye that looks at a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The point in the middle of the picture; lengths in the picture are true in its plane \[m\].
    pub target: DVec3,
    /// Distance of the eye from the target \[m\].
    pub distance: f64,
    /// Unit vector to the right of the picture.
    pub right: DVec3,
    /// Unit vector up the picture.
    pub up: DVec3,
    /// Unit vector from the target to the eye.
    pub back: DVec3,
    /// Height of the picture in the target's plane \[m\].
    pub height: f64,
    /// How depth becomes picture.
    pub projection: Projection,
}

impl Camera {
    /// The eye from which all `points`, each a ball of `radius`, just fit a picture `aspect` times as wide as high, with
    /// `margin` (a fraction of the picture's height) free all around.
    ///
    /// One call for the points of all frames gives a sequence its fixed camera. Points that are not finite are passed
    /// over; without points the eye looks at a ball of one millimetre about the origin.
    #[must_use]
    pub fn framing(
        view: View,
        projection: Projection,
        points: &[DVec3],
        radius: f64,
        aspect: f64,
        margin: f64,
    ) -> Self {
        let (back, up) = view.directions();
        let back = back.normalize();
        let right = up.cross(back).normalize();
        let up = back.cross(right);
        let mut local: Vec<DVec3> =
            points.iter().filter(|p| p.is_finite()).map(|p| DVec3::new(p.dot(right), p.dot(up), p.dot(back))).collect();
        if local.is_empty() {
            local = vec![DVec3::splat(-1e-3), DVec3::splat(1e-3)];
        }
        let free = (1.0 - 2.0 * margin).max(0.1);
        let low = local.iter().fold(DVec3::INFINITY, |a, b| a.min(*b));
        let high = local.iter().fold(DVec3::NEG_INFINITY, |a, b| a.max(*b));
        let mut middle = 0.5 * (low + high);
        let half = 0.5 * (high - low) + radius;
        let free_width = (aspect - 2.0 * margin).max(0.1);
        let mut half_height = (half.y / free).max(half.x / free_width).max(1e-9);
        let mut distance = 4.0 * (half_height + half.z);
        if let Projection::Perspective { angle } = projection {
            let slope = (0.5 * angle).tan();
            // The eye's distance follows from its sideways place and the other way round: a few rounds settle both.
            for _ in 0..8 {
                distance = local
                    .iter()
                    .map(|p| {
                        let q = *p - middle;
                        let reach = (q.y.abs() + radius) / free;
                        let reach = reach.max((q.x.abs() + radius) / free_width);
                        q.z + radius + reach / slope
                    })
                    .fold(1e-9, f64::max);
                let mut span = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
                for p in &local {
                    let q = *p - middle;
                    let scale = distance / (distance - q.z);
                    span[0] = span[0].min((q.x - radius) * scale);
                    span[1] = span[1].max((q.x + radius) * scale);
                    span[2] = span[2].min((q.y - radius) * scale);
                    span[3] = span[3].max((q.y + radius) * scale);
                }
                middle.x += 0.5 * (span[0] + span[1]);
                middle.y += 0.5 * (span[2] + span[3]);
            }
            half_height = distance * slope;
        }
        Self {
            target: middle.x * right + middle.y * up + middle.z * back,
            distance,
            right,
            up,
            back,
            height: 2.0 * half_height,
            projection,
        }
    }

    /// Origin and unit direction of the ray through a point of the picture: `x` to the right and `y` up from the middle,
    /// both in units of half the picture's height.
    #[must_use]
    pub fn ray(&self, x: f64, y: f64) -> (DVec3, DVec3) {
        let seen = self.target + 0.5 * self.height * (x * self.right + y * self.up);
        let eye = self.target + self.distance * self.back;
        match self.projection {
            Projection::Orthographic => (seen + self.distance * self.back, -self.back),
            Projection::Perspective { .. } => (eye, (seen - eye).normalize()),
        }
    }

    /// Where a point appears: right and up from the middle in units of half the picture's height.
    #[must_use]
    pub fn place(&self, point: DVec3) -> (f64, f64) {
        let q = point - self.target;
        let scale = match self.projection {
            Projection::Orthographic => 1.0,
            Projection::Perspective { .. } => self.distance / (self.distance - q.dot(self.back)),
        };
        let unit = 2.0 * scale / self.height;
        (q.dot(self.right) * unit, q.dot(self.up) * unit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_view_frames_its_points_with_the_margin_and_no_more() {
        let points: Vec<DVec3> = (0..50)
            .map(|i| {
                let a = f64::from(i);
                DVec3::new(0.3 + 0.1 * a.sin(), -0.2 + 0.05 * (1.7 * a).cos(), 0.02 * (2.3 * a).sin())
            })
            .collect();
        for (name, view) in View::NAMES {
            assert_eq!(name.parse(), Ok(view));
            for projection in [Projection::Orthographic, Projection::Perspective { angle: 0.6 }] {
                let (aspect, margin) = (1.5, 0.05);
                let camera = Camera::framing(view, projection, &points, 1e-6, aspect, margin);
                let (mut x, mut y) = (0f64, 0f64);
                for p in &points {
                    let at = camera.place(*p);
                    x = x.max(at.0.abs());
                    y = y.max(at.1.abs());
                }
                let (free_x, free_y) = (aspect - 2.0 * margin, 1.0 - 2.0 * margin);
                assert!(x < free_x + 1e-3 && y < free_y + 1e-3, "{name}: {x} {y}");
                assert!(x > free_x - 0.02 || y > free_y - 0.02, "{name} is loose: {x} {y}");
            }
        }
        assert!("sideways".parse::<View>().is_err());
    }

    #[test]
    fn a_ray_goes_through_the_point_it_was_asked_for() {
        let points = [DVec3::ZERO, DVec3::new(1.0, 2.0, 0.5)];
        for projection in [Projection::Orthographic, Projection::Perspective { angle: 0.5 }] {
            let camera = Camera::framing(View::ThreeQuarter, projection, &points, 0.1, 1.0, 0.1);
            let p = DVec3::new(0.4, 0.9, 0.3);
            let (x, y) = camera.place(p);
            let (origin, direction) = camera.ray(x, y);
            assert!((p - origin).cross(direction).length() < 1e-9);
        }
        let empty = Camera::framing(View::Front, Projection::Orthographic, &[DVec3::NAN], 0.0, 1.0, 0.0);
        assert!(empty.height.is_finite() && empty.height > 0.0);
    }
}
