//! The yarn card of a scene.

use std::f64::consts::PI;

use super::si;
use crate::model::YarnCard;
use crate::scene::error::Complaint;
use crate::scene::schema::{Color, YarnText};
use crate::scene::units::{Bounds, Dimension, Quantity};

/// Bulk densities outside are slips of a unit: loose mohair has some 30 kg/m³, glass 2500 \[kg/m³\].
const BULK_DENSITY: std::ops::RangeInclusive<f64> = 5.0..=10_000.0;

/// Diameters that yarns have \[m\].
const DIAMETER: std::ops::RangeInclusive<f64> = 2e-6..=0.1;

/// The card and the colour; `base` stands behind what the scene says.
pub(super) fn resolve(path: &str, said: &YarnText, base: &YarnText) -> Result<(YarnCard, [u8; 3]), Complaint> {
    contradictions(path, said)?;
    let text = said_over_base(said, base);
    let missing = |key: &str| Complaint::new(path, format!("the yarn has no {key}")).mend(format!("add {key} = …"));
    let linear_density = si(text.linear_density).ok_or_else(|| missing("linear_density"))?;
    let radius = match (si(text.diameter), si(text.packing), si(text.fibre_density)) {
        (Some(diameter), ..) => diameter / 2.0,
        (None, Some(packing), Some(fibre)) => (linear_density / (PI * packing * fibre)).sqrt(),
        (None, Some(_), None) => return Err(missing("fibre_density")),
        (None, None, Some(_)) => return Err(missing("packing")),
        (None, None, None) => return Err(missing("diameter")),
    };
    let area = PI * radius * radius;
    if !DIAMETER.contains(&(2.0 * radius)) {
        let what = format!("the yarn is {:.3e} m thick", 2.0 * radius);
        return Err(Complaint::new(format!("{path}.diameter"), what).why("yarns are between 2 µm and 10 cm thick"));
    }
    let bulk = linear_density / area;
    if !BULK_DENSITY.contains(&bulk) {
        let what = format!("linear density and thickness make a yarn of {bulk:.3e} kg/m³");
        let key = if said.linear_density.is_some() { "linear_density" } else { "diameter" };
        return Err(Complaint::new(format!("{path}.{key}"), what)
            .why("yarns have 5 to 10000 kg/m³ (wool about 300, spun cotton about 800)")
            .mend("check the units of linear_density and diameter"));
    }
    let stretch = si(text.stretch_stiffness).or(si(text.elastic_modulus).map(|y| y * area));
    let bending = si(text.bending_stiffness).or(si(text.bending_modulus).map(|b| b * area));
    let card = YarnCard {
        linear_density,
        radius,
        stretch_stiffness: stretch.ok_or_else(|| missing("stretch_stiffness"))?,
        bending_stiffness: bending.ok_or_else(|| missing("bending_stiffness"))?,
        friction_coefficient: si(text.friction).ok_or_else(|| missing("friction"))?,
        mass_damping: si(text.mass_damping).unwrap_or(0.0),
        stiffness_damping: si(text.stiffness_damping).unwrap_or(0.0),
        loose_ends: text.loose_ends.unwrap_or(false),
        plies: text.plies.unwrap_or(2),
        twist: si(text.twist).unwrap_or(0.0),
    };
    if !(1..=YarnCard::MOST_PLIES).contains(&card.plies) {
        let what = format!("a yarn is drawn with 1 to {} plies, not {}", YarnCard::MOST_PLIES, card.plies);
        return Err(Complaint::new(format!("{path}.plies"), what));
    }
    Ok((card, text.color.unwrap_or(Color([0x8a, 0x8a, 0x8a])).0))
}

/// What a scene would have to say of a yarn to give this card.
///
/// # Errors
/// If a number is out of the bounds of the scene format.
pub(in crate::scene) fn text_of(card: &YarnCard, color: [u8; 3]) -> Result<YarnText, String> {
    fn some<D: Dimension, B: Bounds>(value: f64) -> Result<Option<Quantity<D, B>>, String> {
        Quantity::new(value).map(Some)
    }
    Ok(YarnText {
        linear_density: some(card.linear_density)?,
        diameter: some(2.0 * card.radius)?,
        stretch_stiffness: some(card.stretch_stiffness)?,
        bending_stiffness: some(card.bending_stiffness)?,
        friction: some(card.friction_coefficient)?,
        mass_damping: some(card.mass_damping)?,
        stiffness_damping: some(card.stiffness_damping)?,
        loose_ends: Some(card.loose_ends),
        color: Some(Color(color)),
        plies: Some(card.plies),
        twist: some(card.twist)?,
        ..YarnText::default()
    })
}

/// Two keys for one number.
fn contradictions(path: &str, said: &YarnText) -> Result<(), Complaint> {
    let pairs = [
        ("diameter", said.diameter.is_some(), "packing", said.packing.is_some()),
        ("stretch_stiffness", said.stretch_stiffness.is_some(), "elastic_modulus", said.elastic_modulus.is_some()),
        ("bending_stiffness", said.bending_stiffness.is_some(), "bending_modulus", said.bending_modulus.is_some()),
    ];
    for (first, has_first, second, has_second) in pairs {
        if has_first && has_second {
            return Err(Complaint::new(format!("{path}.{second}"), format!("{first} and {second} are both given"))
                .why("each follows from the other")
                .mend("keep one of them"));
        }
    }
    Ok(())
}

/// What the scene says, before what stands behind it. Keys that stand in each other's place are one choice.
pub(super) fn said_over_base(said: &YarnText, base: &YarnText) -> YarnText {
    let sized = said.packing.is_some() || said.fibre_density.is_some();
    YarnText {
        preset: None,
        card: None,
        name: None,
        together: None,
        linear_density: said.linear_density.or(base.linear_density),
        diameter: said.diameter.or(base.diameter.filter(|_| !sized)),
        packing: said.packing.or(base.packing).filter(|_| said.diameter.is_none()),
        fibre_density: said.fibre_density.or(base.fibre_density).filter(|_| said.diameter.is_none()),
        stretch_stiffness: said.stretch_stiffness.or(base.stretch_stiffness.filter(|_| said.elastic_modulus.is_none())),
        elastic_modulus: said.elastic_modulus.or(base.elastic_modulus.filter(|_| said.stretch_stiffness.is_none())),
        bending_stiffness: said.bending_stiffness.or(base.bending_stiffness.filter(|_| said.bending_modulus.is_none())),
        bending_modulus: said.bending_modulus.or(base.bending_modulus.filter(|_| said.bending_stiffness.is_none())),
        friction: said.friction.or(base.friction),
        mass_damping: said.mass_damping.or(base.mass_damping),
        stiffness_damping: said.stiffness_damping.or(base.stiffness_damping),
        loose_ends: said.loose_ends.or(base.loose_ends),
        color: said.color.or(base.color),
        plies: said.plies.or(base.plies),
        twist: said.twist.or(base.twist),
    }
}
