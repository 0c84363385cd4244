//! Where each coordinate of a network lies in the global vector: five slots a block.

use glam::DVec3;

use crate::model::{Frame, Network, NodeId, PassId};

/// Slots of a block: three of a position, two of sliding coordinates.
pub const BLOCK: usize = 5;

/// Index of a scalar coordinate in the global vector.
pub type Dof = u32;

/// Hands out the coordinates that an element reads; periodic tiles answer for images too.
pub trait CoordinateMap {
    /// Position of (an image of) a node.
    fn position(&mut self, node: NodeId, image: [i16; 2]) -> [Dof; 3];
    /// Sliding coordinate of a pass, `turns` closures of its yarn further on.
    fn sliding(&mut self, pass: PassId, turns: i16) -> Dof;
}

/// Coordinates of a finite network: node `i` has the block `i` with its position and the sliding coordinates of its
/// first two passes; passes beyond two go to blocks of their own behind the nodes', five a block.
#[derive(Clone, Debug, Default)]
pub struct Coordinates {
    node_count: usize,
    block_count: usize,
    /// Slot of each pass.
    sliding: Vec<Dof>,
    /// Whether each slot is an unknown: positions, and the passes that slide; padding and tied passes are not.
    free: Vec<bool>,
}

impl Coordinates {
    /// Lays out a network.
    #[must_use]
    pub fn new(network: &Network) -> Self {
        let node_count = network.node_count();
        let mut sliding = vec![0; network.pass_count()];
        let mut overflow = 0usize;
        for node in 0..node_count {
            for (k, pass) in network.stack(NodeId::new(node)).iter().enumerate() {
                sliding[pass.index()] = dof(if k < 2 {
                    BLOCK * node + 3 + k
                } else {
                    overflow += 1;
                    BLOCK * node_count + overflow - 1
                });
            }
        }
        let block_count = node_count + overflow.div_ceil(BLOCK);
        let mut free = vec![false; BLOCK * block_count];
        for node in 0..node_count {
            // A node that all yarns have left is nowhere in particular.
            let there = network.pulled_out.is_empty() || network.live_stack(NodeId::new(node)).next().is_some();
            free[BLOCK * node..BLOCK * node + 3].fill(there);
        }
        for (pass, slot) in sliding.iter().enumerate() {
            free[*slot as usize] = network.slides(PassId::new(pass));
        }
        Self { node_count, block_count, sliding, free }
    }

    /// Number of blocks; the global vector is five times as long.
    #[must_use]
    pub fn block_count(&self) -> usize {
        self.block_count
    }
    /// Number of nodes: blocks that have a position.
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.node_count
    }
    /// Number of passes of all yarns.
    #[must_use]
    pub fn pass_count(&self) -> usize {
        self.sliding.len()
    }
    /// Length of the global vector.
    #[must_use]
    pub fn len(&self) -> usize {
        BLOCK * self.block_count
    }
    /// Whether there are no coordinates.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.block_count == 0
    }
    /// Whether each slot is an unknown.
    #[must_use]
    pub fn free(&self) -> &[bool] {
        &self.free
    }
    /// Number of unknowns.
    #[must_use]
    pub fn unknown_count(&self) -> usize {
        self.free.iter().filter(|free| **free).count()
    }
    /// Slot of a pass's sliding coordinate.
    #[must_use]
    pub fn slot(&self, pass: PassId) -> usize {
        self.sliding[pass.index()] as usize
    }
    /// Position of a node in a global vector.
    #[must_use]
    pub fn position_of(&self, node: usize, q: &[f64]) -> DVec3 {
        DVec3::from_slice(&q[BLOCK * node..BLOCK * node + 3])
    }

    /// The global vector of a network's initial layout.
    #[must_use]
    pub fn initial(&self, network: &Network) -> Vec<f64> {
        self.gather(&network.position, &network.arc_length)
    }
    /// The global vector of positions \[m\] (one per node) and rest arc lengths \[m\] (one per pass).
    #[must_use]
    pub fn gather(&self, positions: &[DVec3], sliding: &[f64]) -> Vec<f64> {
        let mut q = vec![0.0; self.len()];
        for (node, position) in positions.iter().enumerate() {
            q[BLOCK * node..BLOCK * node + 3].copy_from_slice(&position.to_array());
        }
        for (slot, u) in self.sliding.iter().zip(sliding) {
            q[*slot as usize] = *u;
        }
        q
    }
    /// A snapshot of a global vector.
    #[must_use]
    pub fn frame(&self, time: f64, q: &[f64]) -> Frame {
        Frame {
            time,
            positions: (0..self.node_count).map(|node| self.position_of(node, q)).collect(),
            sliding: self.sliding.iter().map(|slot| q[*slot as usize]).collect(),
        }
    }
}

impl CoordinateMap for Coordinates {
    fn position(&mut self, node: NodeId, _image: [i16; 2]) -> [Dof; 3] {
        let first = dof(BLOCK * node.index());
        [first, first + 1, first + 2]
    }
    fn sliding(&mut self, pass: PassId, _turns: i16) -> Dof {
        self.sliding[pass.index()]
    }
}

/// A vector index as a [`Dof`].
pub(crate) fn dof(index: usize) -> Dof {
    Dof::try_from(index).expect("coordinate index fits 32 bits")
}
