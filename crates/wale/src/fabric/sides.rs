//! On which side of a contact a yarn lies: the normal of the contact's nodes, and the places of yarns along it.

use glam::DVec3;

use super::coordinates::{CoordinateMap, Dof};
use crate::energy::thick::normal;
use crate::model::{ContactPair, Network, NodeId, PassId, WrapPair};

/// A node next to another, in some periodic image.
type Around = (NodeId, [i16; 2]);

/// The three nodes around each node of a stitch contact: one on the child, one on the parent, and the other node of the
/// contact, anticlockwise as seen from the front. Their triangle has the normal of the contact.
#[derive(Clone, Debug)]
pub struct Sides {
    around: Vec<Option<[Around; 3]>>,
    /// Distance of the centre lines of two yarns at a contact \[m\].
    distance: f64,
}

impl Sides {
    /// `distance` \[m\] is that of the centre lines of two yarns at a contact.
    #[must_use]
    pub fn new(network: &Network, distance: f64) -> Self {
        let mut around = vec![None; network.node_count()];
        let periods = network.periods.unwrap_or([DVec3::ZERO; 2]);
        for contact in &network.stitches {
            if contact.passes.iter().flatten().any(|&pass| network.is_out(pass)) {
                continue;
            }
            let pairs = |pair: ContactPair| contact.pairs.iter().filter(move |wrap| wrap.pair == pair);
            let Some(course) = pairs(ContactPair::Course).next() else { continue };
            let node = |pass: PassId, image| (network.pass_node[pass.index()], image);
            let at = |(node, image): Around| {
                let [i, j] = image.map(f64::from);
                network.position[node.index()] + i * periods[0] + j * periods[1]
            };
            let beside = node(course.outward_at_first, course.image_at_first);
            let other = (contact.nodes[1], [0; 2]);
            // Of loops that are worked together, the leg that stands most across says where the front is: others come from aside.
            let across = |wrap: &&WrapPair| {
                let below = at(node(wrap.outward_at_first, wrap.image_at_first));
                let [to_leg, to_other] = [below, at(other)].map(|x| x - at(beside));
                to_leg.cross(to_other).length() / to_leg.length()
            };
            let most = |a: &&WrapPair, b: &&WrapPair| across(a).total_cmp(&across(b));
            let Some(leg) = pairs(ContactPair::Leg).max_by(most) else { continue };
            let first = [beside, node(leg.outward_at_first, leg.image_at_first)];
            let second = [course, leg].map(|pair| node(pair.outward_at_second, pair.image_at_second));
            for (k, [a, b]) in [first, second].into_iter().enumerate() {
                let here = contact.nodes[k];
                let mut corners = [a, b, (contact.nodes[1 - k], [0; 2])];
                let [x, y, z] = corners.map(at);
                if (y - x).cross(z - x).dot(network.front[here.index()]) < 0.0 {
                    corners.swap(0, 1);
                }
                around[here.index()] = Some(corners);
            }
        }
        Self { around, distance }
    }

    /// How far in front of its node a pass lies \[m\].
    #[must_use]
    pub fn offset(&self, network: &Network, pass: PassId) -> f64 {
        let node = network.pass_node[pass.index()];
        match self.around[node.index()] {
            Some(_) => 0.5 * self.distance * steps_to_front(network, pass),
            None => 0.0,
        }
    }

    /// Twice the area of a triangle at which its normal fades \[m²\].
    #[must_use]
    pub fn softness(&self) -> f64 {
        0.5 * self.distance * self.distance
    }

    /// All of them.
    #[cfg(test)]
    pub(super) fn corners(&self) -> &[Option<[Around; 3]>] {
        &self.around
    }

    /// Nodes around a node of a finite fabric.
    #[must_use]
    pub fn around(&self, node: usize) -> Option<[usize; 3]> {
        self.around[node].map(|corners| corners.map(|(node, _)| node.index()))
    }

    /// Where a pass of some periodic image lies \[m\], if nodes are where `at` says.
    pub fn place(
        &self,
        network: &Network,
        (pass, image): (PassId, [i16; 2]),
        at: impl Fn(NodeId, [i16; 2]) -> DVec3,
    ) -> DVec3 {
        let node = network.pass_node[pass.index()];
        let x = at(node, image);
        let Some(corners) = self.around[node.index()] else { return x };
        let [a, b, c] = corners.map(|(node, off)| at(node, [image[0] + off[0], image[1] + off[1]]).to_array());
        x + DVec3::from_array(normal(a, b, c, self.softness())) * self.offset(network, pass)
    }

    /// Coordinates `x a b c u` of a pass, as [`crate::energy::Thick`] reads them.
    pub fn coordinates(
        &self,
        map: &mut dyn CoordinateMap,
        network: &Network,
        (pass, image, turns): (PassId, [i16; 2], i16),
    ) -> [Dof; 13] {
        let node = network.pass_node[pass.index()];
        let mut out = [0; 13];
        let x = map.position(node, image);
        let corners = self.around[node.index()].unwrap_or([(node, [0; 2]); 3]);
        out[..3].copy_from_slice(&x);
        for (k, (node, off)) in corners.into_iter().enumerate() {
            let at = map.position(node, [image[0] + off[0], image[1] + off[1]]);
            out[3 + 3 * k..6 + 3 * k].copy_from_slice(&at);
        }
        out[12] = map.sliding(pass, turns);
        out
    }
}

/// How many half distances a pass lies in front of the middle of its stack: 1 and −1 in a pair of two.
pub(super) fn steps_to_front(network: &Network, pass: PassId) -> f64 {
    let stack = network.stack(network.pass_node[pass.index()]);
    let place = stack.iter().position(|&other| other == pass).unwrap_or(0);
    stack.len() as f64 - 1.0 - 2.0 * place as f64
}
