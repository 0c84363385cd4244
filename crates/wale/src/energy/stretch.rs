//! Stretch of a yarn segment.

use wale_numerics::check::Local;
use wale_numerics::jet::Real;
use wale_numerics::jet::vector3::{dot, sub};

use super::element::{Element, point};

/// Stretch of a yarn segment whose material slides through its two nodes.
///
/// `V = ½ k_s Δu (|w| − 1)²`, `w = (x₁ − x₀)/Δu`, `Δu = u₁ − u₀`             [Cirio2014, as used by Cirio2017]
///
/// Local coordinates: `x₀ u₀ x₁ u₁` \[m\]. `V` is jointly convex in the segment's length and `Δu`, so the convex
/// Hessian only drops the geometric part of a compressed segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Stretch stiffness `k_s = EA` \[N\].
    pub stiffness: f64,
}

impl Element<8> for Stretch {
    const NAME: &'static str = "stretch";

    fn energy<T: Real>(&self, q: &[T; 8]) -> T {
        let d = sub(point(q, 4), point(q, 0));
        let rest = q[7] - q[3];
        let excess = dot(d, d).sqrt() - rest;
        (excess.square() / rest).scale(0.5 * self.stiffness)
    }

    fn convex(&self, q: &[f64; 8]) -> Local<8> {
        let mut local = Local::zero();
        self.add_blended(q, 1.0, &mut local);
        local
    }

    fn add_blended(&self, q: &[f64; 8], convexity: f64, local: &mut Local<8>) {
        let d = sub(point(q, 4), point(q, 0));
        let rest = q[7] - q[3];
        let length = dot(d, d).sqrt();
        let ratio = length / rest;
        let inverse_length = if length > 0.0 { 1.0 / length } else { 0.0 };
        let t = d.map(|x| x * inverse_length);
        let tension = self.stiffness * (ratio - 1.0);
        let by_rest = 0.5 * self.stiffness * (1.0 - ratio * ratio);
        let gradient = [
            -tension * t[0],
            -tension * t[1],
            -tension * t[2],
            -by_rest,
            tension * t[0],
            tension * t[1],
            tension * t[2],
            by_rest,
        ];
        local.add_gradient((0.5 * self.stiffness * rest * (ratio - 1.0) * (ratio - 1.0), gradient));
        let g = [-t[0], -t[1], -t[2], ratio, t[0], t[1], t[2], -ratio];
        local.add_square(self.stiffness / rest, &g);
        // Pushed together, a segment buckles: the convex Hessian leaves that out.
        let side = if tension > 0.0 { tension } else { (1.0 - convexity) * tension } * inverse_length;
        for i in 0..3 {
            for j in 0..3 {
                let value = side * (f64::from(u8::from(i == j)) - t[i] * t[j]);
                local.hessian[i][j] += value;
                local.hessian[4 + i][4 + j] += value;
                local.hessian[i][4 + j] -= value;
                local.hessian[4 + i][j] -= value;
            }
        }
    }

    fn gradient(&self, q: &[f64; 8]) -> (f64, [f64; 8]) {
        let d = sub(point(q, 4), point(q, 0));
        let rest = q[7] - q[3];
        let length = dot(d, d).sqrt();
        let ratio = length / rest;
        let pull = if length > 0.0 { self.stiffness * (ratio - 1.0) / length } else { 0.0 };
        let by_rest = 0.5 * self.stiffness * (1.0 - ratio * ratio);
        let f = d.map(|x| x * pull);
        (
            0.5 * self.stiffness * rest * (ratio - 1.0) * (ratio - 1.0),
            [-f[0], -f[1], -f[2], -by_rest, f[0], f[1], f[2], by_rest],
        )
    }
}

#[cfg(test)]
mod tests {
    use super::super::element::testing::{Random, check, check_blend, random_yarn};
    use super::*;

    #[test]
    fn derivatives() {
        let mut random = Random::new(1);
        for _ in 0..20 {
            let q = random_yarn::<2, 8>(&mut random);
            check(&Stretch { stiffness: 3.0 }, &q, 1.0);
            check_blend(&Stretch { stiffness: 3.0 }, &q, 1e-10);
        }
    }

    #[test]
    fn a_stretched_segment_has_the_exact_hessian() {
        let q = [0.0, 0.1, 0.0, 0.2, 1.5, 0.3, -0.2, 1.1];
        let element = Stretch { stiffness: 2.0 };
        let (convex, exact) = (element.convex(&q), element.exact(&q));
        for i in 0..8 {
            for j in 0..8 {
                assert!((convex.hessian[i][j] - exact.hessian[i][j]).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn known_answer() {
        // 10 % strain of 2 N over 1 m: ½·2·0.01 J and 0.2 N.
        let local = Stretch { stiffness: 2.0 }.convex(&[0.0, 0.0, 0.0, 0.0, 1.1, 0.0, 0.0, 1.0]);
        assert!((local.energy - 0.01).abs() < 1e-15);
        assert!((local.gradient[4] - 0.2).abs() < 1e-15);
    }
}
