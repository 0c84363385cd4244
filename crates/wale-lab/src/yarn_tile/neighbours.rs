//! Which edges of a tile lie near which, over all its images.

use super::closest::segment_distance;
use super::coarse::{CoarseDeformation, times};
use super::tile::YarnTile;

/// Two edges near each other: the second lies in another tile, so many periods away.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Pair {
    pub first: u32,
    pub second: u32,
    pub shift: [i32; 2],
}

/// Most tiles that a yarn is followed through, and that are searched in each direction: what needs more is no fabric.
const MOST_TILES: i32 = 64;

/// For each edge those that follow on its yarn too soon to touch it.
///
/// Points of a yarn bent round its own radius `R` touch when `πR` of yarn lie between them; edges whose middles are
/// nearer along the yarn, and in any case neighbours, are no contacts.
#[derive(Clone, Debug)]
pub struct Followers {
    of_edge: Vec<Vec<(u32, [i32; 2])>>,
}

impl Followers {
    /// `between` is the length of yarn between the middles of edges that may touch \[m\].
    pub fn new(tile: &YarnTile, between: f64) -> Self {
        let lengths = &tile.rest.lengths;
        let follow = |first: usize| {
            let (mut found, mut shift) = (Vec::new(), tile.edges[first].shift);
            let mut edge = tile.around[tile.edges[first].ends[1] as usize][1] as usize;
            let mut along = 0.5 * (lengths[first] + lengths[edge]);
            while found.is_empty() || along < between {
                if shift.iter().any(|s| s.abs() > MOST_TILES) || found.len() > tile.edges.len() {
                    break;
                }
                found.push((edge as u32, shift));
                for axis in 0..2 {
                    shift[axis] += tile.edges[edge].shift[axis];
                }
                let next = tile.around[tile.edges[edge].ends[1] as usize][1] as usize;
                along += 0.5 * (lengths[edge] + lengths[next]);
                edge = next;
            }
            found
        };
        Self { of_edge: (0..tile.edges.len()).map(follow).collect() }
    }

    fn contains(&self, first: usize, second: u32, shift: [i32; 2]) -> bool {
        self.of_edge[first].contains(&(second, shift))
    }
}

/// All pairs of edges whose segments in the stretched plane are nearer than `within` \[m\], in the order of their numbers.
///
/// `flat` has the vertices of the tile in the stretched plane.
pub fn near_pairs(
    tile: &YarnTile,
    deformation: &CoarseDeformation,
    flat: &[[f64; 3]],
    followers: &Followers,
    within: f64,
) -> Vec<Pair> {
    let grid = Grid::new(tile, deformation, flat, within);
    let mut pairs = Vec::new();
    for first in 0..tile.edges.len() {
        grid.visit_near(first, |second, shift| {
            // Each pair once: the second has the higher number, or is a copy of the first farther on.
            if (second as usize, shift) <= (first, [0, 0]) {
                return;
            }
            let back = shift.map(|s| -s);
            if followers.contains(first, second, shift) || followers.contains(second as usize, first as u32, back) {
                return;
            }
            let offset = grid.lattice(shift);
            let other = grid.segments[second as usize].map(|x| [x[0] + offset[0], x[1] + offset[1], x[2]]);
            if segment_distance(grid.segments[first], other) < within {
                pairs.push(Pair { first: first as u32, second, shift });
            }
        });
    }
    pairs.sort_unstable();
    pairs
}

/// Edges sorted into the cells of a grid that covers one tile.
struct Grid {
    segments: Vec<[[f64; 3]; 2]>,
    /// Columns are the periods in the stretched plane.
    lattice: [[f64; 2]; 2],
    counts: [i32; 2],
    /// How many cells away an edge may be near.
    range: [i32; 2],
    /// Cell of each edge, and in which tile its middle lies.
    cell: Vec<([i32; 2], [i32; 2])>,
    members: Vec<Vec<u32>>,
}

impl Grid {
    fn new(tile: &YarnTile, deformation: &CoarseDeformation, flat: &[[f64; 3]], within: f64) -> Self {
        let columns = [0, 1].map(|axis| {
            let mut period = [0.0; 2];
            period[axis] = tile.periods[axis];
            times(&deformation.plane, period)
        });
        let lattice = [[columns[0][0], columns[1][0]], [columns[0][1], columns[1][1]]];
        let segments: Vec<[[f64; 3]; 2]> = tile
            .edges
            .iter()
            .map(|edge| {
                let offset = times(&lattice, edge.shift.map(f64::from));
                let [x, y, z] = flat[edge.ends[1] as usize];
                [flat[edge.ends[0] as usize], [x + offset[0], y + offset[1], z]]
            })
            .collect();
        let longest = segments
            .iter()
            .map(|[a, b]| (0..2).map(|i| (b[i] - a[i]).powi(2)).sum::<f64>().sqrt())
            .fold(0.0f64, f64::max);
        let determinant = lattice[0][0] * lattice[1][1] - lattice[0][1] * lattice[1][0];
        let inverse = [
            [lattice[1][1] / determinant, -lattice[0][1] / determinant],
            [-lattice[1][0] / determinant, lattice[0][0] / determinant],
        ];
        // Middles of edges that are near each other lie within this.
        let reach = within + longest;
        let across = inverse.map(|row| 1.0 / row[0].hypot(row[1]));
        let most = (tile.edges.len() as f64).sqrt().ceil();
        let counts = across.map(|width| (width / reach).floor().clamp(1.0, most) as i32);
        let range = [0, 1].map(|axis| {
            let cells = (reach * f64::from(counts[axis]) / across[axis]).ceil();
            cells.min(f64::from(MOST_TILES * counts[axis])) as i32
        });
        let mut members = vec![Vec::new(); (counts[0] * counts[1]) as usize];
        let mut cell = Vec::with_capacity(segments.len());
        for (index, [a, b]) in segments.iter().enumerate() {
            let middle = times(&inverse, [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]);
            let tile_of = middle.map(|u| u.floor());
            let within: [i32; 2] = std::array::from_fn(|axis| {
                let part = (middle[axis] - tile_of[axis]) * f64::from(counts[axis]);
                (part as i32).min(counts[axis] - 1)
            });
            members[(within[1] * counts[0] + within[0]) as usize].push(index as u32);
            cell.push((within, tile_of.map(|t| t as i32)));
        }
        Self { segments, lattice, counts, range, cell, members }
    }

    fn lattice(&self, shift: [i32; 2]) -> [f64; 2] {
        times(&self.lattice, shift.map(f64::from))
    }

    /// Calls `visit` with every edge, and its shift, whose middle may be near that of `first`.
    fn visit_near(&self, first: usize, mut visit: impl FnMut(u32, [i32; 2])) {
        let (own, own_tile) = self.cell[first];
        for v in -self.range[1]..=self.range[1] {
            for u in -self.range[0]..=self.range[0] {
                let to = [own[0] + u, own[1] + v];
                let tile: [i32; 2] = std::array::from_fn(|axis| to[axis].div_euclid(self.counts[axis]));
                let cell: [i32; 2] = std::array::from_fn(|axis| to[axis].rem_euclid(self.counts[axis]));
                for &second in &self.members[(cell[1] * self.counts[0] + cell[0]) as usize] {
                    let (_, other_tile) = self.cell[second as usize];
                    visit(second, std::array::from_fn(|axis| own_tile[axis] + tile[axis] - other_tile[axis]));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_tiles::{basket, stockinette};
    use super::*;

    /// Every pair within a few tiles, looked at one by one.
    fn one_by_one(tile: &YarnTile, deformation: &CoarseDeformation, within: f64, followers: &Followers) -> Vec<Pair> {
        let place = |vertex: u32, shift: [i32; 2]| {
            let x = tile.image(vertex, shift);
            let y = times(&deformation.plane, [x[0], x[1]]);
            [y[0], y[1], x[2]]
        };
        let segment = |edge: usize, shift: [i32; 2]| {
            let e = tile.edges[edge];
            [place(e.ends[0], shift), place(e.ends[1], [shift[0] + e.shift[0], shift[1] + e.shift[1]])]
        };
        let mut pairs = Vec::new();
        for first in 0..tile.edges.len() {
            for second in first..tile.edges.len() {
                for i in -4..=4 {
                    for j in -4..=4 {
                        let (shift, back) = ([i, j], [-i, -j]);
                        let again = second == first && shift <= [0, 0];
                        let follows = followers.contains(first, second as u32, shift)
                            || followers.contains(second, first as u32, back);
                        if !again
                            && !follows
                            && segment_distance(segment(first, [0, 0]), segment(second, shift)) < within
                        {
                            pairs.push(Pair { first: first as u32, second: second as u32, shift });
                        }
                    }
                }
            }
        }
        pairs
    }

    #[test]
    fn the_grid_finds_what_is_near_and_each_pair_once() {
        for tile in [basket(), stockinette(), stockinette().repeated([2, 1]).unwrap()] {
            let followers = Followers::new(&tile, std::f64::consts::PI * tile.radius);
            for plane in [[[1.0, 0.0], [0.0, 1.0]], [[1.6, 0.4], [-0.3, 0.7]], [[0.5, 0.0], [0.9, 1.1]]] {
                let deformation = CoarseDeformation { plane, ..CoarseDeformation::REST };
                let flat: Vec<[f64; 3]> = tile
                    .vertices
                    .iter()
                    .map(|x| {
                        let y = times(&plane, [x[0], x[1]]);
                        [y[0], y[1], x[2]]
                    })
                    .collect();
                for within in [2.2, 3.0].map(|r| r * tile.radius) {
                    let found = near_pairs(&tile, &deformation, &flat, &followers, within);
                    let mut expected = one_by_one(&tile, &deformation, within, &followers);
                    expected.sort_unstable();
                    assert!(!expected.is_empty());
                    assert_eq!(found, expected);
                }
            }
        }
    }

    #[test]
    fn neighbours_along_a_yarn_are_no_contacts() {
        let tile = stockinette();
        let followers = Followers::new(&tile, std::f64::consts::PI * tile.radius);
        for (edge, following) in followers.of_edge.iter().enumerate() {
            let mut along = 0.0;
            let mut last = edge;
            for &(next, _) in following {
                along += 0.5 * (tile.rest.lengths[last] + tile.rest.lengths[next as usize]);
                last = next as usize;
            }
            assert!(along < std::f64::consts::PI * tile.radius || following.len() == 1, "{along}");
        }
        // Round a yarn that closes in its own tile the walk ends.
        let short = Followers::new(&tile, 1e3 * tile.radius);
        assert!(short.of_edge.iter().all(|f| f.len() <= tile.edges.len() + 1));
    }
}
