//! FAST-2 and FAST-3: bending length, extension at three loads, extension along the bias, and what is worked out from them.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use super::rig::{Rig, Specimen};
use super::units::GF_PER_CM;
use crate::shell::bias_extension::{BIAS_LOAD, bias_extension};
use crate::shell::{Cantilever, ShellCard, ShellError};

/// The loads of FAST-3 \[N/m\]: 5, 20 and 100 gf/cm.
pub const LOADS: [f64; 3] = [5.0 * GF_PER_CM, 20.0 * GF_PER_CM, 100.0 * GF_PER_CM];

/// Specimens of both instruments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FastTest {
    /// What is clamped in FAST-3.
    pub specimen: Specimen,
    /// Strip of FAST-2, along the weft; it is turned to the warp too.
    pub cantilever: Cantilever,
}

impl Default for FastTest {
    /// 100 × 50 mm between the clamps, and a strip 50 mm wide at 41.5°.
    fn default() -> Self {
        let specimen = Specimen { length: 0.1, width: 0.05 };
        Self { specimen, cantilever: Cantilever { width: 0.05, rows: 24, ..Cantilever::default() } }
    }
}

/// What a direction reports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FastDirection {
    /// `E5`, `E20`, `E100`: stretch at the loads \[–\].
    pub extension: [f64; 3],
    /// Bending length `C` \[m\].
    pub bending_length: f64,
    /// Bending rigidity `B = W C³` with the weight by area `W` \[N·m\].
    pub bending_rigidity: f64,
    /// Formability `F = (E20 − E5) B / 14.7`, the force between both loads being 14.7 N/m \[m²\]. FAST prints it with `E` in
    /// per cent, a number in mm² a hundred times larger.
    pub formability: f64,
}

/// What the tests report.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FastResult {
    /// Weft and warp.
    pub directions: [FastDirection; 2],
    /// `EB5`: stretch along the bias at 5 gf/cm \[–\].
    pub bias_extension: f64,
    /// Shear rigidity `G = 123/EB5`, with the stretch in per cent \[N/m\].
    pub shear_rigidity: f64,
    /// The same of a strip that is strained uniformly, as the formula supposes \[N/m\]: clamps keep the ends of a short specimen from
    /// shearing.
    pub uniform_shear_rigidity: f64,
}

impl FastTest {
    /// Tests a fabric.
    ///
    /// # Errors
    /// [`ShellError`]: a card without weight or bending, or a specimen that does not come to rest.
    pub fn run(&self, card: &ShellCard) -> Result<FastResult, ShellError> {
        let [weft, warp] = [0.0, FRAC_PI_2].map(|angle| self.direction(card, angle));
        let [bias] = self.extension(card, FRAC_PI_4, [BIAS_LOAD])?;
        Ok(FastResult {
            directions: [weft?, warp?],
            bias_extension: bias,
            shear_rigidity: BIAS_LOAD / (4.0 * bias),
            uniform_shear_rigidity: bias_extension(&card.membrane, BIAS_LOAD)?.shear_rigidity,
        })
    }

    fn direction(&self, card: &ShellCard, angle: f64) -> Result<FastDirection, ShellError> {
        let extension = self.extension(card, angle, LOADS)?;
        let bend = Cantilever { angle, ..self.cantilever }.run(card)?;
        let formability = (extension[1] - extension[0]) * bend.flexural_rigidity / (LOADS[1] - LOADS[0]);
        Ok(FastDirection {
            extension,
            bending_length: bend.bending_length,
            bending_rigidity: bend.flexural_rigidity,
            formability,
        })
    }

    /// Stretch at rising loads by width \[–\].
    fn extension<const N: usize>(&self, card: &ShellCard, angle: f64, loads: [f64; N]) -> Result<[f64; N], ShellError> {
        let mut rig = Rig::new(card, self.specimen, angle, self.specimen.edge())?;
        let mut stretch = [0.0; N];
        for (stretch, load) in stretch.iter_mut().zip(loads) {
            rig.pull_to(load * self.specimen.width, 0.0)?;
            *stretch = rig.moved()[0] / self.specimen.length;
        }
        Ok(stretch)
    }
}

#[cfg(test)]
mod tests {
    use super::super::units::{FAST_MM2, MM, PERCENT, UN_M};
    use super::*;
    use wale::energy::{BendingStiffness, MembraneStiffness};

    #[test]
    fn a_known_cloth_has_the_numbers_that_are_worked_out_by_hand() {
        let (k, mass) = (1000.0, 0.168);
        let membrane =
            MembraneStiffness { xx: k, xy: 0.0, yy: k, ss: 26.0, n1: 0.0, n2: 0.0, ..MembraneStiffness::NONE };
        let card = ShellCard { membrane, bending: BendingStiffness::isotropic(2.7e-6), areal_mass: mass };
        // A coarse strip: what is tested is how its numbers are used.
        let cantilever = Cantilever { width: 0.02, rows: 14, ..Cantilever::default() };
        let found = FastTest { cantilever, ..FastTest::default() }.run(&card).unwrap();
        for one in found.directions {
            // Nothing contracts: load = k E (1 + s), E = s + s²/2.
            for (s, load) in one.extension.into_iter().zip(LOADS) {
                assert!((k * (s + 0.5 * s * s) * (1.0 + s) / load - 1.0).abs() < 1e-6, "{one:?}");
            }
            // The printed formulae, in the units that they are printed in.
            let c = one.bending_length / MM;
            let b = one.bending_rigidity / UN_M;
            assert!((mass * 1e3 * c.powi(3) * 9.81e-6 / b - 1.0).abs() < 1e-9);
            let f = (one.extension[1] - one.extension[0]) / PERCENT * b / 14.7;
            assert!((f / (one.formability / FAST_MM2) - 1.0).abs() < 2e-3, "{f} {one:?}");
        }
        assert!((123.0 / (found.bias_extension / PERCENT) / found.shear_rigidity - 1.0).abs() < 4e-3);
        // For small strains E = F/4 (1/k_ss + 1/k_xx + 1/k_yy).
        let uniform = 1.0 / (1.0 / 26.0 + 2.0 / k);
        assert!((found.uniform_shear_rigidity / uniform - 1.0).abs() < 0.08, "{found:?}");
        // Of a specimen twice as long as wide a quarter shears freely and a half by half: stiff yarns would make it 3/2 of that.
        let ratio = found.shear_rigidity / found.uniform_shear_rigidity;
        assert!(ratio > 1.0 && ratio < 1.5, "{ratio}");
    }
}
