//! How hard the yarns of a contact node press on each other.

use glam::DVec3;
use rayon::prelude::*;
use wale_numerics::jet::vector3::{add, cross, dot, scale, sub};

use super::least_squares::{MOST_YARNS, stack_compressions};
use crate::energy::thick::normal;
use crate::fabric::Coordinates;
use crate::fabric::coordinates::BLOCK;
use crate::fabric::mechanics::chain_stiffness;
use crate::fabric::sides::Sides;
use crate::model::{FabricCard, Network, NodeId, PassId, SegmentKind, YarnCard, YarnRole, Yarns};

/// Compression of contact nodes from the tension of their yarns.
///
/// Two yarns: `λ = ½ |P (F₁ − F₂)|`, `F_i` the net pull of yarn `i` on the node, `P` the projection across the directions
/// of both yarns there: what one pulls along itself, the other holds by friction.
///
/// A stack, of the loop that was worked and the `n − 1` it was worked into: each yarn `i`, counted from that loop, is
/// pulled by `f_i = d·F_i` along `d = P (F₁ − Σ F_j)`, and the compressions of neighbours are the non-negative ones that
/// leave least of it: `min Σ (f_i − λ_i + λ_{i−1})²`, `λ ≥ 0`     [Cirio2017, Eq. 3]
///
/// Differs from the paper: [Cirio2017, section 4.3] projects the forces on a fitted normal after offsetting the yarns
/// by their radii. For clasped yarns the resultant needs no normal, has no sign to choose, and gives the capstan
/// law (tests `capstan`, `a_belt_pulled_over_pegs_has_the_capstan_ratio`). Its Eq. 4, which sets negative compressions to
/// zero one by one, is not the least-squares answer (test `least_squares::tests::stacks_press_by_least_squares`).
///
/// The yarns of a weave are straight in the model and crimped in the fabric: a segment of length `l` and tension `T`
/// between crossings on different sides goes through the fabric by the crimp height `h`, so that it presses its yarn on the
/// other with `T h/l` besides (test `crimp_presses_a_flat_weave`).
#[derive(Clone, Debug, Default)]
pub struct Compression {
    /// The yarns by what they are made of and how they run.
    strands: Vec<Strand>,
    /// The nodes of two passes.
    contacts: Vec<Contact>,
    /// Nodes of more yarns.
    stacks: Vec<Stack>,
    /// Number of contacts between neighbours of the stacks.
    stacked: usize,
    /// The contact of each pass that slides against yarns that cross it.
    contact_of: Vec<Option<u32>>,
    /// Contacts of parallel yarns: contact, the pass nearer to the loop that was worked, and the one beyond it.
    parallel: Vec<(usize, [PassId; 2])>,
    /// Where yarns with a thickness lie; none for yarns that meet in one point.
    normals: Option<Normals>,
}

/// The nodes around each node of a stitch contact, whose triangle has the contact's normal.
#[derive(Clone, Debug)]
struct Normals {
    around: Vec<Option<[u32; 3]>>,
    softness: f64,
}

impl Normals {
    fn of(&self, q: &[f64], node: usize) -> [f64; 3] {
        let Some(corners) = self.around[node] else { return [0.0; 3] };
        let [a, b, c] = corners.map(|node| point(q, node as usize));
        normal(a, b, c, self.softness)
    }
}

fn point(q: &[f64], node: usize) -> [f64; 3] {
    std::array::from_fn(|k| q[node * BLOCK + k])
}

/// What a yarn pulls with.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Strand {
    /// Its stretch stiffness, and that of a cast-on or bind-off of it \[N\].
    stiffness: [f64; 2],
    /// Crimp height where it interlaces \[m\].
    crimp_height: f64,
}

/// The passes of a node of two yarns.
#[derive(Clone, Copy, Debug)]
struct Contact {
    yarns: [Neighbours; 2],
    /// Of crossings in a weave: the sign with which the cross product of the yarns' directions points from the second to
    /// the first.
    side: Option<f64>,
}

/// The passes of a node of more than two yarns.
#[derive(Clone, Copy, Debug)]
struct Stack {
    /// The loop that was worked, then those it was worked into, from that side; as many as there are.
    yarns: [Neighbours; MOST_YARNS],
    count: usize,
}

/// Blocks and slots of a pass and of the passes before and after it; a missing one is the pass itself.
#[derive(Clone, Copy, Debug, Default)]
struct Neighbours {
    block: [u32; 3],
    slot: [u32; 3],
    /// Whether the segment before and the one after is a chain of loops drawn as one strand.
    chain: [bool; 2],
    /// Whether they go to the other side of the fabric.
    interlaces: [bool; 2],
    strand: u16,
    /// How far in front of their nodes the passes lie \[m\].
    offset: [f64; 3],
}

impl Compression {
    /// Finds the contacts of a network.
    #[must_use]
    pub fn new(network: &Network, yarns: &Yarns, card: &FabricCard, coordinates: &Coordinates) -> Self {
        let yarn_of = network.pass_yarn();
        let mut strands = Vec::new();
        let strand_of: Vec<u16> = (0..network.yarn_count())
            .map(|yarn| {
                let strand = strand(yarns.of(network.yarn_kind[yarn]), network.yarn_role[yarn], card);
                let known = strands.iter().position(|known| *known == strand);
                known.unwrap_or_else(|| {
                    strands.push(strand);
                    strands.len() - 1
                }) as u16
            })
            .collect();
        let thickness = card.knit().and_then(|card| card.thickness);
        let sides = thickness.map(|thickness| Sides::new(network, thickness.contact_distance));
        let of = |pass: PassId| {
            let yarn = yarn_of[pass.index()];
            let ends =
                [-1, 0, 1].map(|step| network.neighbour(yarn, pass, step).map_or(pass, |neighbour| neighbour.pass));
            let are = |kind| [ends[0], pass].map(|p| network.segment_kind[p.index()] == kind);
            Neighbours {
                chain: are(SegmentKind::Chain),
                interlaces: are(SegmentKind::Interlacing),
                strand: strand_of[yarn.index()],
                offset: sides.as_ref().map_or([0.0; 3], |sides| ends.map(|pass| sides.offset(network, pass))),
                block: ends.map(|p| network.pass_node[p.index()].0),
                slot: ends.map(|p| coordinates.slot(p) as u32),
            }
        };
        let mut side: Vec<Option<f64>> = vec![None; network.node_count()];
        for crossing in &network.crossings {
            let node = crossing.node.index();
            let [front, back] = [0, 1].map(|k| of(network.stack(crossing.node)[k]).direction(&network.position));
            side[node] = Some(front.cross(back).dot(network.front[node]).signum());
        }
        let normals = sides.as_ref().map(|sides| Normals {
            around: (0..network.node_count()).map(|node| sides.around(node).map(|c| c.map(|n| n as u32))).collect(),
            softness: sides.softness(),
        });
        let mut compression =
            Self { strands, normals, contact_of: vec![None; network.pass_count()], ..Self::default() };
        let mut deeper = Vec::new();
        for node in 0..network.node_count() {
            let stack: Vec<PassId> = network.live_stack(NodeId::new(node)).collect();
            match *stack {
                [a, b] => {
                    let index = compression.contacts.len() as u32;
                    compression.contacts.push(Contact { yarns: [of(a), of(b)], side: side[node] });
                    compression.contact_of[a.index()] = Some(index);
                    compression.contact_of[b.index()] = Some(index);
                }
                [] | [_] => {}
                ref more => deeper.push(more.to_vec()),
            }
        }
        for mut stack in deeper {
            stack.truncate(MOST_YARNS);
            // The yarn that differs in kind from its neighbour is the loop that was worked; it lies at one end.
            let kind = |k: usize| network.pass_kind[stack[k].index()];
            if kind(0) == kind(1) {
                stack.reverse();
            }
            let first = compression.contacts.len() + compression.stacked;
            let yarns = std::array::from_fn(|k| of(stack[k.min(stack.len() - 1)]));
            compression.stacks.push(Stack { yarns, count: stack.len() });
            compression.contact_of[stack[0].index()] = Some(first as u32);
            compression.contact_of[stack[1].index()] = Some(first as u32);
            compression
                .parallel
                .extend(stack.windows(2).enumerate().skip(1).map(|(k, pair)| (first + k, [pair[0], pair[1]])));
            compression.stacked += stack.len() - 1;
        }
        compression
    }

    /// Contacts of parallel yarns in stacks: contact, the pass nearer to the loop that was worked, and the one beyond.
    #[must_use]
    pub fn parallel(&self) -> &[(usize, [PassId; 2])] {
        &self.parallel
    }

    /// The contact of a pass with the yarns that cross it.
    #[must_use]
    pub fn contact_of(&self, pass: PassId) -> Option<usize> {
        self.contact_of[pass.index()].map(|index| index as usize)
    }

    /// Number of contacts.
    #[must_use]
    pub fn len(&self) -> usize {
        self.contacts.len() + self.stacked
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Compressions `λ` \[N\], one per contact, of a fabric at `q`.
    pub fn evaluate(&self, q: &[f64], out: &mut Vec<f64>) {
        out.resize(self.len(), 0.0);
        let (pairs, mut stacked) = out.split_at_mut(self.contacts.len());
        for stack in &self.stacks {
            let (own, rest) = stacked.split_at_mut(stack.count - 1);
            stack.press(q, self, own);
            stacked = rest;
        }
        pairs.par_iter_mut().with_min_len(2048).zip(&self.contacts).for_each(|(lambda, contact)| {
            let [a, b] = contact.yarns.map(|yarn| yarn.pull(q, self));
            let mut across = across_both(sub(a.force, b.force), a.along, b.along);
            if let Some(side) = contact.side {
                let normal = cross(a.along, b.along);
                let length = dot(normal, normal).sqrt();
                if length > 0.0 {
                    across = sub(across, scale(normal, side / length * (a.crimp + b.crimp)));
                }
            }
            *lambda = 0.5 * dot(across, across).sqrt();
        });
    }
}

/// What a yarn pulls with.
fn strand(yarn: &YarnCard, role: YarnRole, card: &FabricCard) -> Strand {
    match card {
        FabricCard::Knit(card) => {
            Strand { stiffness: [yarn.stretch_stiffness, chain_stiffness(yarn, card)], crimp_height: 0.0 }
        }
        FabricCard::Woven(card) => Strand {
            stiffness: [yarn.stretch_stiffness; 2],
            crimp_height: card.crimp_height[usize::from(role == YarnRole::Weft)],
        },
    }
}

impl Stack {
    fn press(&self, q: &[f64], compression: &Compression, lambda: &mut [f64]) {
        let pulls = self.yarns.map(|yarn| yarn.pull(q, compression));
        let (child, parents) = (pulls[0], &pulls[1..self.count]);
        let parents_pull = parents.iter().fold([0.0; 3], |sum, pull| add(sum, pull.force));
        // The parents run side by side, one way or the other.
        let along = parents.iter().fold([0.0; 3], |sum: [f64; 3], pull| {
            if dot(sum, pull.along) < 0.0 { sub(sum, pull.along) } else { add(sum, pull.along) }
        });
        let length = dot(along, along).sqrt();
        let along = if length > 1e-6 { scale(along, 1.0 / length) } else { [0.0; 3] };
        let across = across_both(sub(child.force, parents_pull), child.along, along);
        let size = dot(across, across).sqrt();
        if size == 0.0 {
            return lambda.fill(0.0);
        }
        let pulled = pulls.map(|pull| dot(pull.force, across) / size);
        stack_compressions(&pulled[..self.count], lambda);
    }
}

/// How a yarn pulls on a node.
#[derive(Clone, Copy)]
struct Pull {
    /// Net pull \[N\].
    force: [f64; 3],
    /// Direction of the yarn there: zero if it is folded back on itself.
    along: [f64; 3],
    /// Pull through the fabric, which the straight model does not show \[N\].
    crimp: f64,
}

impl Neighbours {
    fn pull(&self, q: &[f64], compression: &Compression) -> Pull {
        let strand = &compression.strands[usize::from(self.strand)];
        let mut pull = Pull { force: [0.0; 3], along: [0.0; 3], crimp: 0.0 };
        let place = |k: usize| {
            let node = self.block[k] as usize;
            let x = point(q, node);
            match &compression.normals {
                Some(normals) if self.offset[k] != 0.0 => add(x, scale(normals.of(q, node), self.offset[k])),
                _ => x,
            }
        };
        let here = place(1);
        for end in [0, 2] {
            let rest = (q[self.slot[end] as usize] - q[self.slot[1] as usize]).abs();
            let d = sub(place(end), here);
            let length = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
            if length > 0.0 && rest > 0.0 {
                let tension = strand.stiffness[usize::from(self.chain[end / 2])] * (length / rest - 1.0);
                let sign = if end == 0 { -1.0 } else { 1.0 };
                for k in 0..3 {
                    pull.force[k] += tension / length * d[k];
                    pull.along[k] += sign / length * d[k];
                }
                if self.interlaces[end / 2] {
                    pull.crimp += tension.max(0.0) * strand.crimp_height / length;
                }
            }
        }
        let square = dot(pull.along, pull.along);
        pull.along = if square > 1e-12 { scale(pull.along, 1.0 / square.sqrt()) } else { [0.0; 3] };
        pull
    }

    /// From the pass before to the pass after.
    fn direction(&self, positions: &[DVec3]) -> DVec3 {
        positions[self.block[2] as usize] - positions[self.block[0] as usize]
    }
}

/// Below this square of the sine between two directions they count as one.
const PARALLEL: f64 = 1e-3;

/// What of a force lies across two unit directions (or none, where one is zero).
fn across_both(force: [f64; 3], a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    // Least squares of the force by both, held back a little so that nearly parallel ones do no harm.
    let (aa, bb, ab) = (dot(a, a) + PARALLEL, dot(b, b) + PARALLEL, dot(a, b));
    let (fa, fb) = (dot(force, a), dot(force, b));
    let determinant = aa * bb - ab * ab;
    let (x, y) = ((bb * fa - ab * fb) / determinant, (aa * fb - ab * fa) / determinant);
    sub(force, add(scale(a, x), scale(b, y)))
}

#[cfg(test)]
mod tests;
