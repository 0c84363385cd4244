//! Contact of the legs of two neighbouring loops of a course.

use wale_numerics::check::Local;
use wale_numerics::jet::Real;
use wale_numerics::jet::vector3::{add, dot, sub};

use super::element::{Element, point};

/// Contact of two legs that lie side by side, by the distance of their middles:
///
/// `V = −k d (s − 1)² ln s`, `s = |m₁ − m₂|/d < 1`, `m = ½ (x₀ + x₁)`
///
/// Local coordinates: `x₀ u₀ x₁ u₁` of each leg \[m\], of which the sliding coordinates do not matter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegContact {
    /// Stiffness `k` \[N\].
    pub stiffness: f64,
    /// Distance `d` within which the legs touch \[m\].
    pub distance: f64,
}

/// Energy of a contact of stiffness `k` \[N\] that begins at a distance `d` \[m\], and its first two derivatives by the distance.
pub(super) fn profile(k: f64, d: f64, distance: f64) -> [f64; 3] {
    let s = distance / d;
    if s.is_nan() || s >= 1.0 {
        return [0.0; 3];
    }
    let (m, ln) = (s - 1.0, s.ln());
    [-k * d * m * m * ln, -k * (2.0 * m * ln + m * m / s), -k / d * (2.0 * ln + 4.0 * m / s - (m / s) * (m / s))]
}

/// That energy alone, over any scalar.
pub(super) fn energy_at<T: Real>(k: f64, d: f64, distance: T) -> T {
    let s = distance.scale(1.0 / d);
    if s.value() >= 1.0 {
        return T::constant(0.0);
    }
    (s.offset(-1.0).square() * s.ln()).scale(-k * d)
}

impl LegContact {
    /// From the middle of the second leg to that of the first.
    fn apart<T: Real>(q: &[T; 16]) -> [T; 3] {
        sub(add(point(q, 0), point(q, 4)), add(point(q, 8), point(q, 12))).map(|x| x.scale(0.5))
    }
}

impl Element<16> for LegContact {
    const NAME: &'static str = "leg contact";

    fn energy<T: Real>(&self, q: &[T; 16]) -> T {
        let d = Self::apart(q);
        energy_at(self.stiffness, self.distance, dot(d, d).sqrt())
    }

    fn convex(&self, q: &[f64; 16]) -> Local<16> {
        let mut local = Local::zero();
        self.add_blended(q, 1.0, &mut local);
        local
    }

    fn add_blended(&self, q: &[f64; 16], convexity: f64, sum: &mut Local<16>) {
        let d = Self::apart(q);
        let distance = dot(d, d).sqrt();
        let [energy, slope, second] = profile(self.stiffness, self.distance, distance);
        if energy == 0.0 {
            return;
        }
        let n = d.map(|x| x / distance);
        // Pushing apart lets the legs swing around each other: the convex Hessian leaves that out.
        let across = (1.0 - convexity) * slope / distance;
        let half = [0.5, 0.5, -0.5, -0.5];
        let mut gradient = [0.0; 16];
        for (a, &fa) in half.iter().enumerate() {
            for i in 0..3 {
                gradient[4 * a + i] = fa * slope * n[i];
                for (b, &fb) in half.iter().enumerate() {
                    for j in 0..3 {
                        let eye = if i == j { 1.0 } else { 0.0 };
                        sum.hessian[4 * a + i][4 * b + j] +=
                            fa * fb * (second * n[i] * n[j] + across * (eye - n[i] * n[j]));
                    }
                }
            }
        }
        sum.add_gradient((energy, gradient));
    }
}

#[cfg(test)]
mod tests {
    use super::super::element::testing::{Random, check, check_blend};
    use super::*;

    #[test]
    fn derivatives() {
        let mut random = Random::new(41);
        for _ in 0..20 {
            let mut q: [f64; 16] = std::array::from_fn(|_| 0.2 * random.next());
            for k in [8, 12] {
                q[k] += 0.5;
            }
            let element = LegContact { stiffness: 3.0, distance: 1.0 };
            check(&element, &q, 1.0);
            check_blend(&element, &q, 1e-9);
        }
    }

    #[test]
    fn legs_out_of_reach_are_free() {
        let mut q = [0.0; 16];
        (q[8], q[12]) = (1.0, 1.0);
        let element = LegContact { stiffness: 3.0, distance: 0.9 };
        assert!(element.energy(&q) == 0.0 && element.convex(&q).gradient == [0.0; 16]);
    }
}
