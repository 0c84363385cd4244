//! Contact of two segments of yarn that share no contact of the network.

use wale_numerics::check::Local;
use wale_numerics::jet::Real;
use wale_numerics::jet::vector3::dot;

use super::element::{Element, point};
use super::leg_contact::{energy_at, profile};
use super::strand_contact::{closest, distance, places};

/// Contact of two segments wherever they are closest:
///
/// `V = −k d (s − 1)² ln s`, `s = r/d < 1`
///
/// with `r` the distance of the segments `x₀ x₁` and `x₂ x₃`: nothing at `d`, with two derivatives, and without bound where they would
/// meet. Local coordinates: `x u` of the four ends \[m\], of which the sliding coordinates do not matter. Undefined where the segments
/// meet.
///
/// That of [`super::StrandContact`] for who needs what it couples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SegmentContact {
    /// Stiffness `k` \[N\].
    pub stiffness: f64,
    /// Distance `d` below which the segments touch \[m\].
    pub distance: f64,
}

impl SegmentContact {
    /// The ends.
    fn ends<T: Real>(q: &[T; 16]) -> [[T; 3]; 4] {
        std::array::from_fn(|i| point(q, 4 * i))
    }
}

impl Element<16> for SegmentContact {
    const NAME: &'static str = "segment contact";

    fn energy<T: Real>(&self, q: &[T; 16]) -> T {
        let ends = Self::ends(q);
        let at = places(&ends.map(|x| x.map(Real::value)));
        energy_at(self.stiffness, self.distance, distance(&ends, at))
    }

    fn convex(&self, q: &[f64; 16]) -> Local<16> {
        let mut local = Local::zero();
        self.add_blended(q, 1.0, &mut local);
        local
    }

    fn add_blended(&self, q: &[f64; 16], convexity: f64, sum: &mut Local<16>) {
        let near = closest(&Self::ends(q));
        let [energy, slope, second] = profile(self.stiffness, self.distance, near.distance);
        if energy == 0.0 {
            return;
        }
        let mut direction = [0.0; 16];
        for (i, weight) in near.weights.iter().enumerate() {
            (0..3).for_each(|k| direction[4 * i + k] = weight * near.normal[k]);
        }
        sum.add_gradient((energy, direction.map(|d| slope * d)));
        for (i, row) in sum.hessian.iter_mut().enumerate() {
            for (j, value) in row.iter_mut().enumerate() {
                *value += convexity * second * direction[i] * direction[j];
            }
        }
        // What segments turn around each other, and where they are closest moves, is in the exact one alone.
        if convexity < 1.0 {
            let exact = self.exact(q).hessian;
            for (row, exact) in sum.hessian.iter_mut().zip(&exact) {
                for (value, exact) in row.iter_mut().zip(exact) {
                    *value += (1.0 - convexity) * exact;
                }
            }
        }
    }

    fn gradient(&self, q: &[f64; 16]) -> (f64, [f64; 16]) {
        let near = closest(&Self::ends(q));
        let [energy, slope, _] = profile(self.stiffness, self.distance, near.distance);
        let gradient = |i: usize| if i % 4 < 3 { slope * near.weights[i / 4] * near.normal[i % 4] } else { 0.0 };
        (energy, std::array::from_fn(gradient))
    }

    fn acts(&self, q: &[f64; 16]) -> bool {
        let near = closest(&Self::ends(q));
        dot(near.normal, near.normal) > 0.0 && near.distance < self.distance
    }
}

#[cfg(test)]
mod tests {
    use super::super::element::testing::{Random, check, check_blend};
    use super::super::rigid_motion::check_rigid_motion;
    use super::*;

    #[test]
    fn derivatives_where_segments_cross_and_where_ends_are_closest() {
        let mut random = Random::new(29);
        let element = SegmentContact { stiffness: 3.0, distance: 2.0 };
        let base = [
            [[-2.0, 0.0, 0.0], [2.0, 0.1, 0.0], [0.1, -2.0, 1.0], [0.0, 2.0, 1.1]],
            [[-2.0, 0.0, 0.0], [2.0, 0.1, 0.0], [0.1, 0.7, 0.9], [0.0, 4.0, 1.1]],
            [[-2.0, 0.0, 0.0], [2.0, 0.1, 0.0], [2.7, 0.7, 0.9], [4.0, 4.0, 1.1]],
        ];
        for base in base {
            for _ in 0..10 {
                let q: [f64; 16] =
                    std::array::from_fn(|i| if i % 4 < 3 { base[i / 4][i % 4] + 0.1 * random.next() } else { 0.3 });
                let gradient = element.gradient(&q).1;
                assert!(gradient.iter().any(|g| g.abs() > 0.1));
                check(&element, &q, 1.0);
                check_blend(&element, &q, 1e-9);
            }
        }
    }

    /// The element by positions alone.
    #[derive(Clone, Copy)]
    struct Positions(SegmentContact);

    impl Positions {
        fn with_sliding<T: Real>(q: &[T; 12]) -> [T; 16] {
            std::array::from_fn(|i| if i % 4 < 3 { q[i / 4 * 3 + i % 4] } else { T::constant(0.7) })
        }
    }

    impl Element<12> for Positions {
        const NAME: &'static str = SegmentContact::NAME;
        fn energy<T: Real>(&self, q: &[T; 12]) -> T {
            self.0.energy(&Self::with_sliding(q))
        }
        fn convex(&self, q: &[f64; 12]) -> Local<12> {
            let (full, at) = (self.0.convex(&Self::with_sliding(q)), |i: usize| i / 3 * 4 + i % 3);
            let mut local = Local::zero();
            local.energy = full.energy;
            local.gradient = std::array::from_fn(|i| full.gradient[at(i)]);
            local.hessian = std::array::from_fn(|i| std::array::from_fn(|j| full.hessian[at(i)][at(j)]));
            local
        }
    }

    #[test]
    fn turning_and_moving_both_changes_nothing() {
        let element = Positions(SegmentContact { stiffness: 3.0, distance: 2.0 });
        check_rigid_motion(&element, &[-2.0, 0.0, 0.0, 2.0, 0.1, 0.0, 0.1, -2.0, 1.0, 0.0, 2.0, 1.1]);
        check_rigid_motion(&element, &[-2.0, 0.0, 0.0, 2.0, 0.1, 0.0, 2.7, 0.7, 0.9, 4.0, 4.0, 1.1]);
    }

    #[test]
    fn known_answer_and_nothing_apart() {
        let element = SegmentContact { stiffness: 3.0, distance: 2.0 };
        let at = |z: f64| [-1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0, z, 0.0, 0.0, 1.0, z, 0.0];
        let local = element.convex(&at(1.0));
        assert!((local.energy - 3.0 * 2.0 * 0.25 * 2.0f64.ln()).abs() < 1e-14);
        // Half of the force at each end: it pushes the first down and the second up.
        let force = 3.0 * (2.0f64.ln() + 0.5);
        for (i, sign) in [1.0, 1.0, -1.0, -1.0].into_iter().enumerate() {
            assert!((local.gradient[4 * i + 2] - sign * 0.5 * force).abs() < 1e-14);
        }
        assert!(element.acts(&at(1.9)) && !element.acts(&at(2.1)));
        assert_eq!(element.energy(&at(2.1)), 0.0);
    }
}
