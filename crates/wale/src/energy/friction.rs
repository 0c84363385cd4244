//! Sliding friction of a pass: an anchored spring that gives way at the Coulomb limit.

use wale_numerics::check::Local;
use wale_numerics::jet::Real;

use super::element::Element;

/// Coulomb friction of one pass against the other yarns of its node.
///
/// `Φ = ½ k_f s²` for `|s| ≤ s_m`, else `μλ|s| − ½ μλ s_m`; `s = u − ū`, `s_m = μλ/k_f`     [Cirio2017, section 4.4]
///
/// Local coordinate: `u` \[m\]. The compression `λ` is that of the last step. Sticking is a spring, slipping a
/// constant force; the convex Hessian in slip is the secant `μλ/|s|`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnchoredSpring {
    /// Anchor stiffness `k_f` \[N/m\].
    pub stiffness: f64,
    /// Largest friction force `μλ` \[N\].
    pub limit: f64,
    /// Anchor `ū` \[m\].
    pub anchor: f64,
}

impl AnchoredSpring {
    /// The anchor after a step that ended at `u`: dragged along where the yarn slipped.
    #[must_use]
    pub fn dragged_anchor(&self, u: f64) -> f64 {
        let reach = self.limit / self.stiffness;
        u - (u - self.anchor).clamp(-reach, reach)
    }
}

impl Element<1> for AnchoredSpring {
    const NAME: &'static str = "friction";

    fn energy<T: Real>(&self, q: &[T; 1]) -> T {
        let s = q[0].offset(-self.anchor);
        let reach = self.limit / self.stiffness;
        if s.value().abs() <= reach {
            s.square().scale(0.5 * self.stiffness)
        } else {
            s.scale(self.limit * s.value().signum()).offset(-0.5 * self.limit * reach)
        }
    }

    fn convex(&self, q: &[f64; 1]) -> Local<1> {
        let s = q[0] - self.anchor;
        let reach = self.limit / self.stiffness;
        if s.abs() <= reach {
            let slope = self.stiffness * s;
            Local { energy: 0.5 * slope * s, gradient: [slope], hessian: [[self.stiffness]] }
        } else {
            Local {
                energy: self.limit * (s.abs() - 0.5 * reach),
                gradient: [self.limit * s.signum()],
                hessian: [[self.limit / s.abs()]],
            }
        }
    }
}

/// Coulomb friction between two parallel yarns of a stack: the same spring on how far one has slid against the other.
///
/// Local coordinates: `u` of the one and of the other \[m\]; the anchor is that of their difference `u₂ − u₁`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParallelSpring(pub AnchoredSpring);

impl Element<2> for ParallelSpring {
    const NAME: &'static str = AnchoredSpring::NAME;

    fn energy<T: Real>(&self, q: &[T; 2]) -> T {
        self.0.energy(&[q[1] - q[0]])
    }

    fn convex(&self, q: &[f64; 2]) -> Local<2> {
        let Local { energy, gradient: [g], hessian: [[h]] } = self.0.convex(&[q[1] - q[0]]);
        Local { energy, gradient: [-g, g], hessian: [[h, -h], [-h, h]] }
    }
}

#[cfg(test)]
mod tests {
    use super::super::element::testing::check;
    use super::*;

    #[test]
    fn derivatives() {
        let element = AnchoredSpring { stiffness: 10.0, limit: 1.0, anchor: 0.5 };
        check(&element, &[0.55], 0.01);
        let slipping = element.exact(&[0.8]);
        assert!((slipping.gradient[0] - 1.0).abs() < 1e-15 && slipping.hessian[0][0] == 0.0);
        assert!(element.convex(&[0.8]).hessian[0][0] > 0.0);
    }

    #[test]
    fn parallel_yarns_resist_only_their_difference() {
        let element = ParallelSpring(AnchoredSpring { stiffness: 10.0, limit: 1.0, anchor: 0.5 });
        check(&element, &[0.1, 0.65], 0.01);
        let sticking = element.exact(&[0.1, 0.65]);
        assert!((sticking.gradient[1] - 0.5).abs() < 1e-12 && (sticking.gradient[0] + 0.5).abs() < 1e-12);
        let together = element.exact(&[3.1, 3.65]);
        assert!((together.energy - sticking.energy).abs() < 1e-12, "sliding together is free");
        assert!((element.exact(&[0.0, 0.9]).gradient[1] - 1.0).abs() < 1e-12, "Coulomb's limit");
    }

    #[test]
    fn a_closed_cycle_dissipates_the_known_work() {
        // 4 μN (A − μN/k_f) with μN = 0.3 mN, k_f = 10 N/m, A = 0.1 mm.
        let mut element = AnchoredSpring { stiffness: 10.0, limit: 0.3e-3, anchor: 0.0 };
        let amplitude = 1e-4;
        let n = 4000;
        let mut work = [0.0, 0.0];
        let mut force = 0.0;
        for cycle in 0..2 {
            for i in 0..n {
                let at = |i: i32| amplitude * (std::f64::consts::TAU * f64::from(i) / f64::from(n)).sin();
                let next = element.convex(&[at(i + 1)]).gradient[0];
                work[cycle] += 0.5 * (force + next) * (at(i + 1) - at(i));
                force = next;
                element.anchor = element.dragged_anchor(at(i + 1));
            }
        }
        let expected = 4.0 * 0.3e-3 * (amplitude - 0.3e-3 / 10.0);
        assert!((expected - 8.4e-8).abs() < 1e-20);
        assert!((work[1] / expected - 1.0).abs() < 1e-3, "{} {expected}", work[1]);
    }

    #[test]
    fn small_cycles_leave_the_anchor() {
        let element = AnchoredSpring { stiffness: 10.0, limit: 1e-3, anchor: 0.2 };
        assert!((element.dragged_anchor(0.2 + 0.9e-4) - 0.2).abs() < 1e-16);
        assert!((element.dragged_anchor(0.2 + 2e-4) - (0.2 + 1e-4)).abs() < 1e-16);
    }
}
