//! Pure bending test of KES-FB2 \[Kawabata1980\]: a specimen 20 cm wide, 1 cm from clamp to clamp, is bent to ±2.5 cm⁻¹.

use wale::fabric::coordinates::BLOCK;

use super::units::PER_CM;
use crate::shell::error::{ShellError, positive};
use crate::shell::mesh::Rectangle;
use crate::shell::rest::{RestSettings, come_to_rest};
use crate::shell::{ShellCard, ShellSystem};

/// A specimen, and how it is bent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KesBendingTest {
    /// Length between the clamps \[m\].
    pub length: f64,
    /// Width \[m\].
    pub width: f64,
    /// Direction that is curved, from the weft (0) towards the warp (π/2) \[rad\].
    pub angle: f64,
    /// Largest curvature, to either side \[1/m\].
    pub largest: f64,
    /// Points to either side.
    pub points: usize,
    /// Rows of triangles between the clamps and in them.
    pub rows: usize,
}

/// Curvatures between which the slope is taken \[1/m\].
const SLOPE: [f64; 2] = [0.5 * PER_CM, 1.5 * PER_CM];

impl Default for KesBendingTest {
    /// 20 cm wide, 1 cm long, along the weft, ±2.5 cm⁻¹ in steps of a quarter.
    fn default() -> Self {
        Self { length: 0.01, width: 0.2, angle: 0.0, largest: 2.5 * PER_CM, points: 10, rows: 6 }
    }
}

/// What the test reports. `2HB`, the hysteresis at 1 cm⁻¹, is zero for every elastic shell: it is no result.
#[derive(Clone, Debug, PartialEq)]
pub struct KesBendingResult {
    /// `B`: slope of the moment by width between 0.5 and 1.5 cm⁻¹ \[N·m\].
    pub rigidity: f64,
    /// Curvature \[1/m\] and moment by width \[N\], from one side to the other. A shell is flat at rest and the same both ways, so one
    /// side is bent and the other is its mirror image.
    pub points: Vec<[f64; 2]>,
}

impl KesBendingTest {
    /// Bends a fabric.
    ///
    /// # Errors
    /// [`ShellError`]: an impossible number, a fabric without bending stiffness, or a specimen that does not come to rest.
    pub fn run(&self, card: &ShellCard) -> Result<KesBendingResult, ShellError> {
        positive("length between the clamps", self.length)?;
        let (sin, cos) = self.angle.sin_cos();
        positive("bending stiffness along the specimen", card.bending.along([cos, sin]))?;
        // Clamps that turn past each other cannot be.
        let most = 1.8 * std::f64::consts::PI / self.length;
        if !(self.largest >= SLOPE[1] && self.largest < most) {
            let must = "at least 150 per metre, and less than bends the specimen nearly to a ring";
            return Err(ShellError::Number { what: "largest curvature", value: self.largest, must });
        }
        let count = self.points.max(4);
        let curvature = |k: usize| self.largest * k as f64 / count as f64;
        let side: Vec<[f64; 2]> = (1..=count)
            .map(|k| Ok([curvature(k), self.moment(card, curvature(k))?]))
            .collect::<Result<_, ShellError>>()?;
        let [low, high] = [self.moment(card, SLOPE[0])?, self.moment(card, SLOPE[1])?];
        let rigidity = (high - low) / (SLOPE[1] - SLOPE[0]);
        let points = side.iter().rev().map(|p| p.map(|x| -x)).chain([[0.0; 2]]).chain(side.iter().copied()).collect();
        Ok(KesBendingResult { rigidity, points })
    }

    /// Moment by width \[N\] that holds the second clamp where a uniform curvature takes it \[1/m\].
    fn moment(&self, card: &ShellCard, curvature: f64) -> Result<f64, ShellError> {
        let strips = 2 * (self.rows.max(4) / 2);
        // Clamps end in the middle of the first and the last row of triangles, as those of a pear loop do.
        let step = self.length / (strips as f64 - 1.0);
        let rectangle = Rectangle::new(step * strips as f64, self.width, step / 0.75f64.sqrt())?;
        let held_rows = [0, 1, strips - 1, strips];
        let mut held = vec![[false; 3]; rectangle.mesh.points.len()];
        for row in held_rows {
            held[rectangle.rows[row].clone()].fill([true; 3]);
        }
        let mut system = ShellSystem::new(&rectangle.mesh, card, self.angle, [0.0; 3], &held)?;
        let mut q = vec![0.0; BLOCK * rectangle.mesh.points.len()];
        let mut place = [-0.5 * step, 0.0];
        let mut end = place;
        for (row, vertices) in rectangle.rows.iter().enumerate() {
            for v in vertices.clone() {
                q[BLOCK * v..BLOCK * v + 3].copy_from_slice(&[place[0], rectangle.mesh.points[v][1], place[1]]);
            }
            let (sin, cos) = (curvature * step * row as f64).sin_cos();
            end = [place[0] - 0.5 * step * cos, place[1] - 0.5 * step * sin];
            place = [place[0] + step * cos, place[1] + step * sin];
        }
        come_to_rest(&mut system, &mut q, &RestSettings::default()).map_err(|error| match error {
            ShellError::NotAtRest { iterations, residual, .. } => {
                ShellError::NotAtRest { load: format!("a curvature of {curvature:.1} 1/m"), iterations, residual }
            }
            other => other,
        })?;
        let gradient = system.gradient();
        let torque = |v: usize| {
            let [x, z] = [0, 2].map(|axis| q[BLOCK * v + axis]);
            (x - end[0]) * gradient[BLOCK * v + 2] - (z - end[1]) * gradient[BLOCK * v]
        };
        let rows = rectangle.rows[strips - 1].clone().chain(rectangle.rows[strips].clone());
        Ok(rows.map(torque).sum::<f64>() / self.width)
    }
}

#[cfg(test)]
mod tests {
    use super::super::units::GF_CM2_PER_CM;
    use super::*;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
    use wale::energy::{BendingStiffness, MembraneStiffness};

    #[test]
    fn the_rigidity_of_a_known_fabric_is_measured_in_the_instruments_unit() {
        // B = 2k_θ: 0.04, 0.1 and 0.07 gf·cm²/cm.
        let [weft, bias, warp] = [0.04, 0.1, 0.07].map(|b| 0.5 * b * GF_CM2_PER_CM);
        let membrane =
            MembraneStiffness { xx: 400.0, xy: 20.0, yy: 500.0, ss: 40.0, n1: 2.0, n2: 4.0, ..MembraneStiffness::NONE };
        let card = ShellCard { membrane, bending: BendingStiffness { weft, bias, warp }, areal_mass: 0.2 };
        for (angle, known) in [(0.0, 0.04), (FRAC_PI_4, 0.1), (FRAC_PI_2, 0.07)] {
            let test = KesBendingTest { angle, points: 4, ..KesBendingTest::default() };
            let found = test.run(&card).unwrap();
            let ratio = found.rigidity / GF_CM2_PER_CM / known;
            // At its free sides a mesh is not as stiff as elsewhere, by up to a ninth, over a length of the specimen
            // (`docs/topics/thin-shell.md`).
            assert!((ratio - 1.0).abs() < test.length / test.width / 9.0, "{angle}: {ratio}");
            // A straight line through the middle.
            let [curvature, moment] = found.points[8];
            assert!((curvature - 250.0).abs() < 1e-9 && (moment / curvature / found.rigidity - 1.0).abs() < 2e-3);
            assert_eq!(found.points[4], [0.0; 2]);
        }
        let limp = ShellCard { bending: BendingStiffness::isotropic(0.0), ..card };
        assert!(KesBendingTest::default().run(&limp).is_err());
        assert!(KesBendingTest { largest: 1e4, ..KesBendingTest::default() }.run(&card).is_err());
    }
}
