//! Whether a registered tile can be a fabric: yarns that go on where they leave the tile, and that do not pass through each other.

use thiserror::Error;

use super::closest::segment_distance;
use super::coarse::CoarseDeformation;
use super::neighbours::{Followers, Pair, near_pairs};
use super::tile::YarnTile;

/// Why a tile is no fabric.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Unsound {
    /// An edge is far from its rest length.
    #[error(
        "its yarns do not close: the edge from vertex {from} to vertex {to} is {times:.2} times as long as at rest; shift the \
         vertices, or give the period at which they meet"
    )]
    Jumps {
        /// Vertex at which the edge begins.
        from: u32,
        /// Vertex at which it ends.
        to: u32,
        /// Its length over its rest length \[–\].
        times: f64,
    },
    /// Centrelines all but meet.
    #[error(
        "its yarns pass through each other near the vertices {first} and {second}: their centrelines come to {part:.3} radii; \
         lay one over the other"
    )]
    Meet {
        /// Vertex of one yarn.
        first: u32,
        /// Vertex of the other.
        second: u32,
        /// Distance of the centrelines over the radius \[–\].
        part: f64,
    },
}

/// Registered rest lengths are those of the yarn as it lies, or of a yarn that is stretched by less than this.
const MOST_STRETCH: f64 = 2.0;
/// Distance of centrelines, over the radius, at which two yarns are one: touching ones are two radii apart, flattened ones half of it.
const LEAST_DISTANCE: f64 = 0.1;

/// Why a tile is no fabric, if it is none.
#[must_use]
pub fn unsound(tile: &YarnTile) -> Option<Unsound> {
    for ((edge, length), rest) in tile.edges().iter().zip(tile.lengths()).zip(&tile.rest().lengths) {
        let times = length / rest;
        if !(1.0 / MOST_STRETCH..=MOST_STRETCH).contains(&times) {
            return Some(Unsound::Jumps { from: edge.ends[0], to: edge.ends[1], times });
        }
    }
    let (pair, distance) = distances(tile, tile.radius()).into_iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let vertex = |edge: u32| tile.edges()[edge as usize].ends[0];
    (distance < LEAST_DISTANCE * tile.radius()).then(|| Unsound::Meet {
        first: vertex(pair.first),
        second: vertex(pair.second),
        part: distance / tile.radius(),
    })
}

/// Pairs of edges that come nearer to each other than a distance \[m\], as they lie, with what is between them. Edges that follow each
/// other on a yarn are none.
pub(super) fn distances(tile: &YarnTile, within: f64) -> Vec<(Pair, f64)> {
    let followers = Followers::new(tile, std::f64::consts::PI * tile.radius());
    let segment = |edge: u32, shift: [i32; 2]| tile.ends(edge, shift).map(|(vertex, shift)| tile.image(vertex, shift));
    let pairs = near_pairs(tile, &CoarseDeformation::REST, tile.vertices(), &followers, within);
    pairs
        .into_iter()
        .map(|pair| {
            let distance = segment_distance(segment(pair.first, [0, 0]), segment(pair.second, pair.shift));
            (pair, distance)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::test_tiles::{basket, stockinette, straight};
    use super::*;

    #[test]
    fn fabrics_are_sound() {
        for tile in [basket(), stockinette(), straight(5)] {
            assert_eq!(unsound(&tile), None);
        }
    }

    #[test]
    fn yarns_that_do_not_close_are_found() {
        // A longer period leaves a gap that the last edge bridges.
        let tile = basket();
        let [px, py] = tile.periods();
        let (vertices, edges) = (tile.vertices().to_vec(), tile.edges().to_vec());
        let open = YarnTile::new([1.4 * px, py], tile.radius(), vertices, edges)
            .and_then(|open| open.with_rest(tile.rest().clone()))
            .expect("numbers");
        let found = unsound(&open);
        assert!(matches!(found, Some(Unsound::Jumps { times, .. }) if times > 2.0), "{found:?}");
    }

    #[test]
    fn yarns_that_pass_through_each_other_are_found() {
        let tile = basket();
        let flat: Vec<[f64; 3]> = tile.vertices().iter().map(|&[x, y, _]| [x, y, 0.0]).collect();
        let edges = tile.edges().to_vec();
        let found = unsound(&YarnTile::new(tile.periods(), tile.radius(), flat, edges).expect("numbers"));
        assert!(matches!(found, Some(Unsound::Meet { part, .. }) if part < 1e-9), "{found:?}");
    }
}
