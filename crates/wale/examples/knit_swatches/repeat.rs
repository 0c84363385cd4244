//! The smallest repeat of a chart of a swatch.

use wale::model::{LoopProportions, YarnCard};
use wale::pattern::{Chart, Stitch, knit};

/// The smallest repeat of the inside of a chart: a border of a few stitches may be of another pattern. `None` if the rows of no
/// repeat close.
pub fn smallest_repeat(rows: &[Vec<Stitch>]) -> Option<Chart> {
    let (height, width) = (rows.len(), rows[0].len());
    let mut found: Vec<(f64, [usize; 4])> = Vec::new();
    for (bottom, top) in borders() {
        for (left, right) in borders() {
            let inside: Vec<&[Stitch]> =
                rows[bottom..height - top].iter().map(|row| &row[left..width - right]).collect();
            let columns = period(width - left - right, |p| inside.iter().all(|row| row[p..] == row[..row.len() - p]));
            let courses = period(inside.len(), |p| inside[p..] == inside[..inside.len() - p]);
            let cost = (columns * courses) as f64 * (1.0 + 0.02 * (bottom + top + left + right) as f64);
            found.push((cost, [bottom, left, courses, columns]));
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    // The whole width closes where no part of it does.
    found.push((f64::INFINITY, [0, 0, period(height, |p| rows[p..] == rows[..height - p]), width]));
    found.into_iter().find_map(|(_, [bottom, left, courses, columns])| {
        let part = &rows[bottom..bottom + courses];
        let closes = part.iter().all(|row| takes(&row[..left]) == left && takes(&row[left..left + columns]) == columns);
        let chart = || Chart::new(part.iter().map(|row| row[left..left + columns].to_vec()).collect()).ok();
        let card = LoopProportions::default().card(&YarnCard::unit(), 1.0);
        closes.then(chart).flatten().filter(|chart| knit::tile(chart, &card).is_ok())
    })
}

/// Loops of the row below that stitches take.
fn takes(stitches: &[Stitch]) -> usize {
    stitches.iter().map(|stitch| stitch.takes()).sum()
}

fn borders() -> impl Iterator<Item = (usize, usize)> {
    (0..=6).flat_map(|a| (0..=6 - a).map(move |b| (a, b)))
}

fn period(n: usize, repeats: impl Fn(usize) -> bool) -> usize {
    (1..n).find(|&p| repeats(p)).unwrap_or(n)
}
