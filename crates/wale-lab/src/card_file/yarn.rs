//! The yarn on a card.

use std::fmt::Write;

use serde::Deserialize;
use wale::energy::{ContactPhase, ContactReading};
use wale::scene::dimensions::{BendingStiffness, Force, ForcePerLength, Length, Pressure, Ratio};
use wale::scene::units::{NotNegative, Positive, Quantity};

use super::{number, toml_string};
use crate::yarn_tile::{RodMaterial, RodParameter};

/// The yarn of a fabric, in full contact.
#[derive(Clone, Debug, PartialEq)]
pub struct YarnCard {
    /// What it is made of.
    pub material: RodMaterial,
    /// Factors within which its numbers are known with 95 % confidence, in the order of `RodParameter::ALL`; one where a number was
    /// held, infinite where the data do not say.
    pub within: [f64; RodParameter::COUNT],
    /// The file with its tile and rest shapes, beside the card.
    pub tile: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(non_snake_case)]
pub(super) struct YarnText {
    k_s1: Quantity<Force, Positive>,
    k_s2: Quantity<Force, Positive>,
    onset: Quantity<Ratio, NotNegative>,
    k_b: Quantity<BendingStiffness, NotNegative>,
    R_1: Quantity<Length, Positive>,
    k_c1: Quantity<ForcePerLength, NotNegative>,
    k_h: Quantity<Pressure, NotNegative>,
    R_2: Quantity<Length, Positive>,
    k_c2: Quantity<ForcePerLength, NotNegative>,
    contact: ContactReading,
    within: [f64; RodParameter::COUNT],
    tile: String,
}

impl YarnText {
    pub(super) fn card(self) -> YarnCard {
        let outer = ContactPhase { radius: self.R_1.si(), stiffness: self.k_c1.si() };
        let inner = ContactPhase { radius: self.R_2.si(), stiffness: self.k_c2.si() };
        YarnCard {
            material: RodMaterial {
                soft_stretch: self.k_s1.si(),
                stiff_stretch: self.k_s2.si(),
                onset: self.onset.si(),
                bending: self.k_b.si(),
                contact: [outer, inner],
                reading: self.contact,
                holding: self.k_h.si(),
            },
            within: self.within,
            tile: self.tile,
        }
    }
}

impl YarnCard {
    pub(super) fn write(&self, text: &mut String) {
        text.push_str(
            "\n# Its yarn in full contact [Sperl2022, Eqs. 5 to 7]; k_h is how it sticks to yarns that it touches.\n[yarn]\n",
        );
        let units = ["N", "N", "", "N m^2", "m", "N/m", "Pa"];
        for ((name, value), unit) in RodParameter::NAMES.into_iter().zip(self.material.parameters()).zip(units) {
            let _ = match unit {
                "" => writeln!(text, "{name} = {value:?}"),
                unit => writeln!(text, "{name} = \"{value:?} {unit}\""),
            };
        }
        let [_, inner] = self.material.contact;
        let _ = writeln!(text, "R_2 = \"{:?} m\"\nk_c2 = \"{:?} N/m\"", inner.radius, inner.stiffness);
        let reading = match self.material.reading {
            ContactReading::SquareOfBarrier => "square_of_barrier",
            ContactReading::Barrier => "barrier",
            ContactReading::BarrierOfSquare => "barrier_of_square",
        };
        let _ = writeln!(text, "contact = \"{reading}\"");
        let within: Vec<String> = self.within.iter().map(|&factor| number(factor)).collect();
        let _ = writeln!(text, "within = [{}]\ntile = {}", within.join(", "), toml_string(&self.tile));
    }
}
