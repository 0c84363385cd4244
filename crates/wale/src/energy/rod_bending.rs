//! Bending of a yarn of fixed rest lengths at a vertex, against a rest curvature.

use wale_numerics::check::Local;
use wale_numerics::jet::Real;
use wale_numerics::jet::vector3::{cross, dot, sub};

use super::angle::{Angle, Turning};
use super::element::{Element, point};

/// Bending between two consecutive edges of an isotropic yarn.
///
/// `V = k_b |κ − κ̄|²/(L̄_a + L̄_b)`, `κ = 2 e×f/(|e||f| + e·f)`, `e = x₁ − x₀`, `f = x₂ − x₁`          [Sperl2022, Eq. 6]
///
/// `|κ| = 2 tan(θ/2)` with the turning angle `θ`; `k_b` is the continuum's `EI`. Local coordinates: `x₀ x₁ x₂` \[m\].
/// Undefined where an edge has no length or the yarn folds back (`θ = π`).
///
/// Differs from the paper: the paper does not say which frame carries `κ̄`, and its yarn has no twist. In every frame that
/// turns with the two edges `κ` points along their binormal. So does `κ̄` here, and only its size matters:
/// `(|κ| − κ̄)²`, or `κ² − 2m √(κ² + ε²) + 2m² − κ̄²` with `ε = κ̄/20` and `m² = κ̄² + ε²`, which is zero at `κ̄` too and round at
/// the straight yarn, where `|κ|` has a kink. This is what remains of a rod with a rest curvature vector when twist costs nothing: its cross-sections turn about the yarn until `κ̄` lies
/// along `κ`. A rest curvature transported from the rest pose would not be the same in a turned fabric. Tests:
/// `rests_at_the_rest_curvature`, `a_vector_of_rest_curvature_free_to_turn_costs_the_same`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RodBending {
    /// Bending stiffness `k_b` \[N·m²\].
    pub stiffness: f64,
    /// Size of the rest curvature `κ̄`, integrated over the vertex \[–\].
    pub rest_curvature: f64,
    /// Rest lengths of both edges together, `L̄_a + L̄_b` \[m\].
    pub rest_length: f64,
}

/// Part `ε/κ̄` of the rest curvature within which of the straight yarn the energy is rounded \[–\].
const ROUNDED: f64 = 0.05;
/// What keeps `m/ε` a number where there is no rest curvature \[–\].
const LEAST_ROUNDED: f64 = 1e-12;
/// Largest `cos(θ/2)⁻²`: a yarn folded in two has no finite curvature.
const SHARPEST: f64 = 1e8;

impl RodBending {
    /// `ε²` and `m`.
    fn rounding(&self) -> (f64, f64) {
        let least = ROUNDED * self.rest_curvature + LEAST_ROUNDED;
        (least * least, self.rest_curvature * (1.0 + ROUNDED * ROUNDED).sqrt())
    }

    /// Energy and its first two derivatives by the turning angle, and `V′ cot(θ/2)`.
    fn profile(&self, angle: &Angle) -> [f64; 4] {
        let (k, rest) = (self.stiffness / self.rest_length, self.rest_curvature);
        let curvature = 2.0 * angle.half_tangent;
        let (rounding, m) = self.rounding();
        let smooth = (curvature * curvature + rounding).sqrt();
        let by_square = 2.0 - 2.0 * m / smooth;
        let first = by_square * curvature;
        let second = 2.0 - 2.0 * m * rounding / (smooth * smooth * smooth);
        // dκ/dθ and d²κ/dθ².
        let by_angle = (1.0 + angle.half_tangent * angle.half_tangent).min(SHARPEST);
        let twice = angle.half_tangent * by_angle;
        [
            k * (curvature * curvature - 2.0 * m * smooth + 2.0 * m * m - rest * rest),
            k * first * by_angle,
            k * (second * by_angle * by_angle + first * twice),
            k * 2.0 * by_square * by_angle,
        ]
    }
}

impl Element<9> for RodBending {
    const NAME: &'static str = "rod bending";

    fn energy<T: Real>(&self, q: &[T; 9]) -> T {
        let (e, f) = (sub(point(q, 3), point(q, 0)), sub(point(q, 6), point(q, 3)));
        let normal = cross(e, f);
        let below = (dot(e, e) * dot(f, f)).sqrt() + dot(e, f);
        let square = (dot(normal, normal) / below.square()).scale(4.0);
        let (rounding, m) = self.rounding();
        let difference = square - square.offset(rounding).sqrt().scale(2.0 * m);
        let constant = 2.0 * m * m - self.rest_curvature * self.rest_curvature;
        difference.offset(constant).scale(self.stiffness / self.rest_length)
    }

    fn convex(&self, q: &[f64; 9]) -> Local<9> {
        let mut local = Local::zero();
        self.add_blended(q, 1.0, &mut local);
        local
    }

    fn add_blended(&self, q: &[f64; 9], convexity: f64, sum: &mut Local<9>) {
        let angle = Angle::new([0, 3, 6].map(|start| point(q, start)));
        let [energy, first, second, over_half_tangent] = self.profile(&angle);
        for (node, by_node) in angle.gradient.iter().enumerate() {
            for i in 0..3 {
                sum.gradient[3 * node + i] += first * by_node[i];
            }
        }
        sum.energy += energy;
        let by_angle = second + convexity * (second.max(0.0) - second);
        let turning = Turning::new(&angle, first, by_angle, over_half_tangent, convexity);
        angle.add_hessian(&turning, [0, 3, 6], &mut sum.hessian);
    }

    fn gradient(&self, q: &[f64; 9]) -> (f64, [f64; 9]) {
        let angle = Angle::new([0, 3, 6].map(|start| point(q, start)));
        let [energy, first, ..] = self.profile(&angle);
        (energy, std::array::from_fn(|k| first * angle.gradient[k / 3][k % 3]))
    }
}

#[cfg(test)]
mod tests {
    use super::super::element::testing::{Random, check, check_blend};
    use super::super::rigid_motion::check_rigid_motion;
    use super::*;

    fn bent(theta: f64, length: f64) -> [f64; 9] {
        [-length, 0.0, 0.0, 0.0, 0.0, 0.0, length * theta.cos(), length * theta.sin(), 0.0]
    }

    #[test]
    fn derivatives() {
        let mut random = Random::new(52);
        for rest_curvature in [0.0, 0.4, 1.5] {
            for _ in 0..20 {
                let q: [f64; 9] =
                    std::array::from_fn(|k| [0.7, 1.0][k % 3 / 2] * (k / 3) as f64 * 0.8 + 0.5 * random.next());
                let element = RodBending { stiffness: 3.0, rest_curvature, rest_length: 1.7 };
                check(&element, &q, 0.1);
                check_blend(&element, &q, 1e-9);
                check_rigid_motion(&element, &q);
            }
        }
    }

    #[test]
    fn nearly_straight_bends_have_exact_hessians() {
        for (theta, rest_curvature) in [(0.0, 0.0), (5e-4, 0.0), (0.0, 0.7), (2e-3, 0.7)] {
            check_blend(&RodBending { stiffness: 1.0, rest_curvature, rest_length: 2.0 }, &bent(theta, 1.0), 1e-5);
        }
    }

    #[test]
    fn a_circle_stores_the_continuum_energy() {
        // ½ EI/r² a length on a closed polygon of 400 bends: EI π/r.
        let (n, r, stiffness) = (400, 0.7, 2.0);
        let step = 2.0 * std::f64::consts::PI / f64::from(n);
        let chord = 2.0 * r * (0.5 * step).sin();
        let element = RodBending { stiffness, rest_curvature: 0.0, rest_length: 2.0 * chord };
        let total = f64::from(n) * element.energy(&bent(step, chord));
        assert!((total / (stiffness * std::f64::consts::PI / r) - 1.0).abs() < 1e-4, "{total}");
    }

    #[test]
    fn rests_at_the_rest_curvature() {
        let rest = 2.0 * (0.4f64).tan();
        let element = RodBending { stiffness: 1.0, rest_curvature: rest, rest_length: 2.0 };
        let at = |theta: f64| element.energy(&bent(theta, 1.0));
        assert!(at(0.8).abs() < 1e-12 && at(0.75) > 1e-4 && at(0.85) > 1e-4 && at(0.0) > 0.3);
        let slope = element.gradient(&bent(0.8, 1.0)).1[7];
        assert!(slope.abs() < 1e-12, "{slope}");
    }

    #[test]
    fn a_vector_of_rest_curvature_free_to_turn_costs_the_same() {
        // The least of |κ − κ̄|² over all directions of κ̄ across the yarn, tried one by one.
        let (rest, theta) = (0.5, 1.1f64);
        let curvature = 2.0 * (0.5 * theta).tan();
        let least = (0..3600)
            .map(|k| std::f64::consts::TAU * f64::from(k) / 3600.0)
            .map(|turn| (curvature - rest * turn.cos()).powi(2) + (rest * turn.sin()).powi(2))
            .fold(f64::INFINITY, f64::min);
        let element = RodBending { stiffness: 1.0, rest_curvature: rest, rest_length: 2.0 };
        let found = element.energy(&bent(theta, 1.0));
        // Rounding takes a little of it, of the order of ε².
        assert!((2.0 * found - least).abs() < 2.0 * (ROUNDED * rest).powi(2), "{found} {least}");
    }

    #[test]
    fn a_yarn_folded_in_two_has_finite_derivatives() {
        let folded = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.25, 0.0, 0.0];
        for convexity in [0.0, 1.0] {
            let mut local = Local::zero();
            let element = RodBending { stiffness: 1.0, rest_curvature: 0.3, rest_length: 2.0 };
            element.add_blended(&folded, convexity, &mut local);
            assert!(local.energy.is_finite() && local.hessian.iter().flatten().all(|h| h.is_finite()));
        }
    }
}
