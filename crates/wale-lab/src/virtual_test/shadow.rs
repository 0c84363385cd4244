//! The shadow that a draped sheet casts from above: its area, its outline, and the nodes of that.

use std::f64::consts::TAU;

/// Lines across the shadow on which its area is measured.
const LINES: usize = 2000;
/// Directions in which the outline is measured.
const DIRECTIONS: usize = 720;
/// By how much of the specimen's radius a node stands out from the valleys beside it at least \[–\].
const PROMINENCE: f64 = 0.02;

/// Area \[m²\] that triangles cover as seen along one axis, parts that lie above each other counted once: exact along each of
/// two thousand lines.
#[must_use]
pub fn covered_area(triangles: &[[[f64; 2]; 3]]) -> f64 {
    let bound = |of: fn(f64, f64) -> f64, start: f64| triangles.iter().flatten().fold(start, |m, p| of(m, p[1]));
    let (low, high) = (bound(f64::min, f64::INFINITY), bound(f64::max, f64::NEG_INFINITY));
    // Of no triangles the bounds are the wrong way round.
    if low >= high || !(high - low).is_finite() {
        return 0.0;
    }
    let step = (high - low) / LINES as f64;
    let mut spans: Vec<Vec<[f64; 2]>> = vec![Vec::new(); LINES];
    for t in triangles {
        let [bottom, top] =
            [t.iter().fold(f64::INFINITY, |m, p| m.min(p[1])), t.iter().fold(f64::NEG_INFINITY, |m, p| m.max(p[1]))];
        let first = ((bottom - low) / step - 0.5).ceil().max(0.0) as usize;
        for line in first..LINES {
            let y = low + (line as f64 + 0.5) * step;
            if y > top {
                break;
            }
            let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
            for k in 0..3 {
                let (a, b) = (t[k], t[(k + 1) % 3]);
                if (a[1] <= y) != (b[1] <= y) {
                    let x = a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
                    (left, right) = (left.min(x), right.max(x));
                }
            }
            if right > left {
                spans[line].push([left, right]);
            }
        }
    }
    let length = |spans: &mut Vec<[f64; 2]>| {
        spans.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let (mut sum, mut end) = (0.0, f64::NEG_INFINITY);
        for &[left, right] in spans.iter() {
            sum += (right - left.max(end)).max(0.0);
            end = end.max(right);
        }
        sum
    };
    step * spans.iter_mut().map(length).sum::<f64>()
}

/// How far the shadow reaches from the origin in evenly spread directions, counter-clockwise from the first axis \[m\].
#[must_use]
pub fn outline(triangles: &[[[f64; 2]; 3]]) -> Vec<f64> {
    let mut reach = vec![0.0f64; DIRECTIONS];
    for t in triangles {
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            let turn = (a[0] * b[1] - a[1] * b[0]).atan2(a[0] * b[0] + a[1] * b[1]);
            if turn == 0.0 {
                continue;
            }
            let from = a[1].atan2(a[0]);
            let (low, high) = (from.min(from + turn), from.max(from + turn));
            let index = |angle: f64| angle / TAU * DIRECTIONS as f64;
            // A ray through a corner meets at least one of both sides, whichever way its place is rounded.
            for step in (index(low) - 1e-9).ceil() as i64..=(index(high) + 1e-9).floor() as i64 {
                let angle = TAU * step as f64 / DIRECTIONS as f64;
                let (sin, cos) = angle.sin_cos();
                // Where the ray meets the line through both ends.
                let d = [b[0] - a[0], b[1] - a[1]];
                let r = (a[0] * d[1] - a[1] * d[0]) / (cos * d[1] - sin * d[0]);
                let place = step.rem_euclid(DIRECTIONS as i64) as usize;
                if r.is_finite() {
                    reach[place] = reach[place].max(r);
                }
            }
        }
    }
    reach
}

/// Nodes: peaks of an outline that stand out from the valleys to both sides by a fiftieth of `radius` \[m\].
#[must_use]
pub fn nodes(outline: &[f64], radius: f64) -> usize {
    let least = PROMINENCE * radius;
    let lowest = (0..outline.len()).min_by(|&a, &b| outline[a].total_cmp(&outline[b])).unwrap_or(0);
    // Once around from the lowest place: up by enough to a peak, down by enough from it.
    let (mut count, mut rising) = (0, true);
    let mut extreme = outline.get(lowest).copied().unwrap_or(0.0);
    for k in 0..=outline.len() {
        let here = outline[(lowest + k) % outline.len()];
        if rising {
            // The lowest since the last peak, until the outline has risen enough.
            extreme = extreme.min(here);
            if here > extreme + least {
                (rising, extreme) = (false, here);
            }
        } else {
            extreme = extreme.max(here);
            if here < extreme - least {
                count += 1;
                (rising, extreme) = (true, here);
            }
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A star of so many waves about the origin, as a fan, with a second sheet below the first.
    fn star(waves: f64, height: f64) -> Vec<[[f64; 2]; 3]> {
        let corner = |k: usize| {
            let angle = TAU * (k % 3600) as f64 / 3600.0;
            let r = 0.1 * (1.0 + height * (waves * angle + 0.3).cos());
            [r * angle.cos(), r * angle.sin()]
        };
        let fan = (0..3600).map(|k| [[0.0, 0.0], corner(k), corner(k + 1)]);
        let below = [[0.0, 0.0], [0.02, 0.0], [0.0, 0.02]];
        fan.chain([below]).collect()
    }

    #[test]
    fn a_star_has_its_area_its_outline_and_its_nodes() {
        for (waves, height) in [(5.0, 0.3), (7.0, 0.1), (1.0, 0.05)] {
            let star = star(waves, height);
            // ∫ ½ r² dφ.
            let area = 0.5 * TAU * 0.01 * (1.0 + 0.5 * height * height);
            assert!((covered_area(&star) / area - 1.0).abs() < 1e-4, "{}", covered_area(&star));
            let outline = outline(&star);
            for (k, r) in outline.iter().enumerate() {
                let angle = TAU * k as f64 / outline.len() as f64;
                assert!((r / (0.1 * (1.0 + height * (waves * angle + 0.3).cos())) - 1.0).abs() < 1e-4);
            }
            assert_eq!(nodes(&outline, 0.1), waves as usize);
        }
        assert_eq!(nodes(&outline(&star(5.0, 0.005)), 0.1), 0);
        assert_eq!(covered_area(&[]), 0.0);
    }
}
