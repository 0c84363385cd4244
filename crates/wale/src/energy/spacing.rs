//! Contact between adjacent loops: a barrier on the yarn length between them.

use wale_numerics::check::Local;
use wale_numerics::jet::Real;

use super::element::Element;

/// Keeps adjacent stitch contacts along a yarn from sliding into each other.
///
/// `V = −k_c d (x − 1)² ln x` for `x = Δu/d < 1`, else nothing.
///
/// Local coordinates: `u₀ u₁` \[m\]. Twice continuously differentiable, infinite at `Δu = 0`.
///
/// Differs from the paper: it refers to its predecessor for this contact, whose quadratic penalty does not stop `Δu`
/// from reaching zero, where stretch no longer protects the segment (test `a_barrier_at_zero`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spacing {
    /// Stiffness `k_c` \[N\].
    pub stiffness: f64,
    /// Distance `d` at which the barrier begins \[m\].
    pub distance: f64,
}

impl Element<2> for Spacing {
    const NAME: &'static str = "spacing";

    fn energy<T: Real>(&self, q: &[T; 2]) -> T {
        let x = (q[1] - q[0]).scale(1.0 / self.distance);
        if x.value() >= 1.0 {
            return T::constant(0.0);
        }
        (x.offset(-1.0).square() * x.ln()).scale(-self.stiffness * self.distance)
    }

    fn convex(&self, q: &[f64; 2]) -> Local<2> {
        let x = (q[1] - q[0]) / self.distance;
        if x >= 1.0 {
            return Local::zero();
        }
        let (m, ln) = (x - 1.0, x.ln());
        let slope = -self.stiffness * (2.0 * m * ln + m * m / x);
        // −[2 ln x + 4(x − 1)/x − ((x − 1)/x)²]: every term is non-negative for x ≤ 1.
        let second = -(2.0 * ln + 4.0 * m / x - (m / x) * (m / x));
        let k = self.stiffness / self.distance * second;
        Local {
            energy: -self.stiffness * self.distance * m * m * ln,
            gradient: [-slope, slope],
            hessian: [[k, -k], [-k, k]],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::element::testing::check;
    use super::*;

    #[test]
    fn derivatives() {
        for u in [0.1, 0.4, 0.8] {
            check(&Spacing { stiffness: 4.0, distance: 1.0 }, &[0.2, 0.2 + u], 0.3);
        }
    }

    #[test]
    fn known_answer() {
        let element = Spacing { stiffness: 1.0, distance: 1.0 };
        assert!((element.energy(&[0.0, 0.5]) - 0.173_287).abs() < 1e-6);
    }

    #[test]
    fn the_hessian_is_exact_and_continuous() {
        let element = Spacing { stiffness: 4.0, distance: 1.0 };
        for x in [0.3, 0.7, 0.999] {
            let (convex, exact) = (element.convex(&[0.0, x]), element.exact(&[0.0, x]));
            assert!((convex.hessian[0][0] - exact.hessian[0][0]).abs() < 1e-9);
        }
        assert!(element.convex(&[0.0, 1.0 - 1e-9]).hessian[0][0].abs() < 1e-6);
    }

    #[test]
    fn a_barrier_at_zero() {
        let element = Spacing { stiffness: 1.0, distance: 1.0 };
        let quadratic = 0.5; // what ½ k d (1 − x)² would cost at x = 0
        assert!(element.energy(&[0.0, 1e-12]) > 50.0 * quadratic);
    }
}
