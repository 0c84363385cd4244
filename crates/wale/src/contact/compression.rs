//! How hard the two yarns of a contact node press on each other.

use rayon::prelude::*;
use wale_numerics::jet::vector3::{add, dot, scale, sub};

use crate::fabric::Coordinates;
use crate::fabric::coordinates::BLOCK;
use crate::model::{Network, NodeId, PassId, SegmentKind};

/// Compression of two-yarn contact nodes from the tension of their yarns.
///
/// `λ = ½ |P (F₁ − F₂)|`, `F_i` the net pull of yarn `i` on the node, `P` the projection across the directions of both
/// yarns there: what one pulls along itself, the other holds by friction.
///
/// Differs from the paper: [Cirio2017, section 4.3] projects the forces on a fitted normal after offsetting the yarns
/// by their radii. For two clasped yarns the resultant needs no normal, has no sign to choose, and gives the capstan
/// law (tests `capstan`, `a_belt_pulled_over_pegs_has_the_capstan_ratio`).
#[derive(Clone, Debug, Default)]
pub struct Compression {
    /// The two passes of each two-pass node.
    contacts: Vec<[Neighbours; 2]>,
    /// The contact of each pass, if it has one.
    contact_of: Vec<Option<u32>>,
}

/// Blocks and slots of a pass and of the passes before and after it; a missing one is the pass itself.
#[derive(Clone, Copy, Debug)]
struct Neighbours {
    block: [u32; 3],
    slot: [u32; 3],
    /// Whether the segment before and the one after is a chain of loops drawn as one strand.
    chain: [bool; 2],
}

impl Compression {
    /// Finds the two-yarn contacts of a network.
    #[must_use]
    pub fn new(network: &Network, coordinates: &Coordinates) -> Self {
        let yarn_of = network.pass_yarn();
        let of = |pass: PassId| {
            let ends = [-1, 0, 1].map(|step| {
                network.neighbour(yarn_of[pass.index()], pass, step).map_or(pass, |neighbour| neighbour.pass)
            });
            let chain = [ends[0], pass].map(|p| network.segment_kind[p.index()] == SegmentKind::Chain);
            Neighbours {
                chain,
                block: ends.map(|p| network.pass_node[p.index()].0),
                slot: ends.map(|p| coordinates.slot(p) as u32),
            }
        };
        let mut compression = Self { contacts: Vec::new(), contact_of: vec![None; network.pass_count()] };
        for node in 0..network.node_count() {
            if let [a, b] = *network.stack(NodeId::new(node)) {
                let index = compression.contacts.len() as u32;
                compression.contacts.push([of(a), of(b)]);
                compression.contact_of[a.index()] = Some(index);
                compression.contact_of[b.index()] = Some(index);
            }
        }
        compression
    }

    /// The contact that a pass takes part in.
    #[must_use]
    pub fn contact_of(&self, pass: PassId) -> Option<usize> {
        self.contact_of[pass.index()].map(|index| index as usize)
    }

    /// Number of contacts.
    #[must_use]
    pub fn len(&self) -> usize {
        self.contacts.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.contacts.is_empty()
    }

    /// Compressions `λ` \[N\], one per contact, of a fabric at `q` whose yarn, and whose cast-on and bind-off, have these
    /// stretch stiffnesses \[N\].
    pub fn evaluate(&self, q: &[f64], stiffness: [f64; 2], out: &mut Vec<f64>) {
        out.resize(self.contacts.len(), 0.0);
        out.par_iter_mut().with_min_len(2048).zip(&self.contacts).for_each(|(lambda, [a, b])| {
            let ((fa, ta), (fb, tb)) = (a.pull(q, stiffness), b.pull(q, stiffness));
            let across = across_both(sub(fa, fb), ta, tb);
            *lambda = 0.5 * dot(across, across).sqrt();
        });
    }
}

impl Neighbours {
    /// Net pull of the yarn on the node \[N\], and its direction there: zero if it is folded back on itself.
    fn pull(&self, q: &[f64], stiffness: [f64; 2]) -> ([f64; 3], [f64; 3]) {
        let mut force = [0.0; 3];
        let mut along = [0.0; 3];
        let here = self.block[1] as usize * BLOCK;
        for end in [0, 2] {
            let there = self.block[end] as usize * BLOCK;
            let rest = (q[self.slot[end] as usize] - q[self.slot[1] as usize]).abs();
            let d: [f64; 3] = std::array::from_fn(|k| q[there + k] - q[here + k]);
            let length = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
            if length > 0.0 && rest > 0.0 {
                let tension = stiffness[usize::from(self.chain[end / 2])] * (length / rest - 1.0);
                let sign = if end == 0 { -1.0 } else { 1.0 };
                for k in 0..3 {
                    force[k] += tension / length * d[k];
                    along[k] += sign / length * d[k];
                }
            }
        }
        let square = dot(along, along);
        (force, if square > 1e-12 { scale(along, 1.0 / square.sqrt()) } else { [0.0; 3] })
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
        let yarn = Neighbours { block: [1, 0, 2], slot: [8, 3, 13], chain: [false; 2] };
        // The other yarn pulls the node back with the opposite of the first one's resultant, as in equilibrium.
        let (force, along) = yarn.pull(&q, [1.0; 2]);
        let f = across_both(force, along, [0.0; 3]);
        let mut out = Vec::new();
        let pull = (f[0] * f[0] + f[1] * f[1]).sqrt();
        // Two ends, the half of it each, out of the plane by a hair so that the holder has a direction.
        for (block, z) in [(3, 1e-6), (4, -1e-6)] {
            q[5 * block] = -f[0] * (1.0 + 0.5 * pull) / pull;
            q[5 * block + 1] = -f[1] * (1.0 + 0.5 * pull) / pull;
            q[5 * block + 2] = z;
        }
        (q[18], q[23]) = (-1.0, 1.0);
        let holder = Neighbours { block: [3, 0, 4], slot: [18, 4, 23], chain: [false; 2] };
        Compression { contacts: vec![[yarn, holder]], contact_of: Vec::new() }.evaluate(&q, [1.0; 2], &mut out);
        out[0]
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
