//! A draft without end, whose threads close across both periods.

use glam::DVec3;

use super::cloth::{Weaver, Woven};
use super::draft::{Draft, DraftError};
use crate::model::{Network, YarnRole};

/// Least threads of either system: each of them has another thread beside it, and each thread a crossing that is not its first.
const LEAST: usize = 2;

/// The network of a draft that repeats, at a distance of ends and of picks \[m\], straight and flat; the draft is taken as often as
/// makes two ends and two picks. Its periods are those of the sett.
///
/// A float that goes on beyond a period is one float; they are not counted ([`Network::floats`] is empty).
///
/// # Errors
/// If it then has more crossings than a draft can.
pub fn tile(draft: &Draft, spacing: [f64; 2]) -> Result<Network, DraftError> {
    let enough = |threads: usize| threads * LEAST.div_ceil(threads);
    let draft = draft.repeat(enough(draft.ends()), enough(draft.picks()))?;
    let (ends, picks) = (draft.ends(), draft.picks());
    let woven = Woven::new(draft, spacing);
    let mut weaver = Weaver::laid(&woven, spacing);
    for end in 0..ends {
        for pick in 0..picks {
            let onward = weaver.onward((end, pick), Some((end, (pick + 1) % picks)));
            let Some(node) = weaver.at(end, pick) else { continue };
            weaver.passes[node][0] = weaver.pass(node, pick as f64 * spacing[1], true, onward);
        }
        weaver.close(YarnRole::Warp, woven.draft.warp[end], Some(([0, 1], picks as f64 * spacing[1])));
    }
    for pick in 0..picks {
        for end in 0..ends {
            let onward = weaver.onward((end, pick), Some(((end + 1) % ends, pick)));
            let Some(node) = weaver.at(end, pick) else { continue };
            weaver.passes[node][1] = weaver.pass(node, end as f64 * spacing[0], true, onward);
        }
        weaver.close(YarnRole::Weft, woven.draft.weft[pick], Some(([1, 0], ends as f64 * spacing[0])));
    }
    weaver.stack();
    let mut network = weaver.network;
    network.periods = Some([DVec3::X * spacing[0] * ends as f64, DVec3::Y * spacing[1] * picks as f64]);
    Ok(network)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{NodeId, PassId, SegmentKind, YarnId};

    #[test]
    fn every_thread_closes_across_its_period() {
        let spacing = [1e-3, 0.8e-3];
        for draft in [Draft::plain(), Draft::twill(2, 1).unwrap(), Draft::satin(5, 2).unwrap()] {
            let network = tile(&draft, spacing).unwrap();
            let [picks, ends] = network.chart_size.map(|count| count as usize);
            assert_eq!((ends, picks), (draft.ends(), draft.picks()));
            assert_eq!((network.node_count(), network.yarn_count()), (ends * picks, ends + picks));
            let [width, height] = network.periods.unwrap();
            assert!((width.x / (ends as f64 * spacing[0]) - 1.0).abs() < 1e-15);
            assert!((height.y / (picks as f64 * spacing[1]) - 1.0).abs() < 1e-15);
            for yarn in (0..network.yarn_count()).map(YarnId::new) {
                for pass in network.yarn_passes(yarn).map(PassId::new) {
                    // As long as it is laid, to the next and to the one before, across the period too.
                    for step in [-1, 1] {
                        let next = network.neighbour(yarn, pass, step).unwrap();
                        let image = width * f64::from(next.image[0]) + height * f64::from(next.image[1]);
                        let [here, there] =
                            [pass, next.pass].map(|p| network.position[network.pass_node[p.index()].index()]);
                        let arc = network.arc_length[next.pass.index()] - network.arc_length[pass.index()]
                            + f64::from(next.turns) * network.length_of(yarn);
                        let way = there + image - here;
                        assert!((way.length() - arc.abs()).abs() < 1e-15, "{way:?} {arc}");
                        let along = if network.yarn_role[yarn.index()] == YarnRole::Warp { way.y } else { way.x };
                        assert!((along - arc).abs() < 1e-15 && arc * f64::from(step) > 0.0);
                    }
                }
            }
        }
    }

    #[test]
    fn crossings_are_in_the_drafts_order_and_floats_are_where_it_floats() {
        let draft = Draft::twill(2, 1).unwrap();
        let network = tile(&draft, [1e-3; 2]).unwrap();
        let yarn_of = network.pass_yarn();
        for (at, crossing) in network.crossings.iter().enumerate() {
            assert_eq!(crossing.node, NodeId::new(at));
            let front = if draft.warp_up(at % 3, at / 3) { crossing.warp } else { crossing.weft };
            assert_eq!(
                network.stack(crossing.node),
                [front, if front == crossing.warp { crossing.weft } else { crossing.warp }]
            );
            assert_eq!(network.yarn_role[yarn_of[crossing.warp.index()].index()], YarnRole::Warp);
            assert_eq!(network.yarn_role[yarn_of[crossing.weft.index()].index()], YarnRole::Weft);
        }
        // Of three segments of a thread one floats.
        for yarn in (0..6).map(YarnId::new) {
            let floats = network.yarn_passes(yarn).filter(|&pass| network.segment_kind[pass] == SegmentKind::Float);
            assert_eq!(floats.count(), 1);
        }
    }

    #[test]
    fn threads_that_would_be_beside_themselves_are_repeated() {
        // Warp rib: every end alike on a pick; one end of it is a repeat.
        let ribbed = Draft::new(vec![vec![true], vec![false], vec![false]]).unwrap();
        let network = tile(&ribbed, [1e-3, 2e-3]).unwrap();
        assert_eq!(network.chart_size, [3, 2]);
        assert!(network.yarn_passes(YarnId::new(2)).len() == 2);
    }
}
