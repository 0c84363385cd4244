//! Forces that do not depend on the fabric's shape, and air drag.

use wale_numerics::check::Local;
use wale_numerics::jet::Real;

use super::element::Element;

/// A force and a drag on one node: `V = −f·x + ½ c |x − x_n|²`.
///
/// `c` is the drag coefficient over the step length. Local coordinates: `x` \[m\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// Force `f` \[N\].
    pub force: [f64; 3],
    /// Drag coefficient over step length `c` \[N/m\].
    pub drag: f64,
    /// Place at the start of the step `x_n` (moved with the wind, if any) \[m\].
    pub previous: [f64; 3],
}

impl Element<3> for Load {
    const NAME: &'static str = "load";

    fn energy<T: Real>(&self, q: &[T; 3]) -> T {
        (0..3).fold(T::constant(0.0), |sum, k| {
            sum + q[k].offset(-self.previous[k]).square().scale(0.5 * self.drag) - q[k].scale(self.force[k])
        })
    }

    fn convex(&self, q: &[f64; 3]) -> Local<3> {
        let mut local = Local::zero();
        for k in 0..3 {
            let moved = q[k] - self.previous[k];
            local.energy += 0.5 * self.drag * moved * moved - self.force[k] * q[k];
            local.gradient[k] = self.drag * moved - self.force[k];
            local.hessian[k][k] = self.drag;
        }
        local
    }
}

#[cfg(test)]
mod tests {
    use super::super::element::testing::check;
    use super::*;

    #[test]
    fn derivatives_and_known_answer() {
        let element = Load { force: [1.0, -2.0, 0.5], drag: 3.0, previous: [0.1, 0.2, 0.3] };
        check(&element, &[0.4, 0.5, 0.6], 0.1);
        // Still air at the start of the step: the force alone.
        assert_eq!(element.convex(&[0.1, 0.2, 0.3]).gradient, [-1.0, 2.0, -0.5]);
    }
}
