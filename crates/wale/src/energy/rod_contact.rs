//! Contact of two yarn edges of fixed rest lengths, soft at a distance and stiff when the yarns are squeezed.

use serde::{Deserialize, Serialize};
use wale_numerics::check::Local;
use wale_numerics::jet::Real;
use wale_numerics::jet::vector3::{dot, sub};

use super::element::{Element, point};

/// How the square in the printed contact energy is meant; see [`RodContact`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ContactReading {
    /// As printed, `f(x)²`: a contact sets in with `(1 − x)⁶`, very softly.
    #[default]
    SquareOfBarrier,
    /// Without the square, `f(x)`: it sets in with `(1 − x)³`.
    Barrier,
    /// The square inside, `f(x²)`: the barrier of squared distances of \[Li2020\].
    BarrierOfSquare,
}

/// One of the two phases of a contact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactPhase {
    /// Radius `R` \[m\]: the phase acts where centrelines are nearer than `2R`.
    pub radius: f64,
    /// Stiffness `k_c` \[J/m²\].
    pub stiffness: f64,
}

/// Contact of two yarn edges:
///
/// `V = Σᵢ k_cᵢ L̄_a L̄_b ∫∫ f(min(D/2Rᵢ, 1))² da db`, `f(x) = −(x − 1)² ln x`                 [Sperl2022, Eq. 7]
///
/// over an outer and an inner phase `i`, with the centrelines' distance `D` and Simpson's rule of three points an edge. Local
/// coordinates: `x₀ x₁` of the one edge, then of the other \[m\].
///
/// The printed square contradicts the text, which puts the barrier of Li et al. in the place of Kaldor's; [`ContactReading`]
/// has all three readings. Below `x = 10⁻⁶` the barrier goes on as a straight line, so that it stays finite; nothing but a
/// filter of steps keeps yarns from passing through each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RodContact {
    /// Outer phase, soft, and inner phase, stiff; the inner radius is not larger.
    pub phases: [ContactPhase; 2],
    /// How Eq. 7 is read.
    pub reading: ContactReading,
    /// Product of the rest lengths of both edges `L̄_a L̄_b` \[m²\].
    pub rest_area: f64,
}

/// Simpson's rule on an edge: places and weights.
const SIMPSON: [(f64, f64); 3] = [(0.0, 1.0 / 6.0), (0.5, 4.0 / 6.0), (1.0, 1.0 / 6.0)];
/// Relative distance below which the barrier is a straight line.
const NEAREST: f64 = 1e-6;
/// Pairs of local points `(i, j)` with `i ≤ j`.
const PAIRS: [(usize, usize); 10] = [(0, 0), (0, 1), (0, 2), (0, 3), (1, 1), (1, 2), (1, 3), (2, 2), (2, 3), (3, 3)];

impl ContactReading {
    /// The barrier and its first two derivatives by the relative distance `x < 1`.
    fn profile(self, x: f64) -> [f64; 3] {
        let nearest = x.max(NEAREST);
        let [value, first, second] = match self {
            Self::Barrier => barrier(nearest),
            Self::SquareOfBarrier => {
                let [f, d, dd] = barrier(nearest);
                [f * f, 2.0 * f * d, 2.0 * (d * d + f * dd)]
            }
            Self::BarrierOfSquare => {
                let [f, d, dd] = barrier(nearest * nearest);
                [f, 2.0 * nearest * d, 2.0 * d + 4.0 * nearest * nearest * dd]
            }
        };
        if x < NEAREST { [value + first * (x - NEAREST), first, 0.0] } else { [value, first, second] }
    }
}

/// `f(x) = −(x − 1)² ln x` and its first two derivatives.
#[inline]
fn barrier(x: f64) -> [f64; 3] {
    let (m, ln, inverse) = (x - 1.0, x.ln(), 1.0 / x);
    let ratio = m * inverse;
    [-m * m * ln, -m * (2.0 * ln + ratio), -2.0 * ln - 4.0 * ratio + ratio * ratio]
}

/// What the points of the quadrature see of two edges.
struct Pair {
    /// `x₀`, `x₁` of the one edge and of the other.
    x: [[f64; 3]; 4],
    /// Square of the distance beyond which nothing acts.
    reach: f64,
}

impl Pair {
    fn new(q: &[f64; 12], reach: f64) -> Self {
        Self { x: [0, 3, 6, 9].map(|start| point(q, start)), reach: reach * reach }
    }

    /// Whether balls about both edges are out of reach of each other.
    fn apart(&self) -> bool {
        let [a, b, c, d] = self.x;
        let (first, second) = (sub(b, a), sub(d, c));
        let middle: [f64; 3] = std::array::from_fn(|i| 0.5 * (a[i] + b[i] - c[i] - d[i]));
        let radii = 0.5 * (dot(first, first).sqrt() + dot(second, second).sqrt());
        let between = dot(middle, middle);
        let limit = self.reach.sqrt() + radii;
        between >= limit * limit
    }

    /// Calls `visit` with the factors of the four points, the weight, the distance vector and its square, wherever the edges
    /// are within reach.
    #[inline(always)]
    fn for_each(&self, mut visit: impl FnMut([f64; 4], f64, [f64; 3], f64)) {
        for (a, wa) in SIMPSON {
            let p: [f64; 3] = std::array::from_fn(|i| self.x[0][i] + a * (self.x[1][i] - self.x[0][i]));
            for (b, wb) in SIMPSON {
                let d: [f64; 3] = std::array::from_fn(|i| p[i] - (self.x[2][i] + b * (self.x[3][i] - self.x[2][i])));
                let square = dot(d, d);
                if square < self.reach {
                    visit([1.0 - a, a, b - 1.0, -b], wa * wb, d, square);
                }
            }
        }
    }
}

impl RodContact {
    /// Distance within which the contact acts, `2R` of the outer phase \[m\].
    #[must_use]
    pub fn reach(&self) -> f64 {
        2.0 * self.phases[0].radius.max(self.phases[1].radius)
    }

    /// Energy density and its first two derivatives by the distance \[J/m², N/m², N/m³\].
    #[inline]
    fn profile(&self, distance: f64) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for phase in &self.phases {
            let scale = 0.5 / phase.radius;
            let x = distance * scale;
            if x < 1.0 {
                let [value, first, second] = self.reading.profile(x);
                sum[0] += phase.stiffness * value;
                sum[1] += phase.stiffness * scale * first;
                sum[2] += phase.stiffness * scale * scale * second;
            }
        }
        sum
    }

    /// How the energy \[J\] changes with the radius of the outer phase \[N\].
    #[must_use]
    pub fn energy_by_outer_radius(&self, q: &[f64; 12]) -> f64 {
        let ContactPhase { radius, stiffness } = self.phases[0];
        let mut energy = 0.0;
        Pair::new(q, 2.0 * radius).for_each(|_, weight, _, square| {
            let x = 0.5 * square.sqrt() / radius;
            energy -= weight * self.rest_area * stiffness * self.reading.profile(x)[1] * x / radius;
        });
        energy
    }

    /// How the gradient \[N\] changes with the radius of the outer phase \[N/m\].
    #[must_use]
    pub fn gradient_by_outer_radius(&self, q: &[f64; 12]) -> [f64; 12] {
        let ContactPhase { radius, stiffness } = self.phases[0];
        let mut gradient = [0.0; 12];
        Pair::new(q, 2.0 * radius).for_each(|factors, weight, d, square| {
            let distance = square.sqrt();
            let x = 0.5 * distance / radius;
            let [_, first, second] = self.reading.profile(x);
            // ∂/∂R of k f'(D/2R)/2R.
            let slope = -0.5 * stiffness * (x * second + first) / (radius * radius);
            let pull = if distance > 0.0 { weight * self.rest_area * slope / distance } else { 0.0 };
            for (point, factor) in factors.iter().enumerate() {
                for i in 0..3 {
                    gradient[3 * point + i] += factor * pull * d[i];
                }
            }
        });
        gradient
    }
}

impl Element<12> for RodContact {
    const NAME: &'static str = "rod contact";

    fn energy<T: Real>(&self, q: &[T; 12]) -> T {
        let mut sum = T::constant(0.0);
        for (a, wa) in SIMPSON {
            for (b, wb) in SIMPSON {
                let d: [T; 3] = std::array::from_fn(|i| {
                    q[i].scale(1.0 - a) + q[3 + i].scale(a) - q[6 + i].scale(1.0 - b) - q[9 + i].scale(b)
                });
                let distance = dot(d, d).sqrt();
                let [value, first, second] = self.profile(distance.value());
                sum = sum + distance.chain(value, first, second).scale(self.rest_area * wa * wb);
            }
        }
        sum
    }

    fn acts(&self, q: &[f64; 12]) -> bool {
        !Pair::new(q, self.reach()).apart()
    }

    fn convex(&self, q: &[f64; 12]) -> Local<12> {
        let mut local = Local::zero();
        self.add_blended(q, 1.0, &mut local);
        local
    }

    fn add_blended(&self, q: &[f64; 12], convexity: f64, sum: &mut Local<12>) {
        let pair = Pair::new(q, self.reach());
        if pair.apart() {
            return;
        }
        let (mut energy, mut gradient) = (0.0, [0.0; 12]);
        // Upper triangle of the symmetric 3 × 3 blocks of every pair of points.
        let mut blocks = [[0.0; 6]; 10];
        pair.for_each(|factors, weight, d, square| {
            let distance = square.sqrt();
            let [value, first, second] = self.profile(distance);
            let weight = weight * self.rest_area;
            energy += weight * value;
            let inverse = if distance > 0.0 { 1.0 / distance } else { 0.0 };
            let n = d.map(|x| x * inverse);
            let slope = weight * first;
            for (point, factor) in factors.iter().enumerate() {
                for i in 0..3 {
                    gradient[3 * point + i] += factor * slope * n[i];
                }
            }
            // Pushing apart lets the edges swing around each other: the convex Hessian leaves that out.
            let across = (1.0 - convexity) * slope * inverse;
            let along = weight * second - across;
            let block = [
                along * n[0] * n[0] + across,
                along * n[0] * n[1],
                along * n[0] * n[2],
                along * n[1] * n[1] + across,
                along * n[1] * n[2],
                along * n[2] * n[2] + across,
            ];
            for (sums, (i, j)) in blocks.iter_mut().zip(PAIRS) {
                let factor = factors[i] * factors[j];
                for (sum, value) in sums.iter_mut().zip(&block) {
                    *sum += factor * value;
                }
            }
        });
        sum.add_gradient((energy, gradient));
        for (values, (p, q)) in blocks.iter().zip(PAIRS) {
            let [xx, xy, xz, yy, yz, zz] = *values;
            for (i, row) in [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]].iter().enumerate() {
                for (j, value) in row.iter().enumerate() {
                    sum.hessian[3 * p + i][3 * q + j] += value;
                    if p != q {
                        sum.hessian[3 * q + j][3 * p + i] += value;
                    }
                }
            }
        }
    }

    fn gradient(&self, q: &[f64; 12]) -> (f64, [f64; 12]) {
        let pair = Pair::new(q, self.reach());
        let (mut energy, mut gradient) = (0.0, [0.0; 12]);
        if pair.apart() {
            return (energy, gradient);
        }
        pair.for_each(|factors, weight, d, square| {
            let distance = square.sqrt();
            let [value, first, _] = self.profile(distance);
            let weight = weight * self.rest_area;
            energy += weight * value;
            let pull = if distance > 0.0 { weight * first / distance } else { 0.0 };
            for (point, factor) in factors.iter().enumerate() {
                for i in 0..3 {
                    gradient[3 * point + i] += factor * pull * d[i];
                }
            }
        });
        (energy, gradient)
    }
}

#[cfg(test)]
mod tests;
