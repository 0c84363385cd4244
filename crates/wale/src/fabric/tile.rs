//! Coordinates of a periodic tile: nodes, their images and sliding coordinates as affine functions of the unknowns.

use std::collections::HashMap;

use glam::DVec3;

use super::coordinates::{BLOCK, CoordinateMap, Coordinates, Dof, dof};
use crate::model::{Network, NodeId, PassId, YarnId};

/// World coordinates of a tile: the nodes' own, then those of images. Each is an unknown, a multiple of a period, and a
/// constant.
///
/// The unknowns are the nodes' slots followed by the two periods, `w` along x and `h` along y \[m\]. A slot of a position
/// holds the place of its node less that part of the periods at which the node was laid out, so that a period that grows
/// stretches the whole tile evenly and not its seam.
#[derive(Clone, Debug)]
pub struct TileCoordinates {
    own: Coordinates,
    yarn_of: Vec<YarnId>,
    closure_length: Vec<f64>,
    /// How each world coordinate follows from the unknowns.
    sources: Vec<Source>,
    known_positions: HashMap<(NodeId, [i16; 2]), Dof>,
    known_sliding: HashMap<(PassId, i16), Dof>,
}

/// A world coordinate: `y[of] + factor · period[axis] + shift`.
#[derive(Clone, Copy, Debug)]
pub struct Source {
    /// The unknown it follows.
    pub of: Dof,
    /// Which period it moves with.
    pub axis: usize,
    /// Multiples of that period \[–\].
    pub factor: f64,
    /// Constant shift \[m\].
    pub shift: f64,
}

impl TileCoordinates {
    /// Lays out a periodic network.
    #[must_use]
    pub fn new(network: &Network) -> Self {
        let own = Coordinates::new(network);
        let still = |of| Source { of, axis: 0, factor: 0.0, shift: 0.0 };
        let mut sources: Vec<Source> = (0..own.len()).map(|slot| still(dof(slot))).collect();
        let [w, h] = periods(network);
        for (node, x) in network.position.iter().enumerate() {
            sources[BLOCK * node].factor = x.x / w;
            sources[BLOCK * node + 1] = Source { axis: 1, factor: x.y / h, ..still(dof(BLOCK * node + 1)) };
        }
        Self {
            own,
            yarn_of: network.pass_yarn(),
            closure_length: network.yarn_closure.iter().map(|c| c.map_or(0.0, |(_, length)| length)).collect(),
            sources,
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
    /// What a world coordinate follows from.
    #[must_use]
    pub fn source(&self, world: Dof) -> &Source {
        &self.sources[world as usize]
    }
    /// World coordinates from the unknowns.
    pub fn place(&self, unknowns: &[f64], world: &mut Vec<f64>) {
        let periods = [unknowns[self.own.len()], unknowns[self.own.len() + 1]];
        world.clear();
        world.extend(
            self.sources
                .iter()
                .map(|source| unknowns[source.of as usize] + source.factor * periods[source.axis] + source.shift),
        );
    }
    /// Unknowns of the nodes' own world coordinates and the two periods \[m\], as one vector.
    #[must_use]
    pub fn unknowns(&self, mut world: Vec<f64>) -> Vec<f64> {
        let n = self.own.len();
        let periods = [world[n], world[n + 1]];
        for (x, source) in world[..n].iter_mut().zip(&self.sources) {
            *x -= source.factor * periods[source.axis];
        }
        world
    }
    /// World coordinates of the network's own nodes as they are laid out, and the two periods \[m\].
    #[must_use]
    pub fn initial(&self, network: &Network) -> Vec<f64> {
        let mut world = self.own.initial(network);
        world.extend(periods(network));
        world
    }

    fn push(&mut self, source: Source) -> Dof {
        self.sources.push(source);
        dof(self.sources.len() - 1)
    }
}

/// Width and height of a tile \[m\].
fn periods(network: &Network) -> [f64; 2] {
    let [w, h] = network.periods.unwrap_or([DVec3::X, DVec3::Y]);
    [w.x, h.y]
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
        let own = |k: usize| self.sources[first as usize + k];
        let [x, y, z] = [own(0), own(1), own(2)];
        let start = self.push(Source { factor: x.factor + f64::from(image[0]), ..x });
        self.push(Source { factor: y.factor + f64::from(image[1]), ..y });
        self.push(z);
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
        let at = self.push(Source { of, axis: 0, factor: 0.0, shift });
        self.known_sliding.insert((pass, turns), at);
        at
    }
}
