//! Yarns that touch and stick: a spring against sliding along each other.

use wale_numerics::check::Local;
use wale_numerics::jet::Real;
use wale_numerics::jet::vector3::{add, dot, scale, sub};

use super::element::{Element, point};

/// Two edges whose middles stay beside each other.
///
/// `V = ½ k Σ (Δ·t − p̄)²`, `Δ = ½(x₀ + x₁) − ½(x₂ + x₃)`, over the unit vectors `t` along both edges
///
/// with `p̄` what `Δ·t` is at rest. Edges that roll over each other, or are turned together, store nothing. Local coordinates: the
/// ends of one edge and of the other, `x₀ x₁ x₂ x₃` \[m\]. Undefined where an edge has no length.
///
/// Differs from the paper: its yarns slide freely. Friction lets go in the end, and this does not; a spring that lets go after one
/// radius of sliding fits measured knits worse, which stiffen as they stretch. Tests: `sliding_costs_and_rolling_does_not`, and
/// `yarns_stick_where_they_touch` in the lab.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RodStick {
    /// Stiffness `k` \[N/m\].
    pub stiffness: f64,
    /// How far one middle lies from the other along each edge at rest \[m\].
    pub rest: [f64; 2],
}

/// How far the middle of the second of two edges lies behind that of the first, along each of them \[m\].
#[must_use]
pub fn stick_offsets<T: Real>(q: &[T; 12]) -> [T; 2] {
    let (between, edges) = vectors(q);
    edges.map(|edge| dot(between, edge) / dot(edge, edge).sqrt())
}

/// The vector between the middles of two edges, and both edges.
fn vectors<T: Real>(q: &[T; 12]) -> ([T; 3], [[T; 3]; 2]) {
    let [first, second] = [0, 6].map(|start| scale(add(point(q, start), point(q, start + 3)), T::constant(0.5)));
    (sub(first, second), [0, 6].map(|start| sub(point(q, start + 3), point(q, start))))
}

/// An offset along one edge: its derivatives by the vector between the middles and by the edge.
struct Offset {
    value: f64,
    tangent: [f64; 3],
    /// What of the vector between the middles is across the edge, over the length of the edge.
    across: [f64; 3],
    over_length: f64,
}

impl Offset {
    fn new(between: [f64; 3], edge: [f64; 3]) -> Self {
        let over_length = 1.0 / dot(edge, edge).sqrt();
        let tangent = scale(edge, over_length);
        let value = dot(between, tangent);
        Self { value, tangent, across: scale(sub(between, scale(tangent, value)), over_length), over_length }
    }

    /// By all twelve coordinates; the edge is that of the points from `start`.
    fn gradient(&self, start: usize) -> [f64; 12] {
        std::array::from_fn(|k| {
            let (node, i) = (k / 3, k % 3);
            let between = if node < 2 { 0.5 } else { -0.5 } * self.tangent[i];
            let edge = match node {
                node if node == start => -self.across[i],
                node if node == start + 1 => self.across[i],
                _ => 0.0,
            };
            between + edge
        })
    }

    /// Adds `factor` times the second derivatives.
    fn add_second(&self, start: usize, factor: f64, hessian: &mut [[f64; 12]; 12]) {
        let t = self.tangent;
        for i in 0..3 {
            for j in 0..3 {
                let across = (f64::from(u8::from(i == j)) - t[i] * t[j]) * self.over_length;
                // By the edge twice.
                let twice = -(self.value * across + t[i] * self.across[j] + self.across[i] * t[j]) * self.over_length;
                for (node, sign) in [(start, -1.0), (start + 1, 1.0)] {
                    for (other, of_other) in [(start, -1.0), (start + 1, 1.0)] {
                        hessian[3 * node + i][3 * other + j] += factor * sign * of_other * twice;
                    }
                    // By the vector between and by the edge.
                    for other in 0..4 {
                        let of_other = if other < 2 { 0.5 } else { -0.5 };
                        hessian[3 * node + i][3 * other + j] += factor * sign * of_other * across;
                        hessian[3 * other + j][3 * node + i] += factor * sign * of_other * across;
                    }
                }
            }
        }
    }
}

impl RodStick {
    fn offsets(q: &[f64; 12]) -> [Offset; 2] {
        let (between, edges) = vectors(q);
        edges.map(|edge| Offset::new(between, edge))
    }
}

impl Element<12> for RodStick {
    const NAME: &'static str = "rod stick";

    fn energy<T: Real>(&self, q: &[T; 12]) -> T {
        let [a, b] = stick_offsets(q);
        (a.offset(-self.rest[0]).square() + b.offset(-self.rest[1]).square()).scale(0.5 * self.stiffness)
    }

    fn convex(&self, q: &[f64; 12]) -> Local<12> {
        let mut local = Local::zero();
        self.add_blended(q, 1.0, &mut local);
        local
    }

    fn add_blended(&self, q: &[f64; 12], convexity: f64, sum: &mut Local<12>) {
        for (k, offset) in Self::offsets(q).iter().enumerate() {
            let away = offset.value - self.rest[k];
            let gradient = offset.gradient(2 * k);
            sum.add_gradient((0.5 * self.stiffness * away * away, gradient.map(|g| self.stiffness * away * g)));
            sum.add_square(self.stiffness, &gradient);
            if convexity < 1.0 {
                offset.add_second(2 * k, (1.0 - convexity) * self.stiffness * away, &mut sum.hessian);
            }
        }
    }

    fn gradient(&self, q: &[f64; 12]) -> (f64, [f64; 12]) {
        let (mut energy, mut sum) = (0.0, [0.0; 12]);
        for (k, offset) in Self::offsets(q).iter().enumerate() {
            let away = offset.value - self.rest[k];
            energy += 0.5 * self.stiffness * away * away;
            sum.iter_mut().zip(offset.gradient(2 * k)).for_each(|(sum, g)| *sum += self.stiffness * away * g);
        }
        (energy, sum)
    }
}

#[cfg(test)]
mod tests {
    use super::super::element::testing::{Random, check, check_blend};
    use super::super::rigid_motion::check_rigid_motion;
    use super::*;

    #[test]
    fn derivatives() {
        let mut random = Random::new(61);
        for _ in 0..20 {
            let q: [f64; 12] =
                std::array::from_fn(|k| [0.0, 1.0, 0.4, 0.6][k / 3] * [1.0, 0.3, 0.5][k % 3] + 0.5 * random.next());
            let element = RodStick { stiffness: 3.0, rest: [0.2 * random.next(), 0.2 * random.next()] };
            check(&element, &q, 0.1);
            check_blend(&element, &q, 1e-9);
            check_rigid_motion(&element, &q);
        }
    }

    #[test]
    fn sliding_costs_and_rolling_does_not() {
        let radius = 0.3;
        // Two crossing yarns, one lying on the other.
        let at = |along: f64, roll: f64| -> [f64; 12] {
            // The upper yarn, along y, goes round the lower one, along x.
            let (s, c) = roll.sin_cos();
            let centre = [along, 2.0 * radius * s, 2.0 * radius * c];
            let upper = [0.0, c, -s];
            let [a, b] = [-0.5, 0.5].map(|k| add(centre, scale(upper, k)));
            [-0.5, 0.0, 0.0, 0.5, 0.0, 0.0, a[0], a[1], a[2], b[0], b[1], b[2]]
        };
        let element = RodStick { stiffness: 2.0, rest: [0.0; 2] };
        assert!(element.energy(&at(0.0, 0.7)) < 1e-30);
        assert!((element.energy(&at(0.1, 0.0)) - 0.01).abs() < 1e-15);
    }
}
