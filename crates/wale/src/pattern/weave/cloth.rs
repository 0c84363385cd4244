//! From a draft to the network of its yarns: a node at every crossing, with one sliding coordinate for the warp and one
//! for the weft.

use glam::{DQuat, DVec3};

use super::draft::{Draft, Thread};
use crate::model::{Crossing, Float, LoopInfo, Network, NodeId, PassId, PassKind, SegmentKind, YarnId, YarnRole};
use crate::pattern::remark::Remark;

/// How the weft goes at the sides.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Selvedge {
    /// It turns and goes on into the next pick, as long as that is of the same yarn.
    #[default]
    Woven,
    /// It is cut: every pick is a length of its own, with free ends.
    Cut,
}

/// A piece cut out of a fabric, its sides at an angle to the threads.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct BiasCut {
    /// From the warp to the length of the piece, turning to the right \[rad\].
    pub angle: f64,
    /// Width and length \[m\].
    pub size: [f64; 2],
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
    /// The piece that is cut out of its middle and turned upright, if one is.
    pub bias: Option<BiasCut>,
    /// What was unusual in the file that the draft was read from.
    pub remarks: Vec<Remark>,
}

/// Colours of warp and weft of which nothing is said.
const COLORS: [[u8; 3]; 2] = [[196, 138, 96], [122, 148, 170]];

impl BiasCut {
    /// Ends and picks that a piece reaches over, at a spacing \[m\].
    #[must_use]
    pub fn reach(&self, spacing: [f64; 2]) -> [f64; 2] {
        let (sine, cosine) = self.angle.sin_cos();
        let [width, length] = self.size;
        [
            (width * cosine.abs() + length * sine.abs()) / spacing[0],
            (width * sine.abs() + length * cosine.abs()) / spacing[1],
        ]
    }
}

impl Woven {
    /// A draft with a woven selvedge and short free ends of half a spacing.
    #[must_use]
    pub fn new(draft: Draft, spacing: [f64; 2]) -> Self {
        let fringe = [0.5 * spacing[1], 0.5 * spacing[0]];
        Self { draft, selvedge: Selvedge::Woven, fringe, bias: None, remarks: Vec::new() }
    }

    /// The sheet, straight and flat, with ends and picks at a distance from their neighbours \[m\].
    #[must_use]
    pub fn network(&self, spacing: [f64; 2]) -> Network {
        let mut weaver = Weaver::laid(self, spacing);
        (0..self.draft.ends()).for_each(|end| weaver.warp(end));
        weaver.weft();
        weaver.stack();
        weaver.floats();
        weaver.network
    }

    /// Whether the weft is cut after a pick.
    fn is_cut_after(&self, pick: usize) -> bool {
        let kind = |thread: &Thread| (thread.yarn, thread.color);
        let weft = &self.draft.weft;
        self.weft_is_cut() || pick + 1 == weft.len() || kind(&weft[pick]) != kind(&weft[pick + 1])
    }

    fn weft_is_cut(&self) -> bool {
        self.selvedge == Selvedge::Cut || self.bias.is_some()
    }

    /// The thread that a yarn of the network is, or begins with.
    #[must_use]
    pub fn thread(&self, network: &Network, yarn: YarnId) -> Option<Thread> {
        // The first pass is that of its free end, the second its first crossing.
        let crossing = network.pass_node.get(network.yarn_passes(yarn).start + 1)?;
        let [end, pick] = network.chart_place[crossing.index()].map(|place| place as usize);
        match network.yarn_role[yarn.index()] {
            YarnRole::Warp => self.draft.warp.get(end).copied(),
            YarnRole::Weft => self.draft.weft.get(pick).copied(),
            YarnRole::Knitted => None,
        }
    }
}

/// A network of a draft on its way: first its crossings, then its yarns through them.
pub(super) struct Weaver<'a> {
    woven: &'a Woven,
    spacing: [f64; 2],
    pub network: Network,
    /// The node of every crossing that is there.
    crossing: Vec<Option<usize>>,
    /// The passes of warp and weft there, by node.
    pub passes: Vec<[PassId; 2]>,
}

impl<'a> Weaver<'a> {
    /// The crossings of a sheet, of which no yarn is there yet.
    pub fn laid(woven: &'a Woven, spacing: [f64; 2]) -> Self {
        let (ends, picks) = (woven.draft.ends(), woven.draft.picks());
        let count = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        let mut weaver = Self {
            woven,
            spacing,
            network: Network {
                chart_size: [count(picks), count(ends)],
                row_places: vec![count(ends); picks],
                yarn_start: vec![0],
                ..Network::default()
            },
            crossing: vec![None; ends * picks],
            passes: Vec::new(),
        };
        for pick in 0..picks {
            for end in 0..ends {
                if !weaver.keeps(end, pick) {
                    continue;
                }
                let node = weaver.node(end as f64, pick as f64);
                weaver.crossing[pick * ends + end] = Some(node);
                weaver.passes.push([PassId::default(); 2]);
                weaver.network.loops.push(LoopInfo {
                    row: count(pick),
                    column: count(end),
                    nodes: vec![NodeId::new(node)],
                    knit: woven.draft.warp_up(end, pick),
                    held: true,
                });
            }
        }
        weaver
    }

    /// Where an end and a pick cross \[m\].
    fn place(&self, end: f64, pick: f64) -> DVec3 {
        let place = DVec3::new(end * self.spacing[0], pick * self.spacing[1], 0.0);
        match self.woven.bias {
            None => place,
            Some(cut) => {
                let draft = &self.woven.draft;
                let middle = DVec3::new(
                    0.5 * (draft.ends() as f64 - 1.0) * self.spacing[0],
                    0.5 * (draft.picks() as f64 - 1.0) * self.spacing[1],
                    0.0,
                );
                DQuat::from_rotation_z(cut.angle) * (place - middle)
            }
        }
    }

    fn keeps(&self, end: usize, pick: usize) -> bool {
        self.woven.bias.is_none_or(|cut| {
            let place = self.place(end as f64, pick as f64);
            2.0 * place.x.abs() <= cut.size[0] && 2.0 * place.y.abs() <= cut.size[1]
        })
    }

    fn node(&mut self, end: f64, pick: f64) -> usize {
        let place = self.place(end, pick);
        self.network.position.push(place);
        self.network.front.push(DVec3::Z);
        self.network.chart_place.push([end, pick]);
        self.network.position.len() - 1
    }

    /// The node of a crossing, if it is there.
    pub fn at(&self, end: usize, pick: usize) -> Option<usize> {
        self.crossing[pick * self.woven.draft.ends() + end]
    }

    /// A pass, and the kind of the segment that leads on from it.
    pub fn pass(&mut self, node: usize, arc: f64, slides: bool, onward: SegmentKind) -> PassId {
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

    /// Ends a yarn; one that closes on an image of itself does so after a length \[m\].
    pub fn close(&mut self, role: YarnRole, thread: Thread, closure: Option<([i16; 2], f64)>) {
        self.network.yarn_start.push(u32::try_from(self.network.pass_count()).unwrap_or(u32::MAX));
        self.network.yarn_closure.push(closure);
        self.network.yarn_kind.push(thread.yarn);
        self.network.yarn_role.push(role);
        self.network.yarn_color.push(thread.color.unwrap_or(COLORS[usize::from(role == YarnRole::Weft)]));
    }

    /// Between two crossings a yarn changes sides, or floats; behind the last it is an edge.
    pub fn onward(&self, here: (usize, usize), next: Option<(usize, usize)>) -> SegmentKind {
        let up = |(end, pick)| self.woven.draft.warp_up(end, pick);
        match next {
            None => SegmentKind::Edge,
            Some(next) if up(here) == up(next) => SegmentKind::Float,
            Some(_) => SegmentKind::Interlacing,
        }
    }

    fn warp(&mut self, end: usize) {
        let draft = &self.woven.draft;
        let (fringe, step) = (self.woven.fringe[0], self.spacing[1]);
        let picks: Vec<usize> = (0..draft.picks()).filter(|&pick| self.at(end, pick).is_some()).collect();
        let (Some(&first), Some(&last)) = (picks.first(), picks.last()) else { return };
        let tail = fringe / step;
        let node = self.node(end as f64, first as f64 - tail);
        self.pass(node, 0.0, false, SegmentKind::Edge);
        for (k, &pick) in picks.iter().enumerate() {
            let onward = self.onward((end, pick), picks.get(k + 1).map(|&next| (end, next)));
            let Some(node) = self.at(end, pick) else { continue };
            self.passes[node][0] = self.pass(node, fringe + (pick - first) as f64 * step, true, onward);
        }
        let node = self.node(end as f64, last as f64 + tail);
        self.pass(node, 2.0 * fringe + (last - first) as f64 * step, false, SegmentKind::Edge);
        self.close(YarnRole::Warp, draft.warp[end], None);
    }

    fn weft(&mut self) {
        let draft = &self.woven.draft;
        let (fringe, step) = (self.woven.fringe[1], self.spacing[0]);
        let tail = fringe / step;
        let (mut arc, mut begins) = (0.0, true);
        for pick in 0..draft.picks() {
            // To and fro; cut picks all run to the right.
            let rightward = self.woven.weft_is_cut() || pick.is_multiple_of(2);
            let mut ends: Vec<usize> = (0..draft.ends()).filter(|&end| self.at(end, pick).is_some()).collect();
            if !rightward {
                ends.reverse();
            }
            let (Some(&first), Some(&last)) = (ends.first(), ends.last()) else { continue };
            let outward = if rightward { 1.0 } else { -1.0 };
            if begins {
                let node = self.node(first as f64 - outward * tail, pick as f64);
                self.pass(node, 0.0, false, SegmentKind::Edge);
                arc = fringe;
            }
            for (k, &end) in ends.iter().enumerate() {
                let onward = self.onward((end, pick), ends.get(k + 1).map(|&next| (next, pick)));
                let Some(node) = self.at(end, pick) else { continue };
                self.passes[node][1] = self.pass(node, arc, true, onward);
                arc += if k + 1 < ends.len() { step } else { 0.0 };
            }
            begins = self.woven.is_cut_after(pick);
            if begins {
                let node = self.node(last as f64 + outward * tail, pick as f64);
                self.pass(node, arc + fringe, false, SegmentKind::Edge);
                self.close(YarnRole::Weft, draft.weft[pick], None);
            } else {
                // A turn half a spacing outside, half way to the next pick.
                let node = self.node(last as f64 + 0.5 * outward, pick as f64 + 0.5);
                let leg = 0.5 * step.hypot(self.spacing[1]);
                self.pass(node, arc + leg, false, SegmentKind::Edge);
                arc += 2.0 * leg;
            }
        }
    }

    pub fn stack(&mut self) {
        let mut stacks: Vec<Vec<PassId>> = Vec::with_capacity(self.network.node_count());
        for (node, [warp, weft]) in self.passes.iter().enumerate() {
            let up = self.network.loops[node].knit;
            stacks.push(if up { vec![*warp, *weft] } else { vec![*weft, *warp] });
            self.network.crossings.push(Crossing { node: NodeId::new(node), warp: *warp, weft: *weft });
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
        let network = &mut self.network;
        let is_float = |kind: &&SegmentKind| **kind == SegmentKind::Float;
        let mut pass = 0;
        while pass < network.segment_kind.len() {
            let segments = network.segment_kind[pass..].iter().take_while(is_float).count();
            if segments > 0 {
                // It comes from a crossing, and those are the first nodes.
                let LoopInfo { row, column, .. } = network.loops[network.pass_node[pass].index()];
                let over = u32::try_from(segments + 1).unwrap_or(u32::MAX);
                network.floats.push(Float { over, row, column });
            }
            pass += segments + 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_crossing_has_both_yarns_in_the_drafts_order() {
        let draft = Draft::twill(2, 1).unwrap().repeat(7, 5).unwrap();
        for selvedge in [Selvedge::Woven, Selvedge::Cut] {
            let woven = Woven { selvedge, fringe: [2e-3, 3e-3], ..Woven::new(draft.clone(), [1e-3; 2]) };
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
            let longest = network.floats.iter().map(|float| float.over).max();
            assert_eq!(longest, Some(2));
            for float in &network.floats {
                // A warp lies over two picks, so a weft behind two ends: the next crossing of the thread shows the warp, too.
                let (end, pick) = (float.column as usize, float.row as usize);
                let up = |(end, pick): (usize, usize)| end < 7 && pick < 5 && draft.warp_up(end, pick);
                let next = [(end, pick + 1), (end + 1, pick), (end.wrapping_sub(1), pick)];
                assert!(up((end, pick)) && next.into_iter().any(up), "{float:?}");
            }
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
    fn a_piece_on_the_bias_has_threads_of_every_length() {
        let cut = BiasCut { angle: std::f64::consts::FRAC_PI_4, size: [10e-3, 30e-3] };
        let reach = cut.reach([1e-3; 2]).map(|n| n as usize + 1);
        let mut woven = Woven::new(Draft::plain().repeat(reach[0], reach[1]).unwrap(), [1e-3; 2]);
        woven.bias = Some(cut);
        let network = woven.network([1e-3; 2]);
        let inside = network.crossings.iter().map(|crossing| network.position[crossing.node.index()]);
        assert!(inside.clone().all(|x| x.x.abs() <= 5e-3 && x.y.abs() <= 15e-3));
        // A crossing a square millimetre, give or take half of those along the border.
        assert!((270..=330).contains(&inside.count()), "{}", network.crossings.len());
        let longest = (0..network.yarn_count()).map(|y| network.length_of(YarnId::new(y))).fold(0.0, f64::max);
        assert!((longest - 10e-3 * 2f64.sqrt()).abs() < 2e-3, "{longest}");
        let yarn_of = network.pass_yarn();
        for crossing in &network.crossings {
            assert!(yarn_of[crossing.warp.index()] != yarn_of[crossing.weft.index()]);
        }
    }

    #[test]
    fn threads_of_a_piece_are_known_where_others_are_cut_away() {
        let cut = BiasCut { angle: 0.5, size: [0.6e-3, 30e-3] };
        let reach = cut.reach([1e-3; 2]).map(|n| n as usize + 1);
        let mut woven = Woven::new(Draft::plain().repeat(reach[0], reach[1]).unwrap(), [1e-3; 2]);
        woven.bias = Some(cut);
        let threads = woven.draft.warp.iter_mut().chain(&mut woven.draft.weft);
        threads.enumerate().for_each(|(k, thread)| thread.color = Some([k as u8, 0, 0]));
        let network = woven.network([1e-3; 2]);
        assert!(network.yarn_count() < woven.draft.ends() + woven.draft.picks());
        for yarn in (0..network.yarn_count()).map(YarnId::new) {
            assert_eq!(woven.thread(&network, yarn).unwrap().color, Some(network.yarn_color[yarn.index()]));
        }
    }

    #[test]
    fn the_weft_is_cut_where_its_yarn_changes() {
        let mut draft = Draft::plain().repeat(4, 6).unwrap();
        draft.weft[2].yarn = 2;
        draft.weft[3].yarn = 2;
        draft.weft[5].color = Some([1, 2, 3]);
        let woven = Woven::new(draft, [1e-3; 2]);
        let network = woven.network([1e-3; 2]);
        assert_eq!(network.yarn_kind[4..], [1, 2, 1, 1]);
        assert_eq!(network.yarn_color[7], [1, 2, 3]);
        assert_eq!(woven.thread(&network, YarnId::new(5)).unwrap().yarn, 2);
    }
}
