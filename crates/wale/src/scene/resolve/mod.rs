//! From what a scene file says to plain SI numbers: presets, defaults, and every check that needs more than one value.

mod base;
mod beside;
mod chart;
mod fabric;
mod happening;
mod plan;
mod weave;
mod yarn;
mod yarn_cards;
mod yarns;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use glam::{DQuat, DVec3};

use super::dimensions::Ratio;
use super::error::{Complaint, SceneError};
use super::schema::{AxisAngle, Direction, SceneText};
use super::units::{Bounds, Dimension, Quantity};
use super::{SCHEMA, Scene};
use crate::model::{FabricCard, Plan};
pub(super) use chart::is_program;
pub(super) use yarn::text_of as text_of_yarn;
use yarn_cards::YarnCards;

/// What is wrong, in this file or in one that it names.
pub(super) enum Failure {
    Here(Complaint),
    Elsewhere(Box<SceneError>),
}

impl From<Complaint> for Failure {
    fn from(complaint: Complaint) -> Self {
        Self::Here(complaint)
    }
}

/// The scene, and the files that it reads. `directory` holds them; none may be read if `None`.
pub(super) fn scene(text: &SceneText, directory: Option<&Path>) -> Result<(Scene, Vec<PathBuf>), Failure> {
    if text.schema != SCHEMA {
        return Err(Complaint::new("schema", format!("schema {} is not one that this wale reads", text.schema))
            .why(format!("it reads schema {SCHEMA}"))
            .mend(format!("write schema = {SCHEMA}, or use a newer wale"))
            .into());
    }
    let said = text.yarn.clone().unwrap_or_default();
    let base = base::base(text, directory)?;
    let cards = |names: &[String], together: &BTreeMap<String, Vec<String>>| {
        YarnCards { names, together, first: &said, base: &base, others: &text.yarns }.resolve()
    };
    let (fabric, structure, (yarns, yarn_colors), names, inputs) = if let Some(weave) = &text.fabric.weave {
        let mut drafted = weave::resolve(weave, directory)?;
        let (yarns, colors) = cards(&drafted.yarns, &BTreeMap::new())?;
        drafted.complete_colors(&colors);
        let card = weave::card(&text.fabric, &base.fabric, &drafted, &yarns)?;
        let (names, inputs) = (drafted.yarns.clone(), drafted.inputs.clone());
        (FabricCard::Woven(card), drafted.structure(), (yarns, colors), names, inputs)
    } else {
        // A wrong yarn or loop is said before a wrong chart.
        yarn::resolve("yarn", &said, &base.yarn)?;
        let stitches = chart::resolve(text.fabric.chart.as_ref(), directory)?;
        let (yarns, colors) = cards(&stitches.yarns, &stitches.together)?;
        let card = fabric::resolve(&text.fabric, &base.fabric, yarns.first())?;
        (FabricCard::Knit(card), stitches.structure, (yarns, colors), stitches.yarns, stitches.inputs)
    };
    let inputs = [base.inputs, inputs].concat();
    let placement = fabric::placement(&text.fabric)?;
    let simulation = plan::simulation(&text.simulation.clone().unwrap_or_default())?;
    let output = plan::output(&text.output.clone().unwrap_or_default());
    let obstacles = happening::obstacles(&text.obstacle, simulation.duration)?;
    let size = structure.size();
    let grips = happening::grips(&text.grip, simulation.duration, placement.center, size, &names)?;
    let plan = Plan { placement, simulation, obstacles, grips, output };
    let title = text.title.clone().unwrap_or_default();
    Ok((Scene { title, yarns, yarn_colors, fabric, structure, plan }, inputs))
}

fn si<D: Dimension, B: Bounds>(quantity: Option<Quantity<D, B>>) -> Option<f64> {
    quantity.map(Quantity::si)
}

fn vector<D: Dimension, B: Bounds>(parts: &[Quantity<D, B>; 3]) -> DVec3 {
    DVec3::from_array(parts.map(Quantity::si))
}

/// A direction of unit length; one that is of unit length keeps its bits.
fn unit(parts: &Direction, path: &str) -> Result<DVec3, Complaint> {
    let direction = vector(parts);
    let length = direction.length();
    if length == 0.0 || !length.is_finite() {
        return Err(Complaint::new(path, "a direction cannot be zero").mend("write for instance [0, 0, 1]"));
    }
    Ok(if is_one(length) { direction } else { direction / length })
}

fn is_one(length: f64) -> bool {
    (length - 1.0).abs() < 1e-14
}

fn rotation(text: &AxisAngle, path: &str) -> Result<DQuat, Complaint> {
    match (text.quaternion, &text.axis, text.angle) {
        (Some(parts), None, None) => {
            let parts = parts.map(|part: Quantity<Ratio>| part.si());
            let quaternion = DQuat::from_array(parts);
            let length = quaternion.length();
            if length == 0.0 || !length.is_finite() {
                let complaint = Complaint::new(format!("{path}.quaternion"), "a quaternion cannot be zero");
                return Err(complaint.mend("write for instance [0, 0, 0, 1]"));
            }
            Ok(if is_one(length) { quaternion } else { quaternion.normalize() })
        }
        (None, Some(axis), Some(angle)) => Ok(DQuat::from_axis_angle(unit(axis, &format!("{path}.axis"))?, angle.si())),
        _ => Err(Complaint::new(path, "a rotation is an axis and an angle, or a quaternion")
            .mend("write for instance { axis = [0, 0, 1], angle = \"45 deg\" }")),
    }
}

/// Complains unless exactly one of some keys is there.
fn exactly_one(path: &str, keys: &[(&str, bool)]) -> Result<(), Complaint> {
    let names = || keys.iter().map(|(key, _)| *key).collect::<Vec<_>>().join(", ");
    let mut there = keys.iter().filter(|(_, there)| *there).map(|(key, _)| *key);
    match (there.next(), there.next()) {
        (Some(_), None) => Ok(()),
        (None, _) => Err(Complaint::new(path, format!("none of {} is given", names())).mend("give one of them")),
        (Some(first), Some(second)) => {
            let what = format!("{first} and {second} are both given");
            Err(Complaint::new(format!("{path}.{second}"), what).mend(format!("keep one of {}", names())))
        }
    }
}
