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
mod tests {
    use super::*;

    /// A yarn with tensions `T₁`, `T₂` turned by `angle` over a node held by another.
    fn turned(tensions: [f64; 2], angle: f64) -> f64 {
        let half = 0.5 * angle;
        let side = |tension: f64, sign: f64| {
            // stretch stiffness 1: length over rest is 1 + T
            ([sign * half.cos() * (1.0 + tension), -half.sin() * (1.0 + tension), 0.0], sign)
        };
        let (before, after) = (side(tensions[0], -1.0), side(tensions[1], 1.0));
        let mut q = vec![0.0; 25];
        for (block, (x, u)) in [(1, before), (2, after)] {
            q[5 * block..5 * block + 3].copy_from_slice(&x);
            q[5 * block + 3] = u;
        }
        let yarn = Neighbours { block: [1, 0, 2], slot: [8, 3, 13], ..Neighbours::default() };
        // The other yarn pulls the node back with the opposite of the first one's resultant, as in equilibrium.
        let strands = vec![Strand { stiffness: [1.0; 2], crimp_height: 0.0 }];
        let mut compression = Compression { strands, ..Compression::default() };
        let own = yarn.pull(&q, &compression);
        let f = across_both(own.force, own.along, [0.0; 3]);
        let mut out = Vec::new();
        let pull = (f[0] * f[0] + f[1] * f[1]).sqrt();
        // Two ends, the half of it each, out of the plane by a hair so that the holder has a direction.
        for (block, z) in [(3, 1e-6), (4, -1e-6)] {
            q[5 * block] = -f[0] * (1.0 + 0.5 * pull) / pull;
            q[5 * block + 1] = -f[1] * (1.0 + 0.5 * pull) / pull;
            q[5 * block + 2] = z;
        }
        (q[18], q[23]) = (-1.0, 1.0);
        let holder = Neighbours { block: [3, 0, 4], slot: [18, 4, 23], ..Neighbours::default() };
        compression.contacts = vec![Contact { yarns: [yarn, holder], side: None }];
        compression.evaluate(&q, &mut out);
        out[0]
    }

    #[test]
    fn a_yarn_beside_its_node_pulls_from_where_it_lies() {
        // A straight yarn from −1 over 0 to 1, in front of its node by a half: from the triangle's z-axis both sides pull it back.
        let mut q = vec![0.0; 30];
        for (block, [x, y]) in [(1, [-1.0, 0.0]), (2, [1.0, 0.0]), (3, [1.0, 0.0]), (4, [0.0, 1.0]), (5, [-1.0, -1.0])]
        {
            (q[5 * block], q[5 * block + 1]) = (x, y);
        }
        (q[8], q[13]) = (-1.0, 1.0);
        let yarn = Neighbours { block: [1, 0, 2], slot: [8, 3, 13], offset: [0.0, 0.5, 0.0], ..Neighbours::default() };
        let around = vec![Some([3, 4, 5]), None, None, None, None, None];
        let compression = Compression {
            strands: vec![Strand { stiffness: [2.0; 2], crimp_height: 0.0 }],
            normals: Some(Normals { around, softness: 0.0 }),
            ..Compression::default()
        };
        let length = 1.25f64.sqrt();
        let force = yarn.pull(&q, &compression).force;
        assert!(force[0].abs() < 1e-15 && force[1].abs() < 1e-15);
        assert!((force[2] + 2.0 * 2.0 * (length - 1.0) * 0.5 / length).abs() < 1e-15, "{force:?}");
    }

    #[test]
    fn crimp_presses_a_flat_weave() {
        // A flat crossing: segments of 2 m that were 1.9 m long, both to the other side, of both yarns.
        let mut q = vec![0.0; 25];
        let ends = [[2.0, 0.0], [-2.0, 0.0], [0.0, 2.0], [0.0, -2.0]];
        for (k, [x, y]) in ends.into_iter().enumerate() {
            (q[5 * k + 5], q[5 * k + 6], q[5 * k + 8]) = (x, y, if k % 2 == 0 { 1.9 } else { -1.9 });
        }
        let strands =
            vec![Strand { stiffness: [3.0; 2], crimp_height: 0.2 }, Strand { stiffness: [5.0; 2], crimp_height: 0.3 }];
        let yarn = |strand: u16, block: [u32; 3], own: u32| Neighbours {
            block,
            slot: [5 * block[0] + 3, own, 5 * block[2] + 3],
            chain: [false; 2],
            interlaces: [true; 2],
            offset: [0.0; 3],
            strand,
        };
        let yarns = [yarn(0, [2, 0, 1], 3), yarn(1, [4, 0, 3], 4)];
        let contacts = vec![Contact { yarns, side: Some(1.0) }];
        let compression = Compression { strands, contacts, ..Compression::default() };
        let mut out = Vec::new();
        compression.evaluate(&q, &mut out);
        let strain = 2.0 / 1.9 - 1.0;
        let expected = 0.5 * strain * (2.0 * 3.0 * 0.2 / 2.0 + 2.0 * 5.0 * 0.3 / 2.0);
        assert!((out[0] / expected - 1.0).abs() < 1e-12, "{} {expected}", out[0]);
        // Bent over the yarn behind it, the front yarn presses more; bent away from it, less.
        (q[7], q[12]) = (-0.1, -0.1);
        compression.evaluate(&q, &mut out);
        assert!(out[0] > 1.05 * expected);
        (q[7], q[12]) = (0.1, 0.1);
        compression.evaluate(&q, &mut out);
        assert!(out[0] < 0.95 * expected);
    }

    #[test]
    fn capstan() {
        // Slipping over n nodes in all of π: at each T₂ − T₁ = μλ(T₁, T₂), solved by bisection.
        let mu = 0.3;
        for (n, expected) in [(8, 2.5536), (16, 2.56315), (64, 2.56613)] {
            let angle = std::f64::consts::PI / f64::from(n);
            let mut tension = 1e-3;
            for _ in 0..n {
                let (mut low, mut high) = (tension, 2.0 * tension);
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if middle - tension < mu * turned([tension, middle], angle) {
                        low = middle;
                    } else {
                        high = middle;
                    }
                }
                tension = low;
            }
            let ratio: f64 = tension / 1e-3;
            assert!((ratio / expected - 1.0).abs() < 1e-3, "{n}: {ratio} {expected}");
        }
    }
}
