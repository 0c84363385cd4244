//! Shear of a weave: the angle between warp and weft at a crossing, with smooth jamming.

use std::f64::consts::FRAC_PI_2;

use wale_numerics::check::Local;
use wale_numerics::jet::Real;
use wale_numerics::jet::vector3::{add, dot, scale, sub};

use super::angle::{Angle, Turning};
use super::element::{Element, point};

/// Shear of a segment of warp against a segment of weft that meet at a crossing; a crossing inside the fabric has four of
/// them.
///
/// `V = ½ (k_x L/4) [(φ − π/2)² + c max(0, |φ − π/2| − φ_j)³]`
///
/// `φ` is the angle between the segments, `L` the length of yarn at the crossing, so that all four pairs of an evenly
/// sheared crossing store `½ k_x L φ²`. Local coordinates: `x₁ x₀ x₂` \[m\], the crossing between its two neighbours.
/// Undefined where a segment has no length; its derivatives grow without bound as the segments come to lie on each other.
///
/// The paper names the force and refers to earlier work for it; the form, with jamming that is twice continuously
/// differentiable, is ours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shear {
    /// `½ k_x L/4` \[J\].
    pub stiffness: f64,
    /// Angle of shear from which yarns of one system lie side by side `φ_j` \[rad\].
    pub jamming_angle: f64,
}

/// How fast a jammed fabric stiffens \[1/rad\].
const JAMMING: f64 = 200.0;

impl Shear {
    /// `V` and its first two derivatives by the angle that the one segment turns from the other.
    fn profile(&self, theta: f64) -> [f64; 3] {
        let sheared = theta - FRAC_PI_2;
        let over = (sheared.abs() - self.jamming_angle).max(0.0);
        [
            self.stiffness * (sheared * sheared + JAMMING * over * over * over),
            self.stiffness * (2.0 * sheared + 3.0 * JAMMING * over * over * sheared.signum()),
            self.stiffness * (2.0 + 6.0 * JAMMING * over),
        ]
    }

    fn value(angle: &Angle, [energy, first, _]: [f64; 3]) -> (f64, [f64; 9]) {
        (energy, std::array::from_fn(|i| first * angle.gradient[i / 3][i % 3]))
    }
}

fn angle(q: &[f64; 9]) -> Angle {
    Angle::new([0, 3, 6].map(|start| point(q, start)))
}

impl Element<9> for Shear {
    const NAME: &'static str = "shear";

    fn energy<T: Real>(&self, q: &[T; 9]) -> T {
        let (d1, d2) = (sub(point(q, 3), point(q, 0)), sub(point(q, 6), point(q, 3)));
        let t1 = scale(d1, T::constant(1.0) / dot(d1, d1).sqrt());
        let t2 = scale(d2, T::constant(1.0) / dot(d2, d2).sqrt());
        let (difference, sum) = (sub(t2, t1), add(t1, t2));
        let theta = dot(difference, difference).sqrt().atan2(dot(sum, sum).sqrt()).scale(2.0);
        let sheared = theta.offset(-FRAC_PI_2);
        let size = sheared.value().abs() - self.jamming_angle;
        let over = if size > 0.0 {
            sheared.scale(sheared.value().signum()).offset(-self.jamming_angle)
        } else {
            T::constant(0.0)
        };
        (sheared.square() + over.square() * over.scale(JAMMING)).scale(self.stiffness)
    }

    fn convex(&self, q: &[f64; 9]) -> Local<9> {
        let mut local = Local::zero();
        self.add_blended(q, 1.0, &mut local);
        local
    }

    fn add_blended(&self, q: &[f64; 9], convexity: f64, sum: &mut Local<9>) {
        let angle = angle(q);
        let profile = self.profile(angle.theta);
        sum.add_gradient(Self::value(&angle, profile));
        let [_, first, second] = profile;
        let over_half_tangent = first / angle.half_tangent.max(1e-4);
        let turning = Turning::new(&angle, first, second, over_half_tangent, convexity);
        angle.add_hessian(&turning, [0, 3, 6], &mut sum.hessian);
    }

    fn gradient(&self, q: &[f64; 9]) -> (f64, [f64; 9]) {
        let angle = angle(q);
        Self::value(&angle, self.profile(angle.theta))
    }
}

#[cfg(test)]
mod tests {
    use super::super::element::testing::{Random, check, check_blend};
    use super::*;

    fn corner(random: &mut Random, spread: f64) -> [f64; 9] {
        let mut q = [1.0, 0.1, 0.0, 0.0, 0.0, 0.0, -0.2, 1.2, 0.1];
        q.iter_mut().for_each(|x| *x += spread * random.next());
        q
    }

    #[test]
    fn derivatives() {
        let mut random = Random::new(5);
        for jamming_angle in [0.05, 0.7] {
            let shear = Shear { stiffness: 3.0, jamming_angle };
            for _ in 0..20 {
                let q = corner(&mut random, 0.4);
                assert!(shear.gradient(&q).1.iter().any(|g| g.abs() > 1e-3));
                check(&shear, &q, 1.0);
                check_blend(&shear, &q, 1e-9);
            }
        }
    }

    #[test]
    fn four_pairs_store_half_the_stiffness_times_the_angle_squared() {
        // k_x = 2 N, L = 0.3 m, 0.2 rad.
        let (stiffness, length, sheared) = (2.0, 0.3, 0.2f64);
        let element = Shear { stiffness: 0.5 * stiffness * length / 4.0, jamming_angle: 1.0 };
        let weft = [sheared.sin(), sheared.cos(), 0.0];
        let pair = |a: f64, b: f64| element.energy(&[a, 0.0, 0.0, 0.0, 0.0, 0.0, b * weft[0], b * weft[1], 0.0]);
        let total = pair(1.0, 2.0) + pair(-1.0, 0.5) + pair(1.0, -1.0) + pair(-3.0, -1.0);
        assert!((total - 0.5 * stiffness * length * sheared * sheared).abs() < 1e-12);
    }

    #[test]
    fn jams_smoothly() {
        let element = Shear { stiffness: 1.0, jamming_angle: 0.7 };
        let at = |sheared: f64| element.profile(FRAC_PI_2 + sheared)[2];
        assert!((at(0.7 + 1e-9) - at(0.7 - 1e-9)).abs() < 1e-5 && at(1.2) > 200.0 * at(0.6));
        assert!((at(-1.2) / at(1.2) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn does_not_feel_rigid_motions() {
        let mut random = Random::new(6);
        let element = Shear { stiffness: 1.0, jamming_angle: 0.2 };
        let q = corner(&mut random, 0.3);
        let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.4, 2.0, -1.0);
        let moved: Vec<f64> = q
            .chunks(3)
            .flat_map(|x| (turn * glam::DVec3::from_slice(x) + glam::DVec3::new(1.0, -2.0, 0.5)).to_array())
            .collect();
        let moved: [f64; 9] = moved.try_into().unwrap();
        assert!((element.energy(&moved) / element.energy(&q) - 1.0).abs() < 1e-12);
    }
}
