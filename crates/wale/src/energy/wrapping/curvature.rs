//! Second derivatives of a wrap: the exact ones of its angle and its weights, and a bound of their size.

use wale_numerics::check::Local;
use wale_numerics::jet::vector3::{cross, dot, scale, sub};

use super::{FADE, Hinge};
use crate::energy::element::point;

/// What of a term's curvature comes from its angle and from its two weights, for [`add_curvature_size`].
pub(super) struct Curvature {
    /// `|∂V/∂ψ|` \[J\].
    slope: f64,
    /// For the sides of `x₄` and `x₃`: size of the curvature by the weight across the axis, outwards and around, times
    /// the side's length squared \[J\].
    fading: [[f64; 2]; 2],
}

impl Curvature {
    pub(super) fn new(stiffness: f64, deviation: f64, sine_squares: [f64; 2]) -> Self {
        let weights = sine_squares.map(|s2| s2 / (s2 + FADE));
        let weight = weights[0] * weights[1];
        let fading = std::array::from_fn(|side| {
            // The weight by the sine s: ω′/s and |ω″|; the angle and the weight together add the mixed term's size.
            let s2 = sine_squares[side];
            let around = 2.0 * FADE / ((s2 + FADE) * (s2 + FADE));
            let outwards = around * (FADE - 3.0 * s2).abs() / (s2 + FADE);
            let other = stiffness * weights[1 - side] * deviation.abs();
            let mixed = other * around;
            [0.5 * other * deviation.abs() * outwards + mixed, 0.5 * other * deviation.abs() * around + mixed]
        });
        Self { slope: stiffness * weight * deviation.abs(), fading }
    }
}

/// Adds the size of a term's curvature: across the axis at a distance `ρ` a side turns `ψ` by `1/ρ²` a square of its
/// motion, with either sign, so that `slope/ρ²` in both directions across bounds it; and where a side comes near the
/// axis its weight falls within a tenth of the side's length, which is the sharpest of all that bends here.
pub(super) fn add_curvature_size(q: &[f64; 12], curvature: &Curvature, factor: f64, local: &mut Local<12>) {
    let (x0, x1, x3, x4) = (point(q, 0), point(q, 3), point(q, 6), point(q, 9));
    let axis = sub(x1, x0);
    let length = dot(axis, axis).sqrt();
    let e = scale(axis, 1.0 / length);
    // Each side from its own foot on the axis, as the sines are measured.
    for (k, (side, foot, node)) in [(sub(x4, x0), 0.0, 3), (sub(x3, x1), 1.0, 2)].into_iter().enumerate() {
        let along = dot(side, e);
        let across = sub(side, scale(e, along));
        let (distance2, side2) = (dot(across, across), dot(side, side));
        let radial = if distance2 > 1e-12 * side2 {
            scale(across, 1.0 / distance2.sqrt())
        } else {
            // On the axis: any direction across will do.
            let other = if e[0].abs() < 0.6 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
            let across = cross(e, other);
            scale(across, 1.0 / dot(across, across).sqrt())
        };
        let by_angle = curvature.slope / distance2.max(1e-6 * side2);
        let s = foot + along / length;
        for (direction, fading) in [radial, cross(e, radial)].into_iter().zip(curvature.fading[k]) {
            let mut g = [0.0; 12];
            for k in 0..3 {
                g[k] = -(1.0 - s) * direction[k];
                g[3 + k] = -s * direction[k];
                g[3 * node + k] = direction[k];
            }
            local.add_square(factor * (by_angle + fading / side2), &g);
        }
    }
}

/// Adds `factor` times the Hessian of the wrapping angle by `x₀ x₁ x₃ x₄`.
///
/// By the axis `A = x₁ − x₀` and the sides `p = x₄ − x₁`, `r = x₃ − x₁`, with `m = v/|v|²` of `v_a = A × p` and
/// `v_b = r × A`, the gradient of `ψ` is `(p·e) m_a + (r·e) m_b`, `−|A| m_a`, `−|A| m_b`; this is its derivative, a
/// shorter form of [Cirio2017, Eq. 16].
pub(super) fn add_angle_curvature(q: &[f64; 12], factor: f64, hessian: &mut [[f64; 12]; 12]) {
    let (x0, x1, x3, x4) = (point(q, 0), point(q, 3), point(q, 6), point(q, 9));
    let (axis, p, r) = (sub(x1, x0), sub(x4, x1), sub(x3, x1));
    let length = dot(axis, axis).sqrt();
    let e = scale(axis, 1.0 / length);
    let (va, vb) = (cross(axis, p), cross(r, axis));
    let (a2, b2) = (dot(va, va), dot(vb, vb));
    if a2 < 1e-60 || b2 < 1e-60 {
        return;
    }
    let (ma, mb) = (scale(va, 1.0 / a2), scale(vb, 1.0 / b2));
    let (pe, re) = (dot(p, e), dot(r, e));
    // D = ∂m/∂v; `D [w]×` row by row: row i is (Dᵢ) × w, as Dᵢ·(w × x) = (Dᵢ × w)·x.
    let times = |m: [f64; 3], v2: f64, w: [f64; 3]| -> [[f64; 3]; 3] {
        std::array::from_fn(|i| {
            let row: [f64; 3] = std::array::from_fn(|j| f64::from(u8::from(i == j)) / v2 - 2.0 * m[i] * m[j]);
            cross(row, w)
        })
    };
    let (da_axis, da_p) = (times(ma, a2, axis), times(ma, a2, p));
    let (db_axis, db_r) = (times(mb, b2, axis), times(mb, b2, r));
    // Blocks by (A, p, r); the p–r block is zero.
    let mut by = [[[[0.0; 3]; 3]; 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            by[1][1][i][j] = -length * da_axis[i][j];
            by[2][2][i][j] = length * db_axis[i][j];
            by[1][0][i][j] = -ma[i] * e[j] + length * da_p[i][j];
            by[2][0][i][j] = -mb[i] * e[j] - length * db_r[i][j];
            by[0][0][i][j] =
                (ma[i] * (p[j] - pe * e[j]) + mb[i] * (r[j] - re * e[j])) / length - pe * da_p[i][j] + re * db_r[i][j];
        }
    }
    for i in 0..3 {
        for j in 0..3 {
            by[0][1][i][j] = by[1][0][j][i];
            by[0][2][i][j] = by[2][0][j][i];
        }
    }
    // x₀ x₁ x₃ x₄ in terms of A, p, r.
    const SIGNS: [[f64; 3]; 4] = [[-1.0, 0.0, 0.0], [1.0, -1.0, -1.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]];
    for a in 0..4 {
        for b in 0..4 {
            for s in 0..3 {
                for t in 0..3 {
                    let sign = factor * SIGNS[a][s] * SIGNS[b][t];
                    if sign != 0.0 {
                        for i in 0..3 {
                            for j in 0..3 {
                                hessian[3 * a + i][3 * b + j] += sign * by[s][t][i][j];
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Adds what the weights do to the exact Hessian of a term `½ k ω_a ω_b D²`.
pub(super) fn add_weight_curvature(
    q: &[f64; 12],
    hinge: &Hinge,
    stiffness: f64,
    deviation: f64,
    sign: f64,
    factor: f64,
    local: &mut Local<12>,
) {
    let (x0, x1, x3, x4) = (point(q, 0), point(q, 3), point(q, 6), point(q, 9));
    let axis = sub(x1, x0);
    let half = 0.5 * stiffness * deviation * deviation;
    let weights = hinge.sine_squares.map(|s2| s2 / (s2 + FADE));
    let slopes = hinge.sine_squares.map(|s2| FADE / ((s2 + FADE) * (s2 + FADE)));
    let [a, b] = &hinge.sine_gradient;
    // Angle and weight, then both weights.
    let mixed = factor * stiffness * deviation * sign;
    let by_weight: [f64; 12] = std::array::from_fn(|i| slopes[0] * weights[1] * a[i] + slopes[1] * weights[0] * b[i]);
    local.add_symmetric(2.0 * mixed, &hinge.gradient, &by_weight);
    local.add_symmetric(2.0 * factor * half * slopes[0] * slopes[1], a, b);
    for (k, (side, from, to)) in [(sub(x4, x0), 0, 9), (sub(x3, x1), 3, 6)].into_iter().enumerate() {
        let other = factor * half * weights[1 - k];
        let bent = -2.0 * slopes[k] / (hinge.sine_squares[k] + FADE);
        local.add_square(other * bent, &hinge.sine_gradient[k]);
        // sin² = 1 − c², c the cosine of axis and side: −2 (c ∇∇c + ∇c ∇cᵀ).
        let (l1, l2) = (dot(axis, axis).sqrt(), dot(side, side).sqrt());
        let (t1, t2) = (scale(axis, 1.0 / l1), scale(side, 1.0 / l2));
        let c = dot(t1, t2);
        let g1: [f64; 3] = std::array::from_fn(|i| (t2[i] - c * t1[i]) / l1);
        let g2: [f64; 3] = std::array::from_fn(|i| (t1[i] - c * t2[i]) / l2);
        let f = -2.0 * other * slopes[k];
        for i in 0..3 {
            for j in 0..3 {
                let eye = f64::from(u8::from(i == j));
                let own = |t: &[f64; 3], g: &[f64; 3], l: f64| {
                    -(t[i] * g[j] + g[i] * t[j]) / l - c * (eye - t[i] * t[j]) / (l * l)
                };
                let aa = f * (c * own(&t1, &g1, l1) + g1[i] * g1[j]);
                let ss = f * (c * own(&t2, &g2, l2) + g2[i] * g2[j]);
                let m = (eye - t1[i] * t1[j] - t2[i] * t2[j] + c * t1[i] * t2[j]) / (l1 * l2);
                let mixed = f * (c * m + g1[i] * g2[j]);
                // The axis runs from slot 0 to slot 3, the side from `from` to `to`.
                for (row, sr) in [(0, -1.0), (3, 1.0)] {
                    for (column, sc) in [(0, -1.0), (3, 1.0)] {
                        local.hessian[row + i][column + j] += sr * sc * aa;
                    }
                    for (column, sc) in [(from, -1.0), (to, 1.0)] {
                        local.hessian[row + i][column + j] += sr * sc * mixed;
                        local.hessian[column + j][row + i] += sr * sc * mixed;
                    }
                }
                for (row, sr) in [(from, -1.0), (to, 1.0)] {
                    for (column, sc) in [(from, -1.0), (to, 1.0)] {
                        local.hessian[row + i][column + j] += sr * sc * ss;
                    }
                }
            }
        }
    }
}
