//! Three edges of a yarn that turn: products of their unit vectors, and what derivatives of energies of these are made of.

use wale_numerics::jet::Real;
use wale_numerics::jet::vector3::{cross, dot, scale, sub};

use super::element::point;

/// Products of the unit vectors along three edges, with their derivatives as the vectors turn.
pub(super) struct EdgeTurns {
    /// `t₀·t₁`, `t₁·t₂`, `t₀·t₂` and `t₀·(t₁×t₂)`.
    pub values: [f64; 4],
    /// Lengths of the edges \[m\].
    lengths: [f64; 3],
    /// Two unit vectors across each edge, and that along it.
    frames: [[[f64; 3]; 3]; 3],
}

/// Which two edges the first three products are of.
const PAIRS: [[usize; 2]; 3] = [[0, 1], [1, 2], [0, 2]];

impl EdgeTurns {
    pub fn new(q: &[f64; 12]) -> Self {
        let edges: [[f64; 3]; 3] = std::array::from_fn(|k| sub(point(q, 3 * k + 3), point(q, 3 * k)));
        let lengths = edges.map(|d| dot(d, d).sqrt());
        let t: [[f64; 3]; 3] = std::array::from_fn(|k| scale(edges[k], 1.0 / lengths[k]));
        let frames = t.map(|t| {
            let axis = if t[0].abs() < 0.6 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
            let n = cross(t, axis);
            let n = scale(n, 1.0 / dot(n, n).sqrt());
            [n, cross(t, n), t]
        });
        let values = invariants(&edges);
        Self { values, lengths, frames }
    }

    /// Derivatives of the four products by two turns of each edge.
    pub fn gradients(&self) -> [[f64; 6]; 4] {
        let t = self.frames.map(|frame| frame[2]);
        let mut out = [[0.0; 6]; 4];
        for k in 0..2 {
            for (row, [a, b]) in PAIRS.iter().enumerate() {
                out[row][2 * a + k] = dot(self.frames[*a][k], t[*b]);
                out[row][2 * b + k] = dot(self.frames[*b][k], t[*a]);
            }
            for a in 0..3 {
                out[3][2 * a + k] = dot(self.frames[a][k], cross(t[(a + 1) % 3], t[(a + 2) % 3]));
            }
        }
        out
    }

    /// Adds second derivatives of the products, times a factor each, by turns of two edges; those of one edge alone follow from the
    /// products, which are linear in it.
    pub fn add_second(&self, factors: &[f64; 4], matrix: &mut [[f64; 6]; 6]) {
        let t = self.frames.map(|frame| frame[2]);
        for (row, &[a, b]) in PAIRS.iter().enumerate() {
            // t₀·(t₁×t₂) = t_a·(t_b×t_c) for (0, 1, 2) and (1, 2, 0), its opposite for (0, 2, 1).
            let third = scale(t[3 - a - b], if b == a + 1 { factors[3] } else { -factors[3] });
            for i in 0..2 {
                for j in 0..2 {
                    let (m, n) = (self.frames[a][i], self.frames[b][j]);
                    let value = factors[row] * dot(m, n) + dot(cross(m, n), third);
                    matrix[2 * a + i][2 * b + j] += value;
                    matrix[2 * b + j][2 * a + i] += value;
                }
            }
        }
        let [u, v, w, volume]: [f64; 4] = std::array::from_fn(|k| factors[k] * self.values[k]);
        for (a, alone) in [u + w + volume, u + v + volume, v + w + volume].into_iter().enumerate() {
            for i in 0..2 {
                matrix[2 * a + i][2 * a + i] -= alone;
            }
        }
    }

    /// The gradient by the four vertices, from that by turns.
    pub fn spread(&self, by_turn: &[f64; 6]) -> [f64; 12] {
        let mut out = [0.0; 12];
        for a in 0..3 {
            for i in 0..3 {
                let value = (0..2).map(|k| by_turn[2 * a + k] * self.frames[a][k][i]).sum::<f64>() / self.lengths[a];
                out[3 * a + 3 + i] += value;
                out[3 * a + i] -= value;
            }
        }
        out
    }

    /// Adds the Hessian by the four vertices, from second derivatives by turns, and `tilt` times what of it changes lengths.
    pub fn add_hessian(&self, turns: &[[f64; 6]; 6], by_turn: &[f64; 6], tilt: f64, hessian: &mut [[f64; 12]; 12]) {
        for a in 0..3 {
            for b in 0..3 {
                let mut local = [[0.0; 3]; 3];
                for k in 0..2 {
                    local[k] = [turns[2 * a + k][2 * b], turns[2 * a + k][2 * b + 1], 0.0];
                    if a == b {
                        local[k][2] = -tilt * by_turn[2 * a + k];
                    }
                }
                if a == b {
                    local[2] = [local[0][2], local[1][2], 0.0];
                }
                let (left, right) = (&self.frames[a], &self.frames[b]);
                let over = 1.0 / (self.lengths[a] * self.lengths[b]);
                for j in 0..3 {
                    let column: [f64; 3] =
                        std::array::from_fn(|k| over * (0..3).map(|l| local[k][l] * right[l][j]).sum::<f64>());
                    for i in 0..3 {
                        let value: f64 = (0..3).map(|k| left[k][i] * column[k]).sum();
                        let (row, place) = (3 * a + i, 3 * b + j);
                        hessian[row][place] += value;
                        hessian[row + 3][place + 3] += value;
                        hessian[row][place + 3] -= value;
                        hessian[row + 3][place] -= value;
                    }
                }
            }
        }
    }
}

/// `t₀·t₁`, `t₁·t₂`, `t₀·t₂` and `t₀·(t₁×t₂)` of the unit vectors along three edges.
pub(super) fn invariants<T: Real>(edges: &[[T; 3]; 3]) -> [T; 4] {
    let unit = edges.map(|d| scale(d, T::constant(1.0) / dot(d, d).sqrt()));
    let [before, edge, after] = unit;
    [dot(before, edge), dot(edge, after), dot(before, after), dot(before, cross(edge, after))]
}
