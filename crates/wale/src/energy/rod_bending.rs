//! Bending of a yarn of fixed rest lengths along an edge, against the rest curvatures at both its ends.

use wale_numerics::check::Local;
use wale_numerics::eigen::positive_part;
use wale_numerics::jet::vector3::{cross, dot, scale, sub};
use wale_numerics::jet::{Jet, Real};

use super::edge_turns::{EdgeTurns, invariants};
use super::element::{Element, point};

/// The bends at both ends of an edge of an isotropic yarn whose twist costs nothing.
///
/// `V = min_ϑ ½ Σ k_b |κ − R(ϑ) κ̄|²/(L̄ + L̄′)`, `κ = 2 e×f/(|e||f| + e·f)`, over both ends       [Sperl2022, Eq. 6]
///
/// with `e` and `f` the edges before and after an end, `L̄`, `L̄′` their rest lengths and `R(ϑ)` a turn about the edge.
/// `|κ| = 2 tan(θ/2)` with the turning angle `θ`; `k_b` is the continuum's `EI`. A vertex belongs to two edges, with half of its
/// bending each. Local coordinates: the vertex before the edge, both ends, the vertex after it, `x₀ x₁ x₂ x₃` \[m\]. Undefined
/// where an edge has no length.
///
/// Both curvatures lie in the plane across the edge. With `z` and `z̄` for them as complex numbers there and `a = k_b/(L̄ + L̄′)`,
/// the best turn leaves `½ Σ a (|z|² + |z̄|²) − |A|`, `A = Σ a z z̄*`, and of a rest shape only sizes and the torsion, the angle
/// between both `κ̄`, remain. `|A|` has a kink where `A = 0`, at the straight yarn; `√((|A|² + ε²)(S² + ε²))/S`, with `S = Σ a κ̄²`
/// and `ε = S/20`, has none and rests at the same shape.
///
/// Differs from the paper: it does not say which frame carries `κ̄`, and its yarn has no twist. In every frame that turns with
/// the two edges at a vertex `κ` has one direction, so that only sizes would be compared; but then a bent yarn that is pulled
/// straight may bend to the left at one vertex and to the right at the next to keep its curvature, which no yarn does.
/// Cross-sections here are those of edges: they turn freely, each as a whole. A rest curvature transported from the rest pose would not be the same in a turned fabric. Tests: `cross_sections_turn_as_they_like_best`,
/// `bending_one_end_the_other_way_costs`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RodBending {
    /// Bending stiffness `k_b` \[N·m²\].
    pub stiffness: f64,
    /// Sizes of the rest curvatures `κ̄` at both ends, integrated over the vertex \[–\].
    pub rest_curvatures: [f64; 2],
    /// Angle by which the second turns about the edge from the first \[rad\].
    pub rest_torsion: f64,
    /// Rest lengths of the edge before, the edge, and the edge after it \[m\].
    pub rest_lengths: [f64; 3],
}

/// `ε/S`: within this part of the rest curvature of the straight yarn the energy is rounded \[–\].
const ROUNDED: f64 = 0.05;
/// Squares of rest curvatures below this are those of a straight yarn.
const STRAIGHT: f64 = 1e-10;
/// Added to `1 + cos θ`: a yarn folded in two has no finite curvature.
const SHARPEST: f64 = 1e-12;

/// Curvature vector `κ` between two edges `e` and `f` \[m\], integrated over the vertex \[–\].
#[must_use]
pub fn rod_curvature(e: [f64; 3], f: [f64; 3]) -> [f64; 3] {
    let sizes = (dot(e, e) * dot(f, f)).sqrt();
    scale(cross(e, f), 2.0 / (sizes + dot(e, f) + SHARPEST * sizes))
}

/// Angle \[rad\] by which curvatures at the ends of an edge turn about it, zero where one has no size.
#[must_use]
pub fn rod_torsion(edge: [f64; 3], [first, second]: [[f64; 3]; 2]) -> f64 {
    let out = dot(cross(first, second), edge) / dot(edge, edge).sqrt();
    out.atan2(dot(first, second))
}

impl RodBending {
    /// Energy by `t₀·t₁`, `t₁·t₂`, `t₀·t₂` and `t₀·(t₁×t₂)` of the unit vectors along the three edges.
    fn of_invariants<T: Real>(&self, [u, v, w, volume]: [T; 4]) -> T {
        let [before, edge, after] = self.rest_lengths;
        let (a, b) = (self.stiffness / (before + edge), self.stiffness / (edge + after));
        let [first, second] = self.rest_curvatures;
        let (opened, closed) = (u.offset(1.0 + SHARPEST), v.offset(1.0 + SHARPEST));
        // |κ|² of both ends.
        let squares = [T::constant(1.0) - u, T::constant(1.0) - v].map(|difference| difference.scale(4.0));
        let squares = [squares[0] / opened, squares[1] / closed];
        let bent = (squares[0].scale(a) + squares[1].scale(b)).scale(0.5);
        let rest = a * first * first + b * second * second;
        if rest <= STRAIGHT * (a + b) {
            return bent;
        }
        // κ·κ′ and (κ×κ′)·t.
        let both = opened * closed;
        let (along, out) = ((u * v - w).scale(4.0) / both, volume.scale(4.0) / both);
        let (sine, cosine) = self.rest_torsion.sin_cos();
        let product = (along.scale(cosine) + out.scale(sine)).scale(2.0 * a * b * first * second);
        let square = squares[0].scale((a * first).powi(2)) + squares[1].scale((b * second).powi(2)) + product;
        let rounding = (ROUNDED * rest).powi(2);
        let turned = square.offset(rounding).sqrt().scale((1.0 + ROUNDED * ROUNDED).sqrt());
        (bent - turned).offset(rest * (0.5 + ROUNDED * ROUNDED))
    }
}

impl Element<12> for RodBending {
    const NAME: &'static str = "rod bending";

    fn energy<T: Real>(&self, q: &[T; 12]) -> T {
        let edges: [[T; 3]; 3] = std::array::from_fn(|k| sub(point(q, 3 * k + 3), point(q, 3 * k)));
        self.of_invariants(invariants(&edges))
    }

    fn convex(&self, q: &[f64; 12]) -> Local<12> {
        let mut local = Local::zero();
        self.add_blended(q, 1.0, &mut local);
        local
    }

    fn add_blended(&self, q: &[f64; 12], convexity: f64, sum: &mut Local<12>) {
        let turns = EdgeTurns::new(q);
        let jet = self.of_invariants(Jet::variables(&turns.values));
        let (gradients, second) = (turns.gradients(), jet.hessian());
        let by_turn = along(&gradients, &jet.gradient);
        let mut matrix = [[0.0; 6]; 6];
        for (row, gradient) in second.iter().zip(&gradients) {
            let weighted = along(&gradients, row);
            for i in 0..6 {
                for j in 0..6 {
                    matrix[i][j] += gradient[i] * weighted[j];
                }
            }
        }
        turns.add_second(&jet.gradient, &mut matrix);
        if convexity > 0.0 {
            let mut convex = positive_part(&matrix);
            // What tilts an edge while it changes length is left out, and a stiffness of its size takes its place.
            for a in 0..3 {
                let pair = [by_turn[2 * a], by_turn[2 * a + 1]];
                let size = pair[0].hypot(pair[1]).max(f64::MIN_POSITIVE);
                for i in 0..2 {
                    for j in 0..2 {
                        convex[2 * a + i][2 * a + j] += pair[i] * pair[j] / size;
                    }
                }
            }
            for (row, convex) in matrix.iter_mut().zip(&convex) {
                row.iter_mut().zip(convex).for_each(|(h, c)| *h += convexity * (c - *h));
            }
        }
        sum.add_gradient((jet.value, turns.spread(&by_turn)));
        turns.add_hessian(&matrix, &by_turn, 1.0 - convexity, &mut sum.hessian);
    }

    fn gradient(&self, q: &[f64; 12]) -> (f64, [f64; 12]) {
        let turns = EdgeTurns::new(q);
        let jet = self.of_invariants(Jet::variables(&turns.values));
        (jet.value, turns.spread(&along(&turns.gradients(), &jet.gradient)))
    }
}

/// A sum of rows, each times a factor.
fn along(rows: &[[f64; 6]; 4], factors: &[f64; 4]) -> [f64; 6] {
    std::array::from_fn(|i| rows.iter().zip(factors).map(|(row, factor)| factor * row[i]).sum())
}

#[cfg(test)]
mod tests {
    use super::super::element::testing::{Random, check, check_blend};
    use super::super::rigid_motion::check_rigid_motion;
    use super::*;

    fn edges(q: &[f64; 12]) -> [[f64; 3]; 3] {
        std::array::from_fn(|k| sub(point(q, 3 * k + 3), point(q, 3 * k)))
    }

    fn curvatures(q: &[f64; 12]) -> [[f64; 3]; 2] {
        let [before, edge, after] = edges(q);
        [rod_curvature(before, edge), rod_curvature(edge, after)]
    }

    /// An element at rest where `q` lies.
    fn at_rest(q: &[f64; 12]) -> RodBending {
        let bends = curvatures(q);
        RodBending {
            stiffness: 3.0,
            rest_curvatures: bends.map(|k| dot(k, k).sqrt()),
            rest_torsion: rod_torsion(edges(q)[1], bends),
            rest_lengths: edges(q).map(|d| dot(d, d).sqrt()),
        }
    }

    /// Bent in a plane by an angle at each end.
    fn bent(first: f64, second: f64) -> [f64; 12] {
        let ((s, c), (t, d)) = ((-first).sin_cos(), second.sin_cos());
        [-c, -s, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0 + d, t, 0.0]
    }

    fn random_state(random: &mut Random) -> [f64; 12] {
        std::array::from_fn(|k| [0.7, 1.0][k % 3 / 2] * (k / 3) as f64 * 0.8 + 0.5 * random.next())
    }

    #[test]
    fn derivatives() {
        let mut random = Random::new(52);
        for rest_curvatures in [[0.0, 0.0], [0.4, 0.9], [1.5, 0.0]] {
            for _ in 0..20 {
                let q = random_state(&mut random);
                let rest_torsion = 3.0 * random.next();
                let element =
                    RodBending { stiffness: 3.0, rest_curvatures, rest_torsion, rest_lengths: [0.9, 0.7, 1.1] };
                check(&element, &q, 0.1);
                check_blend(&element, &q, 1e-9);
                check_rigid_motion(&element, &q);
            }
        }
    }

    #[test]
    fn nearly_straight_bends_have_exact_hessians() {
        for (angles, rest) in [([0.0, 0.0], 0.0), ([5e-4, 1e-4], 0.0), ([0.0, 0.0], 0.7), ([2e-3, -1e-3], 0.7)] {
            let element = RodBending {
                stiffness: 1.0,
                rest_curvatures: [rest, 0.5 * rest],
                rest_torsion: 0.6,
                rest_lengths: [1.0; 3],
            };
            check_blend(&element, &bent(angles[0], angles[1]), 1e-9);
        }
    }

    #[test]
    fn a_circle_stores_the_continuum_energy() {
        // ½ EI/r² a length on a closed polygon of 400 bends: EI π/r.
        let (n, r, stiffness) = (400, 0.7, 2.0);
        let step = 2.0 * std::f64::consts::PI / f64::from(n);
        let chord = 2.0 * r * (0.5 * step).sin();
        let rest = RodBending { stiffness, rest_curvatures: [0.0; 2], rest_torsion: 0.0, rest_lengths: [chord; 3] };
        let total = f64::from(n) * rest.energy(&bent(step, step));
        assert!((total / (stiffness * std::f64::consts::PI / r) - 1.0).abs() < 1e-4, "{total}");
    }

    #[test]
    fn rests_at_the_rest_shape() {
        let mut random = Random::new(7);
        for _ in 0..20 {
            let q = random_state(&mut random);
            let element = at_rest(&q);
            let (energy, gradient) = element.gradient(&q);
            assert!(energy.abs() < 1e-9 && gradient.iter().all(|g| g.abs() < 1e-8), "{energy:e} {gradient:?}");
            let away: [f64; 12] = std::array::from_fn(|k| q[k] + 0.05 * random.next());
            assert!(element.energy(&away) > 1e-5);
        }
    }

    #[test]
    fn cross_sections_turn_as_they_like_best() {
        // The least over all turns of both rest curvatures about the edge, tried one by one.
        let mut random = Random::new(8);
        for _ in 0..20 {
            let (rest, now) = (random_state(&mut random), random_state(&mut random));
            let element = at_rest(&rest);
            let [_, edge, _] = edges(&now);
            let t = scale(edge, 1.0 / dot(edge, edge).sqrt());
            let [first, second] = curvatures(&now);
            let n = scale(first, 1.0 / dot(first, first).sqrt());
            let m = cross(t, n);
            let [before, length, after] = element.rest_lengths;
            let weights = [before + length, length + after].map(|length| 0.5 * element.stiffness / length);
            let least = (0..36_000)
                .map(|k| std::f64::consts::TAU * f64::from(k) / 36_000.0)
                .map(|turn| {
                    [(first, turn), (second, turn + element.rest_torsion)]
                        .into_iter()
                        .zip(element.rest_curvatures)
                        .zip(weights)
                        .map(|(((now, turn), rest), weight)| {
                            let (s, c) = turn.sin_cos();
                            let d: [f64; 3] = std::array::from_fn(|i| now[i] - rest * (c * n[i] + s * m[i]));
                            weight * dot(d, d)
                        })
                        .sum::<f64>()
                })
                .fold(f64::INFINITY, f64::min);
            let found = element.energy(&now);
            // Rounding takes a little of it, of the order of ε²/S.
            let most: f64 = element.rest_curvatures.iter().zip(weights).map(|(k, a)| 2.0 * a * k * k).sum();
            assert!((found - least).abs() < 3.0 * ROUNDED * ROUNDED * most, "{found} {least} {most}");
        }
    }

    #[test]
    fn bending_one_end_the_other_way_costs() {
        let element = at_rest(&bent(0.4, 0.4));
        assert!(element.energy(&bent(0.4, 0.4)).abs() < 1e-12 && element.energy(&bent(-0.4, -0.4)).abs() < 1e-12);
        let zigzag = element.energy(&bent(0.4, -0.4));
        // Neither turn helps one end without harming the other: what remains is both bendings, from rest to straight and on.
        let straight = element.energy(&bent(0.0, 0.0));
        assert!(zigzag > 1.9 * straight && straight > 0.1, "{zigzag} {straight}");
    }

    #[test]
    fn a_yarn_that_winds_left_is_not_one_that_winds_right() {
        let q: [f64; 12] = std::array::from_fn(|k| {
            let turn = 0.8 * (k / 3) as f64;
            [turn.cos(), turn.sin(), 0.5 * turn][k % 3]
        });
        let mirrored: [f64; 12] = std::array::from_fn(|k| if k % 3 == 2 { -q[k] } else { q[k] });
        let element = at_rest(&q);
        let other = RodBending { rest_torsion: -element.rest_torsion, ..element };
        assert!(element.energy(&mirrored) > 1e-3 && other.energy(&mirrored).abs() < 1e-9);
    }

    #[test]
    fn a_yarn_folded_in_two_has_finite_derivatives() {
        let folded = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.25, 0.0, 0.0, 0.4, 0.1, 0.0];
        for convexity in [0.0, 1.0] {
            let mut local = Local::zero();
            let element =
                RodBending { stiffness: 1.0, rest_curvatures: [0.3; 2], rest_torsion: 0.0, rest_lengths: [1.0; 3] };
            element.add_blended(&folded, convexity, &mut local);
            assert!(local.energy.is_finite() && local.hessian.iter().flatten().all(|h| h.is_finite()));
        }
    }
}
