//! The numbers of a material that a fit may change, and how elements change with them.

use wale::energy::{ContactPhase, Element, RodBending, RodContact, RodStick, RodStretch};

use super::material::RodMaterial;

/// A number of a material that a fit may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RodParameter {
    /// `k_s1` \[N\].
    SoftStretch,
    /// `k_s2` \[N\].
    StiffStretch,
    /// `ε̄` \[–\].
    Onset,
    /// `k_b` \[N·m²\].
    Bending,
    /// `R₁` \[m\].
    OuterRadius,
    /// `k_c1` \[J/m²\].
    OuterContact,
    /// `k_h` \[N/m²\].
    Holding,
}

impl RodParameter {
    /// Number of them.
    pub const COUNT: usize = 7;
    /// All, in the order of arrays.
    pub const ALL: [Self; Self::COUNT] = [
        Self::SoftStretch,
        Self::StiffStretch,
        Self::Onset,
        Self::Bending,
        Self::OuterRadius,
        Self::OuterContact,
        Self::Holding,
    ];
    /// What they are called in files, in the same order.
    pub const NAMES: [&'static str; Self::COUNT] = ["k_s1", "k_s2", "onset", "k_b", "R_1", "k_c1", "k_h"];
}

impl RodMaterial {
    /// The numbers that a fit may change, in the order of [`RodParameter::ALL`].
    #[must_use]
    pub fn parameters(&self) -> [f64; RodParameter::COUNT] {
        let ContactPhase { radius, stiffness } = self.contact[0];
        [self.soft_stretch, self.stiff_stretch, self.onset, self.bending, radius, stiffness, self.holding]
    }

    /// The same material with these numbers.
    #[must_use]
    pub fn with_parameters(&self, parameters: [f64; RodParameter::COUNT]) -> Self {
        let [soft_stretch, stiff_stretch, onset, bending, radius, stiffness, holding] = parameters;
        let contact = [ContactPhase { radius, stiffness }, self.contact[1]];
        Self { soft_stretch, stiff_stretch, onset, bending, contact, reading: self.reading, holding }
    }
}

/// An element of a tile's yarns.
pub trait OfMaterial<const N: usize>: Element<N> {
    /// Calls `visit(number, energy [J], gradient)` with the derivatives of energy and gradient by every number of the material that it
    /// feels, its vertices held.
    fn by_parameters(&self, q: &[f64; N], material: &RodMaterial, visit: &mut impl FnMut(RodParameter, f64, &[f64; N]));
}

impl OfMaterial<6> for RodStretch {
    fn by_parameters(&self, q: &[f64; 6], _: &RodMaterial, visit: &mut impl FnMut(RodParameter, f64, &[f64; 6])) {
        for (number, soft, stiff) in [(RodParameter::SoftStretch, 1.0, 0.0), (RodParameter::StiffStretch, 0.0, 1.0)] {
            let (energy, gradient) = Self { soft, stiff, ..*self }.gradient(q);
            visit(number, energy, &gradient);
        }
        visit(RodParameter::Onset, self.energy_by_onset(q), &self.gradient_by_onset(q));
    }
}

impl OfMaterial<12> for RodBending {
    fn by_parameters(&self, q: &[f64; 12], _: &RodMaterial, visit: &mut impl FnMut(RodParameter, f64, &[f64; 12])) {
        let (energy, gradient) = Self { stiffness: 1.0, ..*self }.gradient(q);
        visit(RodParameter::Bending, energy, &gradient);
    }
}

impl OfMaterial<12> for RodContact {
    fn by_parameters(&self, q: &[f64; 12], _: &RodMaterial, visit: &mut impl FnMut(RodParameter, f64, &[f64; 12])) {
        let [outer, inner] = self.phases;
        let phases = [ContactPhase { stiffness: 1.0, ..outer }, ContactPhase { stiffness: 0.0, ..inner }];
        let (energy, gradient) = Self { phases, ..*self }.gradient(q);
        visit(RodParameter::OuterContact, energy, &gradient);
        visit(RodParameter::OuterRadius, self.energy_by_outer_radius(q), &self.gradient_by_outer_radius(q));
    }
}

impl OfMaterial<12> for RodStick {
    fn by_parameters(
        &self,
        q: &[f64; 12],
        material: &RodMaterial,
        visit: &mut impl FnMut(RodParameter, f64, &[f64; 12]),
    ) {
        let (energy, gradient) = self.gradient(q);
        visit(RodParameter::Holding, energy / material.holding, &gradient.map(|g| g / material.holding));
    }
}
