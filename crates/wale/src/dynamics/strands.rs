//! Contact of strands during a step: which may meet, and how far a step may go before two would pass through each other.

use glam::DVec3;
use rayon::prelude::*;

use super::linear::Coupling;
use super::state::State;
use super::system::System;
use crate::contact::Strands;
use crate::energy::StrandContact;
use crate::fabric::coordinates::{BLOCK, dof};
use crate::model::Network;

/// Times the weight of the yarn at their nodes that strands carry about one yarn radius deep.
const WEIGHTS: f64 = 3e3;
/// Part of the way to where two strands would meet that a step may go.
pub(super) const PART: f64 = 0.7;
/// Parts of a step that are looked at to find where two strands meet.
const PARTS: usize = 8;

impl System {
    /// From now on the strands of the network, which is as in its layout, hold their distance.
    pub(crate) fn keep_strands_apart(&mut self, network: &Network) {
        self.strands = Strands::new(network, &self.yarns);
    }

    /// Finds the strands that may meet during a step of length `h`.
    pub(crate) fn find_strand_contacts(&mut self, state: &State, h: f64, grown: f64) {
        if self.strands.is_empty() {
            return;
        }
        let (coordinates, q) = (&self.coordinates, &state.coordinates);
        let at = |node: usize| coordinates.position_of(node, q);
        let velocity = |node: usize| DVec3::from_slice(&state.velocities[BLOCK * node..]);
        let found = self.strands.find(at, velocity, h, grown);
        let set = &mut self.strand_contacts.set;
        set.elements.clear();
        set.stencils.clear();
        for near in found {
            let mass: f64 = near.nodes.iter().map(|&node| 0.5 * self.mass_at_node[node as usize]).sum();
            // The same in steps of any length: strands that are close would be thrown apart if it grew.
            let stiffness = WEIGHTS * mass * 9.81 / self.least_radius;
            let first = near.nodes.map(|node| dof(BLOCK * node as usize));
            let stencil = std::array::from_fn(|i| first[i / 3] + (i % 3) as u32);
            set.push(StrandContact { stiffness, distance: near.distance, offsets: near.offsets }, stencil);
        }
        self.strand_contacts.plan(&self.chunks);
        self.strand_contacts.locate(&self.pattern);
    }

    /// Adds the strands that touch at `q`, for the linear solver.
    pub(crate) fn active_strand_contacts(&self, q: &[f64], free: &[bool], out: &mut Vec<Coupling>) {
        let set = &self.strand_contacts.set;
        for (index, (element, stencil)) in set.elements.iter().zip(&set.stencils).enumerate() {
            if let Some((near, curvature)) = element.touch(&set.local(index, q)) {
                let slots = [stencil[0], stencil[3], stencil[6], stencil[9]];
                let root = curvature.sqrt();
                let direction = |slot: u32| {
                    std::array::from_fn(|k| if free[slot as usize + k] { root * near.normal[k] } else { 0.0 })
                };
                out.push(Coupling { slots, weights: near.weights, directions: slots.map(direction) });
            }
        }
    }

    /// The part of a step along which no two strands pass through each other, less than all of it where some would.
    pub(super) fn longest_way(&self, q: &[f64], direction: &[f64]) -> f64 {
        let set = &self.strand_contacts.set;
        let ways = (0..set.len()).into_par_iter().with_min_len(1024);
        let way = |index: usize| {
            let (start, way) = (set.local(index, q), set.local(index, direction));
            first_meeting(&set.elements[index].ends(&start), &way).map_or(1.0, |t| PART * t)
        };
        ways.map(way).reduce(|| 1.0, f64::min)
    }

    /// How far strands that may meet move past each other at most, from one state to another \[m\].
    pub(crate) fn strands_shift(&self, from: &[f64], to: &[f64]) -> f64 {
        let set = &self.strand_contacts.set;
        let shift = |index: usize| {
            let (start, end) = (set.local(index, from), set.local(index, to));
            let way = |k: usize| DVec3::from_slice(&end[3 * k..]) - DVec3::from_slice(&start[3 * k..]);
            let apart = [(0, 2), (0, 3), (1, 2), (1, 3)].map(|(i, k)| way(i).distance_squared(way(k)));
            apart.into_iter().fold(0.0, f64::max)
        };
        (0..set.len()).into_par_iter().with_min_len(1024).map(shift).reduce(|| 0.0, f64::max).sqrt()
    }

    /// Whether two strands have passed through each other on the straight way from one state to another.
    pub(crate) fn strands_pass(&self, from: &[f64], to: &[f64]) -> bool {
        let set = &self.strand_contacts.set;
        (0..set.len()).into_par_iter().with_min_len(1024).any(|index| {
            let (start, end) = (set.local(index, from), set.local(index, to));
            let way = std::array::from_fn(|i| end[i] - start[i]);
            first_meeting(&set.elements[index].ends(&start), &way).is_some()
        })
    }
}

/// When two pieces that move straight first meet, from 0 to 1.
pub(super) fn first_meeting(ends: &[[f64; 3]; 4], way: &[f64; 12]) -> Option<f64> {
    let ends = ends.map(DVec3::from_array);
    let ways: [DVec3; 4] = std::array::from_fn(|k| DVec3::from_slice(&way[3 * k..]));
    let at = |t: f64| -> [DVec3; 4] { std::array::from_fn(|k| ends[k] + t * ways[k]) };
    let volume = |t: f64| {
        let [p, q, r, s] = at(t);
        (q - p).cross(s - r).dot(r - p)
    };
    let mut before = volume(0.0);
    for part in 1..=PARTS {
        let [start, end] = [part - 1, part].map(|k| k as f64 / PARTS as f64);
        let after = volume(end);
        if before * after <= 0.0 && (before != 0.0 || after != 0.0) {
            let [mut low, mut high] = [start, end];
            for _ in 0..40 {
                let middle = 0.5 * (low + high);
                if volume(middle) * before > 0.0 { low = middle } else { high = middle }
            }
            if meet(at(0.5 * (low + high))) {
                return Some(low);
            }
        }
        before = after;
    }
    None
}

/// Whether two pieces in one plane cross.
fn meet([p, q, r, s]: [DVec3; 4]) -> bool {
    let (d, e, offset) = (q - p, s - r, r - p);
    let normal = d.cross(e);
    let square = normal.length_squared();
    let along = |other: DVec3| offset.cross(other).dot(normal) / square;
    square > 0.0 && (0.0..=1.0).contains(&along(e)) && (0.0..=1.0).contains(&along(d))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_meet_where_they_do() {
        let ends = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, -1.0, 1.0], [0.0, 1.0, 1.0]];
        let down = |by: f64, aside: f64| [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, aside, 0.0, by, aside, 0.0, by];
        let met = first_meeting(&ends, &down(-4.0, 0.0)).unwrap();
        assert!((met - 0.25).abs() < 1e-9);
        assert_eq!(first_meeting(&ends, &down(-0.9, 0.0)), None);
        assert_eq!(first_meeting(&ends, &down(-4.0, 8.0)), None);
    }
}
