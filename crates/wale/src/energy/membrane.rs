//! In-plane deformation of a thin shell: a triangle that resists stretch, shear and change of area.

use wale_numerics::check::Local;
use wale_numerics::eigen::positive_part;
use wale_numerics::jet::vector3::{add, cross, dot, scale, sub};
use wale_numerics::jet::{Jet, Real};

use super::element::{Element, point};

/// The in-plane stiffnesses of a fabric, `x` along its weft and `y` along its warp \[N/m\]: the six of [Sperl2022, Eq. 1], and
/// four more of a fabric that becomes stiffer as it is stretched, zero in the paper's law.
///
/// Differs from the paper: besides `½ εᵀ K ε` there may be a stiffening `⅓ Q^{3/2}`, with `Q = a² + 2 m_xy ab + b² + c²`,
/// `a = ∛m_xx E₁₁`, `b = ∛m_yy E₂₂`, `c = ∛m_ss 2E₁₂`, so that a fabric pulled along its weft resists by `m_xx E₁₁²` more.
/// The law of the paper lets stress and contraction grow as the first power of strain; those of measured knits and weaves
/// grow faster, as their yarns straighten and lock. `Q` is positive definite, so the term is convex in the strain, and twice
/// differentiable everywhere. Test `ten_measured_sheets` of the lab says what it is worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MembraneStiffness {
    /// `k_xx`: stretch along the weft.
    pub xx: f64,
    /// `k_xy`: coupling of the two stretches.
    pub xy: f64,
    /// `k_yy`: stretch along the warp.
    pub yy: f64,
    /// `k_ss`: shear.
    pub ss: f64,
    /// `k_n1`: change of area, quadratic.
    pub n1: f64,
    /// `k_n2`: change of area, logarithmic; keeps triangles from collapsing.
    pub n2: f64,
    /// `m_xx`: stiffening along the weft.
    pub stiffening_xx: f64,
    /// `m_yy`: stiffening along the warp.
    pub stiffening_yy: f64,
    /// `m_ss`: stiffening in shear.
    pub stiffening_ss: f64,
    /// `m_xy`: coupling of the two stretches where they stiffen, between −1 and 1 \[–\].
    pub stiffening_xy: f64,
}

impl MembraneStiffness {
    /// Number of stiffnesses.
    pub const COUNT: usize = 10;
    /// Number of those of [Sperl2022, Eq. 1], which come first.
    pub const QUADRATIC: usize = 6;
    /// Their names, in the order of [`Self::to_array`].
    pub const NAMES: [&'static str; Self::COUNT] =
        ["k_xx", "k_xy", "k_yy", "k_ss", "k_n1", "k_n2", "m_xx", "m_yy", "m_ss", "m_xy"];
    /// No stiffness at all.
    pub const NONE: Self = Self {
        xx: 0.0,
        xy: 0.0,
        yy: 0.0,
        ss: 0.0,
        n1: 0.0,
        n2: 0.0,
        stiffening_xx: 0.0,
        stiffening_yy: 0.0,
        stiffening_ss: 0.0,
        stiffening_xy: 0.0,
    };

    /// The ten numbers \[N/m; the last –\].
    #[must_use]
    pub fn to_array(self) -> [f64; Self::COUNT] {
        let stiffening = [self.stiffening_xx, self.stiffening_yy, self.stiffening_ss, self.stiffening_xy];
        let [mxx, myy, mss, mxy] = stiffening;
        [self.xx, self.xy, self.yy, self.ss, self.n1, self.n2, mxx, myy, mss, mxy]
    }
    /// From the ten numbers \[N/m; the last –\].
    #[must_use]
    pub fn from_array([xx, xy, yy, ss, n1, n2, mxx, myy, mss, mxy]: [f64; Self::COUNT]) -> Self {
        let (stiffening_xx, stiffening_yy, stiffening_ss, stiffening_xy) = (mxx, myy, mss, mxy);
        Self { xx, xy, yy, ss, n1, n2, stiffening_xx, stiffening_yy, stiffening_ss, stiffening_xy }
    }
    /// From the six numbers of [Sperl2022, Eq. 1] \[N/m\].
    #[must_use]
    pub fn quadratic([xx, xy, yy, ss, n1, n2]: [f64; Self::QUADRATIC]) -> Self {
        Self { xx, xy, yy, ss, n1, n2, ..Self::NONE }
    }
    /// Whether the fabric becomes stiffer as it is stretched.
    #[must_use]
    pub fn stiffens(&self) -> bool {
        self.stiffening_xx != 0.0 || self.stiffening_yy != 0.0 || self.stiffening_ss != 0.0
    }
    /// How many of the numbers the fabric has: those of the paper, or all.
    #[must_use]
    pub fn used(&self) -> usize {
        if self.stiffens() { Self::COUNT } else { Self::QUADRATIC }
    }

    /// Energy density \[J/m²\] of a deformation with the metric `[f₁·f₁, f₂·f₂, f₁·f₂]` and the area ratio `J`.
    pub fn density<T: Real>(&self, [a, b, c]: [T; 3], area_ratio: T) -> T {
        let (e1, e2) = (a.offset(-1.0).scale(0.5), b.offset(-1.0).scale(0.5));
        let quadratic = e1.square().scale(self.xx)
            + (e1 * e2).scale(2.0 * self.xy)
            + e2.square().scale(self.yy)
            + c.square().scale(self.ss);
        let area = area_ratio.offset(-1.0).square().scale(self.n1);
        // Without the logarithm a collapsed triangle has a finite energy; 0 · ∞ would be no number.
        let log = if self.n2 == 0.0 { T::constant(0.0) } else { area_ratio.ln().square().scale(self.n2) };
        let whole = quadratic.scale(0.5) + area + log;
        if !self.stiffens() {
            return whole;
        }
        let [a, b, c] = self.stiffened([e1, e2, c]);
        let q = a.square() + (a * b).scale(2.0 * self.stiffening_xy) + b.square() + c.square();
        if q.value() > 0.0 { whole + (q * q.sqrt()).scale(1.0 / 3.0) } else { whole }
    }

    /// `a`, `b`, `c` of the stiffening.
    fn stiffened<T: Real>(&self, [e1, e2, shear]: [T; 3]) -> [T; 3] {
        [
            e1.scale(self.stiffening_xx.cbrt()),
            e2.scale(self.stiffening_yy.cbrt()),
            shear.scale(self.stiffening_ss.cbrt()),
        ]
    }

    /// Derivative of [`Self::density`] by the stiffness `index`, in the order of [`Self::to_array`] \[–; of the last J/m²\].
    ///
    /// By a stiffening that is zero it is said to be zero, though that by `m` goes as `m^{−1/3}`: such a fabric has none.
    pub fn density_slope<T: Real>(&self, index: usize, [a, b, c]: [T; 3], area_ratio: T) -> T {
        if index < Self::QUADRATIC {
            // The energy is linear in these.
            let mut array = [0.0; Self::COUNT];
            array[index] = 1.0;
            return Self::from_array(array).density([a, b, c], area_ratio);
        }
        let (e1, e2) = (a.offset(-1.0).scale(0.5), b.offset(-1.0).scale(0.5));
        let [a, b, c] = self.stiffened([e1, e2, c]);
        let q = a.square() + (a * b).scale(2.0 * self.stiffening_xy) + b.square() + c.square();
        // Half the derivative of Q; ∂(⅓ Q^{3/2}) = ½ √Q ∂Q.
        let over = |value: T, stiffness: f64| value.scale(if stiffness == 0.0 { 0.0 } else { 1.0 / (3.0 * stiffness) });
        let half = match index - Self::QUADRATIC {
            0 => over(a.square() + (a * b).scale(self.stiffening_xy), self.stiffening_xx),
            1 => over(b.square() + (a * b).scale(self.stiffening_xy), self.stiffening_yy),
            2 => over(c.square(), self.stiffening_ss),
            _ => a * b,
        };
        if q.value() > 0.0 { q.sqrt() * half } else { T::constant(0.0) }
    }

    /// Derivatives of the stiffening by `(E₁₁, E₂₂, 2E₁₂)`, first and second.
    fn stiffening(&self, strain: [f64; 3]) -> ([f64; 3], [[f64; 3]; 3]) {
        let root = [self.stiffening_xx.cbrt(), self.stiffening_yy.cbrt(), self.stiffening_ss.cbrt()];
        let coupled = self.stiffening_xy * root[0] * root[1];
        let form =
            [[root[0] * root[0], coupled, 0.0], [coupled, root[1] * root[1], 0.0], [0.0, 0.0, root[2] * root[2]]];
        let half: [f64; 3] = std::array::from_fn(|i| (0..3).map(|j| form[i][j] * strain[j]).sum());
        let size = (0..3).map(|i| half[i] * strain[i]).sum::<f64>().max(0.0).sqrt();
        if size == 0.0 {
            return ([0.0; 3], [[0.0; 3]; 3]);
        }
        let second = std::array::from_fn(|i| std::array::from_fn(|j| size * form[i][j] + half[i] * half[j] / size));
        (half.map(|slope| size * slope), second)
    }
}

/// A triangle of fabric: anisotropic St. Venant–Kirchhoff with Neo-Hookean terms that preserve its area, and what
/// [`MembraneStiffness`] adds for fabrics that stiffen.
///
/// `V = A [½ εᵀ K ε + k_n1 (J − 1)² + k_n2 log² J]`, `ε = (E₁₁, E₂₂, 2E₁₂)`, `E = ½(FᵀF − I)`      [Sperl2022, Eq. 1]
///
/// `F = (f₁ f₂)` takes directions of the fabric's plane to space, so `J = |f₁ × f₂|`. Local coordinates: the three vertices
/// `x₀ x₁ x₂` \[m\]. Undefined where the triangle has no area; its energy grows beyond all bounds on the way there. In space
/// a triangle that is turned over has a positive area again, so a solver must not step across `J = 0`:
/// [`Membrane::longest_step`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Membrane {
    /// Stiffnesses \[N/m\].
    pub stiffness: MembraneStiffness,
    /// Inverse of the matrix whose columns are the edges `X₁ − X₀`, `X₂ − X₀` in the fabric's coordinates \[1/m\].
    pub inverse: [[f64; 2]; 2],
    /// Area at rest \[m²\].
    pub area: f64,
}

/// First and second derivatives of the density by the metric `a = f₁·f₁`, `b = f₂·f₂`, `c = f₁·f₂`.
struct ByMetric {
    first: [f64; 3],
    second: [[f64; 3]; 3],
}

impl Membrane {
    /// The triangle whose vertices lie at rest at `rest`, in the fabric's coordinates (weft, warp) \[m\]; `None` if it has no
    /// area there, or vertices in clockwise order.
    #[must_use]
    pub fn new(stiffness: MembraneStiffness, rest: [[f64; 2]; 3]) -> Option<Self> {
        let edge = |k: usize| [rest[k][0] - rest[0][0], rest[k][1] - rest[0][1]];
        let (p, q) = (edge(1), edge(2));
        let double = p[0] * q[1] - p[1] * q[0];
        // Written so that a NaN fails.
        if !(double > 0.0 && double < f64::INFINITY) {
            return None;
        }
        let inverse = [[q[1] / double, -q[0] / double], [-p[1] / double, p[0] / double]];
        Some(Self { stiffness, inverse, area: 0.5 * double })
    }

    /// The columns `f₁`, `f₂` of the deformation gradient.
    #[must_use]
    pub fn deformation<T: Real>(&self, q: &[T; 9]) -> [[T; 3]; 2] {
        let (p, r) = (sub(point(q, 3), point(q, 0)), sub(point(q, 6), point(q, 0)));
        let column =
            |k: usize| add(scale(p, T::constant(self.inverse[0][k])), scale(r, T::constant(self.inverse[1][k])));
        [column(0), column(1)]
    }

    /// Area over area at rest, `J` \[–\].
    #[must_use]
    pub fn area_ratio(&self, q: &[f64; 9]) -> f64 {
        let [f1, f2] = self.deformation(q);
        let n = cross(f1, f2);
        dot(n, n).sqrt()
    }

    /// The largest part `t` of a step, at most one, within which the triangle's normal does not turn away by a right angle
    /// or more; then neither does its area vanish, nor is it turned over.
    #[must_use]
    pub fn longest_step(q: &[f64; 9], direction: &[f64; 9]) -> f64 {
        // n(t)·n(0) for the normal n(t) = (p + t dp) × (r + t dr): a parabola that is positive at zero.
        let edge = |of: &[f64; 9], k: usize| sub(point(of, k), point(of, 0));
        let (p, r, dp, dr) = (edge(q, 3), edge(q, 6), edge(direction, 3), edge(direction, 6));
        let n = cross(p, r);
        let (c, b, a) = (dot(n, n), dot(n, add(cross(dp, r), cross(p, dr))), dot(n, cross(dp, dr)));
        let discriminant = b * b - 4.0 * a * c;
        if discriminant < 0.0 {
            return 1.0;
        }
        // The smaller positive root, by the form that does not cancel: 2c / (−b + √…) where b < 0, and for b ≥ 0 only a < 0
        // has a positive root.
        let below = -b + discriminant.sqrt();
        if below > 0.0 && (b < 0.0 || a < 0.0) { (2.0 * c / below).min(1.0) } else { 1.0 }
    }

    /// Derivatives of `direction · gradient` by each stiffness, in the order of [`MembraneStiffness::to_array`].
    #[must_use]
    pub fn gradient_slopes(&self, q: &[f64; 9], direction: &[f64; 9]) -> [f64; MembraneStiffness::COUNT] {
        let moved: [Jet<1>; 9] = std::array::from_fn(|k| {
            let mut jet = Jet::constant(q[k]);
            jet.gradient[0] = direction[k];
            jet
        });
        let [f1, f2] = self.deformation(&moved);
        let n = cross(f1, f2);
        let (metric, area_ratio) = ([dot(f1, f1), dot(f2, f2), dot(f1, f2)], dot(n, n).sqrt());
        let mut out = [0.0; MembraneStiffness::COUNT];
        for (index, slope) in out.iter_mut().enumerate().take(self.stiffness.used()) {
            *slope = self.area * self.stiffness.density_slope(index, metric, area_ratio).gradient[0];
        }
        out
    }

    fn metric(f: &[[f64; 3]; 2]) -> [f64; 3] {
        [dot(f[0], f[0]), dot(f[1], f[1]), dot(f[0], f[1])]
    }

    /// `φ′` and `φ″` by `d = J²` of `φ = k_n1 (J − 1)² + k_n2 log² J`.
    fn by_determinant(&self, area_ratio: f64) -> [f64; 2] {
        let (j, k) = (area_ratio, &self.stiffness);
        let log = if k.n2 == 0.0 { 0.0 } else { j.ln() };
        let first = 2.0 * k.n1 * (j - 1.0) + 2.0 * k.n2 * log / j;
        let second = 2.0 * k.n1 + 2.0 * k.n2 * (1.0 - log) / (j * j);
        [0.5 * first / j, 0.25 * (second - first / j) / (j * j)]
    }

    fn by_metric(&self, [a, b, c]: [f64; 3], area_ratio: f64) -> ByMetric {
        let k = &self.stiffness;
        let (e1, e2) = (0.5 * (a - 1.0), 0.5 * (b - 1.0));
        let [d1, d2] = self.by_determinant(area_ratio);
        // d = ab − c².
        let g = [b, a, -2.0 * c];
        let mut first = [
            0.5 * (k.xx * e1 + k.xy * e2) + d1 * g[0],
            0.5 * (k.xy * e1 + k.yy * e2) + d1 * g[1],
            k.ss * c + d1 * g[2],
        ];
        let mut second =
            [[0.25 * k.xx, 0.25 * k.xy + d1, 0.0], [0.25 * k.xy + d1, 0.25 * k.yy, 0.0], [0.0, 0.0, k.ss - 2.0 * d1]];
        for i in 0..3 {
            for j in 0..3 {
                second[i][j] += d2 * g[i] * g[j];
            }
        }
        if k.stiffens() {
            // E₁₁ and E₂₂ change by half of what a and b do, 2E₁₂ as c does.
            let (slope, curvature) = k.stiffening([e1, e2, c]);
            let by = [0.5, 0.5, 1.0];
            for i in 0..3 {
                first[i] += by[i] * slope[i];
                for j in 0..3 {
                    second[i][j] += by[i] * by[j] * curvature[i][j];
                }
            }
        }
        ByMetric { first, second }
    }

    /// How `f₁` and `f₂` move with each vertex \[1/m\].
    fn weights(&self) -> [[f64; 2]; 3] {
        let m = &self.inverse;
        [[-m[0][0] - m[1][0], -m[0][1] - m[1][1]], m[0], m[1]]
    }

    fn spread(&self, f: &[[f64; 3]; 2], [a, b, c]: [f64; 3]) -> [f64; 9] {
        // ∂ψ/∂f₁ = 2ψ_a f₁ + ψ_c f₂ and the other way round: the first Piola–Kirchhoff stress.
        let stress: [[f64; 3]; 2] = [
            std::array::from_fn(|i| 2.0 * a * f[0][i] + c * f[1][i]),
            std::array::from_fn(|i| 2.0 * b * f[1][i] + c * f[0][i]),
        ];
        let w = self.weights();
        std::array::from_fn(|k| {
            let (vertex, i) = (k / 3, k % 3);
            self.area * (w[vertex][0] * stress[0][i] + w[vertex][1] * stress[1][i])
        })
    }
}

impl Element<9> for Membrane {
    const NAME: &'static str = "membrane";

    fn energy<T: Real>(&self, q: &[T; 9]) -> T {
        let [f1, f2] = self.deformation(q);
        let n = cross(f1, f2);
        let metric = [dot(f1, f1), dot(f2, f2), dot(f1, f2)];
        self.stiffness.density(metric, dot(n, n).sqrt()).scale(self.area)
    }

    fn convex(&self, q: &[f64; 9]) -> Local<9> {
        let mut local = Local::zero();
        self.add_blended(q, 1.0, &mut local);
        local
    }

    fn add_blended(&self, q: &[f64; 9], convexity: f64, sum: &mut Local<9>) {
        let f = self.deformation(q);
        let n = cross(f[0], f[1]);
        let (metric, area_ratio) = (Self::metric(&f), dot(n, n).sqrt());
        let ByMetric { first, second } = self.by_metric(metric, area_ratio);
        sum.add_gradient((self.area * self.stiffness.density(metric, area_ratio), self.spread(&f, first)));

        // H = S ⊗ I + Gᵀ ψ″ G with the second Piola–Kirchhoff stress S: both are clamped for the convex one.
        let mut stress = [[2.0 * first[0], first[2]], [first[2], 2.0 * first[1]]];
        let mut second = second;
        if convexity > 0.0 {
            blend(&mut stress, convexity);
            blend(&mut second, convexity);
        }
        let w = self.weights();
        // Rows of G by vertex and axis: how a, b and c change.
        let slopes: [[f64; 9]; 3] = [
            std::array::from_fn(|k| 2.0 * w[k / 3][0] * f[0][k % 3]),
            std::array::from_fn(|k| 2.0 * w[k / 3][1] * f[1][k % 3]),
            std::array::from_fn(|k| w[k / 3][0] * f[1][k % 3] + w[k / 3][1] * f[0][k % 3]),
        ];
        let second = second.map(|row| row.map(|value| self.area * value));
        let bent: [[f64; 9]; 3] = std::array::from_fn(|i| {
            std::array::from_fn(|k| {
                second[i][0] * slopes[0][k] + second[i][1] * slopes[1][k] + second[i][2] * slopes[2][k]
            })
        });
        for i in 0..9 {
            for j in 0..9 {
                sum.hessian[i][j] += slopes[0][i] * bent[0][j] + slopes[1][i] * bent[1][j] + slopes[2][i] * bent[2][j];
            }
        }
        for v in 0..3 {
            for u in 0..3 {
                let along = |k: usize| stress[k][0] * w[u][0] + stress[k][1] * w[u][1];
                let value = self.area * (w[v][0] * along(0) + w[v][1] * along(1));
                for i in 0..3 {
                    sum.hessian[3 * v + i][3 * u + i] += value;
                }
            }
        }
    }

    fn gradient(&self, q: &[f64; 9]) -> (f64, [f64; 9]) {
        let f = self.deformation(q);
        let n = cross(f[0], f[1]);
        let (metric, area_ratio) = (Self::metric(&f), dot(n, n).sqrt());
        let first = self.by_metric(metric, area_ratio).first;
        (self.area * self.stiffness.density(metric, area_ratio), self.spread(&f, first))
    }
}

/// From the exact matrix towards its positive part.
fn blend<const N: usize>(matrix: &mut [[f64; N]; N], convexity: f64) {
    let positive = positive_part(matrix);
    for (row, other) in matrix.iter_mut().zip(&positive) {
        for (value, other) in row.iter_mut().zip(other) {
            *value += convexity * (other - *value);
        }
    }
}

#[cfg(test)]
mod tests;
