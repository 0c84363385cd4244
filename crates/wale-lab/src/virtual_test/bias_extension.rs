//! The bias extension test: a strip on the bias between clamps shears in its middle as in a picture frame \[Cao2008\].

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
    /// Edge length of the mesh \[m\].
    pub edge: f64,
}

impl Default for BiasExtensionTest {
    /// 150 × 50 mm, to 40°.
    fn default() -> Self {
        Self { specimen: Specimen { length: 0.15, width: 0.05 }, largest: 40.0 * DEG, points: 40, edge: 0.0025 }
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
    /// `F_s(γ) = [(H/W − 1) F (cos γ/2 − sin γ/2) − W F_s(γ/2) cos γ/2] / ((2H − 3W) cos γ)`      \[Cao2008\]
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
        let mut rig = Rig::new(card, self.specimen, FRAC_PI_4, self.edge)?;
        let count = self.points.max(4);
        let (mut angles, mut forces, mut seen_angles, mut travels) = (vec![0.0], vec![0.0], vec![0.0], vec![0.0]);
        for k in 1..=count {
            let angle = self.largest * k as f64 / count as f64;
            let travel = diagonal * (SQRT_2 * (FRAC_PI_4 - 0.5 * angle).cos() - 1.0);
            rig.move_to([travel, 0.0])?;
            angles.push(angle);
            forces.push(rig.force()[0]);
            seen_angles.push(seen(&rig));
            travels.push(travel);
        }
        let shear_forces = normalised(self.specimen, &angles, &forces);
        let points: Vec<BiasPoint> = (0..=count)
            .map(|k| BiasPoint {
                angle: angles[k],
                seen_angle: seen_angles[k],
                stretch: travels[k] / length,
                force: forces[k],
                shear_force: shear_forces[k],
            })
            .collect();
        let rigidity = points[1].shear_force / points[1].angle;
        Ok(BiasExtensionResult { points, rigidity })
    }
}

/// Normalised shear forces \[N/m\] by rising angles \[rad\] from zero on, of forces \[N\]: each needs the one at half its angle, which
/// comes from those before by linear interpolation.
fn normalised(specimen: Specimen, angles: &[f64], forces: &[f64]) -> Vec<f64> {
    let Specimen { length, width } = specimen;
    let mut out: Vec<f64> = vec![0.0];
    for k in 1..angles.len() {
        let (sin, cos) = (0.5 * angles[k]).sin_cos();
        let whole = (length / width - 1.0) * forces[k] * (cos - sin);
        let middle = (2.0 * length - 3.0 * width) * angles[k].cos();
        if k == 1 {
            // Half of the first angle lies before all others: there the force is taken to be linear.
            out.push(whole / (middle + 0.5 * width * cos));
            continue;
        }
        let half = 0.5 * angles[k];
        let upper = angles.partition_point(|angle| *angle < half).clamp(1, k - 1);
        let part = (half - angles[upper - 1]) / (angles[upper] - angles[upper - 1]);
        let beside = out[upper - 1] + part * (out[upper] - out[upper - 1]);
        out.push((whole - width * beside * cos) / middle);
    }
    out
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
    fn the_formula_undoes_the_work_of_the_three_zones() {
        // Stiff yarns with F_s(γ) = 20 sin γ + 5 sin³γ: the middle, ½W(2H − 3W), and W² at half the angle do all the work, while the
        // clamps travel √2 (H − W) cos(π/4 − γ/2).
        let law = |g: f64| 20.0 * g.sin() + 5.0 * g.sin().powi(3);
        let (h, w) = (0.15, 0.05);
        let angles: Vec<f64> = (0..=200).map(|k| 0.7 * f64::from(k) / 200.0).collect();
        let force = |g: &f64| {
            let work = 0.5 * w * (2.0 * h - 3.0 * w) * law(*g) * g.cos() + 0.5 * w * w * law(0.5 * g) * (0.5 * g).cos();
            work / ((h - w) * SQRT_2 * 0.5 * (FRAC_PI_4 - 0.5 * g).sin())
        };
        let forces: Vec<f64> = angles.iter().map(force).collect();
        let found = normalised(Specimen { length: h, width: w }, &angles, &forces);
        for (angle, force) in angles.iter().zip(&found).skip(1) {
            assert!((force / law(*angle) - 1.0).abs() < 1e-4, "{angle} {force}");
        }
    }

    /// What the least energy makes of a specimen three times as long as wide, of yarns that do not stretch and shear that is linear,
    /// over what the zones of the formula make of it: shear in a patch at the middle, and force.
    ///
    /// Displacements along each yarn depend on its own place alone, so shear is `f′(q) + f′(p)` with `f′ = 0` on yarns that touch a
    /// clamp; with `a = W/√2` free yarns have `q` from `a/2` to `5a/2` and cross those with `|p − q| < a`. The least of
    /// `∫∫ (f′(q) + f′(p))²` at a given travel `∫ f′` has `2a f′(q) + ∫ f′(p) dp = λ`.
    fn least_energy() -> [f64; 2] {
        let n = 400;
        let place = |k: usize| 0.5 + 2.0 * (k as f64 + 0.5) / n as f64;
        let (step, mut f) = (2.0 / n as f64, vec![0.5; n]);
        let crossing = |f: &[f64], k: usize| {
            (0..n).filter(|&j| (place(j) - place(k)).abs() < 1.0).map(|j| f[j] * step).sum::<f64>()
        };
        for _ in 0..200 {
            // Halfway to what the condition asks for, with λ such that the travel is that of f′ = ½ everywhere.
            let asked: Vec<f64> = (0..n).map(|k| 0.5 * (1.0 - crossing(&f, k))).collect();
            let off = 0.5 - asked.iter().sum::<f64>() / n as f64;
            f.iter_mut().zip(&asked).for_each(|(f, asked)| *f += 0.5 * (asked + off - *f));
        }
        let energy = |f: &[f64]| (0..n).map(|k| f[k] * (2.0 * f[k] + crossing(f, k)) * step).sum::<f64>();
        // A quarter of the width about the middle, as a camera sees it.
        let patch: Vec<f64> = (0..n).filter(|&k| (place(k) - 1.5).abs() < 0.3).map(|k| 2.0 * f[k]).collect();
        [patch.iter().sum::<f64>() / patch.len() as f64, energy(&f) / energy(&vec![0.5; n])]
    }

    #[test]
    fn stiff_yarns_shear_nearly_as_in_a_picture_frame() {
        let (stiff, k_ss) = (3e4, 20.0);
        let membrane =
            MembraneStiffness { xx: stiff, xy: 0.0, yy: stiff, ss: k_ss, n1: 0.0, n2: 0.0, ..MembraneStiffness::NONE };
        let card = ShellCard { membrane, bending: BendingStiffness::isotropic(0.0), areal_mass: 0.0 };
        let test = BiasExtensionTest { largest: 30.0 * DEG, points: 12, ..BiasExtensionTest::default() };
        let found = test.run(&card).unwrap();
        let [shear, force] = least_energy();
        assert!((shear - 0.818).abs() < 2e-3 && (force - 0.988).abs() < 1e-3, "{shear} {force}");
        for point in &found.points[1..] {
            // The frame's F_s/L is k_ss sin γ without area terms. Yarns that stretch a little give way by a layer of √(k_ss/k_xx).
            let frame = k_ss * point.angle.sin();
            let layer = (k_ss / stiff).sqrt();
            assert!((point.shear_force / frame - force).abs() < layer, "{} {point:?}", point.shear_force / frame);
        }
        let first = &found.points[1];
        assert!((first.seen_angle / first.angle - shear).abs() < 0.03, "{first:?}");
        assert!(BiasExtensionTest { specimen: Specimen { length: 0.09, width: 0.05 }, ..test }.run(&card).is_err());
    }
}
