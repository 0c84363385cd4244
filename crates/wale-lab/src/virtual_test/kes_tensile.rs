//! Tensile test of KES-FB1 \[Kawabata1980\]: a specimen 20 cm wide and 5 cm long is drawn to 500 gf/cm.

use super::rig::{Rig, Specimen};
use super::units::GF_PER_CM;
use crate::shell::ShellCard;
use crate::shell::error::{ShellError, positive};

/// A specimen, and how it is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KesTensileTest {
    /// What is clamped.
    pub specimen: Specimen,
    /// Direction of the pull from the weft (0) towards the warp (π/2) \[rad\].
    pub angle: f64,
    /// Largest load by width \[N/m\].
    pub load: f64,
    /// Points of the curve.
    pub points: usize,
}

impl Default for KesTensileTest {
    /// 20 cm wide, 5 cm long, along the weft, 500 gf/cm.
    fn default() -> Self {
        Self { specimen: Specimen { length: 0.05, width: 0.2 }, angle: 0.0, load: 500.0 * GF_PER_CM, points: 20 }
    }
}

/// What the test reports. `RT`, the part of the work that comes back, is one for every elastic shell: it is no result.
#[derive(Clone, Debug, PartialEq)]
pub struct KesTensileResult {
    /// `LT = WT/(½ F_m EMT)` \[–\]: one for a straight line, less for a fabric that stiffens.
    pub linearity: f64,
    /// `WT`: work by area \[J/m²\].
    pub work: f64,
    /// `EMT`: stretch at the largest load \[–\].
    pub extensibility: f64,
    /// Stretch \[–\], load by width \[N/m\], contraction of the width at mid-length \[–\].
    pub points: Vec<[f64; 3]>,
}

impl KesTensileTest {
    /// Draws a fabric.
    ///
    /// # Errors
    /// [`ShellError`]: an impossible number, or a specimen that does not come to rest.
    pub fn run(&self, card: &ShellCard) -> Result<KesTensileResult, ShellError> {
        positive("load", self.load)?;
        let Specimen { length, width } = self.specimen;
        let clamp = || Rig::new(card, self.specimen, self.angle, self.specimen.edge());
        let mut rig = clamp()?;
        rig.pull_to(self.load * width, 0.0)?;
        let extensibility = rig.moved()[0] / length;
        // The work of the clamps is what an elastic specimen stores.
        let work = rig.energy() / (length * width);
        let mut rig = clamp()?;
        let mut points = vec![[0.0; 3]];
        for k in 1..=self.points {
            let stretch = extensibility * k as f64 / self.points as f64;
            rig.move_to([stretch * length, 0.0])?;
            points.push([stretch, rig.force()[0] / width, 1.0 - rig.width() / width]);
        }
        Ok(KesTensileResult { linearity: work / (0.5 * self.load * extensibility), work, extensibility, points })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;
    use wale::energy::{BendingStiffness, MembraneStiffness};

    fn card(xx: f64, yy: f64) -> ShellCard {
        let membrane = MembraneStiffness { xx, xy: 0.0, yy, ss: 30.0, n1: 0.0, n2: 0.0, ..MembraneStiffness::NONE };
        ShellCard { membrane, bending: BendingStiffness::isotropic(0.0), areal_mass: 0.0 }
    }

    #[test]
    fn a_stiff_cloth_draws_a_straight_line() {
        // 1 MN/m: 500 gf/cm stretch it by 0.049 %.
        let test = KesTensileTest::default();
        let found = test.run(&card(1e6, 1e6)).unwrap();
        let strain = 500.0 * 0.980_665 / 1e6;
        // E (1 + s) = load/k, so s is smaller than that by 3/2 of itself.
        assert!((found.extensibility / strain - 1.0).abs() < 2.0 * strain, "{found:?}");
        assert!((found.linearity - 1.0).abs() < strain, "{found:?}");
        assert!((found.work / (0.5 * test.load * strain) - 1.0).abs() < 3.0 * strain);
    }

    #[test]
    fn a_soft_cloth_stiffens_as_its_energy_says() {
        // Nothing contracts: F = k E (1 + s), WT = ½ k E², E = s + s²/2, so LT = (1 + s/2)/(1 + s).
        let k = 800.0;
        let found = KesTensileTest { angle: FRAC_PI_2, ..KesTensileTest::default() }.run(&card(100.0, k)).unwrap();
        let s = found.extensibility;
        let e = s + 0.5 * s * s;
        assert!(s > 0.3 && (k * e * (1.0 + s) / (500.0 * 0.980_665) - 1.0).abs() < 1e-7, "{s}");
        assert!((found.work / (0.5 * k * e * e) - 1.0).abs() < 1e-7);
        assert!((found.linearity / ((1.0 + 0.5 * s) / (1.0 + s)) - 1.0).abs() < 1e-7);
        // The curve's area is the work.
        let area: f64 = found.points.windows(2).map(|p| 0.5 * (p[1][0] - p[0][0]) * (p[0][1] + p[1][1])).sum();
        assert!((area / found.work - 1.0).abs() < 3e-3);
        assert!(KesTensileTest { load: 0.0, ..KesTensileTest::default() }.run(&card(1.0, 1.0)).is_err());
    }
}
