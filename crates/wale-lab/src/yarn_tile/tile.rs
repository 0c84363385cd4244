//! A periodic tile of yarns: vertices, edges over the tile's border, rest shapes.

use serde::{Deserialize, Serialize};
use thiserror::Error;
use wale_numerics::jet::vector3::{dot, sub};

use super::rest::RestShape;

/// Most vertices of a tile.
pub const MOST_VERTICES: usize = 100_000;
/// Most tiles that an edge leads away.
pub const MOST_SHIFT: i32 = 8;

/// A piece of a yarn between two vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Edge {
    /// First and last vertex.
    pub ends: [u32; 2],
    /// In which tile the last vertex lies, in periods from that of the first.
    pub shift: [i32; 2],
}

/// A rectangle of fabric that repeats in both directions, flat at rest, with its yarns; heights are measured from their mean.
///
/// Yarns have no ends: each vertex is the last of one edge and the first of one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Written", into = "Written")]
pub struct YarnTile {
    pub(super) periods: [f64; 2],
    pub(super) radius: f64,
    pub(super) vertices: Vec<[f64; 3]>,
    pub(super) edges: Vec<Edge>,
    pub(super) rest: RestShape,
    /// Edges of each yarn in their order.
    pub(super) yarns: Vec<Vec<u32>>,
    /// Of each vertex the edge that ends there and the one that begins there.
    pub(super) around: Vec<[u32; 2]>,
}

/// Why numbers are not those of a tile.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TileFault {
    /// A period or the radius is not a positive number.
    #[error("the {what} is {value}, not a positive number")]
    Size {
        /// Which.
        what: &'static str,
        /// What it is.
        value: f64,
    },
    /// The yarn is thicker than its tile is long.
    #[error("a yarn of radius {radius} is thicker than its repeat is long ({} by {}); are all of them in one unit?", periods[0], periods[1])]
    Thick {
        /// Radius \[m\].
        radius: f64,
        /// Periods \[m\].
        periods: [f64; 2],
    },
    /// There are no vertices, or more than `MOST_VERTICES`, or lists of different lengths.
    #[error("{found} {what} where {wanted} are asked for")]
    Count {
        /// Of what.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many there should be.
        wanted: usize,
    },
    /// A vertex is not finite.
    #[error("vertex {vertex} has a coordinate that is not a finite number")]
    Vertex {
        /// Its place in the list.
        vertex: usize,
    },
    /// An edge names no vertex, leads too far, or has no length.
    #[error("edge {edge} {why}")]
    Edge {
        /// Its place in the list.
        edge: usize,
        /// What is wrong with it.
        why: &'static str,
    },
    /// A vertex at which a yarn ends or forks.
    #[error("{ending} edges end and {beginning} begin at vertex {vertex}, where one of each is asked for")]
    Fork {
        /// Its place in the list.
        vertex: usize,
        /// Number of edges that end there.
        ending: usize,
        /// Number of edges that begin there.
        beginning: usize,
    },
    /// A rest length, curvature or torsion that is none.
    #[error("the rest {what} number {index} is {value}")]
    Rest {
        /// Length, curvature or torsion.
        what: &'static str,
        /// Its place in the list.
        index: usize,
        /// What it is.
        value: f64,
    },
}

impl YarnTile {
    /// A tile from its periods \[m\], the yarns' radius \[m\], vertices \[m\] and edges, at rest as it lies.
    ///
    /// # Errors
    /// The first [`TileFault`].
    pub fn new(
        periods: [f64; 2],
        radius: f64,
        mut vertices: Vec<[f64; 3]>,
        edges: Vec<Edge>,
    ) -> Result<Self, TileFault> {
        let positive = |value: f64| value > 0.0 && value.is_finite();
        for (what, value) in [("first period", periods[0]), ("second period", periods[1]), ("radius", radius)] {
            if !positive(value) {
                return Err(TileFault::Size { what, value });
            }
        }
        if 2.0 * radius > periods[0] + periods[1] {
            return Err(TileFault::Thick { radius, periods });
        }
        let n = vertices.len();
        if n == 0 || n > MOST_VERTICES {
            return Err(TileFault::Count { what: "vertices", found: n, wanted: n.clamp(1, MOST_VERTICES) });
        }
        if edges.len() != n {
            return Err(TileFault::Count { what: "edges", found: edges.len(), wanted: n });
        }
        if let Some(vertex) = vertices.iter().position(|x| !x.iter().all(|x| x.is_finite())) {
            return Err(TileFault::Vertex { vertex });
        }
        let around = ends(n, &edges)?;
        let mean = vertices.iter().map(|x| x[2]).sum::<f64>() / n as f64;
        // Heights that were centred once stay as they are, bit by bit.
        if mean.abs() > 1e-12 * radius {
            vertices.iter_mut().for_each(|x| x[2] -= mean);
        }
        let yarns = yarns(&edges, &around);
        let tile = Self { periods, radius, vertices, edges, rest: RestShape::default(), yarns, around };
        if let Some(edge) = tile.lengths().iter().position(|&length| length <= 0.0) {
            return Err(TileFault::Edge { edge, why: "has no length" });
        }
        Ok(tile.at_rest_as_it_lies())
    }

    /// The tile with another rest shape.
    ///
    /// # Errors
    /// [`TileFault::Count`] or [`TileFault::Rest`].
    pub fn with_rest(mut self, rest: RestShape) -> Result<Self, TileFault> {
        rest.check(self.vertex_count())?;
        self.rest = rest;
        Ok(self)
    }

    /// Number of vertices, and of edges.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.vertices.len()
    }
    /// Positions of the vertices \[m\].
    #[must_use]
    pub fn vertices(&self) -> &[[f64; 3]] {
        &self.vertices
    }
    /// The edges.
    #[must_use]
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }
    /// Periods \[m\].
    #[must_use]
    pub fn periods(&self) -> [f64; 2] {
        self.periods
    }
    /// Radius that the yarns were drawn with \[m\]; contact has its own radii in the material.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }
    /// Area \[m²\].
    #[must_use]
    pub fn area(&self) -> f64 {
        self.periods[0] * self.periods[1]
    }
    /// What its yarns would be, each for itself.
    #[must_use]
    pub fn rest(&self) -> &RestShape {
        &self.rest
    }
    /// Number of yarns, counted once however many tiles one passes through before it repeats.
    #[must_use]
    pub fn yarn_count(&self) -> usize {
        self.yarns.len()
    }

    /// Where a vertex lies in the tile that is so many periods away \[m\].
    pub(super) fn image(&self, vertex: u32, shift: [i32; 2]) -> [f64; 3] {
        let [x, y, z] = self.vertices[vertex as usize];
        [x + f64::from(shift[0]) * self.periods[0], y + f64::from(shift[1]) * self.periods[1], z]
    }

    /// The vertices at the ends of an edge that begins so many periods away, and in which tiles they lie.
    pub(super) fn ends(&self, edge: u32, shift: [i32; 2]) -> [(u32, [i32; 2]); 2] {
        let Edge { ends, shift: across } = self.edges[edge as usize];
        [(ends[0], shift), (ends[1], [shift[0] + across[0], shift[1] + across[1]])]
    }

    /// The vertices before and after one, and in which tiles.
    pub(super) fn beside(&self, vertex: usize) -> [(u32, [i32; 2]); 2] {
        let [before, after] = self.around[vertex].map(|edge| self.edges[edge as usize]);
        [(before.ends[0], before.shift.map(|s| -s)), (after.ends[1], after.shift)]
    }

    /// Lengths of the edges as they lie \[m\].
    #[must_use]
    pub fn lengths(&self) -> Vec<f64> {
        self.edge_vectors().map(|d| dot(d, d).sqrt()).collect()
    }

    /// From the first to the last vertex of each edge as it lies \[m\].
    pub(super) fn edge_vectors(&self) -> impl Iterator<Item = [f64; 3]> {
        self.edges.iter().map(|edge| sub(self.image(edge.ends[1], edge.shift), self.image(edge.ends[0], [0, 0])))
    }

    /// The same tile at rest as it lies: no edge stretched, no vertex bent, no yarn wound.
    #[must_use]
    pub fn at_rest_as_it_lies(&self) -> Self {
        Self { rest: RestShape::of(self), ..self.clone() }
    }

    /// The same tile with other periods \[m\]: its yarns go along evenly, and are at rest as they then lie.
    ///
    /// # Panics
    /// If a period is not positive.
    #[must_use]
    pub fn with_periods(&self, periods: [f64; 2]) -> Self {
        assert!(periods.iter().all(|&period| period > 0.0));
        let factor = [0, 1].map(|axis| periods[axis] / self.periods[axis]);
        let vertices = self.vertices.iter().map(|x| [factor[0] * x[0], factor[1] * x[1], x[2]]).collect();
        Self { periods, vertices, ..self.clone() }.at_rest_as_it_lies()
    }

    /// Several tiles beside each other as one.
    ///
    /// # Errors
    /// [`TileFault::Count`] if a count is zero or the tile becomes too large; [`TileFault::Edge`] if an edge is so short that rounding
    /// takes its length away beside others.
    pub fn repeated(&self, counts: [usize; 2]) -> Result<Self, TileFault> {
        let n = self.vertices.len();
        let found = n.saturating_mul(counts[0]).saturating_mul(counts[1]);
        if !(1..=MOST_VERTICES).contains(&found) {
            return Err(TileFault::Count { what: "vertices", found, wanted: found.clamp(1, MOST_VERTICES) });
        }
        let counts_signed = counts.map(|count| count as i32);
        let (mut vertices, mut edges) = (Vec::new(), Vec::new());
        for j in 0..counts_signed[1] {
            for i in 0..counts_signed[0] {
                let place =
                    |vertex: u32, tile: [i32; 2]| (tile[1] * counts_signed[0] + tile[0]) as u32 * n as u32 + vertex;
                vertices.extend((0..n as u32).map(|vertex| self.image(vertex, [i, j])));
                edges.extend(self.edges.iter().map(|edge| {
                    let to = [i + edge.shift[0], j + edge.shift[1]];
                    let shift = [0, 1].map(|axis| to[axis].div_euclid(counts_signed[axis]));
                    let within = [0, 1].map(|axis| to[axis].rem_euclid(counts_signed[axis]));
                    Edge { ends: [place(edge.ends[0], [i, j]), place(edge.ends[1], within)], shift }
                }));
            }
        }
        let copies = counts[0] * counts[1];
        let periods = [0, 1].map(|axis| self.periods[axis] * counts[axis] as f64);
        let tile = Self::new(periods, self.radius, vertices, edges)?;
        Ok(Self { rest: self.rest.repeated(copies), ..tile })
    }
}

/// A tile as it is written.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Written {
    periods: [f64; 2],
    radius: f64,
    vertices: Vec<[f64; 3]>,
    edges: Vec<Edge>,
    rest: RestShape,
}

impl From<YarnTile> for Written {
    fn from(tile: YarnTile) -> Self {
        let YarnTile { periods, radius, vertices, edges, rest, .. } = tile;
        Self { periods, radius, vertices, edges, rest }
    }
}

impl TryFrom<Written> for YarnTile {
    type Error = TileFault;
    fn try_from(w: Written) -> Result<Self, TileFault> {
        Self::new(w.periods, w.radius, w.vertices, w.edges)?.with_rest(w.rest)
    }
}

/// Of each vertex the edge that ends and the one that begins there.
fn ends(n: usize, edges: &[Edge]) -> Result<Vec<[u32; 2]>, TileFault> {
    let mut counts = vec![[0usize; 2]; n];
    let mut around = vec![[0u32; 2]; n];
    for (index, edge) in edges.iter().enumerate() {
        if edge.shift.iter().any(|&s| !(-MOST_SHIFT..=MOST_SHIFT).contains(&s)) {
            return Err(TileFault::Edge { edge: index, why: "leads more than eight tiles away" });
        }
        for (side, &vertex) in edge.ends.iter().rev().enumerate() {
            let Some(count) = counts.get_mut(vertex as usize) else {
                return Err(TileFault::Edge { edge: index, why: "names a vertex that is not there" });
            };
            count[side] += 1;
            around[vertex as usize][side] = index as u32;
        }
    }
    if let Some(vertex) = counts.iter().position(|&count| count != [1, 1]) {
        return Err(TileFault::Fork { vertex, ending: counts[vertex][0], beginning: counts[vertex][1] });
    }
    Ok(around)
}

/// Edges of each yarn in their order, from its first in the list.
fn yarns(edges: &[Edge], around: &[[u32; 2]]) -> Vec<Vec<u32>> {
    let mut seen = vec![false; edges.len()];
    let mut yarns = Vec::new();
    for first in 0..edges.len() {
        let (mut yarn, mut edge) = (Vec::new(), first);
        while !seen[edge] {
            seen[edge] = true;
            yarn.push(edge as u32);
            edge = around[edges[edge].ends[1] as usize][1] as usize;
        }
        if !yarn.is_empty() {
            yarns.push(yarn);
        }
    }
    yarns
}

#[cfg(test)]
mod tests {
    use super::super::test_tiles::{basket, straight};
    use super::*;

    #[test]
    fn a_yarn_thicker_than_its_repeat_is_long_is_refused() {
        let tile = straight(8);
        let periods = tile.periods();
        let radius = 0.6 * (periods[0] + periods[1]);
        let fault = YarnTile::new(periods, radius, tile.vertices().to_vec(), tile.edges().to_vec()).unwrap_err();
        assert!(matches!(fault, TileFault::Thick { .. }) && fault.to_string().contains("one unit"), "{fault}");
        assert!(matches!(tile.repeated([0, 2]), Err(TileFault::Count { .. })));
        assert!(matches!(tile.repeated([usize::MAX, 2]), Err(TileFault::Count { .. })));
    }

    #[test]
    fn a_doubled_tile_has_the_same_lengths_and_more_yarns_across() {
        let tile = basket();
        let doubled = tile.repeated([2, 3]).unwrap();
        assert_eq!(doubled.vertex_count(), 6 * tile.vertex_count());
        assert!((doubled.area() - 6.0 * tile.area()).abs() < 1e-12 * tile.area());
        // Two warp and two weft yarns: twice as many side by side, three times above each other.
        assert_eq!((tile.yarn_count(), doubled.yarn_count()), (4, 2 * 2 + 2 * 3));
        let (once, often) = (tile.lengths(), doubled.lengths());
        assert!(often.iter().enumerate().all(|(i, l)| (l - once[i % once.len()]).abs() < 1e-12));
        let (once, often) = (RestShape::of(&tile).curvatures, RestShape::of(&doubled).curvatures);
        assert!(often.iter().enumerate().all(|(i, l)| (l - once[i % once.len()]).abs() < 1e-9));
    }

    #[test]
    fn what_is_no_tile_is_refused() {
        let good = straight(4);
        let remade = |change: &dyn Fn(&mut YarnTile)| {
            let mut t = good.clone();
            change(&mut t);
            YarnTile::new(t.periods, t.radius, t.vertices, t.edges)?.with_rest(t.rest)
        };
        assert_eq!(remade(&|_| {}), Ok(good.clone()));
        assert!(matches!(remade(&|t| t.periods[1] = 0.0), Err(TileFault::Size { .. })));
        assert!(matches!(remade(&|t| t.radius = f64::NAN), Err(TileFault::Size { .. })));
        assert!(matches!(remade(&|t| t.edges.truncate(3)), Err(TileFault::Count { found: 3, wanted: 4, .. })));
        assert!(matches!(remade(&|t| t.vertices[2][1] = f64::INFINITY), Err(TileFault::Vertex { vertex: 2 })));
        assert!(matches!(remade(&|t| t.edges[1].ends[0] = 9), Err(TileFault::Edge { edge: 1, .. })));
        assert!(matches!(remade(&|t| t.edges[1].shift[0] = 90), Err(TileFault::Edge { edge: 1, .. })));
        assert!(matches!(remade(&|t| t.edges[1].ends[0] = 0), Err(TileFault::Fork { vertex: 0, beginning: 2, .. })));
        assert!(matches!(remade(&|t| t.rest.lengths[3] = -1.0), Err(TileFault::Rest { index: 3, .. })));
        assert!(matches!(remade(&|t| t.rest.curvatures[3] = f64::NAN), Err(TileFault::Rest { index: 3, .. })));
        assert!(matches!(remade(&|t| t.vertices[1] = t.vertices[0]), Err(TileFault::Edge { edge: 0, .. })));
    }
}
