//! The scene's words for what happens to a fabric: obstacles, grips and their motion.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{AxisAngle, Direction, ForceVector, LengthVector, SpeedVector};
use crate::model::{Edge, WhichEnd};
use crate::scene::dimensions::{Angle, AngularSpeed, Length, Ratio, Time};
use crate::scene::units::{NotNegative, Positive, Quantity};

/// A rigid thing: one of plane, sphere, capsule and box.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Obstacle")]
pub struct ObstacleText {
    /// Name for reports.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Half of space.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plane: Option<PlaneText>,
    /// A ball.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sphere: Option<SphereText>,
    /// A rod with round ends.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub capsule: Option<CapsuleText>,
    /// A box.
    #[serde(rename = "box", skip_serializing_if = "Option::is_none")]
    pub block: Option<BoxText>,
    /// Coefficient of friction with yarn; 0.3 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction: Option<Quantity<Ratio, NotNegative>>,
    /// How it moves; still if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<MotionText>,
}

/// Half of space below a plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Plane")]
pub struct PlaneText {
    /// A point of the surface.
    pub point: LengthVector,
    /// Direction out of the solid; up if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normal: Option<Direction>,
}

/// A ball.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Sphere")]
pub struct SphereText {
    /// Centre.
    pub center: LengthVector,
    /// Radius.
    pub radius: Quantity<Length, Positive>,
}

/// A rod with round ends.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Capsule")]
pub struct CapsuleText {
    /// One end of the core line.
    pub a: LengthVector,
    /// The other end.
    pub b: LengthVector,
    /// Radius.
    pub radius: Quantity<Length, Positive>,
}

/// A box.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Box")]
pub struct BoxText {
    /// Centre.
    pub center: LengthVector,
    /// Edge lengths.
    pub size: [Quantity<Length, Positive>; 3],
    /// How it is turned; along the axes if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotation: Option<AxisAngle>,
}

/// A motion: velocity or turn or both, or keys.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Motion")]
pub struct MotionText {
    /// Constant velocity.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub velocity: Option<SpeedVector>,
    /// Constant turning.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub turn: Option<TurnText>,
    /// When velocity and turn begin; at the start, or when the grip takes hold, if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from: Option<Quantity<Time, NotNegative>>,
    /// When they end, after which it stays where it is; at the end of the run, or when the grip lets go, if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub until: Option<Quantity<Time, NotNegative>>,
    /// Places at times, straight in between.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub keys: Option<Vec<KeyText>>,
    /// Point that turns go about; the middle of the obstacle, or of the fabric, if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pivot: Option<LengthVector>,
}

/// Turning about an axis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Turn")]
pub struct TurnText {
    /// Axis, of any length but zero.
    pub axis: Direction,
    /// Angular speed, as a right-handed screw turns.
    pub rate: Quantity<AngularSpeed>,
}

/// A place at a time, relative to the initial place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Key")]
pub struct KeyText {
    /// Simulated time.
    pub time: Quantity<Time, NotNegative>,
    /// Way from the initial place; none if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub translation: Option<LengthVector>,
    /// Rotation vector about the pivot: axis times angle; none if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotation: Option<[Quantity<Angle>; 3]>,
}

/// Something that holds a part of the fabric: still, along a motion, or pulling with a force.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Grip")]
pub struct GripText {
    /// Name for reports and metrics.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// What it holds. Required.
    pub select: SelectText,
    /// The axes it holds, as in "xyz" or "x"; all if left out. Along the others its nodes are free.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axes: Option<Axes>,
    /// How it moves; still if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<MotionText>,
    /// In place of motion: a force it pulls with.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pull: Option<PullText>,
    /// When it takes hold; at the start if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from: Option<Quantity<Time, NotNegative>>,
    /// When it lets go; never if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub until: Option<Quantity<Time, NotNegative>>,
}

/// A pull.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Pull")]
pub struct PullText {
    /// Force on all nodes together.
    pub force: ForceVector,
    /// Time from nothing to the full force; none if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ramp: Option<Quantity<Time, NotNegative>>,
}

/// A part of the fabric: an edge, a corner, loops by rows and columns, a region of space, or all.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Select")]
pub struct SelectText {
    /// "left", "right", "bottom" or "top", as seen from the front.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub edge: Option<Edge>,
    /// "top_left", "top_right", "bottom_left" or "bottom_right".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub corner: Option<Corner>,
    /// How many loops deep an edge or a corner is; 1 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub depth: Option<u32>,
    /// First and last row, counted from 1 at the cast-on.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rows: Option<[u32; 2]>,
    /// First and last column, counted from 1 at the left as seen from the front.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub columns: Option<[u32; 2]>,
    /// What lies in a part of space at first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub region: Option<RegionText>,
    /// The ends of a yarn.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub yarn_end: Option<YarnEndText>,
    /// True for everything.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub all: Option<bool>,
}

/// The first node of a yarn, or its last.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "YarnEnd")]
pub struct YarnEndText {
    /// The name of the yarn in the chart or the weave; "A" where no yarn has a name.
    pub yarn: String,
    /// Which of the lengths of that yarn, counted from 1 in the order in which they are worked; all if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub number: Option<u32>,
    /// "first", where it was begun, "last", or "both".
    pub end: WhichEnd,
}

/// Where two edges meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Corner {
    /// Bind-off and first column.
    TopLeft,
    /// Bind-off and last column.
    TopRight,
    /// Cast-on and first column.
    BottomLeft,
    /// Cast-on and last column.
    BottomRight,
}

/// A box along the axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Region")]
pub struct RegionText {
    /// Smallest corner.
    pub low: LengthVector,
    /// Largest corner.
    pub high: LengthVector,
}

/// Axes that a grip holds, written as in `"xz"`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Axes(pub [bool; 3]);

impl Serialize for Axes {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let held = "xyz".chars().zip(self.0).filter(|(_, held)| *held);
        serializer.serialize_str(&held.map(|(axis, _)| axis).collect::<String>())
    }
}

impl<'de> Deserialize<'de> for Axes {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl serde::de::Visitor<'_> for Visitor {
            type Value = Axes;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("axes such as \"xyz\"")
            }
            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Axes, E> {
                let mut held = [false; 3];
                for c in text.chars() {
                    match "xyz".find(c) {
                        Some(axis) if !held[axis] => held[axis] = true,
                        _ => {
                            return Err(E::custom(
                                "axes are x, y and z, each at most once\nwrite for instance \"xyz\"",
                            ));
                        }
                    }
                }
                if held == [false; 3] {
                    return Err(E::custom("a grip holds at least one axis\nwrite for instance \"xyz\""));
                }
                Ok(Axes(held))
            }
        }
        deserializer.deserialize_any(Visitor)
    }
}

impl JsonSchema for Axes {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "Axes".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "string", "pattern": "^[xyz]{1,3}$" })
    }
}
