//! Bending of a yarn at a node, with smooth jamming.

use std::f64::consts::FRAC_PI_2;

use wale_numerics::check::Local;
use wale_numerics::jet::Real;
use wale_numerics::jet::vector3::{add, cross, dot, scale, sub};

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
}

impl Bending {
    /// Value, gradient and exact Hessian by way of `c = cos θ`, whose derivatives are rational.
    fn curved(&self, q: &[f64; 12]) -> Local<12> {
        let (energy, gradient) = self.gradient(q);
        let mut local = Local { energy, gradient, hessian: [[0.0; 12]; 12] };
        let (d1, d2) = (sub(point(q, 4), point(q, 0)), sub(point(q, 8), point(q, 4)));
        let (l1, l2) = (dot(d1, d1).sqrt(), dot(d2, d2).sqrt());
        let (t1, t2) = (scale(d1, 1.0 / l1), scale(d2, 1.0 / l2));
        let (difference, sum) = (sub(t2, t1), add(t1, t2));
        let theta = 2.0 * dot(difference, difference).sqrt().atan2(dot(sum, sum).sqrt());
        let c = theta.cos();
        let rest = q[11] - q[3];
        let k = self.stiffness / rest;
        let [f, first, second] = self.profile(theta);
        // F(c) = f(θ): F′ = −f′/sin θ, F″ = (f″ − f′ cot θ)/sin²θ, by their series at the straight yarn.
        let (by_c, by_cc) = if theta < 1e-3 {
            let smooth = (theta * theta + SMOOTHING * SMOOTHING).sqrt();
            let g = 2.0 - 2.0 * self.rest_angle / smooth;
            (-g * (1.0 + theta * theta / 6.0), 2.0 * self.rest_angle / (smooth * smooth * smooth) + g / 3.0)
        } else {
            let sine = theta.sin();
            (-first / sine, (second - first * c / sine) / (sine * sine))
        };
        // Gradient of c by d₁ and d₂, and the three blocks of its Hessian.
        let g1: [f64; 3] = std::array::from_fn(|i| (t2[i] - c * t1[i]) / l1);
        let g2: [f64; 3] = std::array::from_fn(|i| (t1[i] - c * t2[i]) / l2);
        let mut h = [[[0.0; 3]; 3]; 3];
        for i in 0..3 {
            for j in 0..3 {
                let eye = f64::from(u8::from(i == j));
                let own = |t: &[f64; 3], g: &[f64; 3], l: f64| {
                    -(t[i] * g[j] + g[i] * t[j]) / l - c * (eye - t[i] * t[j]) / (l * l)
                };
                h[0][i][j] = k * (by_cc * g1[i] * g1[j] + by_c * own(&t1, &g1, l1));
                h[1][i][j] = k * (by_cc * g2[i] * g2[j] + by_c * own(&t2, &g2, l2));
                let mixed = (eye - t1[i] * t1[j] - t2[i] * t2[j] + c * t1[i] * t2[j]) / (l1 * l2);
                h[2][i][j] = k * (by_cc * g1[i] * g2[j] + by_c * mixed);
            }
        }
        // d₁ = x₁ − x₀ and d₂ = x₂ − x₁.
        for i in 0..3 {
            for j in 0..3 {
                let (a, b, m, mt) = (h[0][i][j], h[1][i][j], h[2][i][j], h[2][j][i]);
                local.hessian[i][j] = a;
                local.hessian[i][4 + j] = m - a;
                local.hessian[i][8 + j] = -m;
                local.hessian[4 + i][j] = mt - a;
                local.hessian[4 + i][4 + j] = a + b - m - mt;
                local.hessian[4 + i][8 + j] = m - b;
                local.hessian[8 + i][j] = -mt;
                local.hessian[8 + i][4 + j] = mt - b;
                local.hessian[8 + i][8 + j] = b;
            }
            let slope = k * by_c / rest;
            for (x, g) in [(i, -g1[i]), (4 + i, g1[i] - g2[i]), (8 + i, g2[i])] {
                local.hessian[x][3] = slope * g;
                local.hessian[3][x] = slope * g;
                local.hessian[x][11] = -slope * g;
                local.hessian[11][x] = -slope * g;
            }
        }
        let twice = 2.0 * k * f / (rest * rest);
        local.hessian[3][3] = twice;
        local.hessian[11][11] = twice;
        local.hessian[3][11] = -twice;
        local.hessian[11][3] = -twice;
        local
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
        let angle = Angle::new(q);
        let rest = q[11] - q[3];
        let k = self.stiffness / rest;
        let [f, first, second] = self.profile(angle.theta);
        local.energy = k * f;
        let by_rest = -k * f / rest;
        for i in 0..3 {
            local.gradient[i] = k * first * angle.gradient[0][i];
            local.gradient[4 + i] = k * first * angle.gradient[1][i];
            local.gradient[8 + i] = k * first * angle.gradient[2][i];
        }
        local.gradient[3] = -by_rest;
        local.gradient[11] = by_rest;

        // In (θ, Δu) the energy is k f(θ)/Δu: clamp that 2×2 Hessian, whose θθ entry is positive near and past the
        // rest angle.
        let (a, b, c) = (k * second, -k * first / rest, 2.0 * k * f / (rest * rest));
        let (a, b, c) = clamp2(a, b, c);
        let mut g = [0.0; 12];
        for (slots, by_node) in g.chunks_exact_mut(4).zip(&angle.gradient) {
            slots[..3].copy_from_slice(by_node);
        }
        local.add_square(a, &g);
        for i in 0..12 {
            local.hessian[i][11] += b * g[i];
            local.hessian[i][3] -= b * g[i];
            local.hessian[11][i] += b * g[i];
            local.hessian[3][i] -= b * g[i];
        }
        local.hessian[3][3] += c;
        local.hessian[11][11] += c;
        local.hessian[3][11] -= c;
        local.hessian[11][3] -= c;

        // What turns the bend out of its plane, or tilts a segment while it changes length, changes θ to second order
        // with either sign; the size of that curvature steers well on both sides of the rest angle.
        let size = k * first.abs();
        let straight = if first >= 0.0 { angle.first_over_tangent(first) } else { -first / (0.5 * angle.theta).tan() };
        let (opposite, together) = (0.5 * k * straight, 0.5 * size * (0.5 * angle.theta).tan());
        for (factor, sign) in [(opposite, -1.0), (together, 1.0)] {
            let (l1, l2) = (1.0 / angle.length[0], sign / angle.length[1]);
            local.add_square(factor, &spread(angle.binormal, [-l1, l1 - l2, l2]));
        }
        for (segment, weights) in [(0, [-1.0, 1.0, 0.0]), (1, [0.0, -1.0, 1.0])] {
            let l = angle.length[segment];
            local.add_square(size / (l * l), &spread(angle.in_plane[segment], weights));
        }
        local
    }

    fn add_blended(&self, q: &[f64; 12], convexity: f64, sum: &mut Local<12>) {
        if convexity > 0.0 {
            sum.add_scaled(convexity, &self.convex(q));
        }
        if convexity < 1.0 {
            sum.add_scaled(1.0 - convexity, &self.curved(q));
        }
    }

    fn gradient(&self, q: &[f64; 12]) -> (f64, [f64; 12]) {
        let angle = Angle::new(q);
        let rest = q[11] - q[3];
        let k = self.stiffness / rest;
        let [f, first, _] = self.profile(angle.theta);
        let mut gradient = [0.0; 12];
        for i in 0..3 {
            gradient[i] = k * first * angle.gradient[0][i];
            gradient[4 + i] = k * first * angle.gradient[1][i];
            gradient[8 + i] = k * first * angle.gradient[2][i];
        }
        gradient[3] = k * f / rest;
        gradient[11] = -k * f / rest;
        (k * f, gradient)
    }
}

/// One direction at all three nodes, with weights.
fn spread(direction: [f64; 3], weights: [f64; 3]) -> [f64; 12] {
    let mut g = [0.0; 12];
    for i in 0..3 {
        for node in 0..3 {
            g[4 * node + i] = weights[node] * direction[i];
        }
    }
    g
}

/// The turning angle of two segments and what its derivatives are made of.
struct Angle {
    theta: f64,
    /// By `x₀`, `x₁`, `x₂`.
    gradient: [[f64; 3]; 3],
    /// Unit vector normal to both segments (any, where they are parallel).
    binormal: [f64; 3],
    /// Unit vectors in the plane of the bend, normal to each segment.
    in_plane: [[f64; 3]; 2],
    length: [f64; 2],
}

impl Angle {
    fn new(q: &[f64; 12]) -> Self {
        let (d1, d2) = (sub(point(q, 4), point(q, 0)), sub(point(q, 8), point(q, 4)));
        let length = [dot(d1, d1).sqrt(), dot(d2, d2).sqrt()];
        let (t1, t2) = (scale(d1, 1.0 / length[0]), scale(d2, 1.0 / length[1]));
        let difference = sub(t2, t1);
        let s2 = dot(difference, difference);
        let sum = add(t1, t2);
        let theta = 2.0 * s2.sqrt().atan2(dot(sum, sum).sqrt());
        let normal = cross(t1, t2);
        let sine = dot(normal, normal).sqrt();
        if sine < 1e-12 {
            // Straight: θ has no direction, but every energy here is even in it, so no gradient is lost.
            let axis = if t1[0].abs() < 0.6 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
            let b = cross(t1, axis);
            let binormal = scale(b, 1.0 / dot(b, b).sqrt());
            let m = cross(binormal, t1);
            let gradient = Self::gradients(m, m, length);
            return Self { theta, gradient, binormal, in_plane: [m, m], length };
        }
        let binormal = scale(normal, 1.0 / sine);
        // In-plane unit vectors: turning t₂ along m₂, or t₁ against m₁, increases θ.
        let (m1, m2) = (cross(binormal, t1), cross(binormal, t2));
        Self { theta, gradient: Self::gradients(m1, m2, length), binormal, in_plane: [m1, m2], length }
    }

    fn gradients(m1: [f64; 3], m2: [f64; 3], length: [f64; 2]) -> [[f64; 3]; 3] {
        let (a, b) = (scale(m1, 1.0 / length[0]), scale(m2, 1.0 / length[1]));
        [a, sub(scale(a, -1.0), b), b]
    }

    /// `f′ cot(θ/2)`, finite at the straight yarn because `f′` vanishes there too.
    fn first_over_tangent(&self, first: f64) -> f64 {
        if self.theta > 1e-6 {
            first / (0.5 * self.theta).tan()
        } else {
            // f′ ≈ f″(0) θ, and the in-plane term already carries f″.
            2.0 * if self.theta > 0.0 { first / self.theta } else { 2.0 }
        }
    }
}

/// The positive semi-definite part of `[[a, b], [b, c]]`.
fn clamp2(a: f64, b: f64, c: f64) -> (f64, f64, f64) {
    // Scale the variables first so that both diagonal entries weigh the same.
    let scale = if a > 0.0 && c > 0.0 { (a / c).sqrt() } else { 1.0 };
    let (b, c) = (b * scale, c * scale * scale);
    let mean = 0.5 * (a + c);
    let half = (0.25 * (a - c) * (a - c) + b * b).sqrt();
    let (low, high) = (mean - half, mean + half);
    if low >= 0.0 {
        return (a, b / scale, c / (scale * scale));
    }
    if high <= 0.0 || half == 0.0 {
        return (0.0, 0.0, 0.0);
    }
    // Projector on the positive eigenvector: (A − low I)/(high − low), times high.
    let s = high / (high - low);
    ((a - low) * s, b * s / scale, (c - low) * s / (scale * scale))
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
