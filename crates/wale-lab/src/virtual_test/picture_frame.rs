//! The picture frame: four hinged bars as long as the yarns between them shear a square of cloth uniformly \[Cao2008\].

use std::f64::consts::FRAC_PI_4;

use wale_numerics::jet::{Jet, Real};

use super::units::DEG;
use crate::shell::ShellCard;
use crate::shell::error::{ShellError, positive};

/// A frame, and how far it is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureFrameTest {
    /// Length of its bars, and of the cloth's sides \[m\].
    pub side: f64,
    /// Direction of the first bar from the weft (0) towards the warp (π/2) \[rad\]. Off the axes yarns are stretched too.
    pub angle: f64,
    /// Largest angle of shear \[rad\].
    pub largest: f64,
    /// Points of the curve.
    pub points: usize,
}

impl Default for PictureFrameTest {
    /// 20 cm, bars along weft and warp, to 45°.
    fn default() -> Self {
        Self { side: 0.2, angle: 0.0, largest: 45.0 * DEG, points: 45 }
    }
}

/// A point of the curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FramePoint {
    /// Angle of shear: by how much the angle between the bars is less than a right one \[rad\].
    pub angle: f64,
    /// How much further apart the pulled corners are than at rest \[m\].
    pub travel: f64,
    /// Force on these corners \[N\].
    pub force: f64,
    /// Normalised shear force `F_s/L`, `F_s = F/(2 cos α)` with half the angle `α` of the pulled corners \[N/m\].
    pub shear_force: f64,
    /// What the cloth stores \[J\].
    pub energy: f64,
}

/// What the test reports.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureFrameResult {
    /// From rest on.
    pub points: Vec<FramePoint>,
    /// Slope of the normalised shear force at rest \[N/(m·rad)\]: `k_ss` on the axes of the cloth.
    pub rigidity: f64,
}

impl PictureFrameTest {
    /// Shears a fabric. It stays flat: a shell that may not wrinkle does not lock either.
    ///
    /// With `s = sin γ` the metric between the bars is `[1, 1, s]` and the area ratio `√(1 − s²)`; the work of the corners gives
    /// `F_s/L = dΨ/ds` for every energy `Ψ`.
    ///
    /// # Errors
    /// [`ShellError`]: an impossible number.
    pub fn run(&self, card: &ShellCard) -> Result<PictureFrameResult, ShellError> {
        card.check()?;
        positive("side of the frame", self.side)?;
        if !(self.largest > 0.0 && self.largest <= 85.0 * DEG) {
            let must = "above 0 and at most 85°, in radians";
            return Err(ShellError::Number { what: "largest angle of shear", value: self.largest, must });
        }
        let density = |s: f64| {
            let s = Jet::<1>::variable(s, 0);
            let (sin, cos) = (2.0 * self.angle).sin_cos();
            let metric = [s.scale(-sin).offset(1.0), s.scale(sin).offset(1.0), s.scale(cos)];
            card.membrane.density(metric, (-(s * s)).offset(1.0).sqrt())
        };
        let count = self.points.max(2);
        let point = |k: usize| {
            let angle = self.largest * k as f64 / count as f64;
            let density = density(angle.sin());
            let half = FRAC_PI_4 - 0.5 * angle;
            let shear_force = density.gradient[0];
            FramePoint {
                angle,
                travel: 2.0 * self.side * (half.cos() - FRAC_PI_4.cos()),
                force: 2.0 * half.cos() * shear_force * self.side,
                shear_force,
                energy: self.side * self.side * density.value,
            }
        };
        let rigidity = density(0.0).hessian()[0][0];
        Ok(PictureFrameResult { points: (0..=count).map(point).collect(), rigidity })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shell::ShellSystem;
    use crate::shell::mesh::Rectangle;
    use crate::shell::rest::{RestSettings, come_to_rest};
    use wale::energy::{BendingStiffness, MembraneStiffness};
    use wale::fabric::coordinates::BLOCK;

    fn card() -> ShellCard {
        let membrane =
            MembraneStiffness { xx: 300.0, xy: 20.0, yy: 500.0, ss: 30.0, n1: 3.0, n2: 5.0, ..MembraneStiffness::NONE };
        ShellCard { membrane, bending: BendingStiffness::isotropic(0.0), areal_mass: 0.0 }
    }

    #[test]
    fn on_its_axes_a_cloth_resists_by_shear_and_area_alone() {
        let found = PictureFrameTest::default().run(&card()).unwrap();
        assert!((found.rigidity - 30.0).abs() < 1e-9);
        for point in &found.points[1..] {
            // Derived by hand: Ψ = ½ k_ss sin²γ + k_n1 (cos γ − 1)² + k_n2 log² cos γ, F_s/L = Ψ′(γ)/cos γ.
            let (sin, cos) = point.angle.sin_cos();
            let slope = 30.0 * sin * cos + 2.0 * 3.0 * (1.0 - cos) * sin - 2.0 * 5.0 * cos.ln() * sin / cos;
            assert!((point.shear_force / (slope / cos) - 1.0).abs() < 1e-12, "{point:?}");
        }
        assert!(PictureFrameTest { largest: 2.0, ..PictureFrameTest::default() }.run(&card()).is_err());
    }

    #[test]
    fn work_of_the_frame_is_what_the_cloth_stores() {
        for angle in [0.0, 0.3] {
            let test = PictureFrameTest { angle, points: 200, ..PictureFrameTest::default() };
            let found = test.run(&card()).unwrap();
            let work: f64 =
                found.points.windows(2).map(|p| 0.5 * (p[1].travel - p[0].travel) * (p[0].force + p[1].force)).sum();
            let last = found.points[found.points.len() - 1];
            assert!((work / last.energy - 1.0).abs() < 1e-4, "{work} {last:?}");
        }
    }

    #[test]
    fn a_mesh_held_by_the_frame_stores_the_same() {
        let test = PictureFrameTest { angle: 0.3, points: 2, ..PictureFrameTest::default() };
        let last = test.run(&card()).unwrap().points[2];
        let rectangle = Rectangle::new(test.side, test.side, 0.02).unwrap();
        let inside = |x: f64| x > 1e-9 && x < test.side - 1e-9;
        let held: Vec<[bool; 3]> = rectangle
            .mesh
            .points
            .iter()
            .map(|p| if inside(p[0]) && inside(p[1]) { [false, false, true] } else { [true; 3] })
            .collect();
        let mut system = ShellSystem::new(&rectangle.mesh, &card(), test.angle, [0.0; 3], &held).unwrap();
        let mut q = rectangle.mesh.laid_flat();
        let (sin, cos) = last.angle.sin_cos();
        for (v, &[x, y]) in rectangle.mesh.points.iter().enumerate() {
            // Places inside are disturbed, and come back.
            let push = if held[v][0] { 0.0 } else { 1e-3 * ((900.0 * x).sin() + (700.0 * y).cos()) };
            q[BLOCK * v] = x + sin * y + push;
            q[BLOCK * v + 1] = cos * y - push;
        }
        let energy = come_to_rest(&mut system, &mut q, &RestSettings::default()).unwrap().energy;
        assert!((energy / last.energy - 1.0).abs() < 1e-9, "{energy} {last:?}");
    }
}
