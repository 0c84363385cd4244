//! Fabric cards as files: what was fitted to a fabric, in TOML, with the factor within which each number is known.

mod contacts;
mod yarn;

use std::fmt::Write;

use serde::Deserialize;
use wale::energy::{BendingStiffness, MembraneStiffness};
use wale::scene::dimensions::{ForcePerLength, Ratio};
use wale::scene::units::{Any, Dimension, NotNegative, Positive, Quantity};
use wale::scene::{SceneError, TextFile};

use crate::fabric_file::ArealMass;
use contacts::ContactsText;
use yarn::YarnText;

pub use contacts::{ContactNumber, ContactStiffness, ContactsCard};
pub use yarn::YarnCard;

/// Version of the format.
pub const SCHEMA: u32 = 1;

/// Bending stiffness of a sheet \[N·m\].
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct SheetBending;

impl Dimension for SheetBending {
    const NAME: &'static str = "a bending stiffness of a sheet";
    const SI: &'static str = "N m";
    const UNITS: &'static [(&'static str, f64)] =
        &[("N m", 1.0), ("uN m", 1e-6), ("gf cm^2/cm", 9.806_65e-5), ("mN mm", 1e-6)];
    const EXAMPLE: &'static str = "\"5 uN m\"";
    const LARGEST: f64 = 10.0;
}

/// A fabric, as far as its tests told.
#[derive(Clone, Debug, PartialEq)]
pub struct CardFile {
    /// What the fabric is called.
    pub title: String,
    /// Mass by area \[kg/m²\], if known.
    pub areal_mass: Option<f64>,
    /// In-plane stiffnesses \[N/m\].
    pub membrane: MembraneStiffness,
    /// Factors within which these are known with 95 % confidence, infinite where the data do not say.
    pub membrane_within: [f64; MembraneStiffness::COUNT],
    /// Bending stiffnesses \[N·m\], if loops were measured.
    pub bending: Option<BendingStiffness>,
    /// Factors within which these are known with 95 % confidence, if loops were fitted.
    pub bending_within: Option<[f64; BendingStiffness::COUNT]>,
    /// Its yarn, if it was fitted.
    pub yarn: Option<YarnCard>,
    /// Its contact model, if that was fitted.
    pub contacts: Option<ContactsCard>,
    /// What its tests left open, and what was assumed and not measured, in words.
    pub open: Vec<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Text {
    schema: u32,
    title: String,
    areal_mass: Option<Quantity<ArealMass, Positive>>,
    #[serde(default)]
    open: Vec<String>,
    shell: ShellText,
    yarn: Option<YarnText>,
    contacts: Option<ContactsText>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ShellText {
    k_xx: Quantity<ForcePerLength, Positive>,
    k_xy: Quantity<ForcePerLength, Any>,
    k_yy: Quantity<ForcePerLength, Positive>,
    k_ss: Quantity<ForcePerLength, Positive>,
    k_n1: Quantity<ForcePerLength, Any>,
    k_n2: Quantity<ForcePerLength, Any>,
    m_xx: Option<Quantity<ForcePerLength, NotNegative>>,
    m_yy: Option<Quantity<ForcePerLength, NotNegative>>,
    m_ss: Option<Quantity<ForcePerLength, NotNegative>>,
    m_xy: Option<Quantity<Ratio, Any>>,
    within: Vec<f64>,
    bending: Option<[Quantity<SheetBending, Positive>; BendingStiffness::COUNT]>,
    bending_within: Option<[f64; BendingStiffness::COUNT]>,
}

impl CardFile {
    /// The card as text. Reading it gives the same card.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let mut text = format!("schema = {SCHEMA}\ntitle = {}\n", toml_string(&self.title));
        if let Some(mass) = self.areal_mass {
            let _ = writeln!(text, "areal_mass = \"{mass:?} kg/m^2\"");
        }
        if !self.open.is_empty() {
            text.push_str("# What the tests left open, and what was not measured of this fabric.\nopen = [\n");
            self.open.iter().for_each(|what| {
                let _ = writeln!(text, "    {},", toml_string(what));
            });
            text.push_str("]\n");
        }
        text.push_str("\n# A thin shell [Sperl2022, Eqs. 1 and 4]: x along the weft, y along the warp.\n[shell]\n");
        let used = self.membrane.used();
        for (k, (name, value)) in
            MembraneStiffness::NAMES.into_iter().zip(self.membrane.to_array()).enumerate().take(used)
        {
            let _ = match k {
                MembraneStiffness::QUADRATIC => {
                    text.push_str("# It becomes stiffer as it is stretched.\n");
                    writeln!(text, "{name} = \"{value:?} N/m\"")
                }
                k if k + 1 == MembraneStiffness::COUNT => writeln!(text, "{name} = {value:?}"),
                _ => writeln!(text, "{name} = \"{value:?} N/m\""),
            };
        }
        let within: Vec<String> = self.membrane_within.iter().take(used).map(|&factor| number(factor)).collect();
        text.push_str(
            "# Each may be so many times larger or smaller, with 95 % confidence; inf where the tests do not tell.\n",
        );
        let _ = writeln!(text, "within = [{}]", within.join(", "));
        if let Some(bending) = self.bending {
            text.push_str("# Along the weft, the bias and the warp.\n");
            let values: Vec<String> = bending.to_array().iter().map(|value| format!("\"{value:?} N m\"")).collect();
            let _ = writeln!(text, "bending = [{}]", values.join(", "));
        }
        if let Some(within) = self.bending_within {
            let _ = writeln!(text, "bending_within = [{}]", within.map(number).join(", "));
        }
        if let Some(yarn) = &self.yarn {
            yarn.write(&mut text);
        }
        if let Some(contacts) = &self.contacts {
            contacts.write(&mut text);
        }
        text
    }

    /// Reads a card.
    ///
    /// # Errors
    /// If it is none, or something in it is wrong.
    pub fn of(file: &TextFile) -> Result<Self, SceneError> {
        let text: Text = file.parse()?;
        if text.schema != SCHEMA {
            return Err(file.error(
                "schema",
                format!("schema {} is not known", text.schema),
                format!("write {SCHEMA}"),
            ));
        }
        let shell = text.shell;
        let values =
            [shell.k_xx.si(), shell.k_xy.si(), shell.k_yy.si(), shell.k_ss.si(), shell.k_n1.si(), shell.k_n2.si()];
        let of = |stiffening: Option<Quantity<ForcePerLength, NotNegative>>| stiffening.map_or(0.0, Quantity::si);
        let membrane = MembraneStiffness {
            stiffening_xx: of(shell.m_xx),
            stiffening_yy: of(shell.m_yy),
            stiffening_ss: of(shell.m_ss),
            stiffening_xy: shell.m_xy.map_or(0.0, Quantity::si),
            ..MembraneStiffness::quadratic(values)
        };
        if shell.within.len() != membrane.used() {
            let (has, used) = (shell.within.len(), membrane.used());
            let what = format!("`within` has {has} factors for {used} stiffnesses");
            return Err(file.error("shell.within", what, "give one for each, in their order".to_owned()));
        }
        // What the card does not have is zero, and is known to be.
        let mut within = [1.0; MembraneStiffness::COUNT];
        within.iter_mut().zip(&shell.within).for_each(|(factor, given)| *factor = *given);
        Ok(Self {
            title: text.title,
            areal_mass: text.areal_mass.map(Quantity::si),
            membrane,
            membrane_within: within,
            bending: shell.bending.map(|three| BendingStiffness::from_array(three.map(Quantity::si))),
            bending_within: shell.bending_within,
            yarn: text.yarn.map(YarnText::card),
            contacts: text.contacts.map(|contacts| contacts.card(file)).transpose()?,
            open: text.open,
        })
    }
}

/// A number as TOML has it: always with a point, or `inf`.
fn number(value: f64) -> String {
    format!("{value:?}")
}

/// A basic string of TOML.
fn toml_string(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            c if c.is_control() => {
                let _ = write!(out, "\\u{:04X}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

#[cfg(test)]
mod tests {
    use wale::energy::ContactReading;

    use super::*;
    use crate::yarn_tile::RodMaterial;

    #[test]
    fn a_card_survives_being_written() {
        let card = CardFile {
            title: "\"Jersey\" \\ 2\u{1}".to_owned(),
            areal_mass: Some(0.17),
            membrane: MembraneStiffness {
                xx: 12.0 / 7.0,
                xy: 0.3,
                yy: 1e2,
                ss: 5e-3,
                n1: 0.0,
                n2: 2.5,
                ..MembraneStiffness::NONE
            },
            membrane_within: [1.02, 3.5, 1.1, 2.0, f64::INFINITY, 1e9, 1.0, 1.0, 1.0, 1.0],
            bending: Some(BendingStiffness { weft: 1e-6, bias: 2e-6, warp: 1.0 / 3e5 }),
            bending_within: Some([1.5, f64::INFINITY, 1.0]),
            yarn: None,
            contacts: None,
            open: vec!["k_ss is \"open\"".to_owned(), "assumed: all".to_owned()],
        };
        let material = RodMaterial {
            onset: 0.07,
            holding: 1e5 / 3.0,
            reading: ContactReading::Barrier,
            ..RodMaterial::solid_rod(0.3e-3, 1e7, 20.0)
        };
        let within = [1.0, 2.0, f64::INFINITY, 1.5, 1.1, 7.0, 2.0];
        let yarn = Some(YarnCard { material, within, tile: "tile.pyp".to_owned() });
        let contact = |name: &str, stiffness, within| ContactNumber { name: name.to_owned(), stiffness, within };
        let contacts = Some(ContactsCard {
            scene: "swatch.toml".to_owned(),
            numbers: vec![
                contact("warp bending", ContactStiffness::Bending(1e-8 / 3.0), 1.5),
                contact("shear", ContactStiffness::Force(0.1), f64::INFINITY),
            ],
        });
        let whole = CardFile { yarn, contacts, ..card.clone() };
        let stiffens = CardFile {
            membrane: MembraneStiffness { stiffening_xx: 1.5, stiffening_xy: 1.0 / 3.0, ..card.membrane },
            membrane_within: [1.02, 3.5, 1.1, 2.0, f64::INFINITY, 1e9, 1.5, f64::INFINITY, 2.0, 1.25],
            ..card.clone()
        };
        for card in
            [CardFile { areal_mass: None, bending: None, bending_within: None, ..card.clone() }, card, whole, stiffens]
        {
            let read = CardFile::of(&TextFile::new(&card.to_toml(), "card.toml")).unwrap();
            assert_eq!(read, card);
        }
    }

    #[test]
    fn what_is_no_card_is_refused_with_its_place() {
        let card = CardFile {
            title: String::new(),
            areal_mass: None,
            membrane: MembraneStiffness {
                xx: 1.0,
                xy: 0.0,
                yy: 1.0,
                ss: 1.0,
                n1: 0.0,
                n2: 0.0,
                ..MembraneStiffness::NONE
            },
            membrane_within: [1.0; MembraneStiffness::COUNT],
            bending: None,
            bending_within: None,
            yarn: None,
            contacts: None,
            open: Vec::new(),
        };
        let refused = |from: &str, to: &str| {
            let text = card.to_toml().replacen(from, to, 1);
            CardFile::of(&TextFile::new(&text, "card.toml")).unwrap_err().to_string()
        };
        assert!(refused("schema = 1", "schema = 2").contains("card.toml:1:10: schema 2 is not known"));
        assert!(refused("k_xx = \"1.0 N/m\"", "k_xx = \"-1.0 N/m\"").contains("must be positive"));
        assert!(refused("within = [1.0, ", "within = [").contains("5 factors for 6 stiffnesses"));
        let two = "open = []\n[contacts]\nscene = \"s\"\nnumbers = [{ name = \"shear\", within = 1.0 }]\n[shell]";
        assert!(refused("[shell]", two).contains("shear has not one value"));
        assert!(refused("k_yy = \"1.0 N/m\"\n", "").contains("`k_yy` is missing"));
    }
}
