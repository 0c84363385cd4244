//! How far the nodes still have to go.

use glam::DVec3;

use crate::fabric::coordinates::BLOCK;

/// Most far nodes: so many, or one in so many of the fabric, but no more than there is memory for.
const FEW_NODES: usize = 16;
const FEW_IN: usize = 200;
/// Most far nodes of any fabric.
pub(super) const MOST_FAR: usize = 1024;

/// What is left to go after a move.
#[derive(Clone, Copy)]
pub(super) struct Left {
    /// As a part of the move.
    pub ratio: f64,
    /// Moves of the nodes, root mean square and largest \[m\].
    pub mean: f64,
    pub largest: f64,
}

impl Left {
    pub const ALL: Self = Self { ratio: 1.0, mean: f64::INFINITY, largest: f64::INFINITY };
}

/// Finds the nodes that move further than `far` \[m\]; returns whether there are some, but few.
pub(super) fn far_nodes(direction: &[f64], node_count: usize, far: f64, nodes: &mut Vec<u32>) -> bool {
    let most = FEW_NODES.max(node_count / FEW_IN).min(MOST_FAR);
    let moves = direction[..BLOCK * node_count].as_chunks::<BLOCK>().0;
    let is_far = |d: &[f64; BLOCK]| DVec3::from_slice(d).length_squared() > far * far;
    nodes.clear();
    nodes.extend((0..).zip(moves).filter(|(_, d)| is_far(d)).map(|(node, _)| node).take(most + 1));
    !nodes.is_empty() && nodes.len() <= most
}

/// Moves of the nodes in a global vector: root mean square and largest \[m\].
pub(super) fn moves(direction: &[f64], node_count: usize) -> (f64, f64) {
    let (mut sum, mut largest) = (0.0, 0.0f64);
    for d in direction[..BLOCK * node_count].as_chunks::<BLOCK>().0 {
        let square = DVec3::from_slice(d).length_squared();
        sum += square;
        largest = largest.max(square);
    }
    ((sum / node_count.max(1) as f64).sqrt(), largest.sqrt())
}
