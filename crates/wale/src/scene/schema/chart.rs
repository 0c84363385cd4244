//! The scene's words for the stitches of a fabric.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The stitches: one of pattern, symbols, image and file; and the yarns they are made of.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Chart")]
pub struct ChartText {
    /// A pattern by name: "stockinette", "reverse stockinette", "garter", "rib 2x2", "seed", "moss", "basket 4x4",
    /// "welting 2+2".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pattern: Option<String>,
    /// Rows of symbols as charts are printed, the last row first, each from left to right as seen from the front.
    /// `k K | □` are knit and `p P - • .` purl, `o` a yarn-over, `/ \\` k2tog and ssk, and so on; `#` is no stitch.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub symbols: Option<Vec<String>>,
    /// Symbols of your own by the names of stitches as seen from the front: `{ "x" = "knit", "o" = "yo", "/" = "k2tog" }`;
    /// several loops out of one are "(k, yo, k) in 1 st".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub legend: Option<BTreeMap<String, String>>,
    /// A PNG beside the scene, one pixel a stitch, its lowest line the first row; palette says what its colours mean.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub image: Option<String>,
    /// What each colour of the image is, either all yarns or all stitches: `{ "#ffffff" = "A", "#c03020" = "B" }`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub palette: Option<BTreeMap<String, String>>,
    /// The yarn of each row from the cast-on, repeated: `["A", "A", "B", "B"]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stripes: Option<Vec<String>>,
    /// The yarn of each stitch as rows of single characters, the last row first, repeated over the fabric.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub yarns: Option<Vec<String>>,
    /// A file beside the scene: written row instructions, as in "rib.knit", or a program for a knitting machine in knitout,
    /// as in "sleeve.k" or "sleeve.knitout".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// The text of a program in knitout.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub knitout: Option<String>,
    /// Stitches of a row. Patterns and symbols are repeated and cut off to this size; for a file it is the cast-on.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub columns: Option<u64>,
    /// Rows, repeated and cut off likewise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rows: Option<u64>,
    /// "flat" (back and forth) or "round" (a tube); flat if left out. A file says it itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub worked: Option<Worked>,
    /// The side that faces the knitter in the first row of a flat fabric; the right side if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first_row: Option<FirstRow>,
}

/// How rows follow each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Worked {
    /// Back and forth.
    Flat,
    /// In the round.
    Round,
}

/// The side that faces the knitter in the first row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FirstRow {
    /// The front.
    RightSide,
    /// The back.
    WrongSide,
}
