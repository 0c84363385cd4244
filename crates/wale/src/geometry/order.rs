//! Whether the drawn yarns cross in the order that the chart or the draft says.

use std::collections::BTreeMap;

use glam::DVec3;

use super::Curve;
use crate::model::{Network, NodeId};

/// How the yarns of the contacts cross, seen along the front of the layout.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CrossingOrder {
    /// Contacts where two yarns cross as their stack says.
    pub right: usize,
    /// Nodes where a yarn that lies behind another is drawn in front of it.
    pub wrong: Vec<NodeId>,
    /// Contacts whose yarns do not cross in this view: they touch and part, or are pulled apart.
    pub apart: usize,
}

impl CrossingOrder {
    /// Looks at every two neighbours of every stack. `fronts` are unit vectors to the front, one a node.
    ///
    /// About a node, a yarn is what is drawn from the middle of the segment before to the middle of the one after; there the
    /// two are followed in a view along the front, and where they cross, the one nearer to the eye must be the one that the
    /// stack has in front.
    #[must_use]
    pub fn of(network: &Network, curves: &[Curve], fronts: &[DVec3]) -> Self {
        let near = near_passes(curves);
        let mut order = Self::default();
        for (node, &front) in fronts.iter().enumerate() {
            let node = NodeId::new(node);
            let live: Vec<_> = network.live_stack(node).collect();
            for pair in live.windows(2) {
                let [above, below] = [pair[0], pair[1]].map(|pass| near.get(&pass.0).map_or(&[][..], Vec::as_slice));
                match crossing(above, below, front) {
                    Some(true) => order.right += 1,
                    Some(false) => order.wrong.push(node),
                    None => order.apart += 1,
                }
            }
        }
        order
    }
}

/// The points of the curves about each pass: half of the segment before, and half of the one after.
fn near_passes(curves: &[Curve]) -> BTreeMap<u32, Vec<DVec3>> {
    let mut near: BTreeMap<u32, Vec<DVec3>> = BTreeMap::new();
    for curve in curves {
        let mut start = 0;
        while start < curve.points.len() {
            let pass = curve.pass[start];
            let end = start + curve.pass[start..].iter().take_while(|p| **p == pass).count();
            let middle = start + (end - start) / 2;
            // From this pass to the middle of its segment, and from there to the next pass.
            near.entry(pass).or_default().extend(&curve.points[start..=middle.min(curve.points.len() - 1)]);
            if end < curve.points.len() {
                near.entry(pass + 1).or_default().extend(&curve.points[middle..end]);
            }
            start = end;
        }
    }
    near
}

/// Whether the first line is nearer to the eye where they cross in a view; `None` if they do not.
fn crossing(above: &[DVec3], below: &[DVec3], front: DVec3) -> Option<bool> {
    let side = front.any_orthonormal_vector();
    let up = front.cross(side);
    let flat = |x: DVec3| [x.dot(side), x.dot(up), x.dot(front)];
    let (mut over, mut under) = (0, 0);
    for a in above.windows(2) {
        for b in below.windows(2) {
            let ([p, q], [r, s]) = ([a[0], a[1]].map(flat), [b[0], b[1]].map(flat));
            let (d, e) = ([q[0] - p[0], q[1] - p[1]], [s[0] - r[0], s[1] - r[1]]);
            let determinant = d[0] * e[1] - d[1] * e[0];
            if determinant == 0.0 {
                continue;
            }
            let offset = [r[0] - p[0], r[1] - p[1]];
            let x = (offset[0] * e[1] - offset[1] * e[0]) / determinant;
            let y = (offset[0] * d[1] - offset[1] * d[0]) / determinant;
            if (0.0..1.0).contains(&x) && (0.0..1.0).contains(&y) {
                let heights = (p[2] + x * (q[2] - p[2]), r[2] + y * (s[2] - r[2]));
                if heights.0 > heights.1 { over += 1 } else { under += 1 }
            }
        }
    }
    match (over, under) {
        (0, 0) => None,
        (over, under) => Some(over >= under),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::sample_fabric::plain_weave;
    use crate::geometry::{CurveSettings, curves};
    use crate::model::Frame;

    #[test]
    fn a_weave_crosses_as_it_is_stacked_and_turned_over_it_does_not() {
        let network = plain_weave(6, 5, 2e-3);
        let frame = Frame { time: 0.0, positions: network.position.clone(), sliding: network.arc_length.clone() };
        let drawn = curves(&network, &frame, &CurveSettings::new(0.3e-3));
        let order = CrossingOrder::of(&network, &drawn, &network.front);
        assert_eq!((order.right, order.wrong.len(), order.apart), (30, 0, 0));
        let backs: Vec<DVec3> = network.front.iter().map(|front| -*front).collect();
        assert_eq!(CrossingOrder::of(&network, &drawn, &backs).wrong.len(), 30);
    }
}
