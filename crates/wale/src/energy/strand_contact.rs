//! Contact of two strands of yarn between their nodes.

use wale_numerics::check::Local;
use wale_numerics::jet::Real;
use wale_numerics::jet::vector3::{cross, dot, sub};

use super::element::{Element, point};

/// Contact of two straight pieces of yarn, whose ends lie beside their nodes.
///
/// `V = −k d² (x − 1)² ln x` for `x = r/d < 1`, where `r` is the distance of the pieces `a₁ b₁` and `a₂ b₂`: nothing at
/// `d`, with two derivatives, and without bound where the pieces would meet. Local coordinates: the nodes
/// `a₁ b₁ a₂ b₂` \[m\]. Undefined where the pieces meet.
///
/// The Hessian couples no node with another, so that contacts come and go without a change of the matrix' pattern: with
/// weights that add up to one on each piece, `(Σ wᵢ δᵢ)² ≤ 2 Σ |wᵢ| δᵢ²`, with equality where the pieces move together
/// or apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrandContact {
    /// Stiffness `k` \[N/m\].
    pub stiffness: f64,
    /// Distance `d` of the centre lines below which the pieces push each other apart \[m\].
    pub distance: f64,
    /// Where each end lies beside its node \[m\], while the step lasts.
    pub offsets: [[f64; 3]; 4],
}

/// Where two pieces are closest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closest {
    /// Share of each end in the point of its piece, `a₁ b₁ a₂ b₂`; those of the first piece are negative.
    pub weights: [f64; 4],
    /// Distance \[m\], and unit vector from the first piece to the second.
    pub distance: f64,
    /// Unit vector from the first piece to the second.
    pub normal: [f64; 3],
}

/// Square of the sine between two pieces below which they count as parallel.
const PARALLEL: f64 = 1e-9;

/// Places along two pieces, from 0 to 1, where they are closest.
pub(super) fn places(p: &[[f64; 3]; 4]) -> [f64; 2] {
    let (d, e, r) = (sub(p[1], p[0]), sub(p[3], p[2]), sub(p[2], p[0]));
    let (dd, ee, de, dr, er) = (dot(d, d), dot(e, e), dot(d, e), dot(d, r), dot(e, r));
    let determinant = dd * ee - de * de;
    let share = |x: f64, y: f64| if y > 0.0 { (x / y).clamp(0.0, 1.0) } else { 0.0 };
    let mut s = if determinant > PARALLEL * dd * ee { share(dr * ee - de * er, determinant) } else { 0.0 };
    let t = if ee > 0.0 { (s * de - er) / ee } else { 0.0 };
    let clamped = t.clamp(0.0, 1.0);
    if clamped != t || determinant <= PARALLEL * dd * ee {
        s = share(dr + clamped * de, dd);
    }
    [s, clamped]
}

/// Where two pieces `a₁ b₁` and `a₂ b₂` are closest.
#[must_use]
pub fn closest(p: &[[f64; 3]; 4]) -> Closest {
    let [s, t] = places(p);
    let weights = [s - 1.0, -s, 1.0 - t, t];
    let between: [f64; 3] = std::array::from_fn(|k| (0..4).map(|i| weights[i] * p[i][k]).sum());
    let distance = dot(between, between).sqrt();
    let normal = if distance > 0.0 { between.map(|x| x / distance) } else { [0.0; 3] };
    Closest { weights, distance, normal }
}

/// Distance of two points, of a point and the line through two, or of two lines, whichever the places say.
pub(super) fn distance<T: Real>(p: &[[T; 3]; 4], [s, t]: [f64; 2]) -> T {
    let inside = |x: f64| x > 0.0 && x < 1.0;
    let end = |x: f64, first: usize| p[first + usize::from(x >= 1.0)];
    let to_line = |from: [T; 3], first: usize| {
        let (d, w) = (sub(p[first + 1], p[first]), sub(from, p[first]));
        let across = cross(w, d);
        (dot(across, across) / dot(d, d)).sqrt()
    };
    match (inside(s), inside(t)) {
        (true, true) => {
            let n = cross(sub(p[1], p[0]), sub(p[3], p[2]));
            let along = dot(sub(p[2], p[0]), n);
            (along.square() / dot(n, n)).sqrt()
        }
        (true, false) => to_line(end(t, 2), 0),
        (false, true) => to_line(end(s, 0), 2),
        (false, false) => {
            let between = sub(end(t, 2), end(s, 0));
            dot(between, between).sqrt()
        }
    }
}

impl StrandContact {
    /// The ends of the pieces \[m\].
    #[must_use]
    pub fn ends(&self, q: &[f64; 12]) -> [[f64; 3]; 4] {
        std::array::from_fn(|i| std::array::from_fn(|k| q[3 * i + k] + self.offsets[i][k]))
    }

    /// Where the pieces are closest, and the curvature of the energy there \[N/m\], if they touch.
    #[must_use]
    pub fn touch(&self, q: &[f64; 12]) -> Option<(Closest, f64)> {
        let near = closest(&self.ends(q));
        let x = near.distance / self.distance;
        if x.is_nan() || x >= 1.0 || x <= 0.0 {
            return None;
        }
        let away = x - 1.0;
        Some((near, self.stiffness * (away * away / (x * x) - 2.0 * x.ln() - 4.0 * away / x)))
    }
}

impl Element<12> for StrandContact {
    const NAME: &'static str = "strand contact";
    const COUPLES: bool = false;

    fn energy<T: Real>(&self, q: &[T; 12]) -> T {
        let places = places(&self.ends(&q.each_ref().map(|x| x.value())));
        let ends: [[T; 3]; 4] = std::array::from_fn(|i| {
            let at = point(q, 3 * i);
            std::array::from_fn(|k| at[k].offset(self.offsets[i][k]))
        });
        let x = distance(&ends, places).scale(1.0 / self.distance);
        if x.value() >= 1.0 {
            return T::constant(0.0);
        }
        let scale = -self.stiffness * self.distance * self.distance;
        (x.offset(-1.0).square() * x.ln()).scale(scale)
    }

    fn convex(&self, q: &[f64; 12]) -> Local<12> {
        let mut local = Local::zero();
        local.add_gradient(self.gradient(q));
        if let Some((near, curvature)) = self.touch(q) {
            let n = near.normal;
            for (first, weight) in near.weights.iter().enumerate() {
                let k = 2.0 * weight.abs() * curvature;
                for i in 0..3 {
                    for j in 0..3 {
                        local.hessian[3 * first + i][3 * first + j] = k * n[i] * n[j];
                    }
                }
            }
        }
        local
    }

    fn gradient(&self, q: &[f64; 12]) -> (f64, [f64; 12]) {
        let Some((near, _)) = self.touch(q) else { return (0.0, [0.0; 12]) };
        let x = near.distance / self.distance;
        let (away, log) = (x - 1.0, x.ln());
        // The places where they are closest move too, but that changes the distance to second order only.
        let slope = -self.stiffness * self.distance * (2.0 * away * log + away * away / x);
        let gradient = std::array::from_fn(|i| slope * near.weights[i / 3] * near.normal[i % 3]);
        (-self.stiffness * self.distance * self.distance * away * away * log, gradient)
    }
}

#[cfg(test)]
mod tests {
    use super::super::element::testing::{Random, check};
    use super::*;

    fn element() -> StrandContact {
        let offsets = std::array::from_fn(|i| [0.01 * i as f64, -0.02, 0.03]);
        StrandContact { stiffness: 3.0, distance: 2.0, offsets }
    }

    #[test]
    fn derivatives_where_pieces_cross_and_where_ends_are_closest() {
        let mut random = Random::new(23);
        let base = [
            [-2.0, 0.0, 0.0, 2.0, 0.1, 0.0, 0.1, -2.0, 1.0, 0.0, 2.0, 1.1],
            [-2.0, 0.0, 0.0, 2.0, 0.1, 0.0, 0.1, 0.7, 0.9, 0.0, 4.0, 1.1],
            [-2.0, 0.0, 0.0, 2.0, 0.1, 0.0, 2.7, 0.7, 0.9, 4.0, 4.0, 1.1],
        ];
        for base in base {
            for _ in 0..10 {
                let q = base.map(|x: f64| x + 0.1 * random.next());
                check(&element(), &q, 1.0);
            }
        }
    }

    #[test]
    fn known_answer_and_nothing_apart() {
        let element = StrandContact { offsets: [[0.0; 3]; 4], ..element() };
        let at = |height: f64| [-1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0, height, 0.0, 1.0, height];
        let local = element.convex(&at(1.0));
        assert!((local.energy - 3.0 * 4.0 * 0.25 * 2.0f64.ln()).abs() < 1e-14);
        // Half of the force at each end, and none along the pieces.
        let force = 3.0 * 2.0 * (2.0f64.ln() + 0.5);
        let expected = [0.0, 0.0, 0.5 * force];
        (0..3).for_each(|k| assert!((local.gradient[k] - expected[k]).abs() < 1e-14));
        assert_eq!(element.convex(&at(2.5)).energy, 0.0);
    }

    #[test]
    fn the_hessian_bounds_the_exact_one() {
        let element = element();
        let q = [-2.0, 0.0, 0.0, 2.0, 0.1, 0.0, 0.1, -2.0, 1.0, 0.0, 2.0, 1.1];
        let (convex, exact) = (element.convex(&q), element.exact(&q));
        let along = |h: &[[f64; 12]; 12], d: [f64; 12]| -> f64 {
            (0..12).map(|i| (0..12).map(|j| d[i] * h[i][j] * d[j]).sum::<f64>()).sum()
        };
        let mut random = Random::new(18);
        for _ in 0..20 {
            let d = std::array::from_fn(|_| random.next());
            assert!(along(&convex.hessian, d) >= along(&exact.hessian, d));
        }
    }
}
