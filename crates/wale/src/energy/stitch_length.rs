//! Conservation of the yarn length of stitch contacts.

use wale_numerics::check::Local;
use wale_numerics::jet::Real;

use super::element::Element;

/// Penalty that keeps the yarn length of a stitch contact.
///
/// `V = ½ k_l L (l/L − 1)²`, `l = u₁ − u₀`                                    [Cirio2017, Eq. 6]
///
/// Local coordinates: `u₀ u₁` \[m\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StitchLength {
    /// Stiffness `k_l` \[N\].
    pub stiffness: f64,
    /// Rest length `L` \[m\].
    pub rest_length: f64,
}

impl Element<2> for StitchLength {
    const NAME: &'static str = "stitch length";

    fn energy<T: Real>(&self, q: &[T; 2]) -> T {
        let excess = (q[1] - q[0]).scale(1.0 / self.rest_length).offset(-1.0);
        excess.square().scale(0.5 * self.stiffness * self.rest_length)
    }

    fn convex(&self, q: &[f64; 2]) -> Local<2> {
        let excess = (q[1] - q[0]) / self.rest_length - 1.0;
        let slope = self.stiffness * excess;
        let k = self.stiffness / self.rest_length;
        Local {
            energy: 0.5 * self.stiffness * self.rest_length * excess * excess,
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
    fn derivatives_and_known_answer() {
        let element = StitchLength { stiffness: 4.0, rest_length: 0.5 };
        check(&element, &[0.2, 0.75], 0.5);
        // 10 % too long: ½·4·0.5·0.01 J.
        assert!((element.energy(&[0.2, 0.75]) - 0.01).abs() < 1e-15);
    }
}
