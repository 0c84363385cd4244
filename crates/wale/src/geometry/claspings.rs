//! How the two yarns of a stitch contact are led around each other.

use glam::DVec3;

use super::passes::{Passes, translation};
use super::yarn_geometry::CurveSettings;
use crate::model::{Frame, Network};

/// For segments of stitch contacts, by their first pass: the lateral offset \[m\] of the middle.
///
/// Along the axis `a` from `q₀` to `q₁`, a yarn that starts in front of the one it twists with passes on the side
/// `−s (a × n)`, with `s` the contact's wrap sign: a parent stays outside, its child goes through inside.
pub fn claspings(
    network: &Network,
    frame: &Frame,
    settings: &CurveSettings,
    passes: &Passes,
    normals: &[DVec3],
) -> Vec<Option<DVec3>> {
    let mut offsets = vec![None; network.pass_count()];
    let yarn_of = network.pass_yarn();
    for stitch in &network.stitches {
        let [q0, q1] = stitch.nodes;
        // Both nodes as the first yarn meets them: an axis free of periodic images.
        let Some(&[a, b]) = stitch.passes.first() else {
            continue;
        };
        let axis = segment_between(network, frame, settings, passes, a.index(), b.index());
        let normal = normals[q0.index()] + normals[q1.index()];
        let side = axis.cross(normal).normalize_or_zero() * settings.clasp;
        let depth = |node, pass| network.stack(node).iter().position(|p| *p == pass);
        let depths: Vec<_> = stitch.passes.iter().map(|[a, b]| (depth(q0, *a), depth(q1, *b))).collect();
        for (i, [a, b]) in stitch.passes.iter().enumerate() {
            let Some(first) = passes.earlier(*a, *b) else {
                continue;
            };
            // In front of its partners at q₀ and behind them at q₁: +1; the other way round: −1.
            let turns = depths.iter().fold(0.0, |sum, other| {
                let before = depths[i].0.cmp(&other.0);
                let after = depths[i].1.cmp(&other.1);
                match (before.is_lt(), after.is_lt(), before.is_gt(), after.is_gt()) {
                    (true, _, _, true) => sum + 1.0,
                    (_, true, true, _) => sum - 1.0,
                    _ => sum,
                }
            });
            if turns != 0.0 {
                let radius = settings.radius(network, yarn_of[first]);
                offsets[first] = Some(-side * radius * f64::signum(turns) * stitch.wrap_sign);
            }
        }
    }
    offsets
}

/// The vector \[m\] from one pass's node to that of a neighbour on the same yarn.
fn segment_between(
    network: &Network,
    frame: &Frame,
    settings: &CurveSettings,
    passes: &Passes,
    from: usize,
    to: usize,
) -> DVec3 {
    let periods = settings.periods.unwrap_or(network.periods.unwrap_or_default());
    let shift = [passes.before(from), passes.after(from)]
        .into_iter()
        .flatten()
        .find(|n| n.pass == to)
        .map_or([0, 0], |n| n.shift);
    passes.place(&frame.positions, periods, to) + translation(periods, shift)
        - passes.place(&frame.positions, periods, from)
}
