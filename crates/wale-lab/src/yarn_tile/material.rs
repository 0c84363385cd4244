//! What a yarn is made of, as the full-contact model sees it.

use serde::{Deserialize, Serialize};
use wale::energy::{ContactPhase, ContactReading};

use super::equilibrium::TileError;
use super::tile::YarnTile;

/// Mechanical parameters of the yarns of a tile [Sperl2022, section 6].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RodMaterial {
    /// Stretch stiffness `k_s1` at small stretch \[N\].
    pub soft_stretch: f64,
    /// Stretch stiffness `k_s2` in compression and at large stretch \[N\].
    pub stiff_stretch: f64,
    /// Stretch `ε̄` at which the yarn becomes stiff \[–\].
    pub onset: f64,
    /// Bending stiffness `k_b` \[N·m²\].
    pub bending: f64,
    /// Outer, soft, and inner, stiff, phase of contact: `R₁`, `k_c1`, `R₂`, `k_c2` \[m, J/m²\].
    pub contact: [ContactPhase; 2],
    /// How the printed contact energy is read.
    pub reading: ContactReading,
    /// Stiffness `k_h` \[N/m²\] with which yarns stick where they touch at rest: what friction does to yarns that do not slide.
    ///
    /// Differs from the paper: it has none, and a knit whose yarns slide freely begins to stretch with next to no force, which no
    /// knit does that was measured. Test: `yarns_stick_where_they_touch`.
    pub holding: f64,
}

impl RodMaterial {
    /// A solid round rod of radius `R` \[m\] and Young's modulus `E` \[Pa\], `k_s = E πR²` and `k_b = E πR⁴/4`, in contact with a
    /// stiffness \[J/m²\]; the inner contact has a quarter of the radius and a stiffness of 10³ J/m².
    #[must_use]
    pub fn solid_rod(radius: f64, young: f64, contact: f64) -> Self {
        let stretch = young * std::f64::consts::PI * radius * radius;
        Self {
            soft_stretch: stretch,
            stiff_stretch: stretch,
            onset: 0.0,
            bending: 0.25 * stretch * radius * radius,
            contact: [
                ContactPhase { radius, stiffness: contact },
                ContactPhase { radius: Self::INNER_RADIUS * radius, stiffness: Self::INNER_STIFFNESS },
            ],
            reading: ContactReading::default(),
            holding: 0.0,
        }
    }

    /// Radius of the inner contact over that at which all edges touch \[–\] [Sperl2022, section 7.3.2].
    pub const INNER_RADIUS: f64 = 0.25;
    /// Stiffness of the inner contact, in the paper's unnamed unit, here J/m² [Sperl2022, section 7.3.2].
    pub const INNER_STIFFNESS: f64 = 1e3;

    /// Unit of force of a bent yarn, `k_b/R₁² + 10⁻³ k_s1` \[N\].
    pub(super) fn force_unit(&self) -> f64 {
        let radius = self.contact[0].radius;
        self.bending / (radius * radius) + 1e-3 * self.soft_stretch
    }

    /// Distance of centrelines within which yarns touch \[m\].
    pub(super) fn reach(&self) -> f64 {
        2.0 * self.contact[0].radius.max(self.contact[1].radius)
    }

    /// Whether a tile can be made of it.
    pub(super) fn check(&self, tile: &YarnTile) -> Result<(), TileError> {
        let [outer, inner] = self.contact;
        let fault = |what: &'static str, value: f64, why: &'static str| Err(TileError::Material { what, value, why });
        for (what, value) in [
            ("stretch stiffness", self.soft_stretch),
            ("large-stretch stiffness", self.stiff_stretch),
            ("outer contact radius", outer.radius),
            ("inner contact radius", inner.radius),
        ] {
            if value <= 0.0 || !value.is_finite() {
                return fault(what, value, "it must be positive");
            }
        }
        for (what, value) in [
            ("onset of large stretch", self.onset),
            ("bending stiffness", self.bending),
            ("holding stiffness", self.holding),
            ("outer contact stiffness", outer.stiffness),
            ("inner contact stiffness", inner.stiffness),
        ] {
            if value < 0.0 || !value.is_finite() {
                return fault(what, value, "it must not be negative");
            }
        }
        // Beyond this every yarn would touch every image of every other.
        if self.reach() > tile.periods()[0] + tile.periods()[1] {
            return fault("outer contact radius", 0.5 * self.reach(), "yarns would reach over the whole tile");
        }
        Ok(())
    }
}
