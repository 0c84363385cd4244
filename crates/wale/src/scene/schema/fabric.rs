//! The scene's words for a fabric: stitch size, the stiffnesses of its contacts, and where it lies at first.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{ChartText, Direction, LengthVector, WeaveText};
use crate::scene::dimensions::{Angle, Force, ForcePerLength, Length, Pressure, Rate, Ratio, Time};
use crate::scene::units::{NotNegative, Positive, Quantity};

/// A fabric. Only the chart or the weave is required: the preset of the yarn gives the loop length, and measured proportions of
/// relaxed loops give the rest.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Fabric")]
pub struct FabricText {
    /// Length of real yarn in one loop. In its place: wale_spacing and course_spacing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub loop_length: Option<Quantity<Length, Positive>>,
    /// Width of a stitch at first, and where there is no loop length, of relaxed stockinette: a gauge of 20 stitches
    /// to 10 cm is 5 mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wale_spacing: Option<Quantity<Length, Positive>>,
    /// Height of a row, likewise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub course_spacing: Option<Quantity<Length, Positive>>,
    /// Length along the model's yarn per length of real yarn; the model's straight segments cut corners.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path_ratio: Option<Quantity<Ratio, Positive>>,
    /// Length of a loop along the model's yarn, in place of loop_length × path_ratio.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model_loop_length: Option<Quantity<Length, Positive>>,
    /// Extra loop length per change between knit and purl within a row, as a part of the loop length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transition_length: Option<Quantity<Ratio, NotNegative>>,
    /// Length over which a loop and its parent are wrapped about each other.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stitch_length: Option<Quantity<Length, Positive>>,
    /// Wrapping stiffness k_w.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wrapping_stiffness: Option<Quantity<Force, NotNegative>>,
    /// Rest wrapping angle of sinker and head, along the course.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wrapping_angle_course: Option<Quantity<Angle>>,
    /// Rest wrapping angle of leg and leg, along the wale.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wrapping_angle_leg: Option<Quantity<Angle>>,
    /// Rest bend angle of feet and heads.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bend_angle_foot_head: Option<Quantity<Angle, NotNegative>>,
    /// Rest bend angle of legs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bend_angle_leg: Option<Quantity<Angle, NotNegative>>,
    /// Stiffness k_l that keeps the length of stitch contacts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub length_stiffness: Option<Quantity<Force, Positive>>,
    /// Stiffness k_c that keeps neighbouring contacts apart.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spacing_stiffness: Option<Quantity<Force, Positive>>,
    /// Yarn length below which a leg is jammed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spacing_leg: Option<Quantity<Length, Positive>>,
    /// Yarn length below which a head or a sinker is jammed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spacing_head_sinker: Option<Quantity<Length, Positive>>,
    /// How yarns lie at their contacts: "point", in one point, or "thick", beside each other. Slower, and much nearer to the
    /// sizes of real swatches.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contacts: Option<ContactModel>,
    /// Of thick contacts: distance of the centre lines of two yarns.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact_distance: Option<Quantity<Length, NotNegative>>,
    /// Of thick contacts: distance of the middles of neighbouring legs below which they push each other away.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub leg_distance: Option<Quantity<Length, NotNegative>>,
    /// Of thick contacts: stiffness of that push.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub leg_stiffness: Option<Quantity<Force, NotNegative>>,
    /// Of thick contacts: spacing of a strand that goes from face to face, over that of one that stays on a face.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crossing_spacing: Option<Quantity<Ratio, Positive>>,
    /// Of thick contacts: distance of the middles of legs that meet where the wales between them fold away.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub facing_distance: Option<Quantity<Length, NotNegative>>,
    /// Stiffness k_f of the springs that stand for sticking friction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub anchor_stiffness: Option<Quantity<ForcePerLength, Positive>>,
    /// Force that every contact is pressed with at least.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub residual_compression: Option<Quantity<Force, NotNegative>>,
    /// Parameters as Table 1 of the first paper prints them, in place of a preset.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub paper_table_1: Option<PaperTable1>,
    /// Where the middle of the fabric lies at first; the origin if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub center: Option<LengthVector>,
    /// How the fabric lies at first: "lying", front up, its courses along x and its wales along y, or "hanging", its
    /// wales up along z and its front towards −y.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stance: Option<Stance>,
    /// In place of stance: how the fabric is turned from lying.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotation: Option<AxisAngle>,
    /// The stitches. Required, unless the fabric is woven.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub chart: Option<ChartText>,
    /// The draft of a woven fabric, in place of the chart.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub weave: Option<WeaveText>,
}

/// How yarns lie at their contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ContactModel {
    /// In one point.
    Point,
    /// Beside each other.
    Thick,
}

/// How a fabric lies at first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Stance {
    /// Front up, courses along x, wales along y.
    Lying,
    /// Wales up along z, front towards −y.
    Hanging,
}

/// A rotation: an axis and an angle, or a unit quaternion.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AxisAngle {
    /// Axis, of any length but zero.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axis: Option<Direction>,
    /// Angle about the axis, as a right-handed screw turns.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angle: Option<Quantity<Angle>>,
    /// In place of both: x, y, z, w.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub quaternion: Option<[Quantity<Ratio>; 4]>,
}

/// A row of Table 1 of the first paper. Its units do not work out as printed: B is taken in N and k_w in N, so that
/// the stiffnesses are Y π R² \[N\], B π R² \[N m²\] and k_w \[N\]. The paper gives no density; 400 kg/m³ of yarn is
/// taken where the yarn has no linear density.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[allow(non_snake_case)]
pub struct PaperTable1 {
    /// Loop width.
    pub loop_width: Quantity<Length, Positive>,
    /// Yarn radius.
    pub R: Quantity<Length, Positive>,
    /// Elastic modulus.
    pub Y: Quantity<Pressure, Positive>,
    /// Bending modulus, printed in Pa, taken in N.
    pub B: Quantity<Force, Positive>,
    /// Wrap modulus, printed in Pa, taken in N.
    pub k_w: Quantity<Force, Positive>,
    /// Sliding friction coefficient.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mu: Option<Quantity<Ratio, NotNegative>>,
    /// Rayleigh damping of mass.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alpha: Option<Quantity<Rate, NotNegative>>,
    /// Rayleigh damping of stiffness.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beta: Option<Quantity<Time, NotNegative>>,
}
