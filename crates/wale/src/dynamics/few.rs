//! Few nodes, solved for themselves while the rest of the fabric holds still: loops that snap over need many iterations
//! where all others need one.

use wale_numerics::check::Local;
use wale_numerics::dense::SmallSystem;

use super::scatter::NOWHERE;
use super::selected::Selected;
use super::system::System;
use crate::fabric::coordinates::{BLOCK, Dof};

/// Most unknowns that are solved together.
const MOST_UNKNOWNS: usize = 400;
/// Most iterations.
const MOST_ITERATIONS: usize = 30;
/// Most halvings of a step that does not lower the energy.
const MOST_HALVINGS: usize = 20;
/// A node of which the cluster is not known yet.
const WAITING: u32 = NOWHERE - 1;

/// A system of few nodes as elements write it.
pub struct Few<'a> {
    place: &'a [u32],
    system: &'a mut SmallSystem,
}

impl Few<'_> {
    /// Adds what an element gives to the unknowns that it touches.
    pub fn add<const N: usize>(&mut self, stencil: &[Dof; N], local: &Local<N>) {
        let n = self.system.right_side.len();
        let slot = |i: usize| {
            let dof = stencil[i] as usize;
            let place = self.place[dof / BLOCK];
            (place < WAITING).then(|| BLOCK * place as usize + dof % BLOCK)
        };
        for j in 0..N {
            let Some(column) = slot(j) else { continue };
            self.system.right_side[column] -= local.gradient[j];
            for i in 0..N {
                if let Some(row) = slot(i) {
                    self.system.matrix[column * n + row] += local.hessian[j][i];
                }
            }
        }
    }
}

/// Memory of the solver of few nodes.
pub struct FewNodes {
    /// Place of each block among those that are solved together; [`NOWHERE`] of all others between calls.
    place: Vec<u32>,
    /// The blocks that may move, and those of them that are solved together.
    region: Vec<u32>,
    cluster: Vec<u32>,
    /// Elements that touch them.
    around: Selected,
    touching: Selected,
    system: SmallSystem,
    before: Vec<f64>,
}

impl FewNodes {
    /// Takes memory for a fabric.
    #[must_use]
    pub fn new(block_count: usize) -> Self {
        let blocks = MOST_UNKNOWNS / BLOCK;
        Self {
            place: vec![NOWHERE; block_count],
            region: Vec::with_capacity(4 * blocks),
            cluster: Vec::with_capacity(blocks),
            around: std::array::from_fn(|_| Vec::with_capacity(16 * blocks)),
            touching: std::array::from_fn(|_| Vec::with_capacity(16 * blocks)),
            system: SmallSystem::with_capacity(MOST_UNKNOWNS),
            before: Vec::with_capacity(MOST_UNKNOWNS),
        }
    }

    /// The elements that touch some blocks.
    pub fn touching(&mut self, system: &System, blocks: &[u32]) -> &Selected {
        self.region.clear();
        self.region.extend(blocks);
        self.region.iter().for_each(|&block| self.place[block as usize] = WAITING);
        system.touching(&self.region, &self.place, NOWHERE, &mut self.around);
        self.forget();
        &self.around
    }

    /// Moves `hot` blocks and those that meet them to the minimum of all terms near where they are, until they move less
    /// than `tolerance` \[m\]. The energy falls, whether or not all find their minimum. Returns whether any moved.
    pub fn minimise(&mut self, system: &System, free: &[bool], q: &mut [f64], hot: &[u32], tolerance: f64) -> bool {
        let mut moved = false;
        self.region.clear();
        for &block in hot {
            for &near in system.pattern().row(block as usize) {
                if self.place[near as usize] == NOWHERE {
                    self.place[near as usize] = WAITING;
                    self.region.push(near);
                }
            }
        }
        system.touching(&self.region, &self.place, NOWHERE, &mut self.around);
        for k in 0..self.region.len() {
            if self.place[self.region[k] as usize] == WAITING {
                self.gather(system, self.region[k]);
                if BLOCK * self.cluster.len() <= MOST_UNKNOWNS {
                    system.touching_among(&self.around, &self.place, WAITING, &mut self.touching);
                    moved |= self.descend(system, free, q, tolerance);
                }
                self.cluster.iter().for_each(|&block| self.place[block as usize] = NOWHERE);
            }
        }
        self.forget();
        moved
    }

    fn forget(&mut self) {
        self.region.iter().for_each(|&block| self.place[block as usize] = NOWHERE);
    }

    /// Collects the waiting blocks that hang together with one, and gives them their places.
    fn gather(&mut self, system: &System, first: u32) {
        self.cluster.clear();
        self.cluster.push(first);
        self.place[first as usize] = 0;
        let mut next = 0;
        while next < self.cluster.len() {
            for &near in system.pattern().row(self.cluster[next] as usize) {
                if self.place[near as usize] == WAITING {
                    self.place[near as usize] = self.cluster.len() as u32;
                    self.cluster.push(near);
                }
            }
            next += 1;
        }
    }

    /// Newton's method for the cluster; returns whether it moved.
    fn descend(&mut self, system: &System, free: &[bool], q: &mut [f64], tolerance: f64) -> bool {
        let mut energy = system.energy_of(&self.touching, q);
        let mut convexity = 0.0;
        for iteration in 0..MOST_ITERATIONS {
            let Some(slope) = self.direction(system, free, q, &mut convexity) else { return iteration > 0 };
            let mut length = system.longest_step_of(&self.touching[0], q, |dof| {
                let place = self.place[dof / BLOCK];
                if place < WAITING { self.system.right_side[BLOCK * place as usize + dof % BLOCK] } else { 0.0 }
            });
            self.before.clear();
            self.before.extend(self.cluster.iter().flat_map(|&block| &q[slots(block)]));
            let noise = 1e-13 * energy.abs() + 1e-30;
            let mut halvings = 0;
            loop {
                self.try_length(q, length);
                let new = system.energy_of(&self.touching, q);
                if new <= energy + 1e-4 * length * slope + noise {
                    energy = new;
                    break;
                }
                if halvings == MOST_HALVINGS {
                    self.try_length(q, 0.0);
                    return iteration > 0;
                }
                halvings += 1;
                length *= 0.5;
            }
            convexity = if halvings > 0 { more(convexity) } else { 0.25 * convexity };
            if length == 1.0 && self.system.right_side.as_chunks::<BLOCK>().0.iter().all(|d| norm(d) <= tolerance) {
                break;
            }
        }
        true
    }

    /// Newton's direction, in place of the right side, from the least convex matrix that is positive definite; returns
    /// the slope along it.
    fn direction(&mut self, system: &System, free: &[bool], q: &[f64], convexity: &mut f64) -> Option<f64> {
        loop {
            self.system.clear(BLOCK * self.cluster.len());
            system.linearise_few(
                &self.touching,
                q,
                *convexity,
                &mut Few { place: &self.place, system: &mut self.system },
            );
            self.fix(free);
            self.before.clear();
            self.before.extend(&self.system.right_side);
            if self.system.solve() {
                return Some(-self.before.iter().zip(&self.system.right_side).map(|(b, x)| b * x).sum::<f64>());
            }
            if *convexity >= 1.0 {
                return None;
            }
            *convexity = more(*convexity);
        }
    }

    /// Takes slots that are no unknowns out of the system.
    fn fix(&mut self, free: &[bool]) {
        let n = self.system.right_side.len();
        for (k, &block) in self.cluster.iter().enumerate() {
            for (slot, dof) in slots(block).enumerate() {
                if !free[dof] {
                    let fixed = BLOCK * k + slot;
                    self.system.right_side[fixed] = 0.0;
                    for other in 0..n {
                        self.system.matrix[fixed * n + other] = 0.0;
                        self.system.matrix[other * n + fixed] = 0.0;
                    }
                    self.system.matrix[fixed * n + fixed] = 1.0;
                }
            }
        }
    }

    fn try_length(&self, q: &mut [f64], length: f64) {
        let steps = self.before.chunks_exact(BLOCK).zip(self.system.right_side.chunks_exact(BLOCK));
        for (&block, (before, step)) in self.cluster.iter().zip(steps) {
            for ((q, x), d) in q[slots(block)].iter_mut().zip(before).zip(step) {
                *q = x + length * d;
            }
        }
    }
}

fn slots(block: u32) -> std::ops::Range<usize> {
    BLOCK * block as usize..BLOCK * (block as usize + 1)
}

/// Length of a block's position.
fn norm(d: &[f64; BLOCK]) -> f64 {
    (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt()
}

fn more(convexity: f64) -> f64 {
    (4.0 * convexity).clamp(0.1, 1.0)
}

#[cfg(test)]
mod tests {
    use wale_numerics::block_matrix::BlockMatrix;

    use super::super::selected::Selected;
    use super::super::system::TERMS;
    use super::super::workspace::Workspace;
    use super::*;
    use crate::energy::element::testing::Random;
    use crate::model::{LoopProportions, YarnCard};
    use crate::pattern::{Chart, Working, knit};

    /// A garter swatch of 10 × 10 loops somewhat off its layout, on an elastic bed.
    fn swatch() -> (System, Vec<f64>) {
        let yarn = YarnCard {
            linear_density: 3e-4,
            radius: 5e-4,
            stretch_stiffness: 1.0,
            bending_stiffness: 8e-10,
            friction_coefficient: 0.3,
            mass_damping: 0.0,
            stiffness_damping: 0.0,
            loose_ends: false,
            plies: 2,
            twist: 0.0,
        };
        let card = LoopProportions::default().card(&yarn, 9.5e-3);
        let network = knit::fabric(&Chart::garter().repeat(10, 10).unwrap(), Working::default(), &card);
        let mut system = System::new(&network, &yarn, &card);
        system.set_bed(1e-3, 0.0);
        let mut q = system.coordinates.initial(&network);
        let mut random = Random::new(3);
        for (q, free) in q.iter_mut().zip(system.coordinates.free()) {
            *q += if *free { 2e-5 * random.next() } else { 0.0 };
        }
        (system, q)
    }

    #[test]
    fn few_nodes_find_their_minimum_and_no_other_moves() {
        let (system, start) = swatch();
        let free = system.coordinates.free().to_vec();
        let rows = system.pattern().rows() as u32;
        let hot = [rows / 2, rows / 4];
        let (mut q, mut work, mut gradient) = (start.clone(), Workspace::default(), vec![0.0; start.len()]);
        for &node in &hot {
            q[BLOCK * node as usize + 2] += 2e-3;
        }
        let before = system.gradient(&q, &mut gradient, &mut work);
        let far = q.clone();
        let mut few = FewNodes::new(system.pattern().rows());
        assert!(few.minimise(&system, &free, &mut q, &hot, 1e-9));
        assert!(few.place.iter().all(|&place| place == NOWHERE), "nothing is left marked");
        let pushed: f64 = gradient.iter().map(|g| g.abs()).fold(0.0, f64::max);
        assert!(system.gradient(&q, &mut gradient, &mut work) < before);
        let mut near = vec![false; system.pattern().rows()];
        for &node in &hot {
            system.pattern().row(node as usize).iter().for_each(|&block| near[block as usize] = true);
        }
        for (block, near) in near.iter().enumerate() {
            for slot in BLOCK * block..BLOCK * (block + 1) {
                if *near && free[slot] {
                    assert!(gradient[slot].abs() < 1e-4 * pushed, "slot {slot}: {:e} of {pushed:e}", gradient[slot]);
                } else {
                    assert_eq!(q[slot], far[slot]);
                }
            }
        }
        for &node in &hot {
            let z = BLOCK * node as usize + 2;
            assert!((q[z] - far[z]).abs() > 1e-3, "it came back by {:e}", q[z] - far[z]);
        }
    }

    #[test]
    fn stiffening_all_elements_gives_the_convex_matrix() {
        let (system, q) = swatch();
        let mut gradient = vec![0.0; q.len()];
        let mut matrix = |convexity: f64| {
            let mut matrix: BlockMatrix<f64> = BlockMatrix::zeros(system.pattern().clone());
            system.linearise(&q, convexity, &mut gradient, &mut matrix, &mut Workspace::default());
            matrix
        };
        let (mut blended, convex) = (matrix(0.1), matrix(1.0));
        let off =
            |a: &BlockMatrix<f64>| a.values.iter().zip(&convex.values).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let largest = convex.values.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        assert!(off(&blended) > 1e-6 * largest, "the two differ to begin with");
        let mut few = FewNodes::new(system.pattern().rows());
        let all: Vec<u32> = (0..system.pattern().rows() as u32).collect();
        let selected: &Selected = few.touching(&system, &all);
        assert_eq!(selected.len(), TERMS);
        system.stiffen(selected, &q, 0.1, &mut blended);
        assert!(off(&blended) < 1e-12 * largest, "{:e}", off(&blended) / largest);
    }
}
