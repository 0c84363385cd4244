//! What a scene file may say: these structs are the schema, their comments the reference.
//!
//! Every key is optional here unless a comment says otherwise, so that presets and defaults can stand behind it; what
//! must be there is checked where the text becomes a [`super::Scene`].

mod chart;
mod fabric;
mod happening;
mod simulation;
mod weave;
mod yarn;

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use chart::{ChartText, FirstRow, Worked};
pub use fabric::{AxisAngle, ContactModel, FabricText, PaperTable1, Stance};
pub use happening::{
    Axes, BoxText, CapsuleText, Corner, GripText, KeyText, MotionText, ObstacleText, PlaneText, PullText, RegionText,
    SelectText, SphereText, TurnText, YarnEndText,
};
pub use simulation::{Gravity, OutputText, SimulationText};
pub use weave::{BiasText, SelvedgeText, WeaveText};
pub use yarn::{Color, PresetName, YarnText};

use super::dimensions::{Force, Length, Ratio, Speed};
use super::units::Quantity;

/// A place or a way \[m\]: x, y, z.
pub type LengthVector = [Quantity<Length>; 3];
/// A velocity \[m/s\].
pub type SpeedVector = [Quantity<Speed>; 3];
/// A force \[N\].
pub type ForceVector = [Quantity<Force>; 3];
/// A direction; its length does not matter.
pub type Direction = [Quantity<Ratio>; 3];

/// A scene of wale.
///
/// Physical values are either text with a unit (`"0.5 mm"`, `"30 tex"`, `"2 N"`) or a bare number in SI units. The
/// world's z axis is up.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "wale scene", rename = "Scene")]
pub struct SceneText {
    /// Version of this format: 1. Required.
    pub schema: u32,
    /// A title for reports.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub title: Option<String>,
    /// The yarn; a worsted wool if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub yarn: Option<YarnText>,
    /// Other yarns by the names that the chart or the weave gives them; a name that is not here is that of the yarn above.
    /// What is said of one goes before what is said of that; it has no preset and no damping of its own.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub yarns: BTreeMap<String, YarnText>,
    /// The fabric, with its chart or its weave. Required.
    pub fabric: FabricText,
    /// Time, forces from outside, and the solver.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub simulation: Option<SimulationText>,
    /// What is written.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub output: Option<OutputText>,
    /// Rigid things that the fabric touches.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub obstacle: Vec<ObstacleText>,
    /// What holds, moves or pulls the fabric.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub grip: Vec<GripText>,
}

/// A preset file: a yarn, and a fabric of it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PresetText {
    /// One line about it.
    pub title: String,
    pub yarn: YarnText,
    pub fabric: FabricText,
}
