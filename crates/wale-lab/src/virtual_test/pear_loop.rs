//! The pear loop test [Sperl2022, section 4.3] at several distances of the clamps.

use std::f64::consts::FRAC_PI_2;

use wale_numerics::sparse_cholesky::CholeskyError;

use crate::shell::bending_fit::distances;
use crate::shell::pear_loop::{PearLoop, PearPoint};
use crate::shell::{ShellCard, ShellError};

/// Which way the loop's weight pulls it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hanging {
    /// The loop hangs from the clamps.
    Down,
    /// It stands on them.
    Up,
    /// It has no weight: all fabrics of the same stiffness in all directions make the same loops.
    Weightless,
}

/// How the clamps hold the strip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clamps {
    /// The strip leaves them towards each other.
    Facing,
    /// It leaves them side by side, downward.
    SideBySide,
}

/// Strip, clamps and weight.
#[derive(Clone, Debug, PartialEq)]
pub struct PearLoopTest {
    /// Free length between the clamps \[m\].
    pub length: f64,
    /// Width \[m\].
    pub width: f64,
    /// Direction of the strip from the weft (0) towards the warp (π/2) \[rad\].
    pub angle: f64,
    /// How the clamps hold it.
    pub clamps: Clamps,
    /// Which way its weight pulls.
    pub hanging: Hanging,
    /// Distances between the clamps \[m\].
    pub distances: Vec<f64>,
}

impl Default for PearLoopTest {
    /// 100 × 60 mm along the weft, hanging from clamps that face each other, 3 to 34 mm apart.
    fn default() -> Self {
        Self {
            length: 0.1,
            width: 0.06,
            angle: 0.0,
            clamps: Clamps::Facing,
            hanging: Hanging::Down,
            distances: distances().to_vec(),
        }
    }
}

/// What the test reports.
#[derive(Clone, Debug, PartialEq)]
pub struct PearLoopResult {
    /// Loops by distance of the clamps; `h/p` is their aspect.
    pub points: Vec<PearPoint>,
}

impl PearLoopTest {
    /// Bends a fabric into loops.
    ///
    /// # Errors
    /// As [`PearLoop::run`].
    pub fn run(&self, card: &ShellCard) -> Result<PearLoopResult, ShellError> {
        let gravity = match self.hanging {
            Hanging::Down => -9.81,
            Hanging::Up => 9.81,
            Hanging::Weightless => 0.0,
        };
        let test = PearLoop {
            length: self.length,
            width: self.width,
            angle: self.angle,
            clamp_angle: if self.clamps == Clamps::Facing { 0.0 } else { FRAC_PI_2 },
            gravity: [0.0, 0.0, gravity],
            ..PearLoop::default()
        };
        let points = test.run(card, &self.distances).map_err(|error| match error {
            ShellError::Cholesky(CholeskyError::NotPositiveDefinite { .. }) => ShellError::Unstable("a loop".into()),
            other => other,
        })?;
        Ok(PearLoopResult { points })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wale::energy::{BendingStiffness, MembraneStiffness};

    #[test]
    fn weight_draws_a_loop_long_and_clamps_side_by_side_make_a_pear() {
        let membrane =
            MembraneStiffness { xx: 300.0, xy: 20.0, yy: 300.0, ss: 60.0, n1: 2.0, n2: 4.0, ..MembraneStiffness::NONE };
        let card = ShellCard { membrane, bending: BendingStiffness::isotropic(2e-5), areal_mass: 0.2 };
        let test = PearLoopTest { distances: vec![0.01], width: 0.02, ..PearLoopTest::default() };
        let aspect =
            |hanging, clamps| PearLoopTest { hanging, clamps, ..test.clone() }.run(&card).unwrap().points[0].aspect;
        let facing = [Hanging::Up, Hanging::Weightless, Hanging::Down].map(|hanging| aspect(hanging, Clamps::Facing));
        assert!(facing[0] < facing[1] && facing[1] < facing[2], "{facing:?}");
        // A limp loop from clamps side by side is taller than wide, and does not stand on clamps that face each other.
        let limp = ShellCard { bending: BendingStiffness::isotropic(1e-6), ..card };
        let pear = PearLoopTest { clamps: Clamps::SideBySide, ..test.clone() }.run(&limp).unwrap().points[0];
        assert!(pear.aspect > 1.2 && pear.width > pear.distance, "{pear:?}");
        let fallen = PearLoopTest { hanging: Hanging::Up, ..test }.run(&limp);
        assert!(matches!(fallen, Err(ShellError::Unstable(_) | ShellError::NotAtRest { .. })), "{fallen:?}");
    }
}
