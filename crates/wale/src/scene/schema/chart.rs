//! The scene's words for the stitches of a fabric.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The stitches: one of pattern, symbols and file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Chart")]
pub struct ChartText {
    /// A pattern by name: "stockinette", "reverse stockinette", "garter", "rib 2x2", "seed", "moss", "basket 4x4",
    /// "welting 2+2".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pattern: Option<String>,
    /// Rows of symbols as charts are printed, the last row first, each from left to right as seen from the front.
    /// `k K | □` are knit and `p P - • .` purl, seen from the front in every row.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub symbols: Option<Vec<String>>,
    /// Symbols of your own: `{ "x" = "knit", "o" = "yo", "/" = "k2tog" }`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub legend: Option<BTreeMap<String, StitchName>>,
    /// A file of written row instructions beside the scene, as in "rib.knit".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
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

/// A stitch by name, as seen from the front.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StitchName {
    /// A knit.
    Knit,
    /// A purl.
    Purl,
    /// A yarn-over.
    Yo,
    /// Two loops knitted together, the left one in front.
    K2tog,
    /// Two loops knitted together, the right one in front.
    Ssk,
    /// Two loops purled together, the left one in front.
    P2tog,
    /// Two loops purled together, the right one in front.
    Ssp,
    /// Three loops knitted together, the left one in front.
    K3tog,
    /// Three loops knitted together, the right one in front.
    Sssk,
    /// Three loops purled together, the left one in front.
    P3tog,
    /// Three loops purled together, the right one in front.
    Sssp,
    /// Three loops knitted together, the middle one in front.
    Cdd,
    /// Three loops purled together, the middle one in front.
    Cddp,
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
