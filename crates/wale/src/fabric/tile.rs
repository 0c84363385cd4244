//! Coordinates of a periodic tile: images of nodes and of sliding coordinates as affine functions of the unknowns.

use std::collections::HashMap;

use glam::DVec3;

use super::coordinates::{BLOCK, CoordinateMap, Coordinates, Dof, dof};
use crate::model::{Network, NodeId, PassId, YarnId};

/// World coordinates of a tile: the nodes' own, then those of images, each an unknown plus a multiple of a period and
/// a constant.
///
/// The unknowns are the nodes' slots followed by the two periods, `w` along x and `h` along y \[m\].
#[derive(Clone, Debug)]
pub struct TileCoordinates {
    own: Coordinates,
    yarn_of: Vec<YarnId>,
    closure_length: Vec<f64>,
    images: Vec<Image>,
    known_positions: HashMap<(NodeId, [i16; 2]), Dof>,
    known_sliding: HashMap<(PassId, i16), Dof>,
}

/// One image coordinate: `y[of] + periods · y[period] + constant`.
#[derive(Clone, Copy, Debug)]
pub struct Image {
    /// The unknown it copies.
    pub of: Dof,
    /// Multiples of the periods `w` and `h`.
    pub periods: [f64; 2],
    /// Constant shift \[m\].
    pub shift: f64,
}

impl TileCoordinates {
    /// Lays out a periodic network.
    #[must_use]
    pub fn new(network: &Network) -> Self {
        Self {
            own: Coordinates::new(network),
            yarn_of: network.pass_yarn(),
            closure_length: network.yarn_closure.iter().map(|c| c.map_or(0.0, |(_, length)| length)).collect(),
            images: Vec::new(),
            known_positions: HashMap::new(),
            known_sliding: HashMap::new(),
        }
    }
    /// The coordinates of the tile's own nodes.
    #[must_use]
    pub fn own(&self) -> &Coordinates {
        &self.own
    }
    /// Number of unknowns, fixed slots included: own slots, then the two periods.
    #[must_use]
    pub fn unknown_len(&self) -> usize {
        self.own.len() + 2
    }
    /// The unknowns that a world coordinate depends on, with their factors.
    #[must_use]
    pub fn sources(&self, world: Dof) -> [(usize, f64); 3] {
        let index = world as usize;
        let periods = self.own.len();
        match index.checked_sub(periods) {
            None => [(index, 1.0), (periods, 0.0), (periods + 1, 0.0)],
            Some(k) => {
                let image = &self.images[k];
                [(image.of as usize, 1.0), (periods, image.periods[0]), (periods + 1, image.periods[1])]
            }
        }
    }
    /// World coordinates from the unknowns.
    pub fn place(&self, unknowns: &[f64], world: &mut Vec<f64>) {
        let n = self.own.len();
        world.clear();
        world.extend_from_slice(&unknowns[..n]);
        for image in &self.images {
            world.push(
                unknowns[image.of as usize]
                    + image.periods[0] * unknowns[n]
                    + image.periods[1] * unknowns[n + 1]
                    + image.shift,
            );
        }
    }
    /// Initial unknowns of the network's layout.
    #[must_use]
    pub fn initial(&self, network: &Network) -> Vec<f64> {
        let mut unknowns = self.own.initial(network);
        let [w, h] = network.periods.unwrap_or([DVec3::X, DVec3::Y]);
        unknowns.extend([w.x, h.y]);
        unknowns
    }

    fn push(&mut self, image: Image) -> Dof {
        self.images.push(image);
        dof(self.own.len() + self.images.len() - 1)
    }
}

impl CoordinateMap for TileCoordinates {
    fn position(&mut self, node: NodeId, image: [i16; 2]) -> [Dof; 3] {
        let first = dof(BLOCK * node.index());
        if image == [0; 2] {
            return [first, first + 1, first + 2];
        }
        if let Some(&known) = self.known_positions.get(&(node, image)) {
            return [known, known + 1, known + 2];
        }
        let [i, j] = image.map(f64::from);
        let start = self.push(Image { of: first, periods: [i, 0.0], shift: 0.0 });
        self.push(Image { of: first + 1, periods: [0.0, j], shift: 0.0 });
        self.push(Image { of: first + 2, periods: [0.0, 0.0], shift: 0.0 });
        self.known_positions.insert((node, image), start);
        [start, start + 1, start + 2]
    }
    fn sliding(&mut self, pass: PassId, turns: i16) -> Dof {
        let of = self.own.sliding(pass, 0);
        if turns == 0 {
            return of;
        }
        if let Some(&known) = self.known_sliding.get(&(pass, turns)) {
            return known;
        }
        let shift = f64::from(turns) * self.closure_length[self.yarn_of[pass.index()].index()];
        let at = self.push(Image { of, periods: [0.0; 2], shift });
        self.known_sliding.insert((pass, turns), at);
        at
    }
}
