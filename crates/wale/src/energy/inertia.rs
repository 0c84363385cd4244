//! Inertia and mass damping of a yarn segment whose material slides through its nodes.

use wale_numerics::check::Local;
use wale_numerics::jet::Real;

use super::element::Element;

/// Kinetic part of an implicit step, a quadratic about where the segment would go by itself.
///
/// `V = ½ c (q − q*)ᵀ M (q − q*)` with the generalised mass of a segment with linear material velocity
/// `M = ρ_l Δu/6 · [2 1; 1 2] ⊗ [I, −w; −wᵀ, w²]`, `w = (x₁ − x₀)/Δu`        [Sueda2011, as used by Cirio2017]
///
/// `M` is frozen at the start of the step, as in [Casafranca2020, section 4.2]; the terms dropped with that are far
/// below the error of implicit Euler. Local coordinates: `x₀ u₀ x₁ u₁` \[m\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertia {
    /// Linear density `ρ_l` of the yarn \[kg/m\]; the energy has it in its factor.
    pub density: f64,
    /// `c ρ_l Δu/6` \[kg/s²\], where `c = 1/h² + α/h`.
    pub factor: f64,
    /// Segment over rest length `w` at the start of the step \[–\].
    pub direction: [f64; 3],
    /// Where the segment would go by itself, `q*` \[m\].
    pub target: [f64; 8],
}

/// Share of a segment's mass that resists sliding without material velocity: the mass matrix is singular where a
/// node's yarns are parallel, and this keeps their sliding coordinates determined.
pub const SLIDING_REGULARISATION: f64 = 1e-2;

impl Inertia {
    /// `M v` over `ρ_l Δu/6`, with `a`, `b` the material velocities at both ends.
    fn product<T: Real>(&self, v: &[T; 8]) -> [T; 8] {
        let w = self.direction;
        let a: [T; 3] = std::array::from_fn(|k| v[k] - v[3].scale(w[k]));
        let b: [T; 3] = std::array::from_fn(|k| v[4 + k] - v[7].scale(w[k]));
        let pa: [T; 3] = std::array::from_fn(|k| a[k].scale(2.0) + b[k]);
        let pb: [T; 3] = std::array::from_fn(|k| b[k].scale(2.0) + a[k]);
        let along = |p: &[T; 3]| p[0].scale(-w[0]) + p[1].scale(-w[1]) + p[2].scale(-w[2]);
        let small = 3.0 * SLIDING_REGULARISATION;
        let (ua, ub) = (along(&pa) + v[3].scale(small), along(&pb) + v[7].scale(small));
        [pa[0], pa[1], pa[2], ua, pb[0], pb[1], pb[2], ub]
    }
}

impl Element<8> for Inertia {
    const NAME: &'static str = "inertia";

    fn energy<T: Real>(&self, q: &[T; 8]) -> T {
        let v: [T; 8] = std::array::from_fn(|i| q[i].offset(-self.target[i]));
        let p = self.product(&v);
        (0..8).fold(T::constant(0.0), |sum, i| sum + v[i] * p[i]).scale(0.5 * self.factor)
    }

    fn convex(&self, q: &[f64; 8]) -> Local<8> {
        let mut local = Local::zero();
        self.add_blended(q, 1.0, &mut local);
        local
    }

    fn add_blended(&self, q: &[f64; 8], _convexity: f64, sum: &mut Local<8>) {
        sum.add_gradient(self.gradient(q));
        let w = self.direction;
        let w2 = w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
        for (row, column, weight) in [(0, 0, 2.0), (0, 4, 1.0), (4, 0, 1.0), (4, 4, 2.0)] {
            let f = self.factor * weight;
            for k in 0..3 {
                sum.hessian[row + k][column + k] += f;
                sum.hessian[row + k][column + 3] -= f * w[k];
                sum.hessian[row + 3][column + k] -= f * w[k];
            }
            let extra = if row == column { 3.0 * SLIDING_REGULARISATION * self.factor } else { 0.0 };
            sum.hessian[row + 3][column + 3] += f * w2 + extra;
        }
    }

    fn gradient(&self, q: &[f64; 8]) -> (f64, [f64; 8]) {
        let v: [f64; 8] = std::array::from_fn(|i| q[i] - self.target[i]);
        let p = self.product(&v).map(|x| self.factor * x);
        let energy = 0.5 * v.iter().zip(&p).map(|(a, b)| a * b).sum::<f64>();
        (energy, p)
    }
}

#[cfg(test)]
mod tests {
    use super::super::element::testing::{Random, check, random_yarn};
    use super::*;

    #[test]
    fn derivatives() {
        let mut random = Random::new(7);
        for _ in 0..10 {
            let target = random_yarn::<2, 8>(&mut random);
            let element = Inertia { density: 1.0, factor: 2.0, direction: [0.9, 0.2, -0.3], target };
            check(&element, &random_yarn::<2, 8>(&mut random), 1.0);
        }
    }

    #[test]
    fn translation_has_the_whole_mass_and_sliding_along_itself_almost_none() {
        let target = [0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 2.0];
        let element = Inertia { density: 1.0, factor: 1.5, direction: [1.0, 0.0, 0.0], target };
        // ½ c ρ Δu v² with ρΔu = 6·factor/c.
        let moved = [0.0, 1.0, 0.0, 0.0, 2.0, 1.0, 0.0, 2.0];
        assert!((element.energy(&moved) - 0.5 * 9.0).abs() < 1e-12);
        // x and u together along the yarn: the material stands still.
        let renamed = [0.3, 0.0, 0.0, 0.3, 2.3, 0.0, 0.0, 2.3];
        assert!(element.energy(&renamed) <= 0.5 * 1.5 * 6.0 * SLIDING_REGULARISATION * 0.09 + 1e-15);
    }
}
