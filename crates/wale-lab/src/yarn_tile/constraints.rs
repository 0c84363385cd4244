//! What keeps a tile from moving as a whole and its yarns from sliding along themselves.

use wale_numerics::block_matrix::SLOTS;
use wale_numerics::constrained::Pin;
use wale_numerics::jet::vector3::{dot as dot3, sub};
use wale_numerics::vector::dot;

use super::tile::YarnTile;

/// Linear constraints `C ũ = 0` with orthonormal rows, and as many pins that stop the same motions.
///
/// The mean of `ũ` is zero in all three directions, and so is, for each yarn, the mean of `ũ` along the yarn as it was drawn. They
/// do not depend on the coarse deformation, so that a derivative by it may hold `ũ` fixed. A yarn of this model has no
/// twist that could be constrained: its energies know no turning about itself.
#[derive(Clone, Debug)]
pub struct Constraints {
    pub rows: Vec<Vec<f64>>,
    pub pins: Vec<Pin>,
}

/// Part of a row that the others must leave for it to be one: a single straight yarn slides when the tile moves.
const LEAST_LEFT: f64 = 1e-3;

impl Constraints {
    pub fn new(tile: &YarnTile) -> Self {
        let n = tile.vertex_count();
        let mut constraints = Self { rows: Vec::new(), pins: Vec::new() };
        for axis in 0..3 {
            let row = (0..SLOTS * n).map(|slot| f64::from(u8::from(slot % SLOTS == axis))).collect();
            let direction = std::array::from_fn(|slot| f64::from(u8::from(slot == axis)));
            constraints.add(row, Pin { block: 0, direction });
        }
        for yarn in &tile.yarns {
            let mut row = vec![0.0; SLOTS * n];
            for &edge in yarn {
                let vertex = tile.edges[edge as usize].ends[0] as usize;
                row[SLOTS * vertex..SLOTS * vertex + 3].copy_from_slice(&tangent(tile, vertex));
            }
            // Away from the vertex that holds the tile, where the yarn has gone half its way.
            let vertex = tile.edges[yarn[yarn.len() / 2] as usize].ends[0] as usize;
            let mut direction = [0.0; SLOTS];
            direction[..3].copy_from_slice(&tangent(tile, vertex));
            constraints.add(row, Pin { block: vertex, direction });
        }
        constraints
    }

    /// Adds what of a row the others do not say already.
    fn add(&mut self, mut row: Vec<f64>, pin: Pin) {
        let before = dot(&row, &row).sqrt();
        self.project(&mut row);
        self.project(&mut row);
        let left = dot(&row, &row).sqrt();
        if left > LEAST_LEFT * before {
            row.iter_mut().for_each(|x| *x /= left);
            self.rows.push(row);
            self.pins.push(pin);
        }
    }

    /// Takes out of a vector what the constraints forbid.
    pub fn project(&self, x: &mut [f64]) {
        for row in &self.rows {
            let along = dot(row, x);
            x.iter_mut().zip(row).for_each(|(x, r)| *x -= along * r);
        }
    }
}

/// Unit vector along the yarn at a vertex.
fn tangent(tile: &YarnTile, vertex: usize) -> [f64; 3] {
    let [before, after] = tile.beside(vertex).map(|(v, shift)| tile.image(v, shift));
    let along = sub(after, before);
    let length = dot3(along, along).sqrt();
    // A yarn that turns back within two edges has no direction there.
    if length > 0.0 { along.map(|x| x / length) } else { [0.0; 3] }
}

#[cfg(test)]
mod tests {
    use super::super::test_tiles::{basket, stockinette, straight};
    use super::*;

    #[test]
    fn rows_are_orthonormal_and_as_many_as_motions() {
        for (tile, count) in [(straight(8), 3), (stockinette(), 4), (basket(), 7)] {
            let constraints = Constraints::new(&tile);
            assert_eq!((constraints.rows.len(), constraints.pins.len()), (count, count));
            for (i, a) in constraints.rows.iter().enumerate() {
                for (j, b) in constraints.rows.iter().enumerate() {
                    assert!((dot(a, b) - f64::from(u8::from(i == j))).abs() < 1e-12);
                }
            }
            let mut x: Vec<f64> = (0..SLOTS * tile.vertex_count()).map(|k| (k as f64).sin()).collect();
            constraints.project(&mut x);
            assert!(constraints.rows.iter().all(|row| dot(row, &x).abs() < 1e-12));
        }
    }
}
