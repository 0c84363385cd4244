//! The network: what does not change while a fabric moves.

use glam::DVec3;
use serde::Serialize;

use super::ids::{NodeId, PassId, YarnId};

/// Where on a loop a pass lies; it decides the rest bend angle.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash)]
pub enum PassKind {
    /// Between a stitch contact and a sinker or a head: the foot and the head of a loop.
    FootHead,
    /// Between a stitch contact and a leg.
    Leg,
    /// Where warp and weft cross: rest straight.
    Crossing,
    /// Cast-on ties, selvedge turns, bind-off and yarn ends: rest straight.
    Edge,
}

/// What a yarn is in its fabric.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash)]
pub enum YarnRole {
    /// It is knitted.
    Knitted,
    /// It is the end or the ends of a warp.
    Warp,
    /// It is a pick, or goes from pick to pick.
    Weft,
}

/// What a segment (from a pass to the next pass of its yarn) is part of; it decides the spacing distance.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash)]
pub enum SegmentKind {
    /// Between the two nodes of one stitch contact.
    Stitch,
    /// A leg of a loop (along the wale).
    Leg,
    /// The head of a loop (along the course).
    Head,
    /// A sinker between two neighbouring loops of a course.
    Sinker,
    /// Cast-on ties, selvedge turns and tails.
    Edge,
    /// Cast-on and bind-off between two stitches: a chain of loops in the real fabric, one strand here.
    Chain,
    /// Between two crossings on different sides of the fabric.
    Interlacing,
    /// Between two crossings on the same side.
    Float,
}

/// Which of a stitch contact's two opposite pairs wraps.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash)]
pub enum ContactPair {
    /// Child's sinker side and parent's head side: along the course.
    Course,
    /// Parent's leg side and child's leg side: along the wale.
    Leg,
}

/// One wrapped pair of opposite yarn segments about a stitch contact [Cirio2017, Fig. 8].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WrapPair {
    /// Which pair of the contact this is.
    pub pair: ContactPair,
    /// The pass next to node `q₀`, away from the contact (`x₄` of the paper).
    pub outward_at_first: PassId,
    /// The pass next to node `q₁`, away from the contact (`x₃` of the paper).
    pub outward_at_second: PassId,
    /// Periodic image of `outward_at_first`'s node relative to the contact's nodes.
    pub image_at_first: [i16; 2],
    /// Periodic image of `outward_at_second`'s node relative to the contact's nodes.
    pub image_at_second: [i16; 2],
}

/// A stitch contact: two nodes and the passes that run through both.
#[derive(Clone, Debug, PartialEq)]
pub struct StitchContact {
    /// `q₀` (child's foot crosses parent's leg) and `q₁` (child's leg crosses parent's head).
    pub nodes: [NodeId; 2],
    /// Each yarn of the contact: its pass at `q₀` and its pass at `q₁` (consecutive, in either order).
    pub passes: Vec<[PassId; 2]>,
    /// Sign of the wrapping angle: `+1` for knit-left and purl-right, `−1` for knit-right and purl-left.
    pub wrap_sign: f64,
    /// The pairs that wrap.
    pub pairs: Vec<WrapPair>,
}

/// A strand that passes places of the needle without a loop there, or a thread that passes others on one side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Float {
    /// Places that it passes; of a weave, threads.
    pub over: u32,
    /// Row of the loop, or pick of the crossing, that it comes from, from 0; a cast-on counts as the first row.
    pub row: u32,
    /// Column of that loop, or end of that crossing, from 0.
    pub column: u32,
}

/// Where a warp end and a weft pick cross.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crossing {
    /// Its node.
    pub node: NodeId,
    /// The pass of the warp.
    pub warp: PassId,
    /// The pass of the weft.
    pub weft: PassId,
}

/// A pass next to another along a yarn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Neighbour {
    /// The pass.
    pub pass: PassId,
    /// Periodic image of its node, relative to the pass it was asked from.
    pub image: [i16; 2],
    /// Times that the yarn closed on itself between the two.
    pub turns: i16,
}

/// One loop of the chart, for inspection, colour and measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopInfo {
    /// Row of the chart, from the cast-on.
    pub row: u32,
    /// Column of the chart, from the left as seen from the front (right side).
    pub column: u32,
    /// The loop's own nodes, left foot, left leg, right leg, right foot (fewer at edges).
    pub nodes: Vec<NodeId>,
    /// Seen from the front: `true` for a knit, `false` for a purl.
    pub knit: bool,
    /// Whether anything holds it: a loop drawn through it, or the bind-off. What nothing holds is a dropped stitch.
    pub held: bool,
}

/// The fabric's yarns, nodes and contacts. Lengths in metres.
///
/// All passes of all yarns lie one after the other in yarn order; a *segment* is two consecutive passes of a yarn,
/// a *bend* three.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Network {
    /// Node of each pass.
    pub pass_node: Vec<NodeId>,
    /// Periodic image (course, wale) of the node that the pass goes through; zero in a finite fabric.
    pub pass_image: Vec<[i16; 2]>,
    /// Kind of each pass.
    pub pass_kind: Vec<PassKind>,
    /// Whether the pass's sliding coordinate may change (false at yarn ends, turns and single-yarn nodes).
    pub pass_slides: Vec<bool>,
    /// Passes that the end of their yarn has been pulled out of; empty while there are none.
    pub pulled_out: Vec<bool>,
    /// Kind of the segment from each pass to the next of its yarn (`Edge`, unused, for a yarn's last pass).
    pub segment_kind: Vec<SegmentKind>,
    /// How many loops share the strand that the segment after each pass is part of: more than one where several are
    /// worked into the same loop.
    pub segment_share: Vec<u8>,
    /// Initial rest arc length of each pass along its yarn, strictly increasing \[m\].
    pub arc_length: Vec<f64>,
    /// First pass of each yarn; one entry more than there are yarns.
    pub yarn_start: Vec<u32>,
    /// For a yarn that closes on a periodic image of itself: the image, and its arc length a period \[m\].
    pub yarn_closure: Vec<Option<([i16; 2], f64)>>,
    /// Colour of each yarn as sRGB, for pictures and exports.
    pub yarn_color: Vec<[u8; 3]>,
    /// Which of the fabric's yarns each yarn is a length of.
    pub yarn_kind: Vec<u8>,
    /// What each yarn is in the fabric.
    pub yarn_role: Vec<YarnRole>,
    /// First entry of each node's stack in `stack_pass`; one entry more than there are nodes.
    pub stack_start: Vec<u32>,
    /// Passes of each node's stack, front to back as seen from the right side of the fabric.
    pub stack_pass: Vec<PassId>,
    /// Initial positions \[m\], one per node: x along the course, y along the wale, z to the front.
    pub position: Vec<DVec3>,
    /// Unit vectors to the front of the fabric in the initial layout, one per node.
    pub front: Vec<DVec3>,
    /// Where each node lies on the chart: columns from the left, rows from the cast-on \[–\].
    pub chart_place: Vec<[f64; 2]>,
    /// Stitch contacts.
    pub stitches: Vec<StitchContact>,
    /// Crossings of warp and weft.
    pub crossings: Vec<Crossing>,
    /// Loops of the chart, or crossings of the draft: what is a knit there has the warp in front.
    pub loops: Vec<LoopInfo>,
    /// Floats in the order of the yarns; strands that pass nothing are none.
    pub floats: Vec<Float>,
    /// Rows and columns of the chart.
    pub chart_size: [u32; 2],
    /// Places on the needle after each row of the chart.
    pub row_places: Vec<u32>,
    /// For a periodic tile: initial periods along course and wale \[m\].
    pub periods: Option<[DVec3; 2]>,
}

impl Network {
    /// Number of nodes.
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.position.len()
    }
    /// Number of passes.
    #[must_use]
    pub fn pass_count(&self) -> usize {
        self.pass_node.len()
    }
    /// Number of yarns.
    #[must_use]
    pub fn yarn_count(&self) -> usize {
        self.yarn_start.len().saturating_sub(1)
    }
    /// Passes of a yarn, in order.
    #[must_use]
    pub fn yarn_passes(&self, yarn: YarnId) -> std::ops::Range<usize> {
        self.yarn_start[yarn.index()] as usize..self.yarn_start[yarn.index() + 1] as usize
    }
    /// Passes stacked at a node, front to back.
    #[must_use]
    pub fn stack(&self, node: NodeId) -> &[PassId] {
        let i = node.index();
        &self.stack_pass[self.stack_start[i] as usize..self.stack_start[i + 1] as usize]
    }
    /// The stitch contact of each node, named by its first node; a node of none is one of its own.
    #[must_use]
    pub fn contact_of_nodes(&self) -> Vec<u32> {
        let mut of_node: Vec<u32> = (0..self.node_count() as u32).collect();
        for stitch in &self.stitches {
            of_node[stitch.nodes[1].index()] = stitch.nodes[0].0;
        }
        of_node
    }
    /// The yarn of each pass.
    #[must_use]
    pub fn pass_yarn(&self) -> Vec<YarnId> {
        let mut yarn = vec![YarnId(0); self.pass_count()];
        for y in 0..self.yarn_count() {
            for p in self.yarn_passes(YarnId::new(y)) {
                yarn[p] = YarnId::new(y);
            }
        }
        yarn
    }
    /// Fills `stack_start` from `stacks`, one list of passes (front to back) per node.
    pub fn set_stacks(&mut self, stacks: &[Vec<PassId>]) {
        self.stack_start = vec![0];
        self.stack_pass.clear();
        for stack in stacks {
            self.stack_pass.extend(stack);
            self.stack_start.push(u32::try_from(self.stack_pass.len()).expect("stack count fits 32 bits"));
        }
    }
    /// The pass so many steps further along the yarn, with the periodic image of its node relative to this pass's node, and how
    /// many times the yarn closed on itself on the way. `None` past an open end.
    #[must_use]
    pub fn neighbour(&self, yarn: YarnId, pass: PassId, step: i32) -> Option<Neighbour> {
        let passes = self.yarn_passes(yarn);
        let (start, end) = (passes.start as i64, passes.end as i64);
        let mut moved = i64::from(pass.0) + i64::from(step);
        while step != 0 && (start..end).contains(&moved) && self.is_out(PassId(moved as u32)) {
            moved += i64::from(step.signum());
        }
        let turns = i16::try_from((moved - start).div_euclid(end - start)).ok()?;
        let index = start + (moved - start).rem_euclid(end - start);
        let closure = match self.yarn_closure[yarn.index()] {
            Some((image, _)) => image,
            None if turns != 0 => return None,
            None => [0; 2],
        };
        let to = PassId::new(usize::try_from(index).ok()?);
        let (a, b) = (self.pass_image[pass.index()], self.pass_image[to.index()]);
        let image = std::array::from_fn(|k| b[k] - a[k] + closure[k] * turns);
        Some(Neighbour { pass: to, image, turns })
    }
    /// Whether the end of its yarn has been pulled out of a pass.
    #[must_use]
    pub fn is_out(&self, pass: PassId) -> bool {
        self.pulled_out.get(pass.index()).copied().unwrap_or(false)
    }
    /// Where each node is held by its neighbours: its place in the layout \[m\], or for an end of a yarn that is out of contacts that of
    /// the last of them.
    #[must_use]
    pub fn places_held(&self) -> Vec<DVec3> {
        let mut places = self.position.clone();
        for yarn in (0..self.yarn_count()).map(YarnId::new) {
            let passes = self.yarn_passes(yarn);
            let place = |pass: usize| self.position[self.pass_node[pass].index()];
            let out = |pass: &usize| self.is_out(PassId::new(*pass));
            let ends = [(passes.start, passes.clone().skip(1).take_while(out).last())];
            let ends = ends.into_iter().chain([(passes.end - 1, passes.rev().skip(1).take_while(out).last())]);
            for (end, left) in ends {
                if let Some(left) = left {
                    places[self.pass_node[end].index()] = place(left);
                }
            }
        }
        places
    }
    /// The passes stacked at a node that are still there, front to back.
    pub fn live_stack(&self, node: NodeId) -> impl Iterator<Item = PassId> {
        self.stack(node).iter().copied().filter(|pass| !self.is_out(*pass))
    }
    /// Whether a pass's sliding coordinate may change now: not of a pass that is out, nor of the last yarn of a node.
    #[must_use]
    pub fn slides(&self, pass: PassId) -> bool {
        let index = pass.index();
        self.pass_slides[index]
            && (self.pulled_out.is_empty()
                || !self.is_out(pass) && self.live_stack(self.pass_node[index]).nth(1).is_some())
    }
    /// Which passes are out where the passes have these rest arc lengths \[m\]: those that an end of their yarn has come
    /// to, so that there is no yarn between.
    #[must_use]
    pub fn pulled_out_at(&self, sliding: &[f64]) -> Vec<bool> {
        let mut out = vec![false; self.pass_count()];
        for yarn in (0..self.yarn_count()).map(YarnId::new) {
            let passes = self.yarn_passes(yarn);
            if self.yarn_closure[yarn.index()].is_some() || passes.len() < 3 {
                continue;
            }
            let (first, last) = (sliding[passes.start], sliding[passes.end - 1]);
            passes.clone().skip(1).take_while(|&p| sliding[p] == first).for_each(|p| out[p] = true);
            passes.rev().skip(1).take_while(|&p| sliding[p] == last).for_each(|p| out[p] = true);
        }
        out
    }
    /// Total rest length of all yarns \[m\].
    #[must_use]
    pub fn yarn_length(&self) -> f64 {
        (0..self.yarn_count()).map(|y| self.length_of(YarnId::new(y))).sum()
    }

    /// Rest length of one yarn \[m\]; of a closed one, that of a period.
    #[must_use]
    pub fn length_of(&self, yarn: YarnId) -> f64 {
        let passes = self.yarn_passes(yarn);
        match self.yarn_closure[yarn.index()] {
            Some((_, length)) => length,
            None if passes.len() < 2 => 0.0,
            None => self.arc_length[passes.end - 1] - self.arc_length[passes.start],
        }
    }
}
