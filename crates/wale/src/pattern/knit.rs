//! From a chart of knits and purls to the network of its yarns (`docs/topics/knit-structure.md` has the drawing).

use glam::DVec3;

use super::chart::{Chart, Stitch, Working};
use super::layout::{Layout, Place};
use crate::model::{
    ContactPair, FabricCard, LoopInfo, Network, NodeId, PassId, PassKind, SegmentKind, StitchContact, WrapPair, YarnId,
};

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
pub fn fabric(chart: &Chart, working: Working, card: &FabricCard) -> Network {
    Builder::new(chart, card, Shape::Finite(working)).build()
}

/// Builds the smallest periodic tile: the chart repeats in both directions and every row is a yarn of its own that
/// closes on its image.
#[must_use]
pub fn tile(chart: &Chart, card: &FabricCard) -> Network {
    Builder::new(chart, card, Shape::Periodic).build()
}

#[derive(Clone, Copy, PartialEq)]
enum Shape {
    Finite(Working),
    Periodic,
}

/// A pass before it is given a place in the network.
#[derive(Clone, Copy)]
struct Step {
    node: usize,
    image: [i16; 2],
    kind: PassKind,
    slides: bool,
    /// Kind of the segment to the next step from left to right.
    onward: SegmentKind,
    /// Extra rest length of that segment \[m\].
    extra: f64,
}

struct Builder<'a> {
    chart: &'a Chart,
    card: &'a FabricCard,
    shape: Shape,
    layout: Layout,
    /// First node of each chart row.
    row_start: Vec<usize>,
    /// First node of the bind-off.
    top_start: usize,
    network: Network,
}

impl<'a> Builder<'a> {
    fn new(chart: &'a Chart, card: &'a FabricCard, shape: Shape) -> Self {
        let round = shape == Shape::Finite(Working::Round);
        let layout = Layout::new(chart.column_count(), card.wale_spacing, card.course_spacing, round);
        let network = Network {
            chart_size: [u32_of(chart.row_count()), u32_of(chart.column_count())],
            yarn_start: vec![0],
            ..Network::default()
        };
        Self { chart, card, shape, layout, row_start: Vec::new(), top_start: 0, network }
    }

    fn build(mut self) -> Network {
        self.number_nodes();
        match self.shape {
            Shape::Periodic => self.periodic_yarns(),
            Shape::Finite(working) => self.finite_yarns(working),
        }
        self.stack_nodes();
        self.stitch_contacts();
        self.network
    }

    /// Places every node but turns and tails, row by row so that memory follows the courses.
    fn number_nodes(&mut self) {
        let (rows, columns) = (self.chart.row_count(), self.chart.column_count());
        if self.shape != Shape::Periodic {
            for column in 0..columns {
                self.add_node(self.layout.cast_on(column));
            }
        }
        for row in 0..rows {
            self.row_start.push(self.network.position.len());
            for column in 0..columns {
                let first = self.network.position.len();
                for corner in 0..4 {
                    self.add_node(self.layout.corner(row, column, corner));
                }
                self.network.loops.push(LoopInfo {
                    row: u32_of(row),
                    column: u32_of(column),
                    nodes: (first..first + 4).map(NodeId::new).collect(),
                    knit: self.chart.rows()[row][column] == Stitch::Knit,
                });
            }
        }
        self.top_start = self.network.position.len();
        if self.shape != Shape::Periodic {
            for column in 0..columns {
                for side in 0..2 {
                    self.add_node(self.layout.top(rows, column, side));
                }
            }
        }
    }

    fn add_node(&mut self, place: Place) -> usize {
        self.network.position.push(place.position);
        self.network.front.push(place.front);
        self.network.chart_place.push(place.chart);
        self.network.position.len() - 1
    }

    fn own_node(&self, row: usize, column: usize, corner: usize) -> usize {
        self.row_start[row] + 4 * column + corner
    }

    /// Steps of what goes up through a loop of `row` (`None`: the cast-on), left to right: its child's four nodes, or
    /// the two of the bind-off.
    fn upward(&self, row: Option<usize>, column: usize, steps: &mut Vec<Step>) {
        let rows = self.chart.row_count();
        let child_row = row.map_or(0, |row| row + 1);
        if child_row == rows && self.shape != Shape::Periodic {
            for side in 0..2 {
                let onward = if side == 0 { SegmentKind::Head } else { SegmentKind::Leg };
                steps.push(step(self.top_start + 2 * column + side, PassKind::Edge, onward));
            }
            return;
        }
        let image = if child_row == rows { [0, 1] } else { [0, 0] };
        let corners = [
            (LEFT_FOOT, PassKind::Leg, SegmentKind::Stitch),
            (LEFT_LEG, PassKind::FootHead, SegmentKind::Head),
            (RIGHT_LEG, PassKind::FootHead, SegmentKind::Stitch),
            (RIGHT_FOOT, PassKind::Leg, if row.is_some() { SegmentKind::Leg } else { SegmentKind::Edge }),
        ];
        for (corner, kind, onward) in corners {
            let node = self.own_node(child_row % rows, column, corner);
            steps.push(Step { image, ..step(node, kind, onward) });
        }
    }

    /// Steps of one row, left to right.
    fn row_steps(&self, row: usize) -> Vec<Step> {
        let columns = self.chart.column_count();
        let wraps = self.shape == Shape::Periodic || self.layout.is_round();
        let mut steps = Vec::with_capacity(8 * columns);
        for column in 0..columns {
            steps.push(step(self.own_node(row, column, LEFT_FOOT), PassKind::FootHead, SegmentKind::Stitch));
            steps.push(step(self.own_node(row, column, LEFT_LEG), PassKind::Leg, SegmentKind::Leg));
            self.upward(Some(row), column, &mut steps);
            steps.push(step(self.own_node(row, column, RIGHT_LEG), PassKind::Leg, SegmentKind::Stitch));
            let next = if column + 1 < columns { Some(column + 1) } else { wraps.then_some(0) };
            let changes = next.is_some_and(|next| self.chart.rows()[row][next] != self.chart.rows()[row][column]);
            let extra = if changes { self.card.transition_length * self.card.loop_length } else { 0.0 };
            let foot = step(self.own_node(row, column, RIGHT_FOOT), PassKind::FootHead, SegmentKind::Sinker);
            steps.push(Step { extra, ..foot });
        }
        steps
    }

    fn cast_on_steps(&self) -> Vec<Step> {
        let mut steps = Vec::with_capacity(6 * self.chart.column_count());
        for column in 0..self.chart.column_count() {
            let tie = |onward| Step { slides: false, ..step(column, PassKind::Edge, onward) };
            steps.push(tie(SegmentKind::Edge));
            // A half hitch: the yarn goes up the far leg first and crosses itself at the tie as it comes down the near one.
            let up = steps.len();
            self.upward(None, column, &mut steps);
            steps[up..].reverse();
            let kinds = [SegmentKind::Stitch, SegmentKind::Head, SegmentKind::Stitch, SegmentKind::Edge];
            for (step, onward) in steps[up..].iter_mut().zip(kinds) {
                step.onward = onward;
            }
            steps.push(tie(SegmentKind::Chain));
        }
        steps
    }

    fn periodic_yarns(&mut self) {
        let (rows, columns) = (self.chart.row_count(), self.chart.column_count());
        let periods =
            [DVec3::X * self.card.wale_spacing * columns as f64, DVec3::Y * self.card.course_spacing * rows as f64];
        self.network.periods = Some(periods);
        for row in 0..rows {
            let steps = self.row_steps(row);
            let first = self.network.pass_count();
            let mut arc = 0.0;
            for (i, step) in steps.iter().enumerate() {
                self.push_pass(*step, step.onward, arc);
                let next = &steps[(i + 1) % steps.len()];
                let mut to = self.place(next, periods);
                if i + 1 == steps.len() {
                    to += periods[0];
                }
                arc += self.rest_length(step, (to - self.place(step, periods)).length());
            }
            let total = self.normalise_row(first, arc, row);
            self.close_yarn(Some(([1, 0], total)), row);
        }
    }

    fn place(&self, step: &Step, periods: [DVec3; 2]) -> DVec3 {
        self.network.position[step.node] + periods[0] * f64::from(step.image[0]) + periods[1] * f64::from(step.image[1])
    }

    /// One yarn from the cast-on to the last row, and the bind-off's.
    fn finite_yarns(&mut self, working: Working) {
        let rows = self.chart.row_count();
        let mut path: Vec<(Step, SegmentKind, f64)> = Vec::new();
        // The cast-on runs against the first row, so that the yarn turns once more; in the round it does not turn.
        let flat = working != Working::Round;
        let cast_on_rightward = if flat { !working.left_to_right(0) } else { false };
        let tail = self.add_node(self.layout.beside(0, -1.0, !cast_on_rightward));
        path.push((fixed(tail), SegmentKind::Edge, 0.0));
        extend(&mut path, &self.cast_on_steps(), cast_on_rightward, SegmentKind::Edge);
        let mut rightward = cast_on_rightward;
        for row in 0..rows {
            let next = working.left_to_right(row);
            if flat {
                let turn = self.add_node(self.layout.beside(row, -0.7, rightward));
                path.push((fixed(turn), SegmentKind::Edge, 0.0));
            }
            rightward = next;
            let joint = if flat || row + 1 == rows { SegmentKind::Edge } else { SegmentKind::Sinker };
            extend(&mut path, &self.row_steps(row), rightward, joint);
        }
        let tail = self.add_node(self.layout.beside(rows, -0.5, rightward));
        path.push((fixed(tail), SegmentKind::Edge, 0.0));
        self.lay_yarn(&path);

        let ends = [self.layout.beside(rows, 0.0, false), self.layout.beside(rows, 0.0, true)];
        let [left, right] = ends.map(|place| self.add_node(place));
        let mut path = vec![(fixed(left), SegmentKind::Chain, 0.0)];
        for node in self.top_start..self.top_start + 2 * self.chart.column_count() {
            path.push((step(node, PassKind::Edge, SegmentKind::Chain), SegmentKind::Chain, 0.0));
        }
        path.push((fixed(right), SegmentKind::Edge, 0.0));
        self.lay_yarn(&path);
    }

    /// Lays an open yarn along `path`, each entry with the kind and the extra length of the segment after it.
    fn lay_yarn(&mut self, path: &[(Step, SegmentKind, f64)]) {
        let mut arc = 0.0;
        for (i, (step, onward, extra)) in path.iter().enumerate() {
            self.push_pass(*step, *onward, arc);
            if let Some((next, ..)) = path.get(i + 1) {
                let distance = self.network.position[step.node].distance(self.network.position[next.node]);
                arc += self.rest_length(&Step { onward: *onward, extra: *extra, ..*step }, distance);
            }
        }
        self.close_yarn(None, self.network.yarn_count());
    }

    /// Rest length of the segment after `step`, whose ends lie `distance` apart in the layout.
    fn rest_length(&self, step: &Step, distance: f64) -> f64 {
        match step.onward {
            SegmentKind::Stitch => self.card.stitch_length,
            SegmentKind::Edge | SegmentKind::Chain => distance,
            SegmentKind::Leg | SegmentKind::Head | SegmentKind::Sinker => {
                distance * self.layout.slack(self.card.loop_length, self.card.stitch_length) + step.extra
            }
        }
    }

    /// Takes up round-off and the curvature of tubes, so that every periodic row holds exactly its loops' length.
    fn normalise_row(&mut self, first: usize, total: f64, row: usize) -> f64 {
        let columns = self.chart.column_count();
        let changes =
            (0..columns).filter(|&c| self.chart.rows()[row][c] != self.chart.rows()[row][(c + 1) % columns]).count();
        let expected = self.card.loop_length * (columns as f64 + self.card.transition_length * changes as f64);
        for arc in &mut self.network.arc_length[first..] {
            *arc *= expected / total;
        }
        expected
    }

    fn push_pass(&mut self, step: Step, onward: SegmentKind, arc: f64) {
        self.network.pass_node.push(NodeId::new(step.node));
        self.network.pass_image.push(step.image);
        self.network.pass_kind.push(step.kind);
        self.network.pass_slides.push(step.slides);
        self.network.segment_kind.push(onward);
        self.network.arc_length.push(arc);
    }

    fn close_yarn(&mut self, closure: Option<([i16; 2], f64)>, index: usize) {
        self.network.yarn_start.push(u32_of(self.network.pass_count()));
        self.network.yarn_closure.push(closure);
        self.network.yarn_color.push(YARN_COLORS[index % YARN_COLORS.len()]);
    }

    /// Orders the passes of every node front to back.
    fn stack_nodes(&mut self) {
        let mut stacks = vec![Vec::new(); self.network.node_count()];
        for (pass, node) in self.network.pass_node.iter().enumerate() {
            stacks[node.index()].push(PassId::new(pass));
        }
        for info in &self.network.loops {
            for corner in 0..4 {
                let stack = &mut stacks[info.nodes[corner].index()];
                let child = stack.iter().position(|&pass| is_own(self.network.pass_kind[pass.index()], corner));
                let (Some(child), 2) = (child, stack.len()) else { continue };
                let foot = corner == LEFT_FOOT || corner == RIGHT_FOOT;
                // Knit: the foot passes behind the parent's leg, the leg in front of the parent's head.
                let child_in_front = foot != info.knit;
                if (child == 0) != child_in_front {
                    stack.swap(0, 1);
                }
            }
        }
        self.network.set_stacks(&stacks);
    }

    fn stitch_contacts(&mut self) {
        let yarn_of = self.network.pass_yarn();
        let mut contacts = Vec::with_capacity(2 * self.network.loops.len());
        for info in &self.network.loops {
            for (foot, leg, left) in [(LEFT_FOOT, LEFT_LEG, true), (RIGHT_FOOT, RIGHT_LEG, false)] {
                let nodes = [info.nodes[foot], info.nodes[leg]];
                let child = [0, 1].map(|end| self.pass_at(nodes[end], |kind| is_own(kind, [foot, leg][end])));
                let parent = [0, 1].map(|end| self.pass_at(nodes[end], |kind| !is_own(kind, [foot, leg][end])));
                let outward = |passes: [PassId; 2], end: usize| {
                    let yarn = yarn_of[passes[0].index()];
                    let direction = outward_step(&self.network, yarn, passes[end], passes[1 - end]);
                    self.network.neighbour(yarn, passes[end], direction)
                };
                let mut pairs = Vec::with_capacity(2);
                for (pair, at_first, at_second) in
                    [(ContactPair::Course, child, parent), (ContactPair::Leg, parent, child)]
                {
                    if let (Some(first), Some(second)) = (outward(at_first, 0), outward(at_second, 1)) {
                        pairs.push(WrapPair {
                            pair,
                            outward_at_first: first.pass,
                            outward_at_second: second.pass,
                            image_at_first: first.image,
                            image_at_second: second.image,
                        });
                    }
                }
                let wrap_sign = if info.knit == left { 1.0 } else { -1.0 };
                contacts.push(StitchContact { nodes, passes: vec![child, parent], wrap_sign, pairs });
            }
        }
        self.network.stitches = contacts;
    }

    fn pass_at(&self, node: NodeId, wanted: impl Fn(PassKind) -> bool) -> PassId {
        let stack = self.network.stack(node);
        stack.iter().copied().find(|pass| wanted(self.network.pass_kind[pass.index()])).unwrap_or(stack[0])
    }
}

/// Sequence of colours of yarns: warm wool, then others.
const YARN_COLORS: [[u8; 3]; 4] = [[196, 138, 96], [122, 148, 170], [170, 120, 130], [140, 160, 120]];

/// Whether a pass of this kind at a loop's corner belongs to the loop itself, not to its parent: the loop's own feet
/// are foot-and-head passes and its own legs leg passes; of the parent it is the other way round.
fn is_own(kind: PassKind, corner: usize) -> bool {
    let foot = corner == LEFT_FOOT || corner == RIGHT_FOOT;
    match kind {
        PassKind::FootHead => foot,
        PassKind::Leg => !foot,
        PassKind::Edge => false,
    }
}

/// The direction along the yarn that leads from `pass` away from `other`, its neighbour in a stitch contact.
fn outward_step(network: &Network, yarn: YarnId, pass: PassId, other: PassId) -> i32 {
    match network.neighbour(yarn, pass, 1) {
        Some(next) if next.pass == other => -1,
        _ => 1,
    }
}

fn step(node: usize, kind: PassKind, onward: SegmentKind) -> Step {
    Step { node, image: [0; 2], kind, slides: true, onward, extra: 0.0 }
}

fn fixed(node: usize) -> Step {
    Step { slides: false, ..step(node, PassKind::Edge, SegmentKind::Edge) }
}

/// Appends left-to-right steps to a path in their own order or reversed; `joint` is the kind of the segment that
/// leads on from the last of them.
fn extend(path: &mut Vec<(Step, SegmentKind, f64)>, steps: &[Step], rightward: bool, joint: SegmentKind) {
    let n = steps.len();
    let extra = if joint == SegmentKind::Sinker { steps[n - 1].extra } else { 0.0 };
    if rightward {
        path.extend(steps[..n - 1].iter().map(|s| (*s, s.onward, s.extra)));
        path.push((steps[n - 1], joint, extra));
    } else {
        // Reversed, the segment after a step is the one that led to it.
        path.extend((1..n).rev().map(|i| (steps[i], steps[i - 1].onward, steps[i - 1].extra)));
        path.push((steps[0], joint, extra));
    }
}

fn u32_of(n: usize) -> u32 {
    u32::try_from(n).expect("chart sizes are limited to 32 bits")
}
