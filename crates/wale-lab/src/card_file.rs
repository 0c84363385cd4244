//! Fabric cards as files: what was fitted to a fabric, in TOML, with the factor within which each number is known.

use std::fmt::Write;

use serde::Deserialize;
use wale::energy::{BendingStiffness, MembraneStiffness};
use wale::scene::dimensions::ForcePerLength;
use wale::scene::units::{Any, Dimension, Positive, Quantity};
use wale::scene::{SceneError, TextFile};

use crate::fabric_file::ArealMass;

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

/// A fabric as a thin shell, as far as its tests told.
#[derive(Clone, Debug, PartialEq)]
pub struct ShellCardFile {
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
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Text {
    schema: u32,
    title: String,
    areal_mass: Option<Quantity<ArealMass, Positive>>,
    shell: ShellText,
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
    within: [f64; MembraneStiffness::COUNT],
    bending: Option<[Quantity<SheetBending, Positive>; BendingStiffness::COUNT]>,
}

impl ShellCardFile {
    /// The card as text. Reading it gives the same card.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let mut text = format!("schema = {SCHEMA}\ntitle = {}\n", toml_string(&self.title));
        if let Some(mass) = self.areal_mass {
            let _ = writeln!(text, "areal_mass = \"{mass:?} kg/m^2\"");
        }
        text.push_str("\n# A thin shell [Sperl2022, Eqs. 1 and 4]: x along the weft, y along the warp.\n[shell]\n");
        for (name, value) in MembraneStiffness::NAMES.into_iter().zip(self.membrane.to_array()) {
            let _ = writeln!(text, "{name} = \"{value:?} N/m\"");
        }
        let within: Vec<String> = self.membrane_within.iter().map(|&factor| number(factor)).collect();
        text.push_str(
            "# Each may be so many times larger or smaller, with 95 % confidence; inf where the tests do not tell.\n",
        );
        let _ = writeln!(text, "within = [{}]", within.join(", "));
        if let Some(bending) = self.bending {
            text.push_str("# Along the weft, the bias and the warp.\n");
            let values: Vec<String> = bending.to_array().iter().map(|value| format!("\"{value:?} N m\"")).collect();
            let _ = writeln!(text, "bending = [{}]", values.join(", "));
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
        Ok(Self {
            title: text.title,
            areal_mass: text.areal_mass.map(Quantity::si),
            membrane: MembraneStiffness::from_array(values),
            membrane_within: shell.within,
            bending: shell.bending.map(|three| BendingStiffness::from_array(three.map(Quantity::si))),
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
    use super::*;

    #[test]
    fn a_card_survives_being_written() {
        let card = ShellCardFile {
            title: "\"Jersey\" \\ 2\u{1}".to_owned(),
            areal_mass: Some(0.17),
            membrane: MembraneStiffness { xx: 12.0 / 7.0, xy: 0.3, yy: 1e2, ss: 5e-3, n1: 0.0, n2: 2.5 },
            membrane_within: [1.02, 3.5, 1.1, 2.0, f64::INFINITY, 1e9],
            bending: Some(BendingStiffness { weft: 1e-6, bias: 2e-6, warp: 1.0 / 3e5 }),
        };
        for card in [ShellCardFile { areal_mass: None, bending: None, ..card.clone() }, card] {
            let read = ShellCardFile::of(&TextFile::new(&card.to_toml(), "card.toml")).unwrap();
            assert_eq!(read, card);
        }
    }

    #[test]
    fn what_is_no_card_is_refused_with_its_place() {
        let card = ShellCardFile {
            title: String::new(),
            areal_mass: None,
            membrane: MembraneStiffness { xx: 1.0, xy: 0.0, yy: 1.0, ss: 1.0, n1: 0.0, n2: 0.0 },
            membrane_within: [1.0; 6],
            bending: None,
        };
        let refused = |from: &str, to: &str| {
            let text = card.to_toml().replacen(from, to, 1);
            ShellCardFile::of(&TextFile::new(&text, "card.toml")).unwrap_err().to_string()
        };
        assert!(refused("schema = 1", "schema = 2").contains("card.toml:1:10: schema 2 is not known"));
        assert!(refused("k_xx = \"1.0 N/m\"", "k_xx = \"-1.0 N/m\"").contains("must be positive"));
        assert!(refused("k_yy = \"1.0 N/m\"\n", "").contains("`k_yy` is missing"));
    }
}
