//! Contact of two nodes of a fabric that meet where they are not knitted together.

use wale_numerics::check::Local;
use wale_numerics::jet::Real;
use wale_numerics::jet::vector3::{dot, sub};

use super::element::{Element, point};

/// Contact of two nodes as of two balls.
///
/// `V = ½ k max(0, d − |x₂ − x₁|)²`. Local coordinates: `x₁ x₂` \[m\].
///
/// The Hessian couples no node with another, so that contacts come and go without a change of the matrix' pattern:
/// `½(δ₂ − δ₁)² ≤ δ₁² + δ₂²` bounds it from above, and equals it where the two move apart or together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SelfContact {
    /// Stiffness `k` \[N/m\].
    pub stiffness: f64,
    /// Distance `d` below which the nodes push each other apart \[m\].
    pub distance: f64,
}

impl SelfContact {
    /// Depth \[m\] and unit vector from the first node to the second, if they touch. Where the nodes coincide any direction is as good as
    /// another; energy and gradient must agree that they touch.
    #[must_use]
    pub fn touch(&self, q: &[f64; 6]) -> Option<(f64, [f64; 3])> {
        let d = sub(point(q, 3), point(q, 0));
        let length = dot(d, d).sqrt();
        let direction = if length > 0.0 { d.map(|x| x / length) } else { [0.0, 0.0, 1.0] };
        (length < self.distance).then_some((self.distance - length, direction))
    }
}

impl Element<6> for SelfContact {
    const NAME: &'static str = "self-contact";
    const COUPLES: bool = false;

    fn energy<T: Real>(&self, q: &[T; 6]) -> T {
        let d = sub(point(q, 3), point(q, 0));
        let length = dot(d, d).sqrt();
        if length.value() < self.distance {
            length.offset(-self.distance).square().scale(0.5 * self.stiffness)
        } else {
            T::constant(0.0)
        }
    }

    fn convex(&self, q: &[f64; 6]) -> Local<6> {
        let mut local = Local::zero();
        local.add_gradient(self.gradient(q));
        if let Some((_, n)) = self.touch(q) {
            for (first, k) in [(0, 2.0 * self.stiffness), (3, 2.0 * self.stiffness)] {
                for i in 0..3 {
                    for j in 0..3 {
                        local.hessian[first + i][first + j] = k * n[i] * n[j];
                    }
                }
            }
        }
        local
    }

    fn gradient(&self, q: &[f64; 6]) -> (f64, [f64; 6]) {
        let Some((depth, n)) = self.touch(q) else { return (0.0, [0.0; 6]) };
        let f = n.map(|n| self.stiffness * depth * n);
        (0.5 * self.stiffness * depth * depth, [f[0], f[1], f[2], -f[0], -f[1], -f[2]])
    }
}

#[cfg(test)]
mod tests {
    use super::super::element::testing::{Random, check};
    use super::*;

    #[test]
    fn derivatives() {
        let mut random = Random::new(17);
        for _ in 0..10 {
            let q = std::array::from_fn(|_| 0.4 * random.next());
            check(&SelfContact { stiffness: 3.0, distance: 2.0 }, &q, 1.0);
        }
    }

    #[test]
    fn known_answer_and_nothing_apart() {
        let element = SelfContact { stiffness: 3.0, distance: 2.0 };
        let local = element.convex(&[0.0, 0.0, 0.0, 1.5, 0.0, 0.0]);
        assert!((local.energy - 0.375).abs() < 1e-15 && (local.gradient[0] - 1.5).abs() < 1e-15);
        assert_eq!(element.convex(&[0.0, 0.0, 0.0, 2.5, 0.0, 0.0]).energy, 0.0);
    }

    #[test]
    fn nodes_that_coincide_touch() {
        let element = SelfContact { stiffness: 3.0, distance: 2.0 };
        let q = [0.3; 6];
        let local = element.convex(&q);
        assert_eq!(local.energy, element.energy(&q));
        assert_eq!(local.energy, 6.0);
        assert_eq!(local.gradient.map(f64::abs).iter().sum::<f64>(), 12.0);
    }

    #[test]
    fn the_hessian_bounds_the_exact_one_and_equals_it_head_on() {
        let element = SelfContact { stiffness: 3.0, distance: 2.0 };
        let q = [0.0, 0.0, 0.0, 1.5, 0.0, 0.0];
        let (convex, exact) = (element.convex(&q), element.exact(&q));
        let along = |h: &[[f64; 6]; 6], d: [f64; 6]| -> f64 {
            (0..6).map(|i| (0..6).map(|j| d[i] * h[i][j] * d[j]).sum::<f64>()).sum()
        };
        let head_on = [-1.0, 0.0, 0.0, 1.0, 0.0, 0.0];
        assert!((along(&convex.hessian, head_on) - along(&exact.hessian, head_on)).abs() < 1e-12);
        let mut random = Random::new(18);
        for _ in 0..20 {
            let d = std::array::from_fn(|_| random.next());
            assert!(along(&convex.hessian, d) >= along(&exact.hessian, d));
        }
    }
}
