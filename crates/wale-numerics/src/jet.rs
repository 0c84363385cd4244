//! Second-order forward automatic differentiation over a fixed number of variables: the oracle of every closed form.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A scalar that an energy can be written over: `f64` for values, [`Jet`] for derivatives.
pub trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// A constant.
    fn constant(value: f64) -> Self;
    /// The value, derivatives forgotten; for choosing branches.
    fn value(self) -> f64;
    /// A function of one variable, given its value and first two derivatives here.
    fn chain(self, value: f64, first: f64, second: f64) -> Self;

    /// Square root; its derivatives are undefined at zero.
    #[inline]
    fn sqrt(self) -> Self {
        let root = self.value().sqrt();
        self.chain(root, 0.5 / root, -0.25 / (root * self.value()))
    }
    /// Natural logarithm.
    #[inline]
    fn ln(self) -> Self {
        let x = self.value();
        self.chain(x.ln(), 1.0 / x, -1.0 / (x * x))
    }
    /// Arc cosine, for arguments inside `(−1, 1)`.
    #[inline]
    fn acos(self) -> Self {
        let x = self.value();
        let s = (1.0 - x * x).sqrt();
        self.chain(x.acos(), -1.0 / s, -x / (s * s * s))
    }
    /// `self²`.
    #[inline]
    fn square(self) -> Self {
        self * self
    }
    /// Multiplied by a constant.
    #[inline]
    fn scale(self, factor: f64) -> Self {
        self * Self::constant(factor)
    }
    /// Increased by a constant.
    #[inline]
    fn offset(self, constant: f64) -> Self {
        self + Self::constant(constant)
    }
    /// The angle of the vector `(x, y)` with `self = y`; undefined at the origin.
    fn atan2(self, x: Self) -> Self;
}

impl Real for f64 {
    #[inline]
    fn constant(value: f64) -> Self {
        value
    }
    #[inline]
    fn value(self) -> f64 {
        self
    }
    #[inline]
    fn chain(self, value: f64, _first: f64, _second: f64) -> Self {
        value
    }
    #[inline]
    fn atan2(self, x: Self) -> Self {
        f64::atan2(self, x)
    }
}

/// A value with its gradient and Hessian by `N` variables.
#[derive(Clone, Copy, Debug)]
pub struct Jet<const N: usize> {
    /// Value.
    pub value: f64,
    /// First derivatives.
    pub gradient: [f64; N],
    /// Second derivatives; only entries `[i][j]` with `j ≤ i` are kept.
    lower: [[f64; N]; N],
}

impl<const N: usize> Jet<N> {
    /// The `index`-th variable.
    #[must_use]
    pub fn variable(value: f64, index: usize) -> Self {
        let mut jet = Self::constant(value);
        jet.gradient[index] = 1.0;
        jet
    }
    /// All variables at once.
    #[must_use]
    pub fn variables(values: &[f64; N]) -> [Self; N] {
        std::array::from_fn(|i| Self::variable(values[i], i))
    }
    /// Full symmetric Hessian.
    #[must_use]
    pub fn hessian(&self) -> [[f64; N]; N] {
        std::array::from_fn(|i| std::array::from_fn(|j| if j <= i { self.lower[i][j] } else { self.lower[j][i] }))
    }
    fn binary(self, other: Self, value: f64, d: [f64; 2], dd: [f64; 3]) -> Self {
        let mut out = Self { value, gradient: [0.0; N], lower: [[0.0; N]; N] };
        for i in 0..N {
            let (a, b) = (self.gradient[i], other.gradient[i]);
            out.gradient[i] = d[0] * a + d[1] * b;
            let (left, right) = (dd[0] * a + dd[1] * b, dd[1] * a + dd[2] * b);
            for j in 0..=i {
                out.lower[i][j] = d[0] * self.lower[i][j]
                    + d[1] * other.lower[i][j]
                    + left * self.gradient[j]
                    + right * other.gradient[j];
            }
        }
        out
    }
}

impl<const N: usize> Real for Jet<N> {
    fn constant(value: f64) -> Self {
        Self { value, gradient: [0.0; N], lower: [[0.0; N]; N] }
    }
    fn value(self) -> f64 {
        self.value
    }
    fn chain(self, value: f64, first: f64, second: f64) -> Self {
        let mut out = Self { value, gradient: [0.0; N], lower: [[0.0; N]; N] };
        for i in 0..N {
            out.gradient[i] = first * self.gradient[i];
            let left = second * self.gradient[i];
            for j in 0..=i {
                out.lower[i][j] = first * self.lower[i][j] + left * self.gradient[j];
            }
        }
        out
    }
    fn atan2(self, x: Self) -> Self {
        let (b, a) = (self.value, x.value);
        let r2 = a * a + b * b;
        let r4 = r2 * r2;
        self.binary(x, b.atan2(a), [a / r2, -b / r2], [-2.0 * a * b / r4, (b * b - a * a) / r4, 2.0 * a * b / r4])
    }
}

impl<const N: usize> Add for Jet<N> {
    type Output = Self;
    fn add(mut self, other: Self) -> Self {
        self.value += other.value;
        for i in 0..N {
            self.gradient[i] += other.gradient[i];
            for j in 0..=i {
                self.lower[i][j] += other.lower[i][j];
            }
        }
        self
    }
}

impl<const N: usize> Sub for Jet<N> {
    type Output = Self;
    fn sub(mut self, other: Self) -> Self {
        self.value -= other.value;
        for i in 0..N {
            self.gradient[i] -= other.gradient[i];
            for j in 0..=i {
                self.lower[i][j] -= other.lower[i][j];
            }
        }
        self
    }
}

impl<const N: usize> Neg for Jet<N> {
    type Output = Self;
    fn neg(self) -> Self {
        self.chain(-self.value, -1.0, 0.0)
    }
}

impl<const N: usize> Mul for Jet<N> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.binary(other, self.value * other.value, [other.value, self.value], [0.0, 1.0, 0.0])
    }
}

impl<const N: usize> Div for Jet<N> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let inverse = 1.0 / other.value;
        let q = self.value * inverse;
        self.binary(other, q, [inverse, -q * inverse], [0.0, -inverse * inverse, 2.0 * q * inverse * inverse])
    }
}

/// Vectors of three scalars of any kind.
pub mod vector3 {
    use super::Real;

    /// `a − b`.
    pub fn sub<T: Real>(a: [T; 3], b: [T; 3]) -> [T; 3] {
        [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
    }
    /// `a + b`.
    pub fn add<T: Real>(a: [T; 3], b: [T; 3]) -> [T; 3] {
        [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
    }
    /// `a · b`.
    pub fn dot<T: Real>(a: [T; 3], b: [T; 3]) -> T {
        a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    }
    /// `a × b`.
    pub fn cross<T: Real>(a: [T; 3], b: [T; 3]) -> [T; 3] {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    }
    /// `a s`.
    pub fn scale<T: Real>(a: [T; 3], s: T) -> [T; 3] {
        [a[0] * s, a[1] * s, a[2] * s]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_of_a_known_function() {
        // f = x y² / z + atan2(y, x)
        let f = |x: f64, y: f64, z: f64| x * y * y / z + y.atan2(x);
        let point = [0.7, -1.3, 2.1];
        let [x, y, z] = Jet::<3>::variables(&point);
        let jet = x * y.square() / z + y.atan2(x);
        let h = 1e-5;
        for i in 0..3 {
            let mut up = point;
            let mut down = point;
            up[i] += h;
            down[i] -= h;
            let slope = (f(up[0], up[1], up[2]) - f(down[0], down[1], down[2])) / (2.0 * h);
            assert!((jet.gradient[i] - slope).abs() < 1e-8, "{i}: {} {slope}", jet.gradient[i]);
        }
        // ∂²f/∂x∂y = 2y/z + (y² − x²)/(x² + y²)², by hand.
        let r4 = (0.7f64 * 0.7 + 1.69).powi(2);
        let expected = 2.0 * -1.3 / 2.1 + (1.69 - 0.49) / r4;
        assert!((jet.hessian()[0][1] - expected).abs() < 1e-12);
        assert_eq!(jet.hessian()[0][1], jet.hessian()[1][0]);
    }

    #[test]
    fn one_variable_functions() {
        let x = Jet::<1>::variable(0.3, 0);
        assert!((x.sqrt().square().hessian()[0][0]).abs() < 1e-12);
        assert!((x.ln().hessian()[0][0] + 1.0 / 0.09).abs() < 1e-12);
        let s = (1.0f64 - 0.09).sqrt();
        assert!((x.acos().hessian()[0][0] + 0.3 / (s * s * s)).abs() < 1e-12);
    }
}
