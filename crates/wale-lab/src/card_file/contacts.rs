//! The contact model on a card.

use std::fmt::Write;

use serde::Deserialize;
use wale::scene::dimensions::{BendingStiffness, Force};
use wale::scene::units::{NotNegative, Quantity};
use wale::scene::{SceneError, TextFile};

use super::{number, toml_string};

/// The contact model of a fabric.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactsCard {
    /// The file with the scene that has all of its numbers, beside the card.
    pub scene: String,
    /// Those that were fitted.
    pub numbers: Vec<ContactNumber>,
}

/// A number of the contact model.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactNumber {
    /// What it is called.
    pub name: String,
    /// Its value.
    pub stiffness: ContactStiffness,
    /// Factor within which it is known with 95 % confidence, infinite where the data do not say.
    pub within: f64,
}

/// A stiffness of the contact model, of either dimension.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ContactStiffness {
    /// Against everything else \[N\].
    Force(f64),
    /// Against bending of a yarn \[N·m²\].
    Bending(f64),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ContactsText {
    scene: String,
    numbers: Vec<ContactNumberText>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ContactNumberText {
    name: String,
    stiffness: Option<Quantity<Force, NotNegative>>,
    bending_stiffness: Option<Quantity<BendingStiffness, NotNegative>>,
    within: f64,
}

impl ContactsText {
    pub(super) fn card(self, file: &TextFile) -> Result<ContactsCard, SceneError> {
        let number = |(index, text): (usize, ContactNumberText)| {
            let stiffness = match (text.stiffness, text.bending_stiffness) {
                (Some(force), None) => ContactStiffness::Force(force.si()),
                (None, Some(bending)) => ContactStiffness::Bending(bending.si()),
                _ => {
                    let what = format!("{} has not one value", text.name);
                    let mend = "give a stiffness or a bending_stiffness";
                    return Err(file.error(&format!("contacts.numbers.{index}"), what, mend));
                }
            };
            Ok(ContactNumber { name: text.name, stiffness, within: text.within })
        };
        let numbers = self.numbers.into_iter().enumerate().map(number).collect::<Result<_, _>>()?;
        Ok(ContactsCard { scene: self.scene, numbers })
    }
}

impl ContactsCard {
    pub(super) fn write(&self, text: &mut String) {
        text.push_str(
            "\n# Its contact model [Cirio2017]: other scenes have its numbers by `[yarn] card = \"card.toml\"`.\n[contacts]\n",
        );
        let _ = writeln!(text, "scene = {}\nnumbers = [", toml_string(&self.scene));
        for ContactNumber { name, stiffness, within } in &self.numbers {
            let value = match stiffness {
                ContactStiffness::Force(value) => format!("stiffness = \"{value:?} N\""),
                ContactStiffness::Bending(value) => format!("bending_stiffness = \"{value:?} N m^2\""),
            };
            let _ = writeln!(text, "    {{ name = {}, {value}, within = {} }},", toml_string(name), number(*within));
        }
        text.push_str("]\n");
    }
}
