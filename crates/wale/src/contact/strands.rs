//! Strands of yarn that come near each other between their nodes, where no contact of the network joins them.

use std::cmp::Ordering;

use glam::DVec3;
use rayon::prelude::*;

use super::Nearby;
use crate::energy::strand_contact::closest;
use crate::model::{Network, NodeId, PassId, Yarns};

/// Distance at which strands begin to push each other apart, as a share of that at which they touch.
pub const BEGINS: f64 = 0.9;
/// The same as a share of their distance in the layout, so that the layout is not pushed apart.
const OF_LAYOUT: f64 = 0.8;
/// Share of touching that the distance grows to in a soft start where the layout has less.
const GROWS_TO: f64 = 0.5;
/// Strands nearer than this share of touching in the layout lie through each other there: nothing tells them apart.
const NOTHING: f64 = 0.02;
/// How much further than needed strands are looked for, and the most that their speed adds to it, in yarn radii.
const MARGIN: f64 = 0.7;
const MOST_MARGIN: f64 = 4.0;
/// Lengths of a mean strand above which one is looked for in pieces: a single long float would make every strand near every other.
const LONG: f64 = 4.0;
/// Most pieces of a strand.
const MOST_PIECES: f64 = 4096.0;
/// Pairs of a part.
const PART: usize = 8192;
/// How far the yarns of a stitch contact lie aside of its axis, in yarn radii: they are led around each other.
const ASIDE: f64 = 0.7;
/// Below this share of the flattest possible fit, a node's own normal gives way to its neighbours'.
const TRUSTED: f64 = 0.05;

/// Distance below which strands push each other apart that touch at one distance and lie at another in the layout \[m\]; `None` where
/// nothing tells them apart.
#[must_use]
pub fn holds_off_below(touching: f64, layout: f64) -> Option<f64> {
    (layout > NOTHING * touching).then_some((BEGINS * touching).min(OF_LAYOUT * layout))
}

/// Two strands that may meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearStrands {
    /// Nodes at their ends.
    pub nodes: [u32; 4],
    /// Where the strands lie beside these \[m\].
    pub offsets: [[f64; 3]; 4],
    /// Distance below which they push each other apart \[m\].
    pub distance: f64,
}

/// A segment of yarn.
#[derive(Clone, Copy, Debug)]
struct Strand {
    nodes: [u32; 2],
    /// The contacts at its ends.
    contacts: [u32; 2],
    /// How far in front of the nodes it lies \[m\].
    heights: [f64; 2],
    radius: f64,
    /// How far it is led aside in a stitch contact, to the left of its way as seen from the front \[m\].
    aside: f64,
    /// Where it lies in the layout.
    layout: [DVec3; 2],
}

impl Strand {
    fn layout_length(&self) -> f64 {
        self.layout[0].distance(self.layout[1])
    }

    /// Where its ends lie beside their nodes, which are at `ends` and have these normals.
    fn offsets(&self, ends: [DVec3; 2], normals: [DVec3; 2]) -> [DVec3; 2] {
        let left = (normals[0] + normals[1]).cross(ends[1] - ends[0]).normalize_or_zero();
        std::array::from_fn(|k| normals[k] * self.heights[k] + left * self.aside)
    }
}

/// The segments of a knit. Where each loop holds its neighbours, contacts keep them apart; where some hang free, as yarn-overs do, or
/// are worked together, they may meet between.
#[derive(Clone, Debug, Default)]
pub struct Strands {
    strands: Vec<Strand>,
    /// Length above which a strand is looked for in pieces \[m\].
    long: f64,
    /// The strand of each piece, and its middle.
    pieces: Vec<u32>,
    places: Vec<DVec3>,
    /// For each node the nodes next to it along its yarns, and where they are in the layout, along two directions that make
    /// a right-handed frame with the front.
    around: Vec<(u32, [f64; 2])>,
    around_start: Vec<u32>,
    fits: Vec<(DVec3, f64)>,
    normals: Vec<DVec3>,
    nearby: Nearby,
    pairs: Vec<[u32; 2]>,
    /// What was found by parts of the pairs, and all of it.
    parts: Vec<Vec<NearStrands>>,
    found: Vec<NearStrands>,
}

impl Strands {
    /// The strands of a knit; none of a weave or of a tile.
    #[must_use]
    pub fn new(network: &Network, yarns: &Yarns) -> Self {
        let nodes = 0..network.node_count();
        if network.stitches.is_empty() || network.periods.is_some() {
            return Self::default();
        }
        let contact = network.contact_of_nodes();
        let yarn_of = network.pass_yarn();
        let radius = |pass: PassId| yarns.of(network.yarn_kind[yarn_of[pass.index()].index()]).radius;
        let mut heights = vec![0.0; network.pass_count()];
        for node in nodes {
            let thickness: f64 = network.live_stack(NodeId::new(node)).map(|pass| 2.0 * radius(pass)).sum();
            let mut above = 0.0;
            for pass in network.live_stack(NodeId::new(node)) {
                above += 2.0 * radius(pass);
                heights[pass.index()] = 0.5 * thickness - above + radius(pass);
            }
        }
        let to_the_left = clasps(network);
        let mut strands = Vec::new();
        let mut pairs = Vec::new();
        for pass in (0..network.pass_count()).map(PassId::new) {
            let next = network.neighbour(yarn_of[pass.index()], pass, 1);
            let Some(next) = next.filter(|_| !network.is_out(pass)) else { continue };
            let ends = [pass, next.pass];
            let nodes = ends.map(|pass| network.pass_node[pass.index()]);
            if nodes[0] == nodes[1] {
                continue;
            }
            let mut strand = Strand {
                nodes: nodes.map(|node| node.0),
                contacts: nodes.map(|node| contact[node.index()]),
                heights: ends.map(|pass| heights[pass.index()]),
                radius: radius(pass),
                aside: ASIDE * radius(pass) * to_the_left[pass.index()],
                layout: nodes.map(|node| network.position[node.index()]),
            };
            let offsets = strand.offsets(strand.layout, nodes.map(|node| network.front[node.index()]));
            strand.layout = [0, 1].map(|k| strand.layout[k] + offsets[k]);
            strands.push(strand);
            pairs.extend([(nodes[0], nodes[1]), (nodes[1], nodes[0])]);
        }
        pairs.sort_unstable_by_key(|(node, _)| node.0);
        let around = pairs.iter().map(|&(node, other)| {
            let front = network.front[node.index()].normalize_or(DVec3::Z);
            let first = front.any_orthonormal_vector();
            let rest = (network.position[other.index()] - network.position[node.index()]).normalize_or_zero();
            (other.0, [rest.dot(first), rest.dot(front.cross(first))])
        });
        let start = |node: u32| pairs.partition_point(|(of, _)| of.0 < node) as u32;
        Self {
            long: (LONG * strands.iter().map(Strand::layout_length).sum::<f64>() / strands.len() as f64).max(1e-300),
            pieces: Vec::new(),
            places: Vec::new(),
            around: around.collect(),
            around_start: (0..=network.node_count() as u32).map(start).collect(),
            fits: Vec::new(),
            normals: Vec::new(),
            nearby: Nearby::default(),
            pairs: Vec::new(),
            parts: Vec::new(),
            found: Vec::new(),
            strands,
        }
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.strands.is_empty()
    }

    /// The strands that may meet in a time `h` \[s\], in a fixed order. `at` is where a node is \[m\], `velocity` how it
    /// moves \[m/s\], `grown` how far a soft start has come, from 0 to 1; strands too near in the layout are by then far enough apart
    /// for their curves too, which leave the straight lines between the nodes.
    pub fn find(
        &mut self,
        at: impl Fn(usize) -> DVec3 + Sync,
        velocity: impl Fn(usize) -> DVec3 + Sync,
        h: f64,
        grown: f64,
    ) -> &[NearStrands] {
        self.find_normals(&at);
        self.find_pairs(&at);
        let (strands, normals) = (&self.strands, &self.normals);
        let near = |pair: &[u32; 2]| {
            let [a, b] = pair.map(|index| &strands[index as usize]);
            if a.contacts.iter().any(|contact| b.contacts.contains(contact)) {
                return None;
            }
            let touching = a.radius + b.radius;
            let nodes = [a.nodes[0], a.nodes[1], b.nodes[0], b.nodes[1]];
            let ways = nodes.map(|node| h * velocity(node as usize));
            let fastest = [(0, 2), (0, 3), (1, 2), (1, 3)].map(|(i, k)| (ways[i] - ways[k]).length_squared());
            let moved = fastest.into_iter().fold(0.0, f64::max).sqrt();
            let margin = MARGIN * touching + (1.5 * moved).min(MOST_MARGIN * 0.5 * touching);
            let beside = |strand: &Strand| {
                strand.offsets(
                    strand.nodes.map(|node| at(node as usize)),
                    strand.nodes.map(|node| normals[node as usize]),
                )
            };
            let [[a0, a1], [b0, b1]] = [beside(a), beside(b)];
            let offsets = [a0, a1, b0, b1];
            let ends: [[f64; 3]; 4] = std::array::from_fn(|k| (at(nodes[k] as usize) + offsets[k]).to_array());
            // Boxes that are further apart than they look for each other need no closer look.
            let apart = (0..3).any(|k| {
                let [low, high] = [ends[0][k].min(ends[1][k]), ends[0][k].max(ends[1][k])];
                let reach = BEGINS * touching + margin;
                low > ends[2][k].max(ends[3][k]) + reach || high < ends[2][k].min(ends[3][k]) - reach
            });
            if apart || closest(&ends).distance > BEGINS * touching + margin {
                return None;
            }
            let layout = [a.layout[0], a.layout[1], b.layout[0], b.layout[1]].map(|x| x.to_array());
            let layout = closest(&layout).distance;
            let distance = holds_off_below(touching, layout)?;
            let distance = distance.max(grown * GROWS_TO * touching);
            Some(NearStrands { nodes, offsets: offsets.map(|x| x.to_array()), distance })
        };
        self.parts.resize_with(self.pairs.len().div_ceil(PART), Vec::new);
        self.parts.par_iter_mut().zip(self.pairs.par_chunks(PART)).for_each(|(part, pairs)| {
            part.clear();
            part.extend(pairs.iter().filter_map(near));
        });
        self.found.clear();
        self.found.extend(self.parts.iter().flatten());
        &self.found
    }

    /// Pairs of strands that may be near enough to meet within a step, in order of the first, then of the second.
    fn find_pairs(&mut self, at: &(impl Fn(usize) -> DVec3 + Sync)) {
        let (mut longest, mut thickest): (f64, f64) = (0.0, 0.0);
        self.pieces.clear();
        self.places.clear();
        for (index, strand) in self.strands.iter().enumerate() {
            let [a, b] = strand.nodes.map(|node| at(node as usize));
            let length = a.distance(b);
            let count = (length / self.long).ceil().clamp(1.0, MOST_PIECES);
            longest = longest.max(length / count);
            thickest = thickest.max(strand.radius);
            for piece in 0..count as u32 {
                self.pieces.push(index as u32);
                self.places.push(a.lerp(b, (f64::from(piece) + 0.5) / count));
            }
        }
        let reach = longest + (2.0 * BEGINS + 2.0 + MOST_MARGIN) * thickest;
        let near = self.nearby.find(|piece| self.places[piece], &self.places, reach, 0.0);
        self.pairs.clear();
        self.pairs.extend(near.iter().map(|pair| pair.map(|piece| self.pieces[piece as usize])));
        if self.pieces.len() > self.strands.len() {
            self.pairs.retain(|[a, b]| a != b);
            self.pairs.sort_unstable();
            self.pairs.dedup();
        }
    }

    /// Normals of all nodes to the front of the fabric, as pictures of yarns have them.
    fn find_normals(&mut self, at: &impl Fn(usize) -> DVec3) {
        let around = |node: usize| {
            let range = self.around_start[node] as usize..self.around_start[node + 1] as usize;
            self.around[range].iter()
        };
        self.fits.clear();
        self.fits.extend((0..self.around_start.len() - 1).map(|node| {
            let (mut first, mut second) = (DVec3::ZERO, DVec3::ZERO);
            for &(other, rest) in around(node) {
                let now = (at(other as usize) - at(node)).normalize_or_zero();
                first += now * rest[0];
                second += now * rest[1];
            }
            let area = first.cross(second);
            let flatness = 2.0 * area.length() / (first.length_squared() + second.length_squared()).max(1e-300);
            (area.normalize_or_zero(), (flatness / TRUSTED).min(1.0))
        }));
        self.normals.clear();
        self.normals.extend((0..self.fits.len()).map(|node| {
            let (normal, trust) = self.fits[node];
            if trust >= 1.0 {
                return normal;
            }
            let sum = around(node).map(|&(other, _)| self.fits[other as usize].0 * self.fits[other as usize].1);
            (normal * trust + sum.sum::<DVec3>().normalize_or_zero() * (1.0 - trust)).normalize_or_zero()
        }));
    }
}

/// On which side of the axis of a stitch contact the segment after each pass lies, seen from the front along its way: 1 to the
/// left, −1 to the right, and zero outside contacts. A yarn that changes from the front of another to its back goes around it.
fn clasps(network: &Network) -> Vec<f64> {
    let mut sides = vec![0.0; network.pass_count()];
    for stitch in &network.stitches {
        let depth = |end: usize, pass: PassId| network.live_stack(stitch.nodes[end]).position(|p| p == pass);
        let depths: Vec<_> = stitch.passes.iter().map(|[a, b]| [depth(0, *a), depth(1, *b)]).collect();
        for ([a, b], own) in stitch.passes.iter().zip(&depths) {
            let turns = depths.iter().map(|other| match (own[0].cmp(&other[0]), own[1].cmp(&other[1])) {
                (Ordering::Less, Ordering::Greater) => 1.0,
                (Ordering::Greater, Ordering::Less) => -1.0,
                _ => 0.0,
            });
            let turns: f64 = turns.sum();
            if turns != 0.0 {
                // Along the axis from the first node to the second, left is what the drawn yarn is led to.
                let along = if a.0 < b.0 { 1.0 } else { -1.0 };
                sides[a.0.min(b.0) as usize] = along * turns.signum() * stitch.wrap_sign;
            }
        }
    }
    sides
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{LoopProportions, YarnCard};
    use crate::pattern::{Chart, Stitch, Working, knit};

    #[test]
    fn a_long_float_is_looked_for_in_pieces_and_finds_the_same() {
        let float = [vec![Stitch::Knit], vec![Stitch::Slip { in_front: false }; 38], vec![Stitch::Knit]].concat();
        let rows = (0..12).map(|row| if row == 5 { float.clone() } else { vec![Stitch::Knit; 40] });
        let (chart, yarn) = (Chart::new(rows.collect()).unwrap(), YarnCard::unit());
        let network = knit::fabric(&chart, Working::default(), &LoopProportions::default().card(&yarn, 1.0));
        let mut pieces = Strands::new(&network, &Yarns::from(&yarn));
        let mut whole = Strands { long: f64::INFINITY, ..pieces.clone() };
        let found = |strands: &mut Strands| {
            let found = strands.find(|node| network.position[node], |_| DVec3::ZERO, 1e-3, 1.0).to_vec();
            (found, strands.pairs.len())
        };
        let ((a, few), (b, many)) = (found(&mut pieces), found(&mut whole));
        assert!(!a.is_empty() && a == b, "{} {}", a.len(), b.len());
        assert!(4 * few < many, "{few} {many}");
    }
}
