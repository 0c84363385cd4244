//! Weights that carry motions of a coarse grid to the blocks of a fine one.

/// Each block moves with a weighted mean of at most four coarse nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Prolongation {
    pub(crate) coarse_nodes: usize,
    pub(crate) corners: Vec<[u32; 4]>,
    pub(crate) weights: Vec<[f64; 4]>,
}

impl Prolongation {
    /// Given corners and weights; a corner of weight zero is not used.
    ///
    /// # Panics
    /// If a corner is not below `coarse_nodes` or the lengths differ.
    pub fn new(coarse_nodes: usize, corners: Vec<[u32; 4]>, weights: Vec<[f64; 4]>) -> Self {
        assert_eq!(corners.len(), weights.len());
        let inside = |corner: &u32| (*corner as usize) < coarse_nodes;
        assert!(corners.as_flattened().iter().all(inside));
        Self { coarse_nodes, corners, weights }
    }

    /// Bilinear hats about `spacing` apart over blocks at planar `coordinates`, in grid units
    /// (wale and course).
    ///
    /// The spacing is stretched in each direction so that whole cells cover the extent. Coarse
    /// nodes are numbered with the first coordinate running fastest, as nodes along courses are.
    ///
    /// # Panics
    /// If a coordinate is not finite or the spacing not positive.
    pub fn bilinear(coordinates: &[[f64; 2]], spacing: f64) -> Self {
        assert!(spacing > 0.0 && coordinates.as_flattened().iter().all(|v| v.is_finite()));
        let axis = |k: usize| {
            let least = coordinates.iter().map(|c| c[k]).fold(f64::INFINITY, f64::min);
            let most = coordinates.iter().map(|c| c[k]).fold(f64::NEG_INFINITY, f64::max);
            let extent = (most - least).max(0.0);
            if extent < 1e-9 * spacing {
                return (least, 1.0, 0);
            }
            let cells = (extent / spacing).round().max(1.0);
            (least, extent / cells, cells as usize)
        };
        let axes = [axis(0), axis(1)];
        let nodes_across = axes[0].2 + 1;
        // Cell and place within it; the last node belongs to the last cell.
        let locate = |value: f64, (least, step, cells): (f64, f64, usize)| {
            let place = ((value - least) / step).clamp(0.0, cells as f64);
            let cell = (place as usize).min(cells.saturating_sub(1));
            (cell, (cell + 1).min(cells), place - cell as f64)
        };
        let mut corners = Vec::with_capacity(coordinates.len());
        let mut weights = Vec::with_capacity(coordinates.len());
        for coordinate in coordinates {
            let (left, right, s) = locate(coordinate[0], axes[0]);
            let (low, high, t) = locate(coordinate[1], axes[1]);
            let node = |across: usize, up: usize| (up * nodes_across + across) as u32;
            corners.push([node(left, low), node(right, low), node(left, high), node(right, high)]);
            weights.push([(1.0 - s) * (1.0 - t), s * (1.0 - t), (1.0 - s) * t, s * t]);
        }
        Self::new(nodes_across * (axes[1].2 + 1), corners, weights)
    }

    /// Leaves the blocks from `first` on out of all coarse motions: they have no place.
    #[must_use]
    pub fn without_blocks_from(mut self, first: usize) -> Self {
        let first = first.min(self.weights.len());
        self.weights[first..].fill([0.0; 4]);
        self
    }

    /// Number of coarse nodes.
    pub fn coarse_nodes(&self) -> usize {
        self.coarse_nodes
    }

    /// The coarse nodes and weights a block moves with; unused corners have weight zero.
    pub fn weights_of(&self, block: usize) -> (&[u32; 4], &[f64; 4]) {
        (&self.corners[block], &self.weights[block])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hats_sum_to_one_and_carry_linear_motions_exactly() {
        let coordinates: Vec<[f64; 2]> =
            (0..200).map(|i| [(i * 37 % 101) as f64 * 0.31, (i * 53 % 89) as f64 * 0.17]).collect();
        let hats = Prolongation::bilinear(&coordinates, 6.0);
        // Extents 31 and 15 units in cells of about six.
        assert_eq!(hats.coarse_nodes(), 6 * 3);
        let least = [0, 1].map(|k| coordinates.iter().map(|c| c[k]).fold(f64::MAX, f64::min));
        let most = [0, 1].map(|k| coordinates.iter().map(|c| c[k]).fold(f64::MIN, f64::max));
        for (block, coordinate) in coordinates.iter().enumerate() {
            let (corners, weights) = hats.weights_of(block);
            assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-14);
            assert!(weights.iter().all(|&w| (-1e-12..=1.0 + 1e-12).contains(&w)));
            let place = |corner: u32| {
                let (across, up) = (corner % 6, corner / 6);
                [
                    least[0] + f64::from(across) * (most[0] - least[0]) / 5.0,
                    least[1] + f64::from(up) * (most[1] - least[1]) / 2.0,
                ]
            };
            for k in 0..2 {
                let mean: f64 = (0..4).map(|c| weights[c] * place(corners[c])[k]).sum();
                assert!((mean - coordinate[k]).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_line_and_a_point_have_hats_too() {
        let line: Vec<[f64; 2]> = (0..13).map(|i| [f64::from(i), 2.5]).collect();
        assert_eq!(Prolongation::bilinear(&line, 6.0).coarse_nodes(), 3);
        let point = Prolongation::bilinear(&[[1.0, 1.0]; 4], 6.0);
        assert_eq!(point.coarse_nodes(), 1);
        assert_eq!(point.weights_of(3).1, &[1.0, 0.0, 0.0, 0.0]);
    }
}
