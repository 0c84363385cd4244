//! Damping of the rates of bending and wrapping.

use wale_numerics::check::Local;
use wale_numerics::jet::Real;
use wale_numerics::jet::vector3::{dot, sub};

use super::element::{Element, point};
use super::wrapping::{Wrapping, wrapping_gradient};

/// Damping of the rate of an invariant `r` of the shape of a few nodes over one implicit step.
///
/// `V = ½ κ (∇r(q_n + ½h v_n)·(q − q_n))²`, `κ = β/h` times the stiffness that goes with `r`
///
/// with `r = cos θ` for a bend and `r = ψ` for a wrap. Local coordinates are those of the bend or wrap \[m\].
///
/// Differs from the paper, whose Rayleigh damping `βK` takes the rate of everything. The stretch of the yarn is left
/// undamped: its vibrations are far faster than any step, which removes them by itself, and a frozen `∇r` of something
/// as stiff is hard to solve. `∇r` of a bend or a wrap is frozen, which makes `V` a quadratic that Newton's method
/// solves at once; the invariant at the unknown end of the step kept it from converging
/// (`docs/design/002-newton.md`). It is taken halfway to where the velocities lead: a rotation `R` moves
/// `q_n` by `2 tan(φ/2) a × ½(q_n + R q_n)`, which leaves `r` alone to first order at that halfway place, so that a
/// fabric that keeps turning is not braked at all (tests `rotation_is_free`, `a_turning_fabric_keeps_turning`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rate {
    /// `κ` \[J\].
    pub stiffness: f64,
    /// `∇r` halfway through the step \[1/m\].
    pub gradient: [f64; 12],
    /// `∇r·q_n` \[–\].
    pub start: f64,
}

impl Rate {
    /// No damping.
    pub const NONE: Self = Self { stiffness: 0.0, gradient: [0.0; 12], start: 0.0 };

    fn new(stiffness: f64, gradient: [f64; 12], q: &[f64; 12]) -> Self {
        let start = product(&gradient, q);
        // Nodes that the velocities bring together have no angle.
        if start.is_finite() && stiffness.is_finite() { Self { stiffness, gradient, start } } else { Self::NONE }
    }

    /// Damping of a bend of stiffness `k_b` \[N·m²\] for a step that starts at `x₀ u₀ x₁ u₁ x₂ u₂` and is `halfway` to
    /// where the velocities lead.
    ///
    /// The angle itself has a kink at the straight yarn, its cosine none: `κ = 2 β k_b/(Δu h max(sin²θ, 0.05))`.
    #[must_use]
    pub fn of_bend(q: &[f64; 12], halfway: &[f64; 12], bending_stiffness: f64, beta_over_h: f64) -> Self {
        let (r, gradient) = bend_cosine(halfway);
        let stiffness = 2.0 * beta_over_h * bending_stiffness / ((q[11] - q[3]) * (1.0 - r * r).max(0.05));
        Self::new(stiffness, gradient, q)
    }

    /// Damping of a wrap for a step that starts at `x₀ x₁ x₃ x₄` and is `halfway` to where the velocities lead:
    /// `κ = β k_w L ω_a ω_b/h`.
    #[must_use]
    pub fn of_wrap(q: &[f64; 12], halfway: &[f64; 12], wrap: &Wrapping, beta_over_h: f64) -> Self {
        let (gradient, weight) = wrapping_gradient(halfway);
        Self::new(beta_over_h * wrap.stiffness * weight, gradient, q)
    }
}

impl Element<12> for Rate {
    const NAME: &'static str = "damping";

    fn energy<T: Real>(&self, q: &[T; 12]) -> T {
        let change = (0..12).fold(T::constant(-self.start), |sum, i| sum + q[i].scale(self.gradient[i]));
        change.square().scale(0.5 * self.stiffness)
    }

    fn convex(&self, q: &[f64; 12]) -> Local<12> {
        let mut local = Local::zero();
        self.add_blended(q, 1.0, &mut local);
        local
    }

    fn add_blended(&self, q: &[f64; 12], _convexity: f64, sum: &mut Local<12>) {
        let change = product(&self.gradient, q) - self.start;
        sum.energy += 0.5 * self.stiffness * change * change;
        for (s, g) in sum.gradient.iter_mut().zip(&self.gradient) {
            *s += self.stiffness * change * g;
        }
        sum.add_square(self.stiffness, &self.gradient);
    }

    fn gradient(&self, q: &[f64; 12]) -> (f64, [f64; 12]) {
        let change = product(&self.gradient, q) - self.start;
        (0.5 * self.stiffness * change * change, self.gradient.map(|g| self.stiffness * change * g))
    }
}

fn product(a: &[f64; 12], b: &[f64; 12]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
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

#[cfg(test)]
mod tests {
    use super::super::element::testing::{Random, check, random_yarn};
    use super::super::wrapping::wrapping_angle;
    use super::*;

    fn random_hinge(random: &mut Random) -> [f64; 12] {
        let mut q = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.3, 0.8, 0.1, -0.3, -0.9, 0.2];
        q.iter_mut().for_each(|x| *x += 0.3 * random.next());
        q
    }

    fn turned(q: &[f64; 12], stride: usize, angle: f64) -> [f64; 12] {
        let turn = glam::DQuat::from_scaled_axis(angle * glam::DVec3::new(0.7, -0.4, 1.1).normalize());
        let mut out = *q;
        for k in (0..12).step_by(stride) {
            let x = turn * glam::DVec3::from_slice(&q[k..k + 3]) + glam::DVec3::ONE;
            out[k..k + 3].copy_from_slice(&x.to_array());
        }
        out
    }

    #[test]
    fn derivatives() {
        let mut random = Random::new(8);
        for _ in 0..10 {
            let start = random_yarn::<3, 12>(&mut random);
            check(&Rate::of_bend(&start, &start, 2.0, 3.0), &random_yarn::<3, 12>(&mut random), 1.0);
            let wrap = Wrapping { stiffness: 2.0, rest_angle: 0.5, sign: -1.0 };
            let start = random_hinge(&mut random);
            check(&Rate::of_wrap(&start, &start, &wrap, 3.0), &random_hinge(&mut random), 1.0);
        }
    }

    #[test]
    fn small_changes_cost_what_the_rate_of_the_angle_does() {
        let mut random = Random::new(10);
        let q = random_yarn::<3, 12>(&mut random);
        let mut moved = q;
        moved.iter_mut().for_each(|x| *x += 1e-5 * random.next());
        let (before, after) = (bend_cosine(&q).0, bend_cosine(&moved).0);
        let sine2 = 1.0 - before * before;
        let expected = (after - before).powi(2) * 3.0 * 2.0 / ((q[11] - q[3]) * sine2.max(0.05));
        assert!(expected > 0.0);
        assert!((Rate::of_bend(&q, &q, 2.0, 3.0).energy(&moved) / expected - 1.0).abs() < 1e-3);

        let q = random_hinge(&mut random);
        let mut moved = q;
        moved.iter_mut().for_each(|x| *x += 1e-5 * random.next());
        let wrap = Wrapping { stiffness: 2.0, rest_angle: 0.5, sign: -1.0 };
        let turned: f64 = wrapping_angle(&moved) - wrapping_angle(&q);
        let (_, weight) = wrapping_gradient(&q);
        let expected = 0.5 * 3.0 * 2.0 * weight * turned * turned;
        assert!((Rate::of_wrap(&q, &q, &wrap, 3.0).energy(&moved) / expected - 1.0).abs() < 1e-3);
    }

    #[test]
    fn rotation_is_free() {
        let mut random = Random::new(9);
        let wrap = Wrapping { stiffness: 1.0, rest_angle: 0.5, sign: 1.0 };
        for angle in [0.01, 0.3, 1.2] {
            for (q, stride) in [(random_yarn::<3, 12>(&mut random), 4), (random_hinge(&mut random), 3)] {
                let end = turned(&q, stride, angle);
                let halfway = std::array::from_fn(|i| 0.5 * (q[i] + end[i]));
                let rate = if stride == 4 {
                    Rate::of_bend(&q, &halfway, 1.0, 1.0)
                } else {
                    Rate::of_wrap(&q, &halfway, &wrap, 1.0)
                };
                let mut bent = end;
                bent[0] += 0.1;
                bent[10] -= 0.2;
                assert!(rate.energy(&end) < 1e-26, "{angle}: {:e}", rate.energy(&end));
                assert!(rate.energy(&bent) > 1e-8);
            }
        }
    }

    #[test]
    fn nodes_that_fall_together_are_not_damped() {
        assert_eq!(Rate::of_bend(&[0.0; 12], &[0.0; 12], 1.0, 1.0), Rate::NONE);
    }
}
