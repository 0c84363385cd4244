//! Wrapping of two yarns about a stitch contact.

mod curvature;
mod hinge;

use std::f64::consts::PI;

use wale_numerics::check::Local;
use wale_numerics::jet::Real;
use wale_numerics::jet::vector3::{cross, dot, scale, sub};

use self::curvature::Curvature;
use self::hinge::{Hinge, by_node};
use super::element::{Element, point};

/// Wrapping of two opposite yarn segments about a stitch contact.
///
/// `V = ½ k_w L ω_a ω_b wrap(s ψ − ψ₀)²`                                      [Cirio2017, Eq. 2]
///
/// `ψ` is the angle between the triangles `(q₀, q₁, q₄)` and `(q₀, q₃, q₁)` about the hinge `q₀q₁` (Eqs. 7–13).
/// Local coordinates: `x₀ x₁ x₃ x₄` \[m\].
///
/// Differs from the paper: `ψ` is signed (`atan2`), because Eq. 13's arc cosine has the wrong sign in half of the
/// configurations and is singular at `0` and `π`; `s = ±1` comes from the stitch (test `the_sign_matters`). The
/// weights `ω = sin²/(sin² + 0.1²)` of the angle between axis and segment let the term fade where a segment aligns
/// with the axis and `ψ` loses its meaning (test `fades_where_a_segment_aligns`). `k_w` is in newtons, since
/// `k_w L ψ²` is an energy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrapping {
    /// `k_w L`: wrapping stiffness times the contact's rest length \[N·m\].
    pub stiffness: f64,
    /// Rest angle `ψ₀` \[rad\].
    pub rest_angle: f64,
    /// Sign `s` of the stitch, `±1`.
    pub sign: f64,
}

/// Square of the sine below which the weight fades.
const FADE: f64 = 0.01;

/// `angle` moved into `(−π, π]` by whole turns.
fn whole_turns(angle: f64) -> f64 {
    ((angle + PI) / (2.0 * PI)).floor() * 2.0 * PI
}

impl Element<12> for Wrapping {
    const NAME: &'static str = "wrapping";

    fn energy<T: Real>(&self, q: &[T; 12]) -> T {
        let psi = wrapping_angle(q).scale(self.sign).offset(-self.rest_angle);
        let deviation = psi.offset(-whole_turns(psi.value()));
        let [a, b] = sine_squares(q);
        let weight = (a / a.offset(FADE)) * (b / b.offset(FADE));
        (weight * deviation.square()).scale(0.5 * self.stiffness)
    }

    fn convex(&self, q: &[f64; 12]) -> Local<12> {
        let mut local = Local::zero();
        self.add_blended(q, 1.0, &mut local);
        local
    }

    fn add_blended(&self, q: &[f64; 12], convexity: f64, sum: &mut Local<12>) {
        let hinge = Hinge::new(q);
        sum.add_gradient(self.value(&hinge));
        Curvature::new(&hinge, self.stiffness, self.deviation(hinge.angle), self.sign, convexity)
            .add_to(&mut sum.hessian);
    }

    fn gradient(&self, q: &[f64; 12]) -> (f64, [f64; 12]) {
        self.value(&Hinge::new(q))
    }
}

impl Wrapping {
    /// How far an angle is from rest, the shorter way round.
    fn deviation(&self, angle: f64) -> f64 {
        let psi = self.sign * angle - self.rest_angle;
        psi - whole_turns(psi)
    }

    /// Energy and gradient.
    fn value(&self, hinge: &Hinge) -> (f64, [f64; 12]) {
        let deviation = self.deviation(hinge.angle);
        let weights = hinge.weights();
        let ([wa, wb], [slope_a, slope_b]) = (weights.value, weights.slope);
        let half = 0.5 * self.stiffness * deviation * deviation;
        let (by_a, by_b) = (half * wb * slope_a, half * wa * slope_b);
        let by_angle = self.stiffness * weights.product() * deviation * self.sign;
        let gradient = std::array::from_fn(|edge| {
            std::array::from_fn(|i| {
                by_angle * hinge.gradient[edge][i]
                    + by_a * hinge.sine_gradient[0][edge][i]
                    + by_b * hinge.sine_gradient[1][edge][i]
            })
        });
        (half * weights.product(), by_node(&gradient))
    }
}

/// The signed wrapping angle `ψ` of `x₀ x₁ x₃ x₄` \[rad\].
pub fn wrapping_angle<T: Real>(q: &[T; 12]) -> T {
    let (x0, x1, x3, x4) = (point(q, 0), point(q, 3), point(q, 6), point(q, 9));
    let axis = sub(x1, x0);
    let back = sub(x0, x1);
    let va = cross(sub(x4, x1), back);
    let vb = cross(back, sub(x3, x1));
    let e = scale(axis, T::constant(1.0) / dot(axis, axis).sqrt());
    dot(e, cross(va, vb)).atan2(dot(va, vb))
}

/// Gradient of the wrapping angle `ψ` by `x₀ x₁ x₃ x₄` \[1/m\] and the weight `ω_a ω_b` there.
pub fn wrapping_gradient(q: &[f64; 12]) -> ([f64; 12], f64) {
    let hinge = Hinge::new(q);
    (by_node(&hinge.gradient), hinge.weights().product())
}

fn sine_squares<T: Real>(q: &[T; 12]) -> [T; 2] {
    let (x0, x1, x3, x4) = (point(q, 0), point(q, 3), point(q, 6), point(q, 9));
    let axis = sub(x1, x0);
    let of = |side: [T; 3]| {
        let v = cross(side, axis);
        dot(v, v) / (dot(axis, axis) * dot(side, side))
    };
    [of(sub(x4, x0)), of(sub(x3, x1))]
}

#[cfg(test)]
mod tests {
    use wale_numerics::check::relative_smallest_eigenvalue;

    use super::super::element::testing::{Random, check, check_blend};
    use super::*;

    fn random_contact(random: &mut Random) -> [f64; 12] {
        let mut q = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.3, 0.8, 0.1, -0.3, -0.9, 0.2];
        for x in &mut q {
            *x += 0.4 * random.next();
        }
        q
    }

    #[test]
    fn derivatives() {
        let mut random = Random::new(4);
        for sign in [1.0, -1.0] {
            for _ in 0..20 {
                let element = Wrapping { stiffness: 2.0, rest_angle: 1.6, sign };
                let q = random_contact(&mut random);
                check(&element, &q, 1.0);
                check_blend(&element, &q, 1e-10);
            }
        }
    }

    #[test]
    fn the_paper_s_gradient_of_the_angle() {
        let mut random = Random::new(5);
        for _ in 0..20 {
            let q = random_contact(&mut random);
            let jet = wrapping_angle(&wale_numerics::jet::Jet::variables(&q));
            let (gradient, _) = wrapping_gradient(&q);
            for i in 0..12 {
                assert!((jet.gradient[i] - gradient[i]).abs() < 1e-11);
            }
        }
    }

    #[test]
    fn the_hessian_bounds_the_exact_one_where_a_side_nears_the_axis() {
        // What Newton's method needs: a quadratic model that is nowhere much flatter than the energy.
        let mut random = Random::new(16);
        for offset in [0.02, 0.05, 0.1] {
            for _ in 0..20 {
                let turn = 3.0 * random.next();
                let mut q = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.1, 0.8, 0.1, 0.9, 0.0, 0.0];
                (q[10], q[11]) = (offset * turn.cos(), offset * turn.sin());
                let element = Wrapping { stiffness: 2.0, rest_angle: 1.6, sign: 1.0 };
                let (convex, exact) = (element.convex(&q), element.exact(&q));
                // At least 0.9 of the true curvature in every direction, but for a twentieth of the largest.
                let mut difference = convex.hessian;
                for i in 0..12 {
                    for j in 0..12 {
                        difference[i][j] -= 0.9 * exact.hessian[i][j];
                    }
                }
                let smallest = relative_smallest_eigenvalue(&difference);
                assert!(smallest > -0.05, "{offset} {turn}: {smallest}");
            }
        }
    }

    /// Sides at right angles to the axis, folded by `angle` about it.
    fn folded(angle: f64) -> [f64; 12] {
        [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, angle.cos(), angle.sin(), 0.0, -1.0, 0.0]
    }

    #[test]
    fn the_sign_matters() {
        // Folding to either side gives angles of opposite sign; an arc cosine gives the same for both.
        let (up, down) = (wrapping_angle(&folded(0.5)), wrapping_angle(&folded(-0.5)));
        assert!((up.abs() - 0.5).abs() < 1e-12 && (up + down).abs() < 1e-12);
        let element = Wrapping { stiffness: 2.0, rest_angle: 0.5, sign: up.signum() };
        assert!(element.energy(&folded(0.5)) < 1e-20);
        assert!((element.energy(&folded(-0.5)) / (1.0 / 1.01f64.powi(2)) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn fades_where_a_segment_aligns() {
        let element = Wrapping { stiffness: 2.0, rest_angle: 1.5, sign: 1.0 };
        let norm = |tilt: f64| {
            let mut q = folded(0.2);
            (q[6], q[7], q[8]) = (1.0 + tilt.cos(), tilt.sin(), 0.0);
            let g = element.convex(&q).gradient;
            g.iter().map(|x| x * x).sum::<f64>().sqrt()
        };
        // Without the weight the gradient would grow like 1/sin: a hundredfold from 0.1 to 0.001.
        let (far, near, nearer) = (norm(0.1), norm(1e-3), norm(1e-6));
        assert!(near < far && nearer < 1e-2 * far && norm(0.0).is_finite(), "{far} {near} {nearer}");
    }
}
