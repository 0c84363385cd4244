//! Bending of a yarn at a node, with smooth jamming.

use std::f64::consts::FRAC_PI_2;

use wale_numerics::check::Local;
use wale_numerics::jet::Real;
use wale_numerics::jet::vector3::{add, dot, scale, sub};

use super::angle::{Angle, Turning};
use super::element::{Element, point};

/// Bending between two consecutive segments of a yarn.
///
/// `V = k_b f(θ)/Δu`, `f = θ² − 2θ₀θ̃ + θ₀² + c max(0, θ − π/2)³`, `θ̃ = √(θ² + ε²)`      [Cirio2017, Eq. 1]
///
/// `θ` is the turning angle between the segments, `Δu = u₂ − u₀` the arc length of both. With `θ₀ = 0` this is Eq. 1
/// and `k_b` is exactly the continuum `EI`.
/// Local coordinates: `x₀ u₀ x₁ u₁ x₂ u₂` \[m\]. Undefined where a segment has no length or folds back (`θ = π`).
///
/// Differs from the paper: `k_b` carries its true unit N·m²; a rest angle `θ₀` per pass (smoothed within `ε` of the
/// straight yarn, where `θ` has a kink) stands for the shape that a yarn keeps from knitting; and jamming is a cubic
/// whose tangent stiffness grows to a thousand times `k_b` at `θ = π`, twice continuously differentiable, where the
/// paper gives only the factor and the threshold. Tests: `jamming_grows_a_thousandfold`, `rests_at_the_rest_angle`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bending {
    /// Bending stiffness `k_b = EI` \[N·m²\].
    pub stiffness: f64,
    /// Rest bend angle `θ₀` \[rad\], in `[0, π/2)`.
    pub rest_angle: f64,
}

/// Angle over which a rest bend angle fades in around the straight yarn \[rad\].
const SMOOTHING: f64 = 0.02;
/// Jamming: a thousandfold tangent stiffness at `θ = π` asks for `2 + 6c(π − π/2) = 2000`.
const JAMMING: f64 = 2.0 * 999.0 / (6.0 * FRAC_PI_2);
/// Below this `|t₁ − t₂|²` the series of `θ²` is exact to round-off.
const NEARLY_STRAIGHT: f64 = 1e-8;

impl Bending {
    /// `f(θ)` and its first two derivatives.
    fn profile(&self, theta: f64) -> [f64; 3] {
        let smooth = (theta * theta + SMOOTHING * SMOOTHING).sqrt();
        let over = (theta - FRAC_PI_2).max(0.0);
        let r = self.rest_angle;
        [
            theta * theta - 2.0 * r * smooth + r * r + JAMMING * over * over * over,
            2.0 * theta - 2.0 * r * theta / smooth + 3.0 * JAMMING * over * over,
            2.0 - 2.0 * r * SMOOTHING * SMOOTHING / (smooth * smooth * smooth) + 6.0 * JAMMING * over,
        ]
    }

    /// `f′(θ)/θ`, finite at the straight yarn.
    fn slope_by_angle(&self, theta: f64) -> f64 {
        let smooth = (theta * theta + SMOOTHING * SMOOTHING).sqrt();
        let over = theta - FRAC_PI_2;
        let jamming = if over > 0.0 { 3.0 * JAMMING * over * over / theta } else { 0.0 };
        2.0 - 2.0 * self.rest_angle / smooth + jamming
    }

    /// Value and gradient.
    fn value(&self, angle: &Angle, rest: f64) -> (f64, [f64; 12]) {
        let k = self.stiffness / rest;
        let [f, first, _] = self.profile(angle.theta);
        let mut gradient = [0.0; 12];
        for (node, by_node) in angle.gradient.iter().enumerate() {
            for i in 0..3 {
                gradient[4 * node + i] = k * first * by_node[i];
            }
        }
        gradient[3] = k * f / rest;
        gradient[11] = -k * f / rest;
        (k * f, gradient)
    }
}

impl Element<12> for Bending {
    const NAME: &'static str = "bending";

    fn energy<T: Real>(&self, q: &[T; 12]) -> T {
        let (d1, d2) = (sub(point(q, 4), point(q, 0)), sub(point(q, 8), point(q, 4)));
        let t1 = scale(d1, T::constant(1.0) / dot(d1, d1).sqrt());
        let t2 = scale(d2, T::constant(1.0) / dot(d2, d2).sqrt());
        let difference = sub(t2, t1);
        let s2 = dot(difference, difference);
        let (squared, over) = if s2.value() < NEARLY_STRAIGHT {
            (s2 + s2 * s2.scale(1.0 / 12.0), T::constant(0.0))
        } else {
            let sum = add(t1, t2);
            let theta = s2.sqrt().atan2(dot(sum, sum).sqrt()).scale(2.0);
            let over = if theta.value() > FRAC_PI_2 { theta.offset(-FRAC_PI_2) } else { T::constant(0.0) };
            (theta.square(), over)
        };
        let smooth = squared.offset(SMOOTHING * SMOOTHING).sqrt();
        let f = squared - smooth.scale(2.0 * self.rest_angle) + over.square() * over.scale(JAMMING);
        f.offset(self.rest_angle * self.rest_angle).scale(self.stiffness) / (q[11] - q[3])
    }

    fn convex(&self, q: &[f64; 12]) -> Local<12> {
        let mut local = Local::zero();
        self.add_blended(q, 1.0, &mut local);
        local
    }

    fn add_blended(&self, q: &[f64; 12], convexity: f64, sum: &mut Local<12>) {
        let angle = Angle::new([0, 4, 8].map(|start| point(q, start)));
        let rest = q[11] - q[3];
        let k = self.stiffness / rest;
        let [f, first, second] = self.profile(angle.theta);
        sum.add_gradient(self.value(&angle, rest));

        // In (θ, Δu) the energy is k f(θ)/Δu; the convex Hessian clamps its 2×2 Hessian.
        let exact = [k * second, -k * first / rest, 2.0 * k * f / (rest * rest)];
        let clamped = if convexity > 0.0 { clamp2(exact) } else { exact };
        let [by_angle, mixed, by_rest] = std::array::from_fn(|i| exact[i] + convexity * (clamped[i] - exact[i]));
        let over_half_tangent = k * self.slope_by_angle(angle.theta) * angle.over_half_tangent();
        let turning = Turning::new(&angle, k * first, by_angle, over_half_tangent, convexity);
        angle.add_hessian(&turning, [0, 4, 8], &mut sum.hessian);
        let hessian = &mut sum.hessian;
        for (node, gradient) in angle.gradient.iter().enumerate() {
            for i in 0..3 {
                let h = mixed * gradient[i];
                hessian[4 * node + i][3] -= h;
                hessian[3][4 * node + i] -= h;
                hessian[4 * node + i][11] += h;
                hessian[11][4 * node + i] += h;
            }
        }
        hessian[3][3] += by_rest;
        hessian[11][11] += by_rest;
        hessian[3][11] -= by_rest;
        hessian[11][3] -= by_rest;
    }

    fn gradient(&self, q: &[f64; 12]) -> (f64, [f64; 12]) {
        self.value(&Angle::new([0, 4, 8].map(|start| point(q, start))), q[11] - q[3])
    }
}

/// The positive semi-definite part of `[[a, b], [b, c]]`.
fn clamp2([a, b, c]: [f64; 3]) -> [f64; 3] {
    // Scale the variables first so that both diagonal entries weigh the same.
    let scale = if a > 0.0 && c > 0.0 { (a / c).sqrt() } else { 1.0 };
    let (b, c) = (b * scale, c * scale * scale);
    let mean = 0.5 * (a + c);
    let half = (0.25 * (a - c) * (a - c) + b * b).sqrt();
    let (low, high) = (mean - half, mean + half);
    if low >= 0.0 {
        return [a, b / scale, c / (scale * scale)];
    }
    if high <= 0.0 || half == 0.0 {
        return [0.0; 3];
    }
    // Projector on the positive eigenvector: (A − low I)/(high − low), times high.
    let s = high / (high - low);
    [(a - low) * s, b * s / scale, (c - low) * s / (scale * scale)]
}

#[cfg(test)]
mod tests {
    use super::super::element::testing::{Random, check, check_blend, random_yarn};
    use super::*;

    #[test]
    fn derivatives() {
        let mut random = Random::new(2);
        for rest_angle in [0.0, 0.43, 1.1] {
            for _ in 0..20 {
                let q = random_yarn::<3, 12>(&mut random);
                check(&Bending { stiffness: 3.0, rest_angle }, &q, 1.0);
                check_blend(&Bending { stiffness: 3.0, rest_angle }, &q, 1e-9);
            }
        }
    }

    #[test]
    fn derivatives_past_the_jamming_angle() {
        let mut random = Random::new(3);
        for _ in 0..20 {
            let mut q = random_yarn::<3, 12>(&mut random);
            q[8] = 0.1 * random.next(); // back beside the first node
            q[9] = 1.0 + 0.2 * random.next();
            check(&Bending { stiffness: 3.0, rest_angle: 0.4 }, &q, 1.0);
            check_blend(&Bending { stiffness: 3.0, rest_angle: 0.4 }, &q, 1e-9);
        }
    }

    /// A bend of angle `theta` with unit segments.
    fn bent(theta: f64) -> [f64; 12] {
        [-1.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, theta.cos(), theta.sin(), 0.0, 1.0]
    }

    #[test]
    fn a_circle_stores_the_continuum_energy() {
        // ½ EI κ² a length, on a closed polygon of 400 bends: EI π/r.
        let (n, r, stiffness) = (400, 0.7, 2.0);
        let step = 2.0 * std::f64::consts::PI / f64::from(n);
        let chord = 2.0 * r * (0.5 * step).sin();
        let element = Bending { stiffness, rest_angle: 0.0 };
        let mut q = bent(step);
        for (i, x) in q.iter_mut().enumerate() {
            *x *= if i % 4 == 3 { r * step } else { chord };
        }
        let total = f64::from(n) * element.energy(&q);
        assert!((total / (stiffness * std::f64::consts::PI / r) - 1.0).abs() < 1e-9, "{total}");
    }

    #[test]
    fn a_yarn_folded_in_two_has_finite_derivatives() {
        let bending = Bending { stiffness: 1.0, rest_angle: 0.4 };
        let folded = [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.25, 0.0, 0.0, 2.0];
        for convexity in [0.0, 0.5, 1.0] {
            let mut local = Local::zero();
            bending.add_blended(&folded, convexity, &mut local);
            assert!(local.energy.is_finite() && local.gradient.iter().all(|g| g.is_finite()));
            assert!(local.hessian.iter().flatten().all(|h| h.is_finite()));
        }
    }

    #[test]
    fn jamming_grows_a_thousandfold() {
        let element = Bending { stiffness: 1.0, rest_angle: 0.0 };
        assert!((element.profile(std::f64::consts::PI)[2] / element.profile(1.0)[2] - 1000.0).abs() < 1e-9);
        let (before, after) = (element.profile(FRAC_PI_2 - 1e-9)[2], element.profile(FRAC_PI_2 + 1e-9)[2]);
        assert!((before - after).abs() < 1e-5);
    }

    #[test]
    fn rests_at_the_rest_angle() {
        let element = Bending { stiffness: 1.0, rest_angle: 0.8 };
        let at = |theta: f64| element.energy(&bent(theta));
        assert!(at(0.8) < 1e-3 * at(0.0) && at(0.8) < at(0.75) && at(0.8) < at(0.85));
        // Straight and nearly straight agree: the kink of θ is smoothed.
        assert!((at(0.0) - at(1e-9)).abs() < 1e-12);
    }

    #[test]
    fn nearly_straight_bends_have_exact_hessians() {
        for (theta, rest_angle) in [(0.0, 0.0), (5e-4, 0.0), (5e-4, 0.7), (2e-3, 0.7)] {
            check_blend(&Bending { stiffness: 1.0, rest_angle }, &bent(theta), 1e-5);
        }
    }

    #[test]
    fn a_straight_yarn_is_stiff_in_both_directions() {
        let local = Bending { stiffness: 1.0, rest_angle: 0.0 }.convex(&bent(0.0));
        let exact = Bending { stiffness: 1.0, rest_angle: 0.0 }.exact(&bent(0.0));
        for i in [1, 2, 5, 6, 9, 10] {
            for j in [1, 2, 5, 6, 9, 10] {
                let difference = (local.hessian[i][j] - exact.hessian[i][j]).abs();
                assert!(difference < 1e-6, "{i} {j}: {} {}", local.hessian[i][j], exact.hessian[i][j]);
            }
        }
    }
}
