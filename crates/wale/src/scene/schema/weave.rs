//! The scene's words for a woven fabric.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Color;
use crate::scene::dimensions::{Angle, Force, Length, Ratio, ThreadCount};
use crate::scene::units::{NotNegative, Positive, Quantity};

/// A woven fabric: one of pattern, symbols and file; how close its threads lie; and the yarns they are.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Weave")]
pub struct WeaveText {
    /// A weave by name: "plain", "twill 2/1", "satin 5", "satin 8 by 3", "sateen 5", "basket 2x2".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pattern: Option<String>,
    /// A drawdown, the last pick first: `x` where the warp lies on top as seen from the front, `.` where the weft does.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub symbols: Option<Vec<String>>,
    /// A WIF file beside the scene, with its colours and, where it says them, its distances.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Warp ends. The draft is repeated and cut off to this size; a file is woven once if it is left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ends: Option<u64>,
    /// Weft picks, likewise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub picks: Option<u64>,
    /// Distance of neighbouring ends. In its place: end_count.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub end_spacing: Option<Quantity<Length, Positive>>,
    /// Distance of neighbouring picks. In its place: pick_count.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pick_spacing: Option<Quantity<Length, Positive>>,
    /// Ends to a length: "24 /cm".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub end_count: Option<Quantity<ThreadCount, Positive>>,
    /// Picks to a length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pick_count: Option<Quantity<ThreadCount, Positive>>,
    /// A piece cut out of the fabric at an angle to its threads, in place of ends and picks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bias: Option<BiasText>,
    /// "woven" (the weft turns and goes on) or "cut" (every pick is a length of its own); woven if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub selvedge: Option<SelvedgeText>,
    /// Length of the free ends of the warp; half a pick spacing if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub warp_fringe: Option<Quantity<Length, Positive>>,
    /// Length of the free ends of the weft; half an end spacing if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub weft_fringe: Option<Quantity<Length, Positive>>,
    /// The yarn of each end from the left, repeated: `["A", "A", "B", "B"]`; "warp" if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub warp: Option<Vec<String>>,
    /// The yarn of each pick from the first, repeated; "weft" if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub weft: Option<Vec<String>>,
    /// The colour of each end, repeated, before that of its yarn.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub warp_colors: Option<Vec<Color>>,
    /// The colour of each pick, likewise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub weft_colors: Option<Vec<Color>>,
    /// Crimp of warp and weft; Peirce's geometry gives it if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crimp: Option<[Quantity<Ratio, NotNegative>; 2]>,
    /// How far warp and weft go through the fabric where they interlace, likewise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crimp_height: Option<[Quantity<Length, NotNegative>; 2]>,
    /// Yarn length of warp and weft below which an interlacing is jammed, likewise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interlacing_spacing: Option<[Quantity<Length, NotNegative>; 2]>,
    /// Yarn length of warp and weft below which a float is jammed; a quarter of the other yarn's diameter if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub float_spacing: Option<[Quantity<Length, NotNegative>; 2]>,
    /// Shear stiffness k_x.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shear_stiffness: Option<Quantity<Force, NotNegative>>,
    /// Angle of shear from which threads lie side by side.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shear_jamming_angle: Option<Quantity<Angle, Positive>>,
}

/// A piece cut out at an angle to the threads.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "BiasCut")]
pub struct BiasText {
    /// From the warp to the length of the piece: 45 degrees is the bias.
    pub angle: Quantity<Angle>,
    /// Width of the piece.
    pub width: Quantity<Length, Positive>,
    /// Its length, along y as it lies.
    pub length: Quantity<Length, Positive>,
}

/// How the weft goes at the sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SelvedgeText {
    /// It turns.
    Woven,
    /// It is cut.
    Cut,
}
