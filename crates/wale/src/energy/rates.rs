//! Damping of stretching, bending and wrapping rates, free of drag on rigid motion.

use wale_numerics::check::Local;
use wale_numerics::jet::Real;
use wale_numerics::jet::vector3::{dot, sub};

use super::element::{Element, point};
use super::wrapping::{Wrapping, wrapping_angle};

// All three: `V = ½ κ (r(q) − r(q_n))²` with an invariant `r` of the shape and `κ = β/h` times its stiffness.
//
// Differs from the paper: Rayleigh damping `βK` with a Hessian made positive, or frozen at the start of a step, drags
// rigid rotation; a potential of the change of an invariant does not (test `rotation_is_free`).

/// Damping of the rate of stretch `r = |x₁ − x₀|/Δu`. Local coordinates: `x₀ u₀ x₁ u₁` \[m\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StretchRate {
    /// `β k_s Δu/h` \[J\].
    pub stiffness: f64,
    /// Invariant at the start of the step \[–\].
    pub previous: f64,
}

impl Element<8> for StretchRate {
    const NAME: &'static str = "stretch damping";

    fn energy<T: Real>(&self, q: &[T; 8]) -> T {
        let d = sub(point(q, 4), point(q, 0));
        let r = dot(d, d).sqrt() / (q[7] - q[3]);
        r.offset(-self.previous).square().scale(0.5 * self.stiffness)
    }

    fn convex(&self, q: &[f64; 8]) -> Local<8> {
        let d = sub(point(q, 4), point(q, 0));
        let rest = q[7] - q[3];
        let length = dot(d, d).sqrt();
        let r = length / rest;
        let s = 1.0 / (length.max(f64::MIN_POSITIVE) * rest);
        let by_u = r / rest;
        let g = [-d[0] * s, -d[1] * s, -d[2] * s, by_u, d[0] * s, d[1] * s, d[2] * s, -by_u];
        square_of(self.stiffness, r - self.previous, &g)
    }
}

/// Damping of the rate of bending `r = cos θ`. Local coordinates: `x₀ u₀ x₁ u₁ x₂ u₂` \[m\].
///
/// The angle itself has a kink at the straight yarn, its cosine none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BendRate {
    /// `2 β k_b/(Δu h max(sin²θ, 0.05))` \[J\].
    pub stiffness: f64,
    /// Invariant at the start of the step \[–\].
    pub previous: f64,
}

/// Cosine of the bend angle of `x₀ u₀ x₁ u₁ x₂ u₂` and its gradient.
fn bend_cosine(q: &[f64; 12]) -> (f64, [f64; 12]) {
    let (d1, d2) = (sub(point(q, 4), point(q, 0)), sub(point(q, 8), point(q, 4)));
    let (i1, i2) = (1.0 / dot(d1, d1).sqrt(), 1.0 / dot(d2, d2).sqrt());
    let r = dot(d1, d2) * i1 * i2;
    let mut g = [0.0; 12];
    for k in 0..3 {
        let a = (d2[k] * i2 - r * d1[k] * i1) * i1;
        let b = (d1[k] * i1 - r * d2[k] * i2) * i2;
        g[k] = -a;
        g[4 + k] = a - b;
        g[8 + k] = b;
    }
    (r, g)
}

impl BendRate {
    /// The damping of a step of length `h` that starts at `q`.
    #[must_use]
    pub fn starting_at(q: &[f64; 12], bending_stiffness: f64, beta_over_h: f64) -> Self {
        let (r, _) = bend_cosine(q);
        let stiffness = 2.0 * beta_over_h * bending_stiffness / ((q[11] - q[3]) * (1.0 - r * r).max(0.05));
        Self { stiffness, previous: r }
    }
}

impl Element<12> for BendRate {
    const NAME: &'static str = "bend damping";

    fn energy<T: Real>(&self, q: &[T; 12]) -> T {
        let (d1, d2) = (sub(point(q, 4), point(q, 0)), sub(point(q, 8), point(q, 4)));
        let r = dot(d1, d2) / (dot(d1, d1) * dot(d2, d2)).sqrt();
        r.offset(-self.previous).square().scale(0.5 * self.stiffness)
    }

    fn convex(&self, q: &[f64; 12]) -> Local<12> {
        let (r, g) = bend_cosine(q);
        square_of(self.stiffness, r - self.previous, &g)
    }
}

/// Damping of the rate of wrapping `r = ψ`. Local coordinates: `x₀ x₁ x₃ x₄` \[m\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrapRate {
    /// The wrap whose angle is damped, with stiffness `β k_w L/h` \[J\] and its rest angle the angle at the start of
    /// the step: the damping is a wrap that rests where it is.
    pub wrap: Wrapping,
}

impl WrapRate {
    /// The damping of a step of length `h` that starts at `q`.
    #[must_use]
    pub fn starting_at(q: &[f64; 12], wrap: &Wrapping, beta_over_h: f64) -> Self {
        let rest_angle = wrap.sign * wrapping_angle(q);
        Self { wrap: Wrapping { stiffness: beta_over_h * wrap.stiffness, rest_angle, sign: wrap.sign } }
    }
}

impl Element<12> for WrapRate {
    const NAME: &'static str = "wrap damping";

    fn energy<T: Real>(&self, q: &[T; 12]) -> T {
        self.wrap.energy(q)
    }
    fn convex(&self, q: &[f64; 12]) -> Local<12> {
        self.wrap.convex(q)
    }
    fn gradient(&self, q: &[f64; 12]) -> (f64, [f64; 12]) {
        self.wrap.gradient(q)
    }
}

/// `½ k d²` with the gradient `g` of `d` and the Gauss–Newton Hessian.
fn square_of<const N: usize>(stiffness: f64, difference: f64, g: &[f64; N]) -> Local<N> {
    let mut local = Local::zero();
    local.energy = 0.5 * stiffness * difference * difference;
    local.gradient = g.map(|g| stiffness * difference * g);
    local.add_square(stiffness, g);
    local
}

#[cfg(test)]
mod tests {
    use super::super::element::testing::{Random, check, random_yarn};
    use super::*;

    #[test]
    fn derivatives() {
        let mut random = Random::new(8);
        for _ in 0..10 {
            check(&StretchRate { stiffness: 2.0, previous: 0.4 }, &random_yarn::<2, 8>(&mut random), 1.0);
            check(&BendRate { stiffness: 2.0, previous: -0.3 }, &random_yarn::<3, 12>(&mut random), 1.0);
            let mut q = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.3, 0.8, 0.1, -0.3, -0.9, 0.2];
            q.iter_mut().for_each(|x| *x += 0.3 * random.next());
            let wrap = Wrapping { stiffness: 2.0, rest_angle: 0.5, sign: -1.0 };
            check(&WrapRate { wrap }, &q, 1.0);
        }
    }

    #[test]
    fn rotation_is_free() {
        let mut random = Random::new(9);
        let turn = glam::DQuat::from_scaled_axis(glam::DVec3::new(0.7, -0.4, 1.1));
        let q = random_yarn::<3, 12>(&mut random);
        let mut turned = q;
        for k in 0..3 {
            let x = turn * glam::DVec3::from_slice(&q[4 * k..4 * k + 3]) + glam::DVec3::ONE;
            turned[4 * k..4 * k + 3].copy_from_slice(&x.to_array());
        }
        let damping = BendRate::starting_at(&q, 1.0, 1.0);
        let mut bent = q;
        bent[9] += 0.1;
        assert!(damping.energy(&turned) < 1e-28 && damping.energy(&bent) > 1e-6);
        assert!(damping.convex(&turned).gradient.iter().all(|g| g.abs() < 1e-13));
    }
}
