//! Coordinates of a periodic tile: nodes, their images and sliding coordinates as affine functions of the unknowns.

use std::collections::HashMap;

use glam::DVec3;

use super::coordinates::{BLOCK, CoordinateMap, Coordinates, Dof, dof};
use crate::model::{Network, NodeId, PassId, YarnId};

/// A matrix of the plane, by rows.
pub type Matrix2 = [[f64; 2]; 2];

/// How the plane of a tile follows two numbers `q`: a place `X`, in multiples of the periods, lies at `(B + q₀ R₀ + q₁ R₁) X`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneMap {
    /// `B` \[m\]; its columns are the periods where both numbers are zero.
    pub base: Matrix2,
    /// `R₀` and `R₁`, in metres over the unit of the numbers.
    pub rates: [Matrix2; 2],
}

impl PlaneMap {
    /// The numbers are the periods, `w` along x and `h` along y \[m\].
    pub const PERIODS: Self = Self { base: [[0.0; 2]; 2], rates: [[[1.0, 0.0], [0.0, 0.0]], [[0.0, 0.0], [0.0, 1.0]]] };

    /// The matrix at two numbers.
    #[must_use]
    pub fn at(&self, q: [f64; 2]) -> Matrix2 {
        let rate = self.rate(q);
        std::array::from_fn(|i| std::array::from_fn(|j| self.base[i][j] + rate[i][j]))
    }

    /// Its change where the two numbers change so.
    #[must_use]
    pub fn rate(&self, change: [f64; 2]) -> Matrix2 {
        let [a, b] = &self.rates;
        std::array::from_fn(|i| std::array::from_fn(|j| change[0] * a[i][j] + change[1] * b[i][j]))
    }
}

/// World coordinates of a tile: the nodes' own, then those of images. Each is an unknown, multiples of two numbers of the plane,
/// and a constant.
///
/// The unknowns are the nodes' slots followed by the two numbers: for a tile that relaxes, the periods `w` along x and `h` along y
/// \[m\]; for one that is stretched, how far ([`PlaneMap`]). A slot of a position holds the place of its node less that to which the
/// plane carries it, so that a period that grows stretches the whole tile evenly and not its seam.
#[derive(Clone, Debug)]
pub struct TileCoordinates {
    own: Coordinates,
    yarn_of: Vec<YarnId>,
    closure_length: Vec<f64>,
    map: PlaneMap,
    /// How each world coordinate follows from the unknowns.
    sources: Vec<Source>,
    known_positions: HashMap<(NodeId, [i16; 2]), Dof>,
    known_sliding: HashMap<(PassId, i16), Dof>,
}

/// A world coordinate: `y[of] + by · q + shift`.
#[derive(Clone, Copy, Debug)]
pub struct Source {
    /// The unknown it follows.
    pub of: Dof,
    /// Multiples of the two numbers of the plane.
    pub by: [f64; 2],
    /// Constant shift \[m\].
    pub shift: f64,
    /// Of a coordinate in the plane, which one, and the place `X` that the plane carries, in multiples of the periods.
    plane: Option<(usize, [f64; 2])>,
}

impl Source {
    fn still(of: Dof) -> Self {
        Self { of, by: [0.0; 2], shift: 0.0, plane: None }
    }

    /// A coordinate of a place in the plane, displaced by an unknown.
    fn carried(of: Dof, row: usize, place: [f64; 2], map: &PlaneMap) -> Self {
        let [by, other] = map.rates.map(|rate| times(&rate[row], place));
        Self { of, by: [by, other], shift: times(&map.base[row], place), plane: Some((row, place)) }
    }
}

fn times(row: &[f64; 2], place: [f64; 2]) -> f64 {
    row[0] * place[0] + row[1] * place[1]
}

impl TileCoordinates {
    /// Lays out a periodic network whose periods are unknown.
    #[must_use]
    pub fn new(network: &Network) -> Self {
        let [w, h] = periods(network);
        let places: Vec<[f64; 2]> = network.position.iter().map(|x| [x.x / w, x.y / h]).collect();
        Self::with_plane(network, &places, &PlaneMap::PERIODS)
    }

    /// A periodic network whose nodes are carried by the plane from given places, in multiples of the periods; nodes beyond them
    /// from none.
    #[must_use]
    pub fn with_plane(network: &Network, places: &[[f64; 2]], map: &PlaneMap) -> Self {
        let own = Coordinates::new(network);
        let mut sources: Vec<Source> = (0..own.len()).map(|slot| Source::still(dof(slot))).collect();
        for (node, &place) in places.iter().enumerate().take(own.node_count()) {
            for row in 0..2 {
                let slot = BLOCK * node + row;
                sources[slot] = Source::carried(dof(slot), row, place, map);
            }
        }
        Self {
            own,
            yarn_of: network.pass_yarn(),
            closure_length: network.yarn_closure.iter().map(|c| c.map_or(0.0, |(_, length)| length)).collect(),
            map: *map,
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
    /// How the plane follows its two numbers.
    #[must_use]
    pub fn map(&self) -> &PlaneMap {
        &self.map
    }
    /// Number of unknowns, fixed slots included: own slots, then the two numbers of the plane.
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
        let [p, q] = [unknowns[self.own.len()], unknowns[self.own.len() + 1]];
        world.clear();
        world.extend(
            self.sources
                .iter()
                .map(|source| unknowns[source.of as usize] + source.by[0] * p + source.by[1] * q + source.shift),
        );
    }
    /// How the world moves where all unknowns change so.
    #[must_use]
    pub fn moved(&self, change: &[f64]) -> Vec<f64> {
        let [p, q] = [change[self.own.len()], change[self.own.len() + 1]];
        let one = |source: &Source| change[source.of as usize] + source.by[0] * p + source.by[1] * q;
        self.sources.iter().map(one).collect()
    }
    /// How the world moves where the own slots change so and the plane goes by a matrix, `dx = M X`.
    #[must_use]
    pub fn motion(&self, own: &[f64], matrix: &Matrix2) -> Vec<f64> {
        let plane = |source: &Source| source.plane.map_or(0.0, |(row, place)| times(&matrix[row], place));
        self.sources.iter().map(|source| own[source.of as usize] + plane(source)).collect()
    }
    /// Unknowns of the nodes' own world coordinates and the two numbers of the plane, as one vector.
    #[must_use]
    pub fn unknowns(&self, mut world: Vec<f64>) -> Vec<f64> {
        let n = self.own.len();
        let [p, q] = [world[n], world[n + 1]];
        for (x, source) in world[..n].iter_mut().zip(&self.sources) {
            *x -= source.by[0] * p + source.by[1] * q + source.shift;
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
        let away = |source: Source, map: &PlaneMap| match source.plane {
            Some((row, [x, y])) => {
                Source::carried(source.of, row, [x + f64::from(image[0]), y + f64::from(image[1])], map)
            }
            None => source,
        };
        let [x, y, z] = [own(0), own(1), own(2)];
        let start = self.push(away(x, &self.map));
        self.push(away(y, &self.map));
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
        let at = self.push(Source { shift, ..Source::still(of) });
        self.known_sliding.insert((pass, turns), at);
        at
    }
}
