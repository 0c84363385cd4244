//! Second derivatives of a wrap: the exact ones of its angle and its weights, and a bound of their size.

use wale_numerics::jet::vector3::{cross, dot, scale, sub};

use super::FADE;
use super::hinge::{ByEdge, Hinge, Weights};

/// Blocks of second derivatives by edges: axis–axis, axis–a, axis–b, a–a, a–b, b–b.
#[derive(Default)]
pub(super) struct Curvature([[[f64; 3]; 3]; 6]);

/// Block of the axis with a side, and of the side with itself.
const WITH_AXIS: [usize; 2] = [1, 2];
const WITH_ITSELF: [usize; 2] = [3, 5];

impl Curvature {
    /// Second derivatives of `½ stiffness ω_a ω_b deviation²`, `deviation = sign ψ − rest` (but for whole turns), between
    /// the exact (`convexity = 0`) and the convex ones.
    pub fn new(hinge: &Hinge, stiffness: f64, deviation: f64, sign: f64, convexity: f64) -> Self {
        let mut sum = Self::default();
        let weights = hinge.weights();
        let weight = weights.product();
        let exact = 1.0 - convexity;
        let slope = exact * stiffness * deviation * sign;
        let half = exact * 0.5 * stiffness * deviation * deviation;
        let [va, vb] = weights.value;
        let [sa, sb] = weights.slope;
        sum.add_products(
            [&hinge.gradient, &hinge.sine_gradient[0], &hinge.sine_gradient[1]],
            [
                [stiffness * weight, slope * sa * vb, slope * va * sb],
                [slope * sa * vb, half * weights.second[0] * vb, half * sa * sb],
                [slope * va * sb, half * sa * sb, half * va * weights.second[1]],
            ],
        );
        if exact > 0.0 {
            sum.add_angle(hinge, slope * weight);
            sum.add_sine(hinge, 0, half * sa * vb);
            sum.add_sine(hinge, 1, half * va * sb);
        }
        if convexity > 0.0 {
            sum.add_size(hinge, &weights, stiffness, deviation.abs(), convexity);
        }
        sum
    }

    /// Adds `Σ factor[r][s] g_r g_sᵀ` of three gradients, the factors symmetric.
    fn add_products(&mut self, gradients: [&ByEdge; 3], factors: [[f64; 3]; 3]) {
        let other: [ByEdge; 3] = factors.map(|row| {
            std::array::from_fn(|e| std::array::from_fn(|j| (0..3).map(|s| row[s] * gradients[s][e][j]).sum()))
        });
        for (block, [left, right]) in self.0.iter_mut().zip([[0, 0], [0, 1], [0, 2], [1, 1], [1, 2], [2, 2]]) {
            for (gradient, other) in gradients.iter().zip(&other) {
                for i in 0..3 {
                    for j in 0..3 {
                        block[i][j] += gradient[left][i] * other[right][j];
                    }
                }
            }
        }
    }

    /// Adds `factor` times the Hessian of the wrapping angle: the derivative of its gradient `(a·e) m_a + (b·e) m_b`,
    /// `−|A| m_a`, `−|A| m_b` with `m = v/|v|²` of `v_a = A × a`, `v_b = b × A`, a shorter form of [Cirio2017, Eq. 16].
    fn add_angle(&mut self, hinge: &Hinge, factor: f64) {
        let [axis, a, b] = hinge.edges;
        let (length, e) = (hinge.length, hinge.along);
        let ([a2, b2], [ma, mb]) = (hinge.normal_squares, hinge.normals);
        if a2 < 1e-60 || b2 < 1e-60 {
            return;
        }
        let (ae, be) = (dot(a, e), dot(b, e));
        // D = ∂m/∂v; `D [w]×` row by row: row i is (Dᵢ) × w, as Dᵢ·(w × x) = (Dᵢ × w)·x.
        let times = |m: [f64; 3], v2: f64, w: [f64; 3]| -> [[f64; 3]; 3] {
            std::array::from_fn(|i| {
                let row: [f64; 3] = std::array::from_fn(|j| eye(i, j) / v2 - 2.0 * m[i] * m[j]);
                cross(row, w)
            })
        };
        let (da_axis, da_a) = (times(ma, a2, axis), times(ma, a2, a));
        let (db_axis, db_b) = (times(mb, b2, axis), times(mb, b2, b));
        let [by_axis, axis_a, axis_b, by_a, _, by_b] = &mut self.0;
        for i in 0..3 {
            for j in 0..3 {
                let along = (ma[i] * (a[j] - ae * e[j]) + mb[i] * (b[j] - be * e[j])) / length;
                by_axis[i][j] += factor * (along - ae * da_a[i][j] + be * db_b[i][j]);
                // These two are found as side–axis.
                axis_a[j][i] += factor * (length * da_a[i][j] - ma[i] * e[j]);
                axis_b[j][i] -= factor * (length * db_b[i][j] + mb[i] * e[j]);
                by_a[i][j] -= factor * length * da_axis[i][j];
                by_b[i][j] += factor * length * db_axis[i][j];
            }
        }
    }

    /// Adds `factor` times the Hessian of a side's `sin² = 1 − c²`, `c` its cosine with the axis: `−2 (c ∇∇c + ∇c ∇cᵀ)`.
    fn add_sine(&mut self, hinge: &Hinge, side: usize, factor: f64) {
        let edge = hinge.edges[1 + side];
        let (i1, i2) = (1.0 / hinge.length, 1.0 / dot(edge, edge).sqrt());
        let (t1, t2) = (hinge.along, scale(edge, i2));
        let c = dot(t1, t2);
        let g1: [f64; 3] = std::array::from_fn(|i| (t2[i] - c * t1[i]) * i1);
        let g2: [f64; 3] = std::array::from_fn(|i| (t1[i] - c * t2[i]) * i2);
        let f = -2.0 * factor;
        for i in 0..3 {
            for j in 0..3 {
                let own = |t: &[f64; 3], g: &[f64; 3], inverse: f64| {
                    -inverse * (t[i] * g[j] + g[i] * t[j] + c * inverse * (eye(i, j) - t[i] * t[j]))
                };
                let mixed = (eye(i, j) - t1[i] * t1[j] - t2[i] * t2[j] + c * t1[i] * t2[j]) * (i1 * i2);
                self.0[0][i][j] += f * (c * own(&t1, &g1, i1) + g1[i] * g1[j]);
                self.0[WITH_AXIS[side]][i][j] += f * (c * mixed + g1[i] * g2[j]);
                self.0[WITH_ITSELF[side]][i][j] += f * (c * own(&t2, &g2, i2) + g2[i] * g2[j]);
            }
        }
    }

    /// Adds the size of the term's curvature: across the axis at a distance `ρ` a side turns `ψ` by `1/ρ²` a square of its
    /// motion, with either sign, so that `slope/ρ²` in both directions across bounds it; and where a side comes near the
    /// axis its weight falls within a tenth of the side's length, which is the sharpest of all that bends here.
    fn add_size(&mut self, hinge: &Hinge, weights: &Weights, stiffness: f64, deviation: f64, factor: f64) {
        let e = hinge.along;
        let slope = stiffness * weights.product() * deviation;
        for side in 0..2 {
            let edge = hinge.edges[1 + side];
            let along = dot(edge, e);
            let across = sub(edge, scale(e, along));
            let (distance2, side2) = (dot(across, across), dot(edge, edge));
            let outward = if distance2 > 1e-12 * side2 {
                scale(across, 1.0 / distance2.sqrt())
            } else {
                // On the axis: any direction across will do.
                let other = if e[0].abs() < 0.6 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
                let across = cross(e, other);
                scale(across, 1.0 / dot(across, across).sqrt())
            };
            let around = cross(e, outward);
            // The weight by the sine s: ω′/s and |ω″|; the angle and the weight together add the mixed term's size.
            let s2 = hinge.sine_squares[side];
            let sharp = 2.0 * weights.slope[side];
            let sharp_outward = sharp * (FADE - 3.0 * s2).abs() / (s2 + FADE);
            let other = stiffness * weights.value[1 - side] * deviation;
            let size = |fading: f64| {
                let by_weight = 0.5 * other * deviation * fading + other * sharp;
                factor * (slope / distance2.max(1e-6 * side2) + by_weight / side2)
            };
            let (by_outward, by_around) = (size(sharp_outward), size(sharp));
            // The end of the side moves against the point of the axis that is its foot.
            let foot = along / hinge.length;
            for i in 0..3 {
                for j in 0..3 {
                    let h = by_outward * outward[i] * outward[j] + by_around * around[i] * around[j];
                    self.0[0][i][j] += foot * foot * h;
                    self.0[WITH_AXIS[side]][i][j] -= foot * h;
                    self.0[WITH_ITSELF[side]][i][j] += h;
                }
            }
        }
    }

    /// Adds the whole to a Hessian by `x₀ x₁ x₃ x₄`: `A = x₁ − x₀`, `a = x₄ − x₀`, `b = x₃ − x₁`.
    pub fn add_to(&self, hessian: &mut [[f64; 12]; 12]) {
        let [axis, axis_a, axis_b, aa, ab, bb] = &self.0;
        for i in 0..3 {
            for j in 0..3 {
                let (p, r, pt, rt) = (axis_a[i][j], axis_b[i][j], axis_a[j][i], axis_b[j][i]);
                let (m, mt) = (ab[i][j], ab[j][i]);
                let (o, a, b) = (axis[i][j], aa[i][j], bb[i][j]);
                let rows = [
                    [o + p + pt + a, r + m - o - pt, -r - m, -p - a],
                    [rt + mt - o - p, o - r - rt + b, r - b, p - mt],
                    [-rt - mt, rt - b, b, mt],
                    [-pt - a, pt - m, m, a],
                ];
                for (k, row) in rows.iter().enumerate() {
                    for (l, value) in row.iter().enumerate() {
                        hessian[3 * k + i][3 * l + j] += value;
                    }
                }
            }
        }
    }
}

fn eye(i: usize, j: usize) -> f64 {
    if i == j { 1.0 } else { 0.0 }
}
