//! Shear test of KES-FB1 \[Kawabata1980\]: a specimen 20 cm wide and 5 cm long, pulled by 10 gf/cm, is sheared to ±8°.

use super::rig::{Rig, Specimen};
use super::units::{DEG, GF_PER_CM};
use crate::shell::ShellCard;
use crate::shell::error::{ShellError, positive};

/// A specimen, and how it is sheared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KesShearTest {
    /// What is clamped.
    pub specimen: Specimen,
    /// Direction of the pull from the weft (0) towards the warp (π/2) \[rad\].
    pub angle: f64,
    /// Constant pull by width \[N/m\].
    pub tension: f64,
    /// Largest angle of shear, to either side \[rad\].
    pub largest: f64,
    /// Points to either side.
    pub points: usize,
}

/// Angles between which the slope is taken \[rad\].
pub(crate) const SLOPE: [f64; 2] = [0.5 * DEG, 5.0 * DEG];

impl Default for KesShearTest {
    /// 20 cm wide, 5 cm long, 10 gf/cm along the weft, ±8° in steps of half a degree.
    fn default() -> Self {
        let specimen = Specimen { length: 0.05, width: 0.2 };
        Self { specimen, angle: 0.0, tension: 10.0 * GF_PER_CM, largest: 8.0 * DEG, points: 16 }
    }
}

/// What the test reports. `2HG` and `2HG5`, the hysteresis at 0.5° and 5°, are zero for every elastic shell: they are no results.
#[derive(Clone, Debug, PartialEq)]
pub struct KesShearResult {
    /// `G`: slope of the force by width between 0.5° and 5°, mean of both sides \[N/(m·rad)\].
    ///
    /// The pull is part of it: for a cloth of stiff yarns it is nearly `k_ss` and the pull by width.
    pub rigidity: f64,
    /// Angle \[rad\], force across by width \[N/m\], stretch along \[–\].
    pub points: Vec<[f64; 3]>,
}

impl KesShearResult {
    /// From points to either side, with angle and force positive on both.
    pub(crate) fn of_sides(one: &[[f64; 3]], other: &[[f64; 3]]) -> Self {
        let slope = |side: &[[f64; 3]]| {
            let at = |angle: f64| interpolate(side, angle);
            (at(SLOPE[1]) - at(SLOPE[0])) / (SLOPE[1] - SLOPE[0])
        };
        let rigidity = 0.5 * (slope(one) + slope(other));
        let points = other.iter().skip(1).rev().map(|[angle, force, stretch]| [-angle, -force, *stretch]);
        Self { rigidity, points: points.chain(one.iter().copied()).collect() }
    }
}

impl KesShearTest {
    /// Shears a fabric. The clamp moves by the length at rest times the tangent of the angle.
    ///
    /// # Errors
    /// [`ShellError`]: an impossible number, or a specimen that does not come to rest.
    pub fn run(&self, card: &ShellCard) -> Result<KesShearResult, ShellError> {
        positive("tension", self.tension)?;
        if !(self.largest >= SLOPE[1] && self.largest < 80.0 * DEG) {
            let must = "between 5° and 80°, in radians";
            return Err(ShellError::Number { what: "largest angle of shear", value: self.largest, must });
        }
        let one = self.side(card, 1.0)?;
        let other = self.side(card, -1.0)?;
        Ok(KesShearResult::of_sides(&one, &other))
    }

    /// Points to one side, with angle and force positive there.
    fn side(&self, card: &ShellCard, sign: f64) -> Result<Vec<[f64; 3]>, ShellError> {
        let Specimen { length, width } = self.specimen;
        let mut rig = Rig::new(card, self.specimen, self.angle, self.specimen.edge())?;
        // Off the axes of the fabric the pull alone would shear it; at no angle the clamps still face each other.
        rig.pull_to(self.tension * width, 0.0)?;
        let mut points = Vec::new();
        let count = self.points.max(4);
        for k in 0..=count {
            let angle = self.largest * k as f64 / count as f64;
            rig.pull_to(self.tension * width, sign * length * angle.tan())?;
            points.push([angle, sign * rig.force()[1] / width, rig.moved()[0] / length]);
        }
        Ok(points)
    }
}

/// Force at an angle among points by rising angle, linearly.
fn interpolate(points: &[[f64; 3]], angle: f64) -> f64 {
    let upper = points.partition_point(|p| p[0] < angle).clamp(1, points.len() - 1);
    let (a, b) = (points[upper - 1], points[upper]);
    a[1] + (angle - a[0]) / (b[0] - a[0]) * (b[1] - a[1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use wale::energy::{BendingStiffness, MembraneStiffness};

    #[test]
    fn a_cloth_of_stiff_yarns_tells_its_shear_stiffness_and_the_pull() {
        let (k_ss, stiff) = (30.0, 3e5);
        let membrane =
            MembraneStiffness { xx: stiff, xy: 0.0, yy: stiff, ss: k_ss, n1: 0.0, n2: 0.0, ..MembraneStiffness::NONE };
        let card = ShellCard { membrane, bending: BendingStiffness::isotropic(0.0), areal_mass: 0.0 };
        let test = KesShearTest { points: 8, ..KesShearTest::default() };
        let found = test.run(&card).unwrap();
        // Lines along the pull become (λ, tan φ), those across stay: E₁₁ = (λ² + tan²φ − 1)/2, 2E₁₂ = tan φ, and
        // Ψ = ½ k_xx E₁₁² + ½ k_ss tan²φ. The pull is ∂Ψ/∂λ = k_xx E₁₁ λ = T, the force across
        // ∂Ψ/∂tan φ = (k_xx E₁₁ + k_ss) tan φ = (k_ss + T/λ) tan φ.
        let tension = 10.0 * 0.980_665;
        let lambda = |t: f64| {
            (0..50).fold(1.0f64, |l, _| {
                let residual = stiff * 0.5 * (l * l + t * t - 1.0) * l - tension;
                l - residual / (stiff * (l * l + 0.5 * (l * l + t * t - 1.0)))
            })
        };
        let force = |angle: f64| {
            let t = angle.tan();
            (k_ss + tension / lambda(t)) * t
        };
        let expected = (force(5.0 * DEG) - force(0.5 * DEG)) / (4.5 * DEG);
        // Free sides bear no shear: they disturb a strip of about √(k_ss/k_xx) of the length, at either of two sides.
        let layer = 2.0 * (k_ss / stiff).sqrt() * test.specimen.length / test.specimen.width;
        assert!((found.rigidity / expected - 1.0).abs() < layer, "{} {expected}", found.rigidity);
        for [angle, force_found, stretch] in &found.points {
            assert!((force_found - force(*angle)).abs() < layer * force(8.0 * DEG), "{angle} {force_found}");
            assert!((1.0 + stretch - lambda(angle.tan())).abs() < 1e-4, "{stretch}");
        }
        assert!(found.points.windows(2).all(|p| p[1][0] > p[0][0]) && found.points.len() == 17);
        assert!(KesShearTest { largest: 0.01, ..test }.run(&card).is_err());
    }
}
