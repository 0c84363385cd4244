//! The swatches of KnitDB [Hofmann et al. 2019]: charts and measured sizes, from the file that holds them.

use serde::Deserialize;
use wale::pattern::{Chart, Stitch};

use super::repeat::smallest_repeat;
use super::sizes::STOCKINETTE;

/// A real swatch of 60 × 60 stitches.
pub struct Swatch {
    pub name: String,
    /// Relaxed width and height \[mm\].
    pub width: f64,
    pub height: f64,
    /// The smallest repeat of its inside.
    pub repeat: Chart,
    /// Whether its chart is one of those that cards are fitted to.
    pub fitted: bool,
}

/// What cards are fitted to: eleven charts. Of those that repeat within 50 loops (a fit relaxes each many times) all but two
/// whose swatches are doubtful, Furrows (as light as stockinette, so that less yarn was fed) and diag ck (ran out of yarn), and
/// two that are left out for their size, so that what is predicted is as varied as what is fitted: garter and moss.
const FITTED: [&str; 11] = [
    "Stockinette",
    "k1p1rib",
    "faux cable",
    "weavy",
    "BrokenSingleRib",
    "Seeded Rib",
    "_112Diagonal",
    "BrokenRibBacketWeave",
    "GarterWelting",
    "Three plus",
    "Dog Sweater",
];

/// Sizes of charts that were knitted several times: means of all swatches, also of those that the file does not hold.
const REPEATED: [(&str, [f64; 2]); 3] =
    [("Stockinette", STOCKINETTE), ("Dog Sweater", [119.0, 84.0]), ("_007Moss", [102.0, 102.5])];

/// Other swatches of the charts above.
const AGAIN: [&str; 2] = ["ReverseStockinette", "Big Mossy"];

#[derive(Deserialize)]
struct File {
    swatches: Vec<Entry>,
}

#[derive(Deserialize)]
struct Entry {
    name: String,
    relaxed_w_mm: String,
    relaxed_h_mm: String,
    rows_bottom_up_front_view: Vec<String>,
}

/// What is not of knits and purls alone although its chart is: the chart files do not hold crossed and twisted stitches, nor
/// tucks. By the names of the stitch collection's chapters on twists and cables (its patterns 37 to 104), and by the words.
fn is_crossed(name: &str) -> bool {
    let number = name.split('_').nth(2).and_then(|rest| rest.get(..3)?.parse::<u32>().ok());
    let collection = ESC.iter().any(|known| name.contains(known));
    (collection && number.is_some_and(|n| (37..=104).contains(&n)))
        || ["Cable 1", "Cable 2", "Zig Zag", "Tucked"].iter().any(|word| name.contains(word))
}

/// Patterns 37 to 104 of the stitch collection that the folder has.
const ESC: [&str; 21] = [
    "TexturedTrellis",
    "LittleLattice",
    "DoubleInterlacedLattice",
    "TravelingTwists",
    "TwistedStemLeaves",
    "Lightning",
    "TeaxturedWaves",
    "Illusion",
    "DoubleBranchingRib",
    "InterwovenDiamonds",
    "WavesL",
    "DoubleHoneyComb",
    "DiagonalL",
    "StagHorn",
    "OffCenterCable",
    "XO",
    "InterlockingDiagonals",
    "Zigzagbranch",
    "GrandDiamondPanel",
    "DiagonalDiamond",
    "FramedDiamond",
];

/// The stitches of the swatches that are asked for.
#[derive(Clone, Copy, PartialEq)]
pub enum Kind {
    KnitAndPurl,
    /// Yarn-overs and decreases too.
    Lace,
}

/// The swatches of knits and purls alone or those of lace, smallest repeat first.
pub fn read(path: &str, kind: Kind) -> Result<Vec<Swatch>, String> {
    let text = std::fs::read_to_string(path).map_err(|error| format!("{path}: {error}"))?;
    let file: File = serde_json::from_str(&text).map_err(|error| format!("{path}: {error}"))?;
    let mut swatches = Vec::new();
    for entry in file.swatches {
        // The first row is the cast-on.
        let rows: Option<Vec<Vec<Stitch>>> =
            entry.rows_bottom_up_front_view[1..].iter().map(|row| stitches(row)).collect();
        let Some(rows) = rows.filter(|_| !is_crossed(&entry.name)) else { continue };
        let plain = rows.iter().flatten().all(|stitch| matches!(stitch, Stitch::Knit | Stitch::Purl));
        if plain != (kind == Kind::KnitAndPurl) {
            continue;
        }
        let Some(repeat) = smallest_repeat(&rows) else {
            eprintln!("{}: its rows do not close", entry.name);
            continue;
        };
        let number =
            |text: &str| text.trim().parse::<f64>().map_err(|error| format!("{path}: {}: {error}", entry.name));
        if AGAIN.iter().any(|name| entry.name.ends_with(name)) {
            continue;
        }
        let mean = REPEATED.iter().find(|(name, _)| entry.name.ends_with(name)).map(|(_, size)| *size);
        let [width, height] = match mean {
            Some(size) => size,
            None => [number(&entry.relaxed_w_mm)?, number(&entry.relaxed_h_mm)?],
        };
        swatches.push(Swatch {
            width,
            height,
            repeat,
            fitted: FITTED.iter().any(|name| entry.name.ends_with(name)),
            name: entry.name,
        });
    }
    swatches.sort_by_key(|swatch| swatch.repeat.loop_count());
    Ok(swatches)
}

/// The stitches of a row. The file says how many loops each takes and which side shows, not which of the loops lies in front.
fn stitches(row: &str) -> Option<Vec<Stitch>> {
    row.chars()
        .map(|c| match c {
            'k' => Some(Stitch::Knit),
            'p' => Some(Stitch::Purl),
            'o' => Some(Stitch::YarnOver),
            '/' => Stitch::named("k2tog"),
            '\\' => Stitch::named("ssk"),
            'b' => Stitch::named("p2tog"),
            'd' => Stitch::named("ssp"),
            '3' => Stitch::named("cdd"),
            _ => None,
        })
        .collect()
}
