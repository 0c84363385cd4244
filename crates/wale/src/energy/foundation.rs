//! A light elastic bed under a fabric whose size is measured.

use wale_numerics::check::Local;
use wale_numerics::jet::Real;

use super::element::Element;

/// A spring from a coordinate to a place: `V = ½ k (x − x̄)²`.
///
/// Under the heights of a tile's nodes it is the bed on which swatches are measured, which keeps wide bands of equal
/// wales from rolling up; at the held nodes of a grip, the grip. Local coordinate: one coordinate \[m\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foundation {
    /// Stiffness `k` \[N/m\].
    pub stiffness: f64,
    /// Place `x̄` \[m\].
    pub place: f64,
}

impl Element<1> for Foundation {
    const NAME: &'static str = "foundation";

    fn energy<T: Real>(&self, q: &[T; 1]) -> T {
        q[0].offset(-self.place).square().scale(0.5 * self.stiffness)
    }

    fn convex(&self, q: &[f64; 1]) -> Local<1> {
        let slope = self.stiffness * (q[0] - self.place);
        Local { energy: 0.5 * slope * (q[0] - self.place), gradient: [slope], hessian: [[self.stiffness]] }
    }
}

#[cfg(test)]
mod tests {
    use super::super::element::testing::check;
    use super::*;

    #[test]
    fn derivatives_and_known_answer() {
        let element = Foundation { stiffness: 3.0, place: 0.25 };
        check(&element, &[0.75], 0.1);
        assert!((element.energy(&[0.75]) - 0.375).abs() < 1e-15);
    }
}
