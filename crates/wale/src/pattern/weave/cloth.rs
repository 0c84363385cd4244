//! From a draft to the network of its yarns: a node at every crossing, with one sliding coordinate for the warp and one
//! for the weft.

use glam::DVec3;

use super::draft::{Draft, Thread};
use crate::model::{Crossing, LoopInfo, Network, NodeId, PassId, PassKind, SegmentKind, YarnRole};

/// How the weft goes at the sides.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Selvedge {
    /// It turns and goes on into the next pick, as long as that is of the same yarn.
    #[default]
    Woven,
    /// It is cut: every pick is a length of its own, with free ends.
    Cut,
}

/// A woven fabric, before anything is known of its yarns.
#[derive(Clone, PartialEq, Debug)]
pub struct Woven {
    /// The whole draft: every end and every pick.
    pub draft: Draft,
    /// How the weft goes at the sides.
    pub selvedge: Selvedge,
    /// Length of the free ends of the warp, and of the weft, beyond the last crossing \[m\].
    pub fringe: [f64; 2],
}

/// Colours of warp and weft of which nothing is said.
const COLORS: [[u8; 3]; 2] = [[196, 138, 96], [122, 148, 170]];

impl Woven {
    /// A draft with a woven selvedge and short free ends of half a spacing.
    #[must_use]
    pub fn new(draft: Draft, spacing: [f64; 2]) -> Self {
        Self { draft, selvedge: Selvedge::Woven, fringe: [0.5 * spacing[1], 0.5 * spacing[0]] }
    }

    /// The sheet, straight and flat, with ends and picks at a distance from their neighbours \[m\].
    #[must_use]
    pub fn network(&self, spacing: [f64; 2]) -> Network {
        let (ends, picks) = (self.draft.ends(), self.draft.picks());
        let count = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        let mut weaver = Weaver {
            woven: self,
            spacing,
            network: Network {
                chart_size: [count(picks), count(ends)],
                row_places: vec![count(ends); picks],
                yarn_start: vec![0],
                ..Network::default()
            },
            passes: vec![[PassId::default(); 2]; ends * picks],
        };
        for pick in 0..picks {
            for end in 0..ends {
                let node = weaver.node(end as f64, pick as f64);
                weaver.network.loops.push(LoopInfo {
                    row: count(pick),
                    column: count(end),
                    nodes: vec![NodeId::new(node)],
                    knit: self.draft.warp_up(end, pick),
                    held: true,
                });
            }
        }
        (0..ends).for_each(|end| weaver.warp(end));
        weaver.weft();
        weaver.stack();
        weaver.floats();
        weaver.network
    }

    /// Whether the weft is cut after a pick.
    fn is_cut_after(&self, pick: usize) -> bool {
        let kind = |thread: &Thread| (thread.yarn, thread.color);
        let weft = &self.draft.weft;
        self.selvedge == Selvedge::Cut || pick + 1 == weft.len() || kind(&weft[pick]) != kind(&weft[pick + 1])
    }

    /// The thread that each yarn of the network begins with, in their order.
    #[must_use]
    pub fn threads(&self) -> Vec<Thread> {
        let begins = |pick: &usize| *pick == 0 || self.is_cut_after(pick - 1);
        let weft = (0..self.draft.picks()).filter(begins).map(|pick| self.draft.weft[pick]);
        self.draft.warp.iter().copied().chain(weft).collect()
    }
}

struct Weaver<'a> {
    woven: &'a Woven,
    spacing: [f64; 2],
    network: Network,
    /// The passes of warp and weft at every crossing.
    passes: Vec<[PassId; 2]>,
}

impl Weaver<'_> {
    fn node(&mut self, end: f64, pick: f64) -> usize {
        let place = DVec3::new(end * self.spacing[0], pick * self.spacing[1], 0.0);
        self.network.position.push(place);
        self.network.front.push(DVec3::Z);
        self.network.chart_place.push([end, pick]);
        self.network.position.len() - 1
    }

    fn crossing(&self, end: usize, pick: usize) -> usize {
        pick * self.woven.draft.ends() + end
    }

    /// A pass, and the kind of the segment that leads on from it.
    fn pass(&mut self, node: usize, arc: f64, slides: bool, onward: SegmentKind) -> PassId {
        let pass = PassId::new(self.network.pass_node.len());
        self.network.pass_node.push(NodeId::new(node));
        self.network.pass_image.push([0; 2]);
        self.network.pass_kind.push(if slides { PassKind::Crossing } else { PassKind::Edge });
        self.network.pass_slides.push(slides);
        self.network.segment_kind.push(onward);
        self.network.segment_share.push(1);
        self.network.arc_length.push(arc);
        pass
    }

    fn close(&mut self, role: YarnRole, thread: Thread) {
        self.network.yarn_start.push(u32::try_from(self.network.pass_count()).unwrap_or(u32::MAX));
        self.network.yarn_closure.push(None);
        self.network.yarn_kind.push(thread.yarn);
        self.network.yarn_role.push(role);
        self.network.yarn_color.push(thread.color.unwrap_or(COLORS[usize::from(role == YarnRole::Weft)]));
    }

    /// Between two crossings a yarn changes sides, or floats.
    fn between(a: bool, b: bool) -> SegmentKind {
        if a == b { SegmentKind::Float } else { SegmentKind::Interlacing }
    }

    fn warp(&mut self, end: usize) {
        let draft = &self.woven.draft;
        let (picks, fringe, step) = (draft.picks(), self.woven.fringe[0], self.spacing[1]);
        let tail = fringe / step;
        let node = self.node(end as f64, -tail);
        self.pass(node, 0.0, false, SegmentKind::Edge);
        for pick in 0..picks {
            let up = |pick: usize| draft.warp_up(end, pick);
            let onward = if pick + 1 < picks { Self::between(up(pick), up(pick + 1)) } else { SegmentKind::Edge };
            let crossing = self.crossing(end, pick);
            self.passes[crossing][0] = self.pass(crossing, fringe + pick as f64 * step, true, onward);
        }
        let last = (picks as f64 - 1.0) * step;
        let node = self.node(end as f64, picks as f64 - 1.0 + tail);
        self.pass(node, 2.0 * fringe + last, false, SegmentKind::Edge);
        self.close(YarnRole::Warp, draft.warp[end]);
    }

    fn weft(&mut self) {
        let draft = &self.woven.draft;
        let (ends, fringe) = (draft.ends(), self.woven.fringe[1]);
        let tail = fringe / self.spacing[0];
        let (mut arc, mut begins) = (0.0, true);
        for pick in 0..draft.picks() {
            // To and fro; cut picks all run to the right.
            let rightward = self.woven.selvedge == Selvedge::Cut || pick.is_multiple_of(2);
            let beside = |right: bool| if right { ends as f64 - 1.0 + tail } else { -tail };
            if begins {
                let node = self.node(beside(!rightward), pick as f64);
                self.pass(node, 0.0, false, SegmentKind::Edge);
                arc = fringe;
            }
            for k in 0..ends {
                let at = |k: usize| if rightward { k } else { ends - 1 - k };
                let up = |k: usize| draft.warp_up(at(k), pick);
                let onward = if k + 1 < ends { Self::between(up(k), up(k + 1)) } else { SegmentKind::Edge };
                let crossing = self.crossing(at(k), pick);
                self.passes[crossing][1] = self.pass(crossing, arc, true, onward);
                arc += if k + 1 < ends { self.spacing[0] } else { 0.0 };
            }
            begins = self.woven.is_cut_after(pick);
            if begins {
                let node = self.node(beside(rightward), pick as f64);
                self.pass(node, arc + fringe, false, SegmentKind::Edge);
                self.close(YarnRole::Weft, draft.weft[pick]);
            } else {
                // A turn half a spacing outside, half way to the next pick.
                let side = if rightward { ends as f64 - 0.5 } else { -0.5 };
                let node = self.node(side, pick as f64 + 0.5);
                let leg = 0.5 * self.spacing[0].hypot(self.spacing[1]);
                self.pass(node, arc + leg, false, SegmentKind::Edge);
                arc += 2.0 * leg;
            }
        }
    }

    fn stack(&mut self) {
        let ends = self.woven.draft.ends();
        let mut stacks: Vec<Vec<PassId>> = Vec::with_capacity(self.network.node_count());
        for (crossing, [warp, weft]) in self.passes.iter().enumerate() {
            let up = self.woven.draft.warp_up(crossing % ends, crossing / ends);
            stacks.push(if up { vec![*warp, *weft] } else { vec![*weft, *warp] });
            self.network.crossings.push(Crossing { node: NodeId::new(crossing), warp: *warp, weft: *weft });
        }
        stacks.resize(self.network.node_count(), Vec::new());
        for (pass, node) in self.network.pass_node.iter().enumerate() {
            if node.index() >= self.passes.len() {
                stacks[node.index()].push(PassId::new(pass));
            }
        }
        self.network.set_stacks(&stacks);
    }

    /// How many yarns each float passes.
    fn floats(&mut self) {
        let mut run = 1;
        for kind in &self.network.segment_kind {
            if *kind == SegmentKind::Float {
                run += 1;
            } else {
                self.network.floats.extend((run > 1).then_some(run));
                run = 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::YarnId;

    #[test]
    fn every_crossing_has_both_yarns_in_the_drafts_order() {
        let draft = Draft::twill(2, 1).unwrap().repeat(7, 5).unwrap();
        for selvedge in [Selvedge::Woven, Selvedge::Cut] {
            let woven = Woven { draft: draft.clone(), selvedge, fringe: [2e-3, 3e-3] };
            let network = woven.network([1e-3, 0.8e-3]);
            assert_eq!(network.crossings.len(), 35);
            let yarn_of = network.pass_yarn();
            for (at, crossing) in network.crossings.iter().enumerate() {
                let up = draft.warp_up(at % 7, at / 7);
                let front = if up { crossing.warp } else { crossing.weft };
                assert_eq!(network.stack(crossing.node)[0], front);
                assert_eq!(network.stack(crossing.node).len(), 2);
                assert_eq!(network.yarn_role[yarn_of[crossing.warp.index()].index()], YarnRole::Warp);
                assert_eq!(network.yarn_role[yarn_of[crossing.weft.index()].index()], YarnRole::Weft);
            }
            let cut = selvedge == Selvedge::Cut;
            assert_eq!(network.yarn_count(), if cut { 12 } else { 8 });
            assert_eq!(woven.threads().len(), network.yarn_count());
            let longest = network.floats.iter().copied().max();
            assert_eq!(longest, Some(2));
            // Everything is as long as it is laid.
            for yarn in 0..network.yarn_count() {
                let passes = network.yarn_passes(YarnId::new(yarn));
                for p in passes.start..passes.end - 1 {
                    let [a, b] = [p, p + 1].map(|p| network.position[network.pass_node[p].index()]);
                    assert!((a.distance(b) - (network.arc_length[p + 1] - network.arc_length[p])).abs() < 1e-12);
                }
            }
            let width = 6e-3 + 2.0 * 3e-3;
            let weft = network.length_of(YarnId::new(7));
            assert!(if cut { (weft - width).abs() < 1e-12 } else { weft > 5.0 * 6e-3 });
        }
    }

    #[test]
    fn the_weft_is_cut_where_its_yarn_changes() {
        let mut draft = Draft::plain().repeat(4, 6).unwrap();
        draft.weft[2].yarn = 2;
        draft.weft[3].yarn = 2;
        draft.weft[5].color = Some([1, 2, 3]);
        let network = Woven::new(draft, [1e-3; 2]).network([1e-3; 2]);
        assert_eq!(network.yarn_kind[4..], [1, 2, 1, 1]);
        assert_eq!(network.yarn_color[7], [1, 2, 3]);
    }
}
