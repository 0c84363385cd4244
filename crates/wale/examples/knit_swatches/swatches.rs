//! The swatches of KnitDB [Hofmann et al. 2019]: charts and measured sizes, from the file that holds them.

use serde::Deserialize;
use wale::pattern::{Chart, Stitch};

use super::sizes::STOCKINETTE;

/// A real swatch of 60 × 60 stitches.
pub struct Swatch {
    pub name: String,
    /// Relaxed width and height \[mm\].
    pub width: f64,
    pub height: f64,
    /// The smallest repeat of its inside.
    pub repeat: Chart,
    /// Part that it has in a fit.
    pub weight: f64,
    /// Whether its chart is one of those that cards are fitted to.
    pub fitted: bool,
}

/// What cards are fitted to: eleven charts. Where a chart was knitted several times, its size is the mean of all, also of those
/// that the file does not hold.
pub fn fitted(all: &[Swatch]) -> Vec<Swatch> {
    let of = |name: &str, repeat: Chart, width, height| Swatch {
        name: name.to_owned(),
        width,
        height,
        repeat,
        weight: 1.0,
        fitted: true,
    };
    let rib = |knits, purls| Chart::rib(knits, purls).expect("a rib");
    let mut swatches = vec![
        of("stockinette", Chart::stockinette(), STOCKINETTE[0], STOCKINETTE[1]),
        of("garter", Chart::garter(), 111.0, 64.0),
        of("rib 1x1", rib(1, 1), 71.0, 103.0),
        of("rib 2x2", rib(2, 2), 60.5, 94.8),
        of("seed", Chart::seed(), 119.0, 84.0),
        of("moss", Chart::moss(), 102.0, 102.5),
        of("welting 2+2", Chart::welting(2, 2).expect("a welting"), 111.0, 56.0),
    ];
    // Furrows weighs less than other swatches with as many changes between knit and purl: less yarn was fed.
    for (name, weight) in [("weavy", 1.0), ("Seeded Rib", 1.0), ("Furrows", 0.5), ("Three plus", 1.0)] {
        if let Some(found) = all.iter().find(|swatch| swatch.name.ends_with(name)) {
            let swatch = of(name, found.repeat.clone(), found.width, found.height);
            swatches.push(Swatch { weight, ..swatch });
        }
    }
    swatches
}

/// Ends of the names of swatches whose charts are among the fitted ones.
const FITTED: [&str; 12] = [
    "Stockinette",
    "ReverseStockinette",
    "Garter",
    "k1p1rib",
    "k2p2rib",
    "Dog Sweater",
    "Moss",
    "Big Mossy",
    "weavy",
    "Seeded Rib",
    "Furrows",
    "Three plus",
];

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

/// The swatches of knits and purls alone, smallest repeat first.
pub fn knit_and_purl(path: &str) -> Result<Vec<Swatch>, String> {
    let text = std::fs::read_to_string(path).map_err(|error| format!("{path}: {error}"))?;
    let file: File = serde_json::from_str(&text).map_err(|error| format!("{path}: {error}"))?;
    let mut swatches = Vec::new();
    for entry in file.swatches {
        // The first row is the cast-on.
        let rows: Option<Vec<Vec<bool>>> = entry.rows_bottom_up_front_view[1..].iter().map(|row| faces(row)).collect();
        let Some(rows) = rows.filter(|_| !is_crossed(&entry.name)) else { continue };
        let number =
            |text: &str| text.trim().parse::<f64>().map_err(|error| format!("{path}: {}: {error}", entry.name));
        swatches.push(Swatch {
            width: number(&entry.relaxed_w_mm)?,
            height: number(&entry.relaxed_h_mm)?,
            repeat: repeat(&rows),
            weight: 1.0,
            fitted: FITTED.iter().any(|name| entry.name.ends_with(name)),
            name: entry.name,
        });
    }
    swatches.sort_by_key(|swatch| swatch.repeat.loop_count());
    Ok(swatches)
}

/// Which stitches of a row show their purl side; `None` where there is something else.
fn faces(row: &str) -> Option<Vec<bool>> {
    row.chars()
        .map(|c| match c {
            'k' => Some(false),
            'p' | 'b' => Some(true),
            _ => None,
        })
        .collect()
}

/// The smallest repeat of the inside of a chart: a border of a few stitches may be of another pattern.
fn repeat(rows: &[Vec<bool>]) -> Chart {
    let (height, width) = (rows.len(), rows[0].len());
    let mut best: Option<(f64, Vec<Vec<bool>>)> = None;
    for (bottom, top) in borders() {
        for (left, right) in borders() {
            let inside: Vec<&[bool]> = rows[bottom..height - top].iter().map(|row| &row[left..width - right]).collect();
            let columns = period(width - left - right, |p| inside.iter().all(|row| row[p..] == row[..row.len() - p]));
            let courses = period(inside.len(), |p| inside[p..] == inside[..inside.len() - p]);
            let cost = (columns * courses) as f64 * (1.0 + 0.02 * (bottom + top + left + right) as f64);
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, inside[..courses].iter().map(|row| row[..columns].to_vec()).collect()));
            }
        }
    }
    let (_, rows) = best.expect("a chart has rows");
    let stitch = |&purl: &bool| if purl { Stitch::Purl } else { Stitch::Knit };
    Chart::new(rows.iter().map(|row| row.iter().map(stitch).collect()).collect()).expect("a chart of knits and purls")
}

fn borders() -> impl Iterator<Item = (usize, usize)> {
    (0..=6).flat_map(|a| (0..=6 - a).map(move |b| (a, b)))
}

fn period(n: usize, repeats: impl Fn(usize) -> bool) -> usize {
    (1..n).find(|&p| repeats(p)).unwrap_or(n)
}
