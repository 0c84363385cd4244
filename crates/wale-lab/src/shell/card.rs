//! The card of a fabric as a thin shell.

use wale::energy::{BendingStiffness, MembraneStiffness};

use super::error::{ShellError, not_negative, positive};

/// What a fabric is, as a thin shell [Sperl2022, section 5].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShellCard {
    /// In-plane stiffnesses, `x` along the weft and `y` along the warp \[N/m\].
    pub membrane: MembraneStiffness,
    /// Bending stiffnesses by the direction of curvature \[N·m\].
    pub bending: BendingStiffness,
    /// Mass an area \[kg/m²\].
    pub areal_mass: f64,
}

impl ShellCard {
    /// That its numbers are such that a flat piece is stable.
    ///
    /// # Errors
    /// [`ShellError::Number`] if a stiffness along an axis is not positive, another is negative, the two stretches are coupled
    /// more strongly than they are stiff, or the mass is negative.
    pub fn check(&self) -> Result<(), ShellError> {
        let m = &self.membrane;
        positive("k_xx", m.xx)?;
        positive("k_yy", m.yy)?;
        positive("k_ss", m.ss)?;
        not_negative("k_n1", m.n1)?;
        not_negative("k_n2", m.n2)?;
        not_negative("m_xx", m.stiffening_xx)?;
        not_negative("m_yy", m.stiffening_yy)?;
        not_negative("m_ss", m.stiffening_ss)?;
        positive("1 − |m_xy|", 1.0 - m.stiffening_xy.abs())?;
        let area = 2.0 * (m.n1 + m.n2);
        let most = ((m.xx + area) * (m.yy + area)).sqrt();
        let coupled = (m.xy + area).abs();
        if coupled >= most || coupled.is_nan() {
            let must = "smaller in size than what it couples, √(C_xx C_yy)";
            return Err(ShellError::Number { what: "C_xy = k_xy + 2(k_n1 + k_n2)", value: m.xy + area, must });
        }
        for (what, value) in BendingStiffness::NAMES.into_iter().zip(self.bending.to_array()) {
            not_negative(what, value)?;
        }
        not_negative("areal mass", self.areal_mass)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_card_that_is_not_stable_is_refused() {
        let membrane =
            MembraneStiffness { xx: 30.0, xy: 5.0, yy: 80.0, ss: 6.0, n1: 1.0, n2: 2.0, ..MembraneStiffness::NONE };
        let card = ShellCard { membrane, bending: BendingStiffness::isotropic(2e-6), areal_mass: 0.2 };
        assert_eq!(card.check(), Ok(()));
        let with = |membrane| ShellCard { membrane, ..card }.check();
        assert!(with(MembraneStiffness { xx: 0.0, ..membrane }).is_err());
        assert!(with(MembraneStiffness { ss: f64::NAN, ..membrane }).is_err());
        assert!(with(MembraneStiffness { xy: 60.0, ..membrane }).is_err());
        assert!(with(MembraneStiffness { n2: -1.0, ..membrane }).is_err());
        assert!(with(MembraneStiffness { stiffening_xy: 0.5, stiffening_xx: 9.0, ..membrane }).is_ok());
        assert!(with(MembraneStiffness { stiffening_xy: 1.0, ..membrane }).is_err());
        assert!(with(MembraneStiffness { stiffening_ss: -1.0, ..membrane }).is_err());
        assert!(ShellCard { areal_mass: -0.1, ..card }.check().unwrap_err().to_string().contains("areal mass"));
        assert!(ShellCard { bending: BendingStiffness::isotropic(-1.0), ..card }.check().is_err());
    }
}
