//! What is known of a yarn before it is fitted: numbers that are held, and bounds within which others are looked for.

use serde::Deserialize;
use wale::scene::dimensions::{BendingStiffness, Force, ForcePerLength, Length, Pressure, Ratio};
use wale::scene::units::{Bounds, Dimension, NotNegative, Positive, Quantity};
use wale::scene::{SceneError, TextFile};

use crate::yarn_tile::RodParameter;

/// Least and largest value of each number, in SI units and in the order of [`RodParameter::ALL`]; equal where it is held, none where
/// nothing is said.
pub type KnownNumbers = [Option<[f64; 2]>; RodParameter::COUNT];

/// Values of some numbers: `[held]`.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[allow(non_snake_case, reason = "the symbols of the paper")]
pub struct HeldText {
    k_s1: Option<Quantity<Force, Positive>>,
    k_s2: Option<Quantity<Force, Positive>>,
    onset: Option<Quantity<Ratio, NotNegative>>,
    k_b: Option<Quantity<BendingStiffness, Positive>>,
    R_1: Option<Quantity<Length, Positive>>,
    k_c1: Option<Quantity<ForcePerLength, Positive>>,
    k_h: Option<Quantity<Pressure, Positive>>,
}

/// Least and largest values of some numbers: `[within]`.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[allow(non_snake_case, reason = "the symbols of the paper")]
pub struct WithinText {
    k_s1: Option<[Quantity<Force, Positive>; 2]>,
    k_s2: Option<[Quantity<Force, Positive>; 2]>,
    onset: Option<[Quantity<Ratio, NotNegative>; 2]>,
    k_b: Option<[Quantity<BendingStiffness, Positive>; 2]>,
    R_1: Option<[Quantity<Length, Positive>; 2]>,
    k_c1: Option<[Quantity<ForcePerLength, Positive>; 2]>,
    k_h: Option<[Quantity<Pressure, Positive>; 2]>,
}

fn pair<D: Dimension, B: Bounds>(both: [Quantity<D, B>; 2]) -> [f64; 2] {
    both.map(|one| one.si())
}

/// What both tables say together.
///
/// # Errors
/// If bounds are the wrong way round, or a number is in both.
pub fn known(held: HeldText, within: WithinText, file: &TextFile) -> Result<KnownNumbers, SceneError> {
    let held: [Option<f64>; RodParameter::COUNT] = [
        held.k_s1.map(Quantity::si),
        held.k_s2.map(Quantity::si),
        held.onset.map(Quantity::si),
        held.k_b.map(Quantity::si),
        held.R_1.map(Quantity::si),
        held.k_c1.map(Quantity::si),
        held.k_h.map(Quantity::si),
    ];
    let within: KnownNumbers = [
        within.k_s1.map(pair),
        within.k_s2.map(pair),
        within.onset.map(pair),
        within.k_b.map(pair),
        within.R_1.map(pair),
        within.k_c1.map(pair),
        within.k_h.map(pair),
    ];
    let mut known = [None; RodParameter::COUNT];
    for (k, name) in RodParameter::NAMES.into_iter().enumerate() {
        known[k] = match (held[k], within[k]) {
            (Some(_), Some(_)) => {
                let what = format!("{name} is held, and is to be looked for within bounds");
                return Err(file.error(&format!("within.{name}"), what, "leave one of them out"));
            }
            (_, Some([least, largest])) if least > largest => {
                let what = format!("the least {name} is larger than the largest");
                return Err(file.error(&format!("within.{name}"), what, "write the smaller value first"));
            }
            (Some(value), None) => Some([value; 2]),
            (None, bounds) => bounds,
        };
    }
    Ok(known)
}
