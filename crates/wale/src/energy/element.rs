//! The element: a potential energy of a few local coordinates that knows nothing of the fabric it belongs to.

use wale_numerics::check::Local;
use wale_numerics::jet::{Jet, Real};

/// A potential energy of `N` local coordinates.
pub trait Element<const N: usize>: Copy + Send + Sync {
    /// Name in logs and metrics.
    const NAME: &'static str;
    /// Whether the Hessian couples nodes; one that does not needs no blocks off the diagonal.
    const COUPLES: bool = true;

    /// The energy \[J\]: the definition, written once, over any scalar.
    fn energy<T: Real>(&self, q: &[T; N]) -> T;

    /// Value, gradient and exact Hessian, by automatic differentiation.
    fn exact(&self, q: &[f64; N]) -> Local<N> {
        let jet = self.energy(&Jet::variables(q));
        Local { energy: jet.value, gradient: jet.gradient, hessian: jet.hessian() }
    }

    /// Value, exact gradient, and a positive semi-definite Hessian that a descent method may use, in closed form.
    fn convex(&self, q: &[f64; N]) -> Local<N>;

    /// Adds value, exact gradient, and a Hessian between the exact one (`convexity = 0`) and the convex one
    /// (`convexity = 1`), in closed form.
    ///
    /// The convex one lets Newton's method take whole steps wherever it is; the exact one is what it converges fast with,
    /// once it is near.
    fn add_blended(&self, q: &[f64; N], _convexity: f64, sum: &mut Local<N>) {
        sum.add(&self.convex(q));
    }

    /// Whether energy and derivatives may differ from zero here: a quick look that spares contacts out of reach the rest.
    fn acts(&self, _q: &[f64; N]) -> bool {
        true
    }

    /// Calls `visit` with the name and energy \[J\] of every part.
    fn parts(&self, q: &[f64; N], visit: &mut impl FnMut(&'static str, f64)) {
        visit(Self::NAME, self.energy(q));
    }

    /// Value and gradient alone; the hot path of line searches.
    fn gradient(&self, q: &[f64; N]) -> (f64, [f64; N]) {
        let local = self.convex(q);
        (local.energy, local.gradient)
    }
}

/// Two elements over the same coordinates are one: they are evaluated, and written into the matrix, together.
impl<A: Element<N>, B: Element<N>, const N: usize> Element<N> for (A, B) {
    const NAME: &'static str = A::NAME;

    fn energy<T: Real>(&self, q: &[T; N]) -> T {
        self.0.energy(q) + self.1.energy(q)
    }
    fn convex(&self, q: &[f64; N]) -> Local<N> {
        let mut sum = Local::zero();
        self.add_blended(q, 1.0, &mut sum);
        sum
    }
    fn add_blended(&self, q: &[f64; N], convexity: f64, sum: &mut Local<N>) {
        self.0.add_blended(q, convexity, sum);
        self.1.add_blended(q, convexity, sum);
    }
    fn gradient(&self, q: &[f64; N]) -> (f64, [f64; N]) {
        let (a, b) = (self.0.gradient(q), self.1.gradient(q));
        (a.0 + b.0, std::array::from_fn(|i| a.1[i] + b.1[i]))
    }
    fn parts(&self, q: &[f64; N], visit: &mut impl FnMut(&'static str, f64)) {
        self.0.parts(q, visit);
        self.1.parts(q, visit);
    }
}

/// Position of the `k`-th three coordinates from `start`.
pub(crate) fn point<T: Copy, const N: usize>(q: &[T; N], start: usize) -> [T; 3] {
    [q[start], q[start + 1], q[start + 2]]
}

#[cfg(test)]
pub(crate) mod testing {
    //! What every element must pass.
    use super::Element;
    use wale_numerics::check::{gradient_error, hessian_error, relative_smallest_eigenvalue};

    /// Closed gradient against automatic and numeric ones; automatic Hessian against differences; convex Hessian
    /// symmetric and positive semi-definite.
    pub fn check<E: Element<N>, const N: usize>(element: &E, q: &[f64; N], scale: f64) {
        let convex = element.convex(q);
        let exact = element.exact(q);
        assert!((convex.energy - exact.energy).abs() <= 1e-12 * exact.energy.abs().max(1e-30), "{} energy", E::NAME);
        assert!(
            (convex.energy - element.energy(q)).abs() <= 1e-12 * exact.energy.abs().max(1e-30),
            "{} energy over f64",
            E::NAME
        );
        let norm = exact.gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
        for i in 0..N {
            let difference = (convex.gradient[i] - exact.gradient[i]).abs();
            assert!(
                difference <= 1e-10 * norm,
                "{} gradient {i}: closed {} automatic {}",
                E::NAME,
                convex.gradient[i],
                exact.gradient[i]
            );
        }
        let error = gradient_error(|q| element.energy(q), &exact.gradient, q, scale);
        assert!(error < 1e-7, "{} gradient against differences: {error:e}", E::NAME);
        let error = hessian_error(|q| element.exact(q).gradient, &exact.hessian, q, scale);
        assert!(error < 1e-7, "{} Hessian against differences: {error:e}", E::NAME);
        for i in 0..N {
            for j in 0..N {
                let asymmetry = (convex.hessian[i][j] - convex.hessian[j][i]).abs();
                assert!(asymmetry <= 1e-9 * (convex.hessian[i][i] + convex.hessian[j][j]).abs().max(1e-300));
            }
        }
        let smallest = relative_smallest_eigenvalue(&convex.hessian);
        assert!(smallest > -1e-10, "{} convex Hessian has eigenvalue {smallest:e}", E::NAME);
    }

    /// The blend's Hessian against the exact one at convexity zero and the convex one at one, and its gradient.
    pub fn check_blend<E: Element<N>, const N: usize>(element: &E, q: &[f64; N], tolerance: f64) {
        let (exact, convex) = (element.exact(q), element.convex(q));
        let largest = exact.hessian.iter().flatten().fold(0.0f64, |m, h| m.max(h.abs()));
        for (convexity, expected) in [(0.0, &exact.hessian), (1.0, &convex.hessian)] {
            let mut blended = wale_numerics::check::Local::zero();
            element.add_blended(q, convexity, &mut blended);
            for i in 0..N {
                assert!((blended.gradient[i] - convex.gradient[i]).abs() <= 1e-12 * largest);
                for j in 0..N {
                    let difference = (blended.hessian[i][j] - expected[i][j]).abs();
                    assert!(
                        difference <= tolerance * largest,
                        "{} {i} {j} at {convexity}: {} {}",
                        E::NAME,
                        blended.hessian[i][j],
                        expected[i][j]
                    );
                }
            }
        }
    }

    /// A deterministic stream of numbers in `[−1, 1)`.
    pub struct Random(u64);

    impl Random {
        pub fn new(seed: u64) -> Self {
            Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
        }
        pub fn next(&mut self) -> f64 {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }
    }

    /// Three-node yarn with strictly increasing arc lengths: `x₀ u₀ x₁ u₁ x₂ u₂`.
    pub fn random_yarn<const NODES: usize, const N: usize>(random: &mut Random) -> [f64; N] {
        let mut q = [0.0; N];
        for k in 0..NODES {
            q[4 * k] = k as f64 + 0.3 * random.next();
            q[4 * k + 1] = 0.6 * random.next();
            q[4 * k + 2] = 0.6 * random.next();
            q[4 * k + 3] = 1.1 * k as f64 + 0.2 * random.next();
        }
        q
    }
}
