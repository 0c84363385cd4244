//! The bias extension test: a strip on the bias between clamps shears in its middle as in a picture frame [Cao2008].

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, SQRT_2};

use super::rig::{Rig, Specimen};
use super::units::DEG;
use crate::shell::ShellCard;
use crate::shell::error::{ShellError, positive};

/// A specimen, and how far it is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BiasExtensionTest {
    /// What is clamped; at least twice as long as wide, or no part of it is sheared freely.
    pub specimen: Specimen,
    /// Largest angle of shear by the travel of the clamps \[rad\].
    pub largest: f64,
    /// Points of the curve.
    pub points: usize,
}

impl Default for BiasExtensionTest {
    /// 150 × 50 mm, to 40°.
    fn default() -> Self {
        Self { specimen: Specimen { length: 0.15, width: 0.05 }, largest: 40.0 * DEG, points: 40 }
    }
}

/// A point of the curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BiasPoint {
    /// Angle of shear in the middle by the travel of the clamps, as if yarns neither stretched nor slipped \[rad\].
    pub angle: f64,
    /// Angle of shear in the middle as a camera sees it \[rad\].
    pub seen_angle: f64,
    /// Travel over the length at rest \[–\].
    pub stretch: f64,
    /// Force \[N\].
    pub force: f64,
    /// Normalised shear force \[N/m\].
    pub shear_force: f64,
}

/// What the test reports.
#[derive(Clone, Debug, PartialEq)]
pub struct BiasExtensionResult {
    /// From rest on.
    pub points: Vec<BiasPoint>,
    /// Slope of the normalised shear force up to the first point \[N/(m·rad)\].
    pub rigidity: f64,
}

impl BiasExtensionTest {
    /// Draws a fabric along its bias. It stays flat.
    ///
    /// Of a specimen of length `H` and width `W` of stiff yarns the middle, `½W(2H − 3W)`, is sheared by `γ`, `W²` beside it by `γ/2`,
    /// and the rest not at all; the work of the clamps gives
    /// `F_s(γ) = [(H/W − 1) F (cos γ/2 − sin γ/2) − W F_s(γ/2) cos γ/2] / ((2H − 3W) cos γ)`      [Cao2008]
    ///
    /// # Errors
    /// [`ShellError`]: an impossible number, or a specimen that does not come to rest.
    pub fn run(&self, card: &ShellCard) -> Result<BiasExtensionResult, ShellError> {
        let Specimen { length, width } = self.specimen;
        positive("width of the specimen", width)?;
        if !(length >= 2.0 * width && length < f64::INFINITY) {
            let must = "at least twice the width";
            return Err(ShellError::Number { what: "length of a specimen on the bias", value: length, must });
        }
        if !(self.largest > 0.0 && self.largest <= 80.0 * DEG) {
            let must = "above 0 and at most 80°, in radians";
            return Err(ShellError::Number { what: "largest angle of shear", value: self.largest, must });
        }
        let diagonal = length - width;
        let mut rig = Rig::new(card, self.specimen, FRAC_PI_4, self.specimen.edge())?;
        let mut points = vec![BiasPoint { angle: 0.0, seen_angle: 0.0, stretch: 0.0, force: 0.0, shear_force: 0.0 }];
        let count = self.points.max(4);
        for k in 1..=count {
            let angle = self.largest * k as f64 / count as f64;
            let travel = diagonal * (SQRT_2 * (FRAC_PI_4 - 0.5 * angle).cos() - 1.0);
            rig.move_to([travel, 0.0])?;
            let (force, (sin, cos)) = (rig.force()[0], (0.5 * angle).sin_cos());
            let half = half_way(&points, angle, force, self.specimen);
            let shear_force = ((length / width - 1.0) * force * (cos - sin) - width * half * cos)
                / ((2.0 * length - 3.0 * width) * angle.cos());
            points.push(BiasPoint { angle, seen_angle: seen(&rig), stretch: travel / length, force, shear_force });
        }
        let rigidity = points[1].shear_force / points[1].angle;
        Ok(BiasExtensionResult { points, rigidity })
    }
}

/// Normalised shear force at half an angle, from the points before; at the first, whose half lies before any, shear is taken to
/// be linear.
fn half_way(points: &[BiasPoint], angle: f64, force: f64, specimen: Specimen) -> f64 {
    let half = 0.5 * angle;
    let upper = points.partition_point(|p| p.angle < half);
    if upper == 0 || upper == points.len() {
        let Specimen { length, width } = specimen;
        let (sin, cos) = half.sin_cos();
        let whole = (length / width - 1.0) * force * (cos - sin)
            / ((2.0 * length - 3.0 * width) * angle.cos() + 0.5 * width * cos);
        return 0.5 * whole;
    }
    let (a, b) = (&points[upper - 1], &points[upper]);
    a.shear_force + (half - a.angle) / (b.angle - a.angle) * (b.shear_force - a.shear_force)
}

/// By how much the angle between weft and warp is less than a right one in the middle \[rad\].
fn seen(rig: &Rig) -> f64 {
    let [along, across] = rig.middle();
    let yarn = |sign: f64| [along[0] + sign * across[0], along[1] + sign * across[1]];
    let (p, q) = (yarn(1.0), yarn(-1.0));
    let cross = (p[0] * q[1] - p[1] * q[0]).abs();
    FRAC_PI_2 - cross.atan2(p[0] * q[0] + p[1] * q[1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use wale::energy::{BendingStiffness, MembraneStiffness};

    #[test]
    fn stiff_yarns_shear_as_in_a_picture_frame() {
        let (stiff, k_ss) = (3e4, 20.0);
        let membrane = MembraneStiffness { xx: stiff, xy: 0.0, yy: stiff, ss: k_ss, n1: 0.0, n2: 0.0 };
        let card = ShellCard { membrane, bending: BendingStiffness::isotropic(0.0), areal_mass: 0.0 };
        let test = BiasExtensionTest { largest: 30.0 * DEG, points: 12, ..BiasExtensionTest::default() };
        let found = test.run(&card).unwrap();
        for point in &found.points[1..] {
            // The frame's F_s/L is k_ss sin γ without area terms.
            let frame = k_ss * point.angle.sin();
            assert!((point.shear_force / frame - 1.0).abs() < 0.08, "{} {frame} {point:?}", point.angle.to_degrees());
            assert!((point.seen_angle / point.angle - 1.0).abs() < 0.05, "{point:?}");
        }
        assert!(BiasExtensionTest { specimen: Specimen { length: 0.09, width: 0.05 }, ..test }.run(&card).is_err());
    }
}
