//! Which yarn lies in front at every node, and the contacts of stitches.

use super::knit::{LEFT_FOOT, LEFT_LEG, RIGHT_FOOT, RIGHT_LEG};
use super::loops::{Form, Loop, LoopGraph, LoopId};
use crate::model::{ContactPair, Network, NodeId, PassId, StitchContact, WrapPair, YarnId};

/// What the builder of a network knows of its passes and nodes.
#[derive(Default)]
pub(super) struct Made {
    /// The loop that each pass is part of; `None` of turns, tails and the bind-off.
    pub owner: Vec<Option<LoopId>>,
    /// First own node of each loop.
    pub first_node: Vec<usize>,
}

/// The loops with own nodes.
fn worked(graph: &LoopGraph) -> impl Iterator<Item = (LoopId, &Loop, bool)> {
    graph.loops.iter().enumerate().filter_map(|(at, of)| match of.form {
        Form::Worked { knit } => Some((LoopId::new(at), of, knit)),
        _ => None,
    })
}

/// Orders the passes of every node front to back.
pub(super) fn stack_nodes(network: &mut Network, graph: &LoopGraph, made: &Made) {
    let mut stacks = vec![Vec::new(); network.node_count()];
    for (pass, node) in network.pass_node.iter().enumerate() {
        stacks[node.index()].push(PassId::new(pass));
    }
    for (id, of, knit) in worked(graph) {
        for corner in 0..4 {
            let foot = corner == LEFT_FOOT || corner == RIGHT_FOOT;
            // Knit: the feet pass behind the parents' legs, the legs in front of the parents' heads.
            let child_in_front = foot != knit;
            let own = if child_in_front { 0 } else { of.parents.len() + 1 };
            let place = |pass: &PassId| match parent_of(network, made, id, of, *pass) {
                None => own,
                Some(parent) => 1 + parent,
            };
            stacks[made.first_node[id.index()] + corner].sort_by_key(place);
        }
    }
    network.set_stacks(&stacks);
}

/// Which of a loop's parents a pass at one of its own nodes belongs to; `None` of the loop's own pass.
fn parent_of(network: &Network, made: &Made, id: LoopId, of: &Loop, pass: PassId) -> Option<usize> {
    let (owner, image) = (made.owner[pass.index()], network.pass_image[pass.index()]);
    if owner == Some(id) && image == [0; 2] {
        return None;
    }
    // The parent sees the node in the image opposite to that in which the loop sees the parent.
    of.parents.iter().position(|held| Some(held.of) == owner && held.image == image.map(|shift| -shift))
}

/// Finds the contacts of stitches after [`stack_nodes`]: every loop wraps around each of those that it is worked into,
/// those not around each other.
pub(super) fn stitch_contacts(network: &mut Network, graph: &LoopGraph, made: &Made) {
    let yarn_of = network.pass_yarn();
    let mut contacts = Vec::with_capacity(2 * graph.loops.len());
    for (id, of, knit) in worked(graph) {
        let node = |corner: usize| NodeId::new(made.first_node[id.index()] + corner);
        for (foot, leg, left) in [(LEFT_FOOT, LEFT_LEG, true), (RIGHT_FOOT, RIGHT_LEG, false)] {
            let nodes = [node(foot), node(leg)];
            let split = |end: usize| {
                let own = |pass: &PassId| parent_of(network, made, id, of, *pass).is_none();
                network.stack(nodes[end]).iter().copied().partition::<Vec<_>, _>(own)
            };
            let ((child0, parents0), (child1, parents1)) = (split(0), split(1));
            let beside = |a: PassId, b: PassId| {
                let yarn = yarn_of[a.index()];
                [1, -1].into_iter().any(|step| network.neighbour(yarn, a, step).is_some_and(|found| found.pass == b))
            };
            let partner = |&at_first: &PassId| {
                let at_second = parents1.iter().copied().find(|&at_second| beside(at_first, at_second));
                at_second.map(|at_second| [at_first, at_second])
            };
            let child = [child0[0], child1[0]];
            let parents: Vec<[PassId; 2]> = parents0.iter().filter_map(partner).collect();
            let outward = |passes: [PassId; 2], end: usize| {
                let yarn = yarn_of[passes[0].index()];
                let direction = outward_step(network, yarn, passes[end], passes[1 - end]);
                network.neighbour(yarn, passes[end], direction)
            };
            let mut pairs = Vec::with_capacity(2 * parents.len());
            for &parent in &parents {
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
            }
            let wrap_sign = if knit == left { 1.0 } else { -1.0 };
            let passes = std::iter::once(child).chain(parents).collect();
            contacts.push(StitchContact { nodes, passes, wrap_sign, pairs });
        }
    }
    network.stitches = contacts;
}

/// The direction along the yarn that leads from `pass` away from `other`, its neighbour in a stitch contact.
fn outward_step(network: &Network, yarn: YarnId, pass: PassId, other: PassId) -> i32 {
    match network.neighbour(yarn, pass, 1) {
        Some(next) if next.pass == other => -1,
        _ => 1,
    }
}
