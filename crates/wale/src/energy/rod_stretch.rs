//! Stretch of a yarn edge of fixed rest length, soft at first and stiff when all its fibres are taut.

use wale_numerics::check::Local;
use wale_numerics::jet::Real;
use wale_numerics::jet::vector3::{dot, sub};

use super::element::{Element, point};

/// Stretch of a yarn edge in two phases, for yarns of fibres that pull taut one after the other.
///
/// `V = ½ L̄ k_s2 ε²` for `ε ≤ 0`, `½ L̄ k_s1 ε²` for `0 ≤ ε ≤ ε̄`, and `½ L̄ (k_s2 (ε − ε̄)² + k_s1 ε̄ (2ε − ε̄))` beyond,
/// with `ε = |x₁ − x₀|/L̄ − 1`                                                                  [Sperl2022, Eq. 5]
///
/// The tension is continuous, its slope jumps at `0` and at `ε̄`. Local coordinates: `x₀ x₁` \[m\]. Undefined where the edge
/// has no length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RodStretch {
    /// Stiffness `k_s1` at small stretch \[N\].
    pub soft: f64,
    /// Stiffness `k_s2` in compression and at large stretch \[N\].
    pub stiff: f64,
    /// Stretch `ε̄` at which the yarn becomes stiff \[–\], not negative.
    pub onset: f64,
    /// Rest length `L̄` \[m\].
    pub rest_length: f64,
}

impl RodStretch {
    /// Energy a rest length, and its derivatives by the strain: tension and stiffness \[N\].
    fn profile(&self, strain: f64) -> [f64; 3] {
        let Self { soft, stiff, onset, .. } = *self;
        if strain <= 0.0 {
            [0.5 * stiff * strain * strain, stiff * strain, stiff]
        } else if strain <= onset {
            [0.5 * soft * strain * strain, soft * strain, soft]
        } else {
            let over = strain - onset;
            [0.5 * (stiff * over * over + soft * onset * (2.0 * strain - onset)), stiff * over + soft * onset, stiff]
        }
    }

    /// How the energy \[J\] changes with the onset `ε̄`.
    #[must_use]
    pub fn energy_by_onset(&self, q: &[f64; 6]) -> f64 {
        let d = sub(point(q, 3), point(q, 0));
        let over = dot(d, d).sqrt() / self.rest_length - 1.0 - self.onset;
        if over > 0.0 { self.rest_length * (self.soft - self.stiff) * over } else { 0.0 }
    }

    /// How the gradient \[N\] changes with the onset `ε̄`.
    #[must_use]
    pub fn gradient_by_onset(&self, q: &[f64; 6]) -> [f64; 6] {
        let d = sub(point(q, 3), point(q, 0));
        let length = dot(d, d).sqrt();
        let tension = if length / self.rest_length - 1.0 > self.onset { self.soft - self.stiff } else { 0.0 };
        let f = d.map(|x| x * tension / length);
        [-f[0], -f[1], -f[2], f[0], f[1], f[2]]
    }
}

impl Element<6> for RodStretch {
    const NAME: &'static str = "rod stretch";

    fn energy<T: Real>(&self, q: &[T; 6]) -> T {
        let d = sub(point(q, 3), point(q, 0));
        let strain = dot(d, d).sqrt().scale(1.0 / self.rest_length).offset(-1.0);
        let (soft, stiff, onset) = (self.soft, self.stiff, self.onset);
        let twice = if strain.value() <= 0.0 {
            strain.square().scale(stiff)
        } else if strain.value() <= onset {
            strain.square().scale(soft)
        } else {
            strain.offset(-onset).square().scale(stiff) + strain.scale(2.0).offset(-onset).scale(soft * onset)
        };
        twice.scale(0.5 * self.rest_length)
    }

    fn convex(&self, q: &[f64; 6]) -> Local<6> {
        let mut local = Local::zero();
        self.add_blended(q, 1.0, &mut local);
        local
    }

    fn add_blended(&self, q: &[f64; 6], convexity: f64, sum: &mut Local<6>) {
        let d = sub(point(q, 3), point(q, 0));
        let length = dot(d, d).sqrt();
        let [energy, tension, stiffness] = self.profile(length / self.rest_length - 1.0);
        let t = d.map(|x| x / length);
        let pull = t.map(|x| x * tension);
        sum.add_gradient((self.rest_length * energy, [-pull[0], -pull[1], -pull[2], pull[0], pull[1], pull[2]]));
        // Pushed together, an edge buckles: the convex Hessian leaves that out.
        let side = if tension > 0.0 { tension } else { (1.0 - convexity) * tension } / length;
        let along = stiffness / self.rest_length;
        for i in 0..3 {
            for j in 0..3 {
                let eye = f64::from(u8::from(i == j));
                let value = along * t[i] * t[j] + side * (eye - t[i] * t[j]);
                sum.hessian[i][j] += value;
                sum.hessian[3 + i][3 + j] += value;
                sum.hessian[i][3 + j] -= value;
                sum.hessian[3 + i][j] -= value;
            }
        }
    }

    fn gradient(&self, q: &[f64; 6]) -> (f64, [f64; 6]) {
        let d = sub(point(q, 3), point(q, 0));
        let length = dot(d, d).sqrt();
        let [energy, tension, _] = self.profile(length / self.rest_length - 1.0);
        let f = d.map(|x| x * tension / length);
        (self.rest_length * energy, [-f[0], -f[1], -f[2], f[0], f[1], f[2]])
    }
}

#[cfg(test)]
mod tests {
    use super::super::element::testing::{Random, check, check_blend};
    use super::super::rigid_motion::check_rigid_motion;
    use super::*;

    const ELEMENT: RodStretch = RodStretch { soft: 2.0, stiff: 50.0, onset: 0.1, rest_length: 0.8 };

    /// An edge of some direction that is strained so much.
    fn strained(random: &mut Random, strain: f64) -> [f64; 6] {
        let d: [f64; 3] = std::array::from_fn(|_| random.next());
        let factor = ELEMENT.rest_length * (1.0 + strain) / dot(d, d).sqrt();
        let x: [f64; 3] = std::array::from_fn(|_| random.next());
        std::array::from_fn(|i| if i < 3 { x[i] } else { x[i - 3] + factor * d[i - 3] })
    }

    #[test]
    fn the_gradient_follows_the_onset() {
        let mut random = Random::new(54);
        for strain in [-0.2, 0.05, 0.3] {
            let q = strained(&mut random, strain);
            let at = |onset: f64| RodStretch { onset, ..ELEMENT }.gradient(&q).1;
            let (up, down, slope) = (at(ELEMENT.onset + 1e-6), at(ELEMENT.onset - 1e-6), ELEMENT.gradient_by_onset(&q));
            assert!(slope.iter().enumerate().all(|(i, s)| ((up[i] - down[i]) / 2e-6 - s).abs() < 1e-6));
            let energy = |onset: f64| RodStretch { onset, ..ELEMENT }.gradient(&q).0;
            let expected = (energy(ELEMENT.onset + 1e-6) - energy(ELEMENT.onset - 1e-6)) / 2e-6;
            assert!((expected - ELEMENT.energy_by_onset(&q)).abs() < 1e-6);
            assert_eq!(slope.iter().any(|s| s.abs() > 1.0), strain > ELEMENT.onset);
        }
    }

    #[test]
    fn derivatives_in_every_phase() {
        let mut random = Random::new(51);
        for strain in [-0.4, -0.05, 0.03, 0.07, 0.2, 0.9] {
            for _ in 0..5 {
                let q = strained(&mut random, strain);
                check(&ELEMENT, &q, 0.1);
                check_blend(&ELEMENT, &q, 1e-10);
                check_rigid_motion(&ELEMENT, &q);
                let ((energy, gradient), local) = (ELEMENT.gradient(&q), ELEMENT.convex(&q));
                assert!((energy - local.energy).abs() < 1e-14 * energy);
                assert!(
                    gradient.iter().zip(&local.gradient).all(|(a, b)| (a - b).abs() < 1e-13 * local.energy.max(1.0))
                );
            }
        }
    }

    #[test]
    fn energy_and_tension_have_no_jump_and_stiffness_has() {
        for (strain, before, after) in [(0.0, 50.0, 2.0), (0.1, 2.0, 50.0)] {
            let (low, high) = (ELEMENT.profile(strain - 1e-12), ELEMENT.profile(strain + 1e-12));
            assert!((low[0] - high[0]).abs() < 1e-11 && (low[1] - high[1]).abs() < 1e-9);
            assert_eq!((low[2], high[2]), (before, after));
        }
    }

    #[test]
    fn known_answer() {
        // Strain 0.3: 0.2 beyond the onset: tension 50·0.2 + 2·0.1 N, energy 0.4 (50·0.04 + 0.2·0.5) J.
        let local = ELEMENT.convex(&[0.0, 0.0, 0.0, 0.0, 1.04, 0.0]);
        assert!((local.gradient[4] - 10.2).abs() < 1e-12, "{:?}", local.gradient);
        assert!((local.energy - 0.4 * 2.1).abs() < 1e-12, "{}", local.energy);
    }
}
