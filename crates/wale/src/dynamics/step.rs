//! What is frozen for a step before it is solved, and what friction remembers after it.

use glam::DVec3;
use rayon::prelude::*;

use super::linear::Coupling;
use super::state::State;
use super::system::System;
use crate::contact::surface::{obstacle_distance, to_rest_frame};
use crate::energy::{Inertia, ObstacleContact, ParallelSpring, Rate, SelfContact};
use crate::fabric::coordinates::{BLOCK, dof};
use crate::model::{Obstacle, PassId};

/// Where a node touches an obstacle during a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Node.
    pub node: u32,
    /// Obstacle.
    pub obstacle: u32,
    /// Whether friction held the node when the step began.
    pub held: bool,
}

/// Longest distance from a surface, in yarn radii, at which a node is watched for contact besides its own motion.
const WATCH: f64 = 2.0;
/// Depth at which an obstacle carries a thousand times the weight of the node's yarn under gravity, in yarn radii.
const PENALTY_DEPTH: f64 = 1.0;
/// Distance of two layers of fabric that lie on each other, in yarn radii: each is two yarns thick where they cross, and
/// crossings come to lie in the gaps of the other layer.
const LAYERS: f64 = 3.0;
/// Nodes nearer than so many loops in the layout hold their distance by being knitted together.
const KNITTED_TOGETHER: f64 = 2.5;
/// Slip over which friction with an obstacle builds up, in yarn radii.
const SLIP: f64 = 0.02;

impl System {
    /// Freezes mass, damping and friction at the state that a step of length `h` starts from.
    pub(crate) fn begin_step(&mut self, state: &State, h: f64, friction: bool, compression: &mut Vec<f64>) {
        let (q, v) = (&state.coordinates, &state.velocities);
        let alpha = self.yarns.first().mass_damping;
        let factor = 1.0 / (h * h) + alpha / h;
        // Inertia pulls towards q + h v, mass damping towards q.
        let reach = h / (1.0 + alpha * h);
        self.segments.update(q, |stencil, (_, inertia), local| {
            let rest = local[7] - local[3];
            *inertia = Inertia {
                density: inertia.density,
                factor: factor * inertia.density * rest / 6.0,
                direction: std::array::from_fn(|k| (local[4 + k] - local[k]) / rest),
                target: std::array::from_fn(|i| local[i] + reach * v[stencil[i] as usize]),
            };
        });
        let beta_over_h = self.stiffness_damping / h;
        let halfway = |stencil: &[u32; 12], local: &[f64; 12]| -> [f64; 12] {
            std::array::from_fn(|i| local[i] + 0.5 * h * v[stencil[i] as usize])
        };
        self.bends.update(q, |stencil, (bending, rate), local| {
            *rate = Rate::of_bend(local, &halfway(stencil, local), bending.stiffness, beta_over_h);
        });
        self.thick_bends.update(q, |stencil, thick, local| {
            let moved: [f64; 39] = std::array::from_fn(|i| local[i] + 0.5 * h * v[stencil[i] as usize]);
            let (start, halfway) = (thick.points(local), thick.points(&moved));
            thick.inner.1 = Rate::of_bend(&start, &halfway, thick.inner.0.stiffness, beta_over_h);
        });
        self.wraps.update(q, |stencil, (wrapping, rate), local| {
            *rate = Rate::of_wrap(local, &halfway(stencil, local), wrapping, beta_over_h);
        });
        self.compression.evaluate(q, compression);
        let least = self.card.residual_compression();
        let rubbing = &self.rubbing;
        let lambda = &*compression;
        self.friction.set.elements.par_iter_mut().zip(rubbing).with_min_len(4096).for_each(
            |(element, &(pass, contact, mu))| {
                element.anchor = state.anchors[pass.index()];
                // Without friction the spring is there but carries nothing.
                element.limit = if friction { mu * lambda[contact].max(least) } else { 0.0 };
            },
        );
        let parallel = self.parallel.set.elements.iter_mut().zip(&self.parallel_friction);
        for ((ParallelSpring(spring), mu), (contact, pair)) in parallel.zip(self.compression.parallel()) {
            spring.anchor = state.anchors[pair[1].index()];
            spring.limit = if friction { mu * lambda[*contact].max(least) } else { 0.0 };
        }
    }

    /// Friction anchors of a fabric at `q` that nothing has pulled at: where every pass is, and of parallel yarns how far
    /// one is from the other.
    pub(crate) fn anchors_at(&self, q: &[f64]) -> Vec<f64> {
        let passes = 0..self.coordinates.pass_count();
        let mut anchors: Vec<f64> = passes.map(|p| q[self.coordinates.slot(PassId::new(p))]).collect();
        for (_, [near, far]) in self.compression.parallel() {
            anchors[far.index()] = q[self.coordinates.slot(*far)] - q[self.coordinates.slot(*near)];
        }
        anchors
    }

    /// Moves the friction anchors of the passes to where the step left them.
    pub(crate) fn drag_anchors(&self, q: &[f64], anchors: &mut [f64]) {
        for ((element, stencil), (pass, ..)) in
            self.friction.set.elements.iter().zip(&self.friction.set.stencils).zip(&self.rubbing)
        {
            anchors[pass.index()] = element.dragged_anchor(q[stencil[0] as usize]);
        }
        let parallel = self.parallel.set.elements.iter().zip(&self.parallel.set.stencils);
        for ((ParallelSpring(spring), stencil), (_, pair)) in parallel.zip(self.compression.parallel()) {
            let [near, far] = stencil.map(|slot| q[slot as usize]);
            anchors[pair[1].index()] = spring.dragged_anchor(far - near);
        }
    }

    /// Finds the nodes that may touch an obstacle during a step that starts at `time`.
    pub(crate) fn find_touches(&mut self, obstacles: &[Obstacle], state: &State, h: f64, touches: &mut Vec<Touch>) {
        touches.clear();
        self.obstacles.set.elements.clear();
        self.obstacles.set.stencils.clear();
        for node in 0..self.coordinates.node_count() {
            let x = self.coordinates.position_of(node, &state.coordinates);
            let speed = DVec3::from_slice(&state.velocities[BLOCK * node..BLOCK * node + 3]).length();
            let radius = self.radius_at_node[node];
            for (index, obstacle) in obstacles.iter().enumerate() {
                let reach = (1.0 + WATCH) * radius + 2.0 * h * speed;
                let near = |time: f64| obstacle_distance(obstacle, x, time).0 < reach;
                if near(state.time) || near(state.time + h) {
                    let held = held_place(&state.obstacle_anchors, node, index).is_some();
                    touches.push(Touch { node: node as u32, obstacle: index as u32, held });
                    let blank = ObstacleContact {
                        stiffness: 0.0,
                        point: [0.0; 3],
                        normal: [0.0, 0.0, 1.0],
                        anchor: [0.0; 3],
                        anchor_stiffness: 1.0,
                        limit: 0.0,
                    };
                    let first = dof(BLOCK * node);
                    self.obstacles.set.push(blank, [first, first + 1, first + 2]);
                }
            }
        }
        if !touches.is_empty() || self.obstacles.set.is_empty() {
            self.obstacles.plan(&self.chunks);
            self.obstacles.locate(&self.pattern);
        }
        for (k, touch) in touches.iter().enumerate() {
            let obstacle = &obstacles[touch.obstacle as usize];
            let node = touch.node as usize;
            let x = self.coordinates.position_of(node, &state.coordinates);
            let (mass, radius) = (self.mass_at_node[node], self.radius_at_node[node]);
            // Strong enough for a thousand weights, and stiffer in shorter steps, so that impacts stay shallow.
            let stiffness = (1e3 * mass * 9.81 / (PENALTY_DEPTH * radius)).max(0.1 * mass / (h * h));
            let (distance, _) = obstacle_distance(obstacle, x, state.time);
            let depth = radius - distance;
            let anchor = held_place(&state.obstacle_anchors, node, touch.obstacle as usize)
                .map(|place| obstacle.motion.place(place, state.time + h));
            let element = &mut self.obstacles.set.elements[k];
            element.stiffness = stiffness;
            if let (Some(anchor), true) = (anchor, depth > 0.0) {
                element.anchor = anchor.to_array();
                element.limit = obstacle.friction_coefficient * stiffness * depth;
                element.anchor_stiffness = (element.limit / (SLIP * radius)).max(1e-3 * stiffness);
            }
        }
    }

    /// Finds the nodes that may meet others of the same fabric during a step of length `h`.
    pub(crate) fn find_self_contacts(&mut self, state: &State, h: f64) {
        let radius = self.radius_at_node.iter().copied().fold(0.0, f64::max);
        let distance = LAYERS * radius;
        let nodes = self.coordinates.node_count();
        let velocity = |node: usize| DVec3::from_slice(&state.velocities[BLOCK * node..]);
        let mean = (0..nodes).map(velocity).sum::<DVec3>() / nodes.max(1) as f64;
        let squares =
            (0..nodes).into_par_iter().with_min_len(4096).map(|node| (velocity(node) - mean).length_squared());
        let fastest = squares.reduce(|| 0.0, f64::max).sqrt();
        // Two nodes close in by twice the fastest; a longer reach would find everything near everything.
        let reach = distance + (2.0 * h * fastest).clamp(0.5 * radius, distance);
        let apart = KNITTED_TOGETHER * self.card.cell().into_iter().fold(0.0, f64::max);
        let (coordinates, q) = (&self.coordinates, &state.coordinates);
        let pairs = self.nearby.find(|node| coordinates.position_of(node, q), &self.layout, reach, apart);
        let had = !self.self_contacts.set.is_empty();
        self.self_contacts.set.elements.clear();
        self.self_contacts.set.stencils.clear();
        for pair in pairs {
            let mass: f64 = pair.iter().map(|&node| self.mass_at_node[node as usize]).sum();
            let distance = 0.5 * LAYERS * pair.iter().map(|&node| self.radius_at_node[node as usize]).sum::<f64>();
            let stiffness = 1e3 * mass * 9.81 / (PENALTY_DEPTH * radius);
            let [a, b] = pair.map(|node| dof(BLOCK * node as usize));
            self.self_contacts.set.push(SelfContact { stiffness, distance }, [a, a + 1, a + 2, b, b + 1, b + 2]);
        }
        if had || !pairs.is_empty() {
            self.self_contacts.plan(&self.chunks);
            self.self_contacts.locate(&self.pattern);
        }
    }

    /// The contacts that are closed at `q`, for the linear solver.
    pub(crate) fn active_self_contacts(&self, q: &[f64], free: &[bool], out: &mut Vec<Coupling>) {
        out.clear();
        for (index, (element, stencil)) in
            self.self_contacts.set.elements.iter().zip(&self.self_contacts.set.stencils).enumerate()
        {
            if let Some((_, n)) = element.touch(&self.self_contacts.set.local(index, q)) {
                let slots = [stencil[0], stencil[3], stencil[0], stencil[0]];
                let root = element.stiffness.sqrt();
                let direction =
                    |slot: u32| std::array::from_fn(|k| if free[slot as usize + k] { root * n[k] } else { 0.0 });
                let weights = [-1.0, 1.0, 0.0, 0.0];
                out.push(Coupling { slots, weights, directions: slots.map(direction) });
            }
        }
    }

    /// Sets the tangent planes of the obstacles at the current coordinates.
    pub(crate) fn renew_touches(&mut self, obstacles: &[Obstacle], q: &[f64], time: f64, touches: &[Touch]) {
        for (touch, element) in touches.iter().zip(&mut self.obstacles.set.elements) {
            let x = self.coordinates.position_of(touch.node as usize, q);
            let (distance, normal) = obstacle_distance(&obstacles[touch.obstacle as usize], x, time);
            element.normal = normal.to_array();
            element.point = (x - normal * (distance - self.radius_at_node[touch.node as usize])).to_array();
        }
    }

    /// Notes where friction with obstacles holds nodes after a step that ended at `time`.
    pub(crate) fn hold_touches(
        &self,
        obstacles: &[Obstacle],
        q: &[f64],
        time: f64,
        touches: &[Touch],
        anchors: &mut Vec<f64>,
    ) {
        anchors.clear();
        for (touch, element) in touches.iter().zip(&self.obstacles.set.elements) {
            let x = self.coordinates.position_of(touch.node as usize, q);
            if element.depth(x.to_array()) <= 0.0 {
                continue;
            }
            let place = if touch.held && element.limit > 0.0 {
                let slip = DVec3::from_array(element.slip(x.to_array()));
                let reach = element.limit / element.anchor_stiffness;
                x - slip.clamp_length_max(reach)
            } else {
                x
            };
            let local = to_rest_frame(&obstacles[touch.obstacle as usize], place, time);
            anchors.extend([f64::from(touch.node), f64::from(touch.obstacle), local.x, local.y, local.z]);
        }
    }
}

/// Where an obstacle holds a node, in the obstacle's rest frame; anchors are in order of node, then obstacle.
fn held_place(anchors: &[f64], node: usize, obstacle: usize) -> Option<DVec3> {
    let anchors = anchors.as_chunks::<5>().0;
    let key = |a: &[f64; 5]| (a[0] as usize, a[1] as usize);
    let found = anchors.binary_search_by_key(&(node, obstacle), key).ok()?;
    Some(DVec3::from_slice(&anchors[found][2..]))
}
