//! The card that a test is made with.

use std::path::Path;

use wale::energy::{BendingStiffness, MembraneStiffness};
use wale_lab::card_file::CardFile;
use wale_lab::shell::ShellCard;

use crate::arguments::lab::Common;
use crate::exit::{Code, Failure};

/// Beyond this factor a stiffness counts as not determined.
const DETERMINED: f64 = 3.0;

/// A card as a test takes it.
#[derive(Debug)]
pub struct Card {
    /// What the fabric is called.
    pub title: String,
    /// Its numbers; weight and bending are zero where they are not known and not needed.
    pub shell: ShellCard,
    /// What is to be known of the card when its numbers are read.
    pub remarks: Vec<String>,
}

/// What a test needs beside in-plane stiffnesses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Needs {
    /// Bending stiffness.
    pub bending: bool,
    /// Mass by area.
    pub mass: bool,
}

/// Makes a card ready for a test.
///
/// # Errors
/// If it lacks what the test needs.
pub fn card(card: CardFile, place: &Path, arguments: &Common, needs: Needs) -> Result<Card, Failure> {
    let lacks = |what: &str, option: &str| {
        let mend = "add [[bending]] loops and areal_mass to the fabric file and fit it again";
        Failure::new(
            Code::BadInput,
            format_args!("{} has no {what}, which this test needs: {mend}, or give it with {option}", place.display()),
        )
    };
    // B = 2k_θ.
    let given = arguments.bending.map(|rigidity| BendingStiffness::isotropic(0.5 * rigidity));
    let bending = given.or(card.bending);
    if needs.bending && bending.is_none() {
        return Err(lacks("bending stiffness", "--bending \"0.05 gf cm^2/cm\""));
    }
    let mass = arguments.areal_mass.or(card.areal_mass);
    if needs.mass && mass.is_none() {
        return Err(lacks("mass by area", "--areal-mass \"170 g/m^2\""));
    }
    let assumed = card.open.iter().filter(|what| what.starts_with("assumed: "));
    let mut remarks: Vec<String> = assumed.cloned().collect();
    let open: Vec<&str> = MembraneStiffness::NAMES
        .into_iter()
        .zip(card.membrane_within)
        .filter(|(_, within)| within.is_nan() || *within > DETERMINED)
        .map(|(name, _)| name)
        .collect();
    if !open.is_empty() {
        remarks.push(format!("not determined by the fabric's own tests: {}", open.join(", ")));
    }
    if needs.bending && given.is_some() {
        remarks.push("bending is the one given, the same in all directions".to_owned());
    }
    let shell = ShellCard {
        membrane: card.membrane,
        bending: bending.unwrap_or(BendingStiffness::isotropic(0.0)),
        areal_mass: mass.unwrap_or(0.0),
    };
    shell.check().map_err(|error| Failure::new(Code::BadInput, format_args!("{}: {error}", place.display())))?;
    Ok(Card { title: card.title, shell, remarks })
}
