//! The fabric card of a scene, and where the fabric lies.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DQuat, DVec3};

use super::{rotation, si, vector};
use crate::model::{KnitCard, LoopProportions, Placement, YarnCard};
use crate::scene::error::Complaint;
use crate::scene::schema::{ContactModel, FabricText, PaperTable1, Stance, YarnText};
use crate::scene::units::{Bounds, Dimension, Quantity};

/// Loop lengths that knitted fabrics have \[m\].
const LOOP_LENGTH: std::ops::RangeInclusive<f64> = 1e-4..=2.0;

/// The card; `base` stands behind what the scene says.
pub(super) fn resolve(said: &FabricText, base: &FabricText, yarn: &YarnCard) -> Result<KnitCard, Complaint> {
    let thick = said.contacts.or(base.contacts) == Some(ContactModel::Thick);
    let mut proportions = if thick { LoopProportions::thick() } else { LoopProportions::default() };
    if let Some(ratio) = si(said.path_ratio.or(base.path_ratio)) {
        proportions.path_ratio = ratio;
    }
    let sized = said.loop_length.is_some()
        || said.model_loop_length.is_some()
        || said.wale_spacing.is_some()
        || said.course_spacing.is_some();
    let loop_length = loop_length(if sized { said } else { base }, &proportions)?;
    if !LOOP_LENGTH.contains(&loop_length) {
        let what = format!("a loop of {loop_length:.3e} m along the model's yarn");
        return Err(Complaint::new(size_key(said), what).why("loops are between 0.1 mm and 2 m long"));
    }
    if 2.0 * yarn.radius > 0.25 * loop_length {
        let what = format!("the yarn is {:.3e} m thick, the loop {loop_length:.3e} m long", 2.0 * yarn.radius);
        return Err(Complaint::new(size_key(said), what)
            .why("no loop can be made that is shorter than four diameters of its yarn")
            .mend("take a longer loop or a thinner yarn"));
    }
    // Defaults follow lengths that the scene states, so those come first.
    let stated = |said: Option<f64>, base: Option<f64>| said.or(base);
    if let Some(length) = stated(si(said.stitch_length), si(base.stitch_length)) {
        proportions.stitch_length = length / loop_length;
    }
    if let Some(width) = stated(si(said.wale_spacing), si(base.wale_spacing)) {
        proportions.wale_spacing = width / loop_length;
    }
    let card = overridden(overridden(proportions.card(yarn, loop_length), base), said);
    check(&card, said)?;
    Ok(card)
}

/// Loop length along the model's yarn \[m\].
fn loop_length(text: &FabricText, proportions: &LoopProportions) -> Result<f64, Complaint> {
    let from_width = si(text.wale_spacing).map(|width| width / proportions.wale_spacing);
    let from_height = si(text.course_spacing).map(|height| height / proportions.course_spacing);
    let from_spacing = match (from_width, from_height) {
        (Some(a), Some(b)) => Some((a * b).sqrt()),
        (a, b) => a.or(b),
    };
    si(text.model_loop_length)
        .or(si(text.loop_length).map(|length| length * proportions.path_ratio))
        .or(from_spacing)
        .ok_or_else(|| Complaint::new("fabric", "the fabric has no loop_length").mend("add loop_length = \"10 mm\""))
}

/// The key to underline when the loop length is wrong.
fn size_key(said: &FabricText) -> &'static str {
    if said.model_loop_length.is_some() {
        "fabric.model_loop_length"
    } else if said.loop_length.is_some() {
        "fabric.loop_length"
    } else if said.wale_spacing.is_some() {
        "fabric.wale_spacing"
    } else if said.course_spacing.is_some() {
        "fabric.course_spacing"
    } else {
        "yarn"
    }
}

/// The card with every number that the text states.
fn overridden(mut card: KnitCard, text: &FabricText) -> KnitCard {
    fn set<D: Dimension, B: Bounds>(number: &mut f64, stated: Option<Quantity<D, B>>) {
        if let Some(value) = stated {
            *number = value.si();
        }
    }
    set(&mut card.wale_spacing, text.wale_spacing);
    set(&mut card.course_spacing, text.course_spacing);
    set(&mut card.transition_length, text.transition_length);
    set(&mut card.stitch_length, text.stitch_length);
    set(&mut card.wrapping_stiffness, text.wrapping_stiffness);
    set(&mut card.wrapping_angle_course, text.wrapping_angle_course);
    set(&mut card.wrapping_angle_leg, text.wrapping_angle_leg);
    set(&mut card.bend_angle_foot_head, text.bend_angle_foot_head);
    set(&mut card.bend_angle_leg, text.bend_angle_leg);
    set(&mut card.length_stiffness, text.length_stiffness);
    set(&mut card.spacing_stiffness, text.spacing_stiffness);
    set(&mut card.spacing_leg, text.spacing_leg);
    set(&mut card.spacing_head_sinker, text.spacing_head_sinker);
    if let Some(thickness) = &mut card.thickness {
        set(&mut thickness.contact_distance, text.contact_distance);
        set(&mut thickness.leg_distance, text.leg_distance);
        set(&mut thickness.leg_stiffness, text.leg_stiffness);
        set(&mut thickness.crossing_spacing, text.crossing_spacing);
        set(&mut thickness.facing_distance, text.facing_distance);
    }
    set(&mut card.anchor_stiffness, text.anchor_stiffness);
    set(&mut card.residual_compression, text.residual_compression);
    card
}

/// Numbers that cannot be together.
fn check(card: &KnitCard, said: &FabricText) -> Result<(), Complaint> {
    if 4.0 * card.stitch_length > 0.9 * card.loop_length {
        let key = if said.stitch_length.is_some() { "fabric.stitch_length" } else { size_key(said) };
        let what = format!(
            "four stitch contacts of {:.3e} m leave too little of a loop of {:.3e} m",
            card.stitch_length, card.loop_length
        );
        return Err(Complaint::new(key, what).why("legs, head and sinker need at least a tenth of the loop"));
    }
    let angles = [
        ("wrapping_angle_course", card.wrapping_angle_course.abs()),
        ("wrapping_angle_leg", card.wrapping_angle_leg.abs()),
        ("bend_angle_foot_head", card.bend_angle_foot_head),
        ("bend_angle_leg", card.bend_angle_leg),
    ];
    for (key, angle) in angles {
        if angle >= PI {
            let what = format!("a rest angle of {angle:.4} rad");
            return Err(Complaint::new(format!("fabric.{key}"), what)
                .why("rest angles are below 180 degrees")
                .mend("a bare number is in radians; write degrees as \"90 deg\""));
        }
    }
    let of_thick = [
        ("contact_distance", said.contact_distance.is_some()),
        ("leg_distance", said.leg_distance.is_some()),
        ("leg_stiffness", said.leg_stiffness.is_some()),
        ("crossing_spacing", said.crossing_spacing.is_some()),
        ("facing_distance", said.facing_distance.is_some()),
    ];
    match (card.thickness, of_thick.iter().find(|(_, given)| *given)) {
        (None, Some((key, _))) => {
            return Err(Complaint::new(format!("fabric.{key}"), format!("{key} of contacts in one point"))
                .why("only thick contacts have it")
                .mend("add contacts = \"thick\" to [fabric]"));
        }
        (Some(thickness), _) if thickness.contact_distance > card.stitch_length => {
            let what = format!("a contact_distance of {:.3e} m", thickness.contact_distance);
            return Err(Complaint::new("fabric.contact_distance", what).why(format!(
                "yarns that are wrapped about each other over {:.3e} m lie nearer to each other than that",
                card.stitch_length
            )));
        }
        _ => {}
    }
    if card.transition_length > 1.0 {
        let what = format!("a transition_length of {}", card.transition_length);
        return Err(Complaint::new("fabric.transition_length", what).why("it is a part of the loop length, at most 1"));
    }
    if !(0.1..=10.0).contains(&card.path_ratio) {
        let what = format!("a path_ratio of {}", card.path_ratio);
        return Err(Complaint::new("fabric.path_ratio", what).why("it is between 0.1 and 10, as a rule near 0.75"));
    }
    Ok(())
}

/// Yarn and fabric from a row of the first paper's Table 1, in true units.
///
/// The paper lays loops with `C ≈ 0.77 W`; lengths of the parts of a loop are those of the initial layout, rest angles
/// those of the paper (wrapping 90°, bending none). Spacing distances are the yarn diameter, as far as the layout has
/// room for it.
pub(super) fn from_paper_table_1(table: &PaperTable1) -> (YarnText, FabricText) {
    // Of checked, positive numbers; products stay within the bounds of a scene or are left out and reported missing.
    fn of<D: Dimension, B: Bounds>(value: f64) -> Option<Quantity<D, B>> {
        Quantity::new(value).ok()
    }
    let (width, radius) = (table.loop_width.si(), table.R.si());
    let area = PI * radius * radius;
    let stretch = table.Y.si() * area;
    // Parts of a loop in the layout, in loop widths.
    let (course, stitch, leg, head_sinker) = (0.77, 0.324, 0.473, 0.4);
    let loop_length = (4.0 * stitch + 2.0 * leg + 2.0 * head_sinker) * width;
    let spacing = |room: f64| of((2.0 * radius).min(0.9 * room * width));
    let yarn = YarnText {
        linear_density: of(400.0 * area),
        diameter: of(2.0 * radius),
        stretch_stiffness: of(stretch),
        bending_stiffness: of(table.B.si() * area),
        friction: table.mu.or(of(0.3)),
        mass_damping: table.alpha,
        stiffness_damping: table.beta,
        plies: Some(2),
        ..YarnText::default()
    };
    let fabric = FabricText {
        model_loop_length: of(loop_length),
        path_ratio: of(1.0),
        wale_spacing: of(width),
        course_spacing: of(course * width),
        transition_length: of(0.0),
        stitch_length: of(stitch * width),
        wrapping_stiffness: of(table.k_w.si()),
        wrapping_angle_course: of(FRAC_PI_2),
        wrapping_angle_leg: of(FRAC_PI_2),
        bend_angle_foot_head: of(0.0),
        bend_angle_leg: of(0.0),
        length_stiffness: of(stretch),
        spacing_stiffness: of(0.1 * stretch),
        spacing_leg: spacing(leg),
        spacing_head_sinker: spacing(head_sinker),
        anchor_stiffness: of(0.1 * stretch / width),
        residual_compression: of(2e-3),
        ..FabricText::default()
    };
    (yarn, fabric)
}

/// Where the fabric lies at first.
pub(super) fn placement(text: &FabricText) -> Result<Placement, Complaint> {
    if text.stance.is_some() && text.rotation.is_some() {
        let complaint = Complaint::new("fabric.rotation", "stance and rotation are both given");
        return Err(complaint.mend("keep one of them"));
    }
    let turned = match (&text.rotation, text.stance) {
        (Some(turn), _) => rotation(turn, "fabric.rotation")?,
        (None, Some(Stance::Hanging)) => DQuat::from_rotation_x(FRAC_PI_2),
        (None, _) => DQuat::IDENTITY,
    };
    Ok(Placement { center: text.center.as_ref().map_or(DVec3::ZERO, vector), rotation: turned })
}
