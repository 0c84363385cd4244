//! The geometry of a wrap: its angle about the axis, the angles of its sides to the axis, and their first derivatives.

use wale_numerics::jet::vector3::{cross, dot, scale, sub};

use super::FADE;
use crate::energy::element::point;

/// By the axis `A = x₁ − x₀` and the sides `a = x₄ − x₀` and `b = x₃ − x₁`, in this order: everything here depends on
/// these nine numbers alone.
pub(super) type ByEdge = [[f64; 3]; 3];

/// The wrapping angle, the sines of both sides to the axis, and their gradients.
pub(super) struct Hinge {
    pub edges: ByEdge,
    /// Length of the axis, and the unit vector along it.
    pub length: f64,
    pub along: [f64; 3],
    /// `A × a` and `b × A` over their squares, zero for a side along the axis, and the squares.
    pub normals: [[f64; 3]; 2],
    pub normal_squares: [f64; 2],
    /// The signed angle `ψ` [Cirio2017, Eqs. 7–13] and its gradient [Eq. 14, in other variables].
    pub angle: f64,
    pub gradient: ByEdge,
    /// `sin²` of the angles between the axis and `a`, `b`, and their gradients.
    pub sine_squares: [f64; 2],
    pub sine_gradient: [ByEdge; 2],
}

impl Hinge {
    pub fn new(q: &[f64; 12]) -> Self {
        let (x0, x1, x3, x4) = (point(q, 0), point(q, 3), point(q, 6), point(q, 9));
        let edges = [sub(x1, x0), sub(x4, x0), sub(x3, x1)];
        let [axis, a, b] = edges;
        let axis_square = dot(axis, axis);
        let length = axis_square.sqrt();
        let along = scale(axis, 1.0 / length);
        let (va, vb) = (cross(axis, a), cross(b, axis));
        let normal_squares = [dot(va, va), dot(vb, vb)];
        let angle = dot(along, cross(va, vb)).atan2(dot(va, vb));
        // A side along the axis has weight zero; any finite direction will do there.
        let normals = [scale(va, 1.0 / normal_squares[0].max(1e-60)), scale(vb, 1.0 / normal_squares[1].max(1e-60))];
        let (ae, be) = (dot(a, along), dot(b, along));
        let gradient = [
            std::array::from_fn(|k| ae * normals[0][k] + be * normals[1][k]),
            scale(normals[0], -length),
            scale(normals[1], -length),
        ];
        // sin² = |v|²/(|axis|²|side|²), by side and by axis.
        let sine = |v: [f64; 3], v2: f64, side: [f64; 3]| {
            let side_square = dot(side, side);
            let factor = 2.0 / (axis_square * side_square);
            let s = 0.5 * v2 * factor;
            let by_side = sub(scale(cross(axis, v), factor), scale(side, 2.0 * s / side_square));
            let by_axis = sub(scale(cross(v, side), factor), scale(axis, 2.0 * s / axis_square));
            (s, by_axis, by_side)
        };
        let (sa, a_axis, a_side) = sine(scale(va, -1.0), normal_squares[0], a);
        let (sb, b_axis, b_side) = sine(vb, normal_squares[1], b);
        Self {
            edges,
            length,
            along,
            normals,
            normal_squares,
            angle,
            gradient,
            sine_squares: [sa, sb],
            sine_gradient: [[a_axis, a_side, [0.0; 3]], [b_axis, [0.0; 3], b_side]],
        }
    }
}

/// The weights `ω = sin²/(sin² + 0.1²)` of both sides, and their derivatives by `sin²`.
pub(super) struct Weights {
    pub value: [f64; 2],
    pub slope: [f64; 2],
    pub second: [f64; 2],
}

impl Weights {
    /// `ω_a ω_b`.
    pub fn product(&self) -> f64 {
        self.value[0] * self.value[1]
    }
}

impl Hinge {
    pub fn weights(&self) -> Weights {
        let value = self.sine_squares.map(|s2| s2 / (s2 + FADE));
        let slope = self.sine_squares.map(|s2| FADE / ((s2 + FADE) * (s2 + FADE)));
        Weights { value, slope, second: std::array::from_fn(|k| -2.0 * slope[k] / (self.sine_squares[k] + FADE)) }
    }
}

/// A gradient by edges as one by `x₀ x₁ x₃ x₄`.
pub(super) fn by_node([axis, a, b]: &ByEdge) -> [f64; 12] {
    let mut out = [0.0; 12];
    for k in 0..3 {
        out[k] = -axis[k] - a[k];
        out[3 + k] = axis[k] - b[k];
        out[6 + k] = b[k];
        out[9 + k] = a[k];
    }
    out
}
