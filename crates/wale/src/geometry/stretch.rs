//! How far each yarn segment is stretched: a number to colour pictures by.

use glam::DVec3;

use super::passes::Passes;
use crate::model::{Frame, Network};

/// Engineering strain of the straight segment after each pass, `|x₁ − x₀| / (u₁ − u₀) − 1` \[–\].
///
/// The last pass of an open yarn repeats the segment before it. Segments without rest length read as zero.
/// `periods` as in [`super::CurveSettings`].
///
/// # Panics
/// If the frame does not belong to the network (another number of nodes or passes).
#[must_use]
pub fn segment_stretch(network: &Network, frame: &Frame, periods: Option<[DVec3; 2]>) -> Vec<f64> {
    assert_eq!(frame.positions.len(), network.node_count(), "nodes");
    assert_eq!(frame.sliding.len(), network.pass_count(), "passes");
    let periods = periods.or(network.periods).unwrap_or_default();
    let passes = Passes::new(network);
    let yarns = network.pass_yarn();
    let mut stretch = vec![0.0; network.pass_count()];
    for p in 0..stretch.len() {
        let Some(next) = passes.after(p) else {
            stretch[p] = passes.before(p).map_or(0.0, |n| stretch[n.pass]);
            continue;
        };
        let closure = network.yarn_closure[yarns[p].index()].map_or(0.0, |(_, length)| length);
        let rest = frame.sliding[next.pass] + f64::from(next.turns) * closure - frame.sliding[p];
        let length = passes.neighbour_place(&frame.positions, periods, next).distance(passes.place(
            &frame.positions,
            periods,
            p,
        ));
        if rest > 0.0 {
            stretch[p] = length / rest - 1.0;
        }
    }
    stretch
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::sample_fabric::plain_weave;

    #[test]
    fn a_fabric_drawn_out_by_a_tenth_reads_a_tenth_along_its_wefts() {
        let network = plain_weave(3, 2, 1e-3);
        let frame = Frame {
            time: 0.0,
            positions: network.position.iter().map(|x| DVec3::new(x.x * 1.1, x.y, x.z)).collect(),
            sliding: network.arc_length.clone(),
        };
        let stretch = segment_stretch(&network, &frame, None);
        let wefts = network.yarn_start[2] as usize;
        assert!(stretch[..wefts].iter().all(|s| (s - 0.1).abs() < 1e-12));
        assert!(stretch[wefts..].iter().all(|s| s.abs() < 1e-12));
    }
}
