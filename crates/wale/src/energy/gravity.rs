//! Weight of a yarn segment.

use wale_numerics::check::Local;
use wale_numerics::jet::Real;

use super::element::Element;

/// Weight of a yarn segment whose material slides through its nodes.
///
/// `V = −ρ_l Δu g·(x₀ + x₁)/2`
///
/// Local coordinates: `x₀ u₀ x₁ u₁` \[m\]. The energy is bilinear, hence indefinite: the convex Hessian is zero. The
/// force on a sliding coordinate depends on the origin only at a yarn's end, whose coordinate is fixed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gravity {
    /// Weight a length: linear density times acceleration `ρ_l g` \[N/m\].
    pub weight: [f64; 3],
}

impl Element<8> for Gravity {
    const NAME: &'static str = "gravity";

    fn energy<T: Real>(&self, q: &[T; 8]) -> T {
        let height = (q[0] + q[4]).scale(self.weight[0])
            + (q[1] + q[5]).scale(self.weight[1])
            + (q[2] + q[6]).scale(self.weight[2]);
        ((q[7] - q[3]) * height).scale(-0.5)
    }

    fn convex(&self, q: &[f64; 8]) -> Local<8> {
        let (energy, gradient) = self.gradient(q);
        Local { energy, gradient, hessian: [[0.0; 8]; 8] }
    }

    fn add_blended(&self, q: &[f64; 8], convexity: f64, sum: &mut Local<8>) {
        sum.add_gradient(self.gradient(q));
        for k in 0..3 {
            let w = 0.5 * (1.0 - convexity) * self.weight[k];
            for (x, u, w) in [(k, 3, w), (4 + k, 3, w), (k, 7, -w), (4 + k, 7, -w)] {
                sum.hessian[x][u] += w;
                sum.hessian[u][x] += w;
            }
        }
    }

    fn gradient(&self, q: &[f64; 8]) -> (f64, [f64; 8]) {
        let rest = q[7] - q[3];
        let height: f64 = (0..3).map(|k| self.weight[k] * (q[k] + q[4 + k])).sum();
        let w = self.weight.map(|w| -0.5 * rest * w);
        let by_rest = -0.5 * height;
        (-0.5 * rest * height, [w[0], w[1], w[2], -by_rest, w[0], w[1], w[2], by_rest])
    }
}

#[cfg(test)]
mod tests {
    use super::super::element::testing::{Random, check, random_yarn};
    use super::*;

    #[test]
    fn derivatives_and_known_answer() {
        let mut random = Random::new(6);
        for _ in 0..5 {
            check(&Gravity { weight: [0.1, -0.2, -9.81] }, &random_yarn::<2, 8>(&mut random), 1.0);
        }
        // 2 m of 0.1 kg/m, 3 m up: 0.2 · 9.81 · 3 J.
        let energy = Gravity { weight: [0.0, 0.0, -0.981] }.energy(&[0.0, 0.0, 2.0, 1.0, 0.0, 0.0, 4.0, 3.0]);
        assert!((energy - 0.2 * 9.81 * 3.0).abs() < 1e-12);
    }
}
