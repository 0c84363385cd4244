//! From the graph of loops to the network of its yarns (`docs/topics/knit-structure.md` has the drawing).

use glam::DVec3;

use super::chart::{Chart, ChartError};
use super::layout::{Layout, Place};
use super::loops::{Form, Form2d, Loop, LoopGraph, LoopId, Onward, Stop, Strand};
use super::rest_lengths::{RestLengths, Segment};
use super::stacks::{self, Made};
use super::work::{work, work_tile};
use super::working::Working;
use crate::model::{Float, KnitCard, LoopInfo, Network, NodeId, PassKind, SegmentKind, YarnRole};

/// The four own nodes of a loop, left to right along its yarn.
pub(super) const LEFT_FOOT: usize = 0;
/// Where the left leg crosses the parent's head.
pub(super) const LEFT_LEG: usize = 1;
/// Where the right leg crosses the parent's head.
pub(super) const RIGHT_LEG: usize = 2;
/// Where the right foot crosses the parent's leg.
pub(super) const RIGHT_FOOT: usize = 3;

/// Builds a finite fabric: cast-on, the rows of the chart, bind-off.
#[must_use]
pub fn fabric(chart: &Chart, working: Working, card: &KnitCard) -> Network {
    network(&work(chart, working), card)
}

/// Builds the smallest periodic tile: the chart repeats in both directions and every row is a yarn of its own that
/// closes on its image.
///
/// # Errors
/// If the chart cannot be repeated without end.
pub fn tile(chart: &Chart, card: &KnitCard) -> Result<Network, ChartError> {
    Ok(network(&work_tile(chart)?, card))
}

/// Builds the network of a graph of loops.
#[must_use]
pub fn network(graph: &LoopGraph, card: &KnitCard) -> Network {
    Builder::new(graph, card).build()
}

/// A pass before it is given a place in the network, and the segment to the next one from left to right.
#[derive(Clone, Copy)]
struct Step {
    node: usize,
    image: [i16; 2],
    kind: PassKind,
    slides: bool,
    /// The loop that the yarn is part of there.
    owner: Option<LoopId>,
    onward: Segment,
}

struct Builder<'a> {
    graph: &'a LoopGraph,
    card: &'a KnitCard,
    layout: Layout,
    rest: RestLengths,
    /// First own node of each loop (of a cast-on its tie); unused where there is none.
    first_node: Vec<usize>,
    /// First node of the bind-off.
    top_start: usize,
    network: Network,
    made: Made,
}

impl<'a> Builder<'a> {
    fn new(graph: &'a LoopGraph, card: &'a KnitCard) -> Self {
        let columns = graph.size[1] as usize;
        let round = graph.form == Form2d::Tube;
        let layout = Layout::new(columns, card.wale_spacing, card.course_spacing, round);
        let mut network = Network {
            chart_size: graph.size,
            row_places: graph.row_places.clone(),
            yarn_start: vec![0],
            ..Network::default()
        };
        if graph.form == Form2d::Tile {
            let [rows, columns] = graph.size.map(f64::from);
            network.periods = Some([DVec3::X * card.wale_spacing * columns, DVec3::Y * card.course_spacing * rows]);
        }
        Self {
            graph,
            card,
            rest: RestLengths::new(card, &layout),
            layout,
            first_node: Vec::with_capacity(graph.loops.len()),
            top_start: 0,
            network,
            made: Made::default(),
        }
    }

    fn build(mut self) -> Network {
        self.number_nodes();
        for strand in &self.graph.strands {
            if self.graph.form == Form2d::Tile {
                self.closed_yarn(strand);
            } else {
                self.open_yarn(strand);
            }
        }
        if !self.graph.bound.is_empty() {
            self.bind_off();
        }
        self.made.first_node = self.first_node;
        stacks::stack_nodes(&mut self.network, self.graph, &self.made);
        stacks::stitch_contacts(&mut self.network, self.graph, &self.made);
        self.network
    }

    /// Places every node but turns and tails, row by row so that memory follows the courses.
    fn number_nodes(&mut self) {
        let graph = self.graph;
        for of in &graph.loops {
            let first = self.network.position.len();
            self.first_node.push(first);
            match of.form {
                Form::CastOn => {
                    self.add_node(self.layout.cast_on(of.place));
                }
                Form::Worked { .. } => {
                    let middle = self.middle(of);
                    for corner in 0..4 {
                        let mut place = self.layout.corner(middle, corner, self.share(of));
                        place.position += place.front * (of.depth * self.card.wale_spacing);
                        self.add_node(place);
                    }
                }
                Form::Open | Form::Lifted => {}
            }
            let Ok(row) = u32::try_from(of.row) else { continue };
            if of.form != Form::Lifted {
                self.network.loops.push(LoopInfo {
                    row,
                    column: of.column,
                    nodes: (first..self.network.position.len()).map(NodeId::new).collect(),
                    knit: of.form != (Form::Worked { knit: false }),
                    held: !of.children.is_empty() || of.bound.is_some(),
                });
            }
        }
        self.top_start = self.network.position.len();
        for bound in &graph.bound {
            for side in 0..2 {
                self.add_node(self.layout.top(bound.place, side));
            }
        }
    }

    /// The middle of a loop's own nodes: between its own place and that of the loops that it is drawn through.
    fn middle(&self, of: &Loop) -> [f64; 2] {
        let columns = f64::from(self.graph.size[1]);
        let below = of.parents.iter().map(|held| self.graph.of(held.of).place[0] + columns * f64::from(held.image[0]));
        let below = below.sum::<f64>() / of.parents.len().max(1) as f64;
        [0.5 * (of.place[0] + below), of.place[1]]
    }

    fn add_node(&mut self, place: Place) -> usize {
        self.network.position.push(place.position);
        self.network.front.push(place.front);
        self.network.chart_place.push(place.chart);
        self.network.position.len() - 1
    }

    /// Steps of what goes up through a loop, left to right: the four nodes of each of its children, or the two of the
    /// bind-off; none of a loop that nothing holds.
    fn upward(&self, id: LoopId, steps: &mut Vec<Step>) {
        let of = self.graph.of(id);
        let leg = if of.form == Form::CastOn { SegmentKind::Edge } else { SegmentKind::Leg };
        let share = u8::try_from(of.children.len()).unwrap_or(u8::MAX).max(1);
        let shared = |kind: SegmentKind| Segment { kind, extra: 0.0, share };
        for (k, child) in of.children.iter().enumerate() {
            let onward = if k + 1 == of.children.len() { leg.into() } else { shared(SegmentKind::Head) };
            let corners = [
                (LEFT_FOOT, PassKind::Leg, shared(SegmentKind::Stitch)),
                (LEFT_LEG, PassKind::FootHead, shared(SegmentKind::Head)),
                (RIGHT_LEG, PassKind::FootHead, shared(SegmentKind::Stitch)),
                (RIGHT_FOOT, PassKind::Leg, onward),
            ];
            for (corner, kind, onward) in corners {
                let node = self.first_node[child.of.index()] + corner;
                let step = step(node, kind, onward);
                steps.push(Step { image: child.image, owner: Some(id), ..step });
            }
        }
        if let (true, Some(bound)) = (of.children.is_empty(), of.bound) {
            for (side, onward) in [SegmentKind::Head, leg].into_iter().enumerate() {
                let node = self.top_start + 2 * bound as usize + side;
                steps.push(Step { owner: Some(id), ..step(node, PassKind::Edge, onward.into()) });
            }
        }
    }

    /// Steps of one loop, left to right; what leads on from the last is for the yarn to say.
    fn loop_steps(&self, id: LoopId) -> Vec<Step> {
        let of = self.graph.of(id);
        let first = self.first_node[id.index()];
        let own =
            |corner, kind, onward: SegmentKind| Step { owner: Some(id), ..step(first + corner, kind, onward.into()) };
        let mut steps = Vec::with_capacity(8);
        match of.form {
            Form::CastOn => {
                let tie = || Step { slides: false, ..own(0, PassKind::Edge, SegmentKind::Edge) };
                steps.push(tie());
                // A half hitch: the yarn goes up the far leg first and crosses itself at the tie as it comes down the near
                // one. Turned around, the segment after a step is the one that led to it.
                let mut up = Vec::new();
                self.upward(id, &mut up);
                let onward: Vec<Segment> = up.iter().map(|step| step.onward).collect();
                let led = onward[..onward.len().saturating_sub(1)].iter().rev().copied();
                let led = led.chain([SegmentKind::Edge.into()]);
                steps.extend(up.into_iter().rev().zip(led).map(|(step, onward)| Step { onward, ..step }));
                steps.push(tie());
            }
            Form::Worked { .. } => {
                steps.push(own(LEFT_FOOT, PassKind::FootHead, SegmentKind::Stitch));
                steps.push(own(LEFT_LEG, PassKind::Leg, SegmentKind::Leg));
                self.upward(id, &mut steps);
                // A loop that is bound off, or that nothing holds, has as much yarn as others.
                let unheld = self.rest.stitch;
                if steps.len() == 2 {
                    let [leg, head, _] = self.rest.parts;
                    steps[1].onward.extra = leg + head + 2.0 * unheld;
                } else if of.children.is_empty() {
                    steps[1].onward.extra = unheld;
                    steps[3].onward.extra = unheld;
                }
                steps.push(own(RIGHT_LEG, PassKind::Leg, SegmentKind::Stitch));
                steps.push(own(RIGHT_FOOT, PassKind::FootHead, SegmentKind::Sinker));
            }
            Form::Open | Form::Lifted => self.upward(id, &mut steps),
        }
        // The feet of a loop that shares its parent with others lie as close as they do.
        if let (Form::Worked { .. }, n) = (of.form, steps.len()) {
            steps[0].onward.share = self.share(of);
            steps[n - 2].onward.share = self.share(of);
        }
        steps
    }

    /// With how many a loop shares the one that it is drawn through, itself counted.
    fn share(&self, of: &Loop) -> u8 {
        let siblings = of.parents.iter().map(|held| self.graph.of(held.of).children.len()).max();
        u8::try_from(siblings.unwrap_or(1)).unwrap_or(u8::MAX).max(1)
    }

    /// The steps along a strand, each with the segment that leads on; `closed` strands lead on to their own beginning.
    fn along(&mut self, strand: &Strand, closed: bool) -> Vec<Step> {
        let graph = self.graph;
        let mut path: Vec<Step> = Vec::with_capacity(8 * strand.stops.len());
        // What leads on from a loop that has no step itself (nothing holds it) is added to what led there.
        let mut carried = 0.0;
        for (at, (stop, onward)) in strand.stops.iter().enumerate() {
            let (id, rightward) = match *stop {
                Stop::Loop { id, rightward } => (id, rightward),
                Stop::Beside { row, offset, right } => {
                    let node = self.add_node(self.layout.beside(row, offset, right));
                    path.push(fixed(node));
                    continue;
                }
                Stop::At { place, depth } => {
                    let node = self.add_node(self.layout.at(place, depth));
                    path.push(fixed(node));
                    continue;
                }
                Stop::Behind { place } => {
                    let node = self.add_node(self.layout.behind(place));
                    path.push(fixed(node));
                    continue;
                }
            };
            let mut steps = self.loop_steps(id);
            if !rightward {
                // Turned around, the segment after a step is the one that led to it.
                let led: Vec<Segment> = steps.iter().map(|step| step.onward).collect();
                steps.reverse();
                for (k, step) in steps.iter_mut().enumerate() {
                    step.onward = led[(2 * led.len() - 2 - k) % led.len()];
                }
            }
            let next = match strand.stops.get(at + 1) {
                None if closed => strand.stops.first(),
                next => next,
            };
            let mut lead = match (onward, next) {
                (Onward::Sinker { over }, Some((Stop::Loop { id: next, .. }, _))) => {
                    if *over > 0 {
                        let from = graph.of(id);
                        let row = u32::try_from(from.row).unwrap_or(0);
                        self.network.floats.push(Float { over: *over, row, column: from.column });
                    }
                    let (from, to) = if rightward { (id, *next) } else { (*next, id) };
                    self.rest.joint(graph.of(from), graph.of(to), *over)
                }
                (Onward::Chain, _) => SegmentKind::Chain.into(),
                _ => SegmentKind::Edge.into(),
            };
            lead.extra += carried;
            carried = 0.0;
            match steps.last_mut() {
                Some(last) => last.onward = lead,
                None => {
                    if let Some(last) = path.last_mut() {
                        last.onward.extra += lead.extra;
                    } else {
                        carried = lead.extra;
                    }
                }
            }
            path.extend(steps);
        }
        path
    }

    fn closed_yarn(&mut self, strand: &Strand) {
        let path = self.along(strand, true);
        let periods = self.network.periods.unwrap_or_default();
        let place = |builder: &Self, step: &Step| {
            builder.network.position[step.node]
                + periods[0] * f64::from(step.image[0])
                + periods[1] * f64::from(step.image[1])
        };
        let mut arc = 0.0;
        for (i, step) in path.iter().enumerate() {
            self.push_pass(step, arc);
            let next = &path[(i + 1) % path.len()];
            let mut to = place(self, next);
            if i + 1 == path.len() {
                to += periods[0];
            }
            arc += self.rest.of(step.onward, to.distance(place(self, step)));
        }
        self.close_yarn(Some(([1, 0], arc)), strand.yarn);
    }

    fn open_yarn(&mut self, strand: &Strand) {
        let path = self.along(strand, false);
        self.lay_yarn(&path, strand.yarn);
    }

    /// One strand through the two nodes of every bound loop.
    fn bind_off(&mut self) {
        let rows = i32::try_from(self.graph.size[0]).unwrap_or(i32::MAX);
        let ends = [self.layout.beside(rows, 0.0, false), self.layout.beside(rows, 0.0, true)];
        let ends = self.ends(ends);
        let [left, right] = ends.map(|place| self.add_node(place));
        let chain = Segment::from(SegmentKind::Chain);
        let mut path = vec![Step { onward: chain, ..fixed(left) }];
        for node in self.top_start..self.top_start + 2 * self.graph.bound.len() {
            path.push(step(node, PassKind::Edge, chain));
        }
        path.push(fixed(right));
        self.lay_yarn(&path, self.graph.bind_off_yarn);
    }

    /// The ends of the bind-off: beside the edges of the fabric, or of a last row that is narrower.
    fn ends(&self, [left, right]: [Place; 2]) -> [Place; 2] {
        if self.layout.is_round() {
            return [left, right];
        }
        let first = self.graph.bound.first().map_or(0.5, |bound| bound.place[0]);
        let last = self.graph.bound.last().map_or(0.5, |bound| bound.place[0]);
        let columns = f64::from(self.graph.size[1]);
        let moved = |mut place: Place, by: f64| {
            place.position.x += by * self.card.wale_spacing;
            place.chart[0] += by;
            place
        };
        [moved(left, first - 0.5), moved(right, last + 0.5 - columns)]
    }

    /// Lays an open yarn along a path.
    fn lay_yarn(&mut self, path: &[Step], yarn: u8) {
        let mut arc = 0.0;
        for (i, step) in path.iter().enumerate() {
            self.push_pass(step, arc);
            if let Some(next) = path.get(i + 1) {
                let distance = self.network.position[step.node].distance(self.network.position[next.node]);
                arc += self.rest.of(step.onward, distance);
            }
        }
        self.close_yarn(None, yarn);
    }

    fn push_pass(&mut self, step: &Step, arc: f64) {
        self.network.pass_node.push(NodeId::new(step.node));
        self.network.pass_image.push(step.image);
        self.network.pass_kind.push(step.kind);
        self.network.pass_slides.push(step.slides);
        self.network.segment_kind.push(step.onward.kind);
        self.network.segment_share.push(step.onward.share);
        self.network.arc_length.push(arc);
        self.made.owner.push(step.owner);
    }

    fn close_yarn(&mut self, closure: Option<([i16; 2], f64)>, yarn: u8) {
        self.network.yarn_start.push(u32::try_from(self.network.pass_count()).expect("charts are limited to 32 bits"));
        self.network.yarn_closure.push(closure);
        self.network.yarn_kind.push(yarn);
        self.network.yarn_role.push(YarnRole::Knitted);
        self.network.yarn_color.push(YARN_COLORS[usize::from(yarn) % YARN_COLORS.len()]);
    }
}

/// Sequence of colours of yarns: warm wool, then others.
const YARN_COLORS: [[u8; 3]; 4] = [[196, 138, 96], [122, 148, 170], [170, 120, 130], [140, 160, 120]];

fn step(node: usize, kind: PassKind, onward: Segment) -> Step {
    Step { node, image: [0; 2], kind, slides: true, owner: None, onward }
}

fn fixed(node: usize) -> Step {
    Step { slides: false, ..step(node, PassKind::Edge, SegmentKind::Edge.into()) }
}
