//! Checks of derivatives against independent ones, for tests.

/// Value, gradient and Hessian of an energy by its `N` local coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Local<const N: usize> {
    /// Energy \[J\].
    pub energy: f64,
    /// First derivatives.
    pub gradient: [f64; N],
    /// Second derivatives (or a positive semi-definite stand-in).
    pub hessian: [[f64; N]; N],
}

impl<const N: usize> Local<N> {
    /// Nothing yet.
    #[must_use]
    pub fn zero() -> Self {
        Self { energy: 0.0, gradient: [0.0; N], hessian: [[0.0; N]; N] }
    }

    /// Adds another sum.
    #[inline]
    pub fn add(&mut self, other: &Self) {
        self.add_scaled(1.0, other);
    }

    /// Adds `factor` times another sum.
    #[inline]
    pub fn add_scaled(&mut self, factor: f64, other: &Self) {
        self.add_gradient((factor * other.energy, other.gradient.map(|g| factor * g)));
        for (row, other) in self.hessian.iter_mut().zip(&other.hessian) {
            for (h, o) in row.iter_mut().zip(other) {
                *h += factor * o;
            }
        }
    }

    /// Adds a value and a gradient without curvature.
    #[inline]
    pub fn add_gradient(&mut self, (energy, gradient): (f64, [f64; N])) {
        self.energy += energy;
        for (g, o) in self.gradient.iter_mut().zip(&gradient) {
            *g += o;
        }
    }

    /// Adds `factor · a aᵀ`.
    #[inline]
    pub fn add_square(&mut self, factor: f64, a: &[f64; N]) {
        for i in 0..N {
            let scaled = factor * a[i];
            for j in 0..N {
                self.hessian[i][j] += scaled * a[j];
            }
        }
    }
}

/// Largest relative difference between a gradient and central differences of the energy.
///
/// `scale` is the size of a coordinate; the step is `1e-4 scale` with a fourth-order stencil.
///
/// # Panics
/// If the gradient is zero: a derivative test that can pass on zeros checks nothing.
pub fn gradient_error<const N: usize>(
    energy: impl Fn(&[f64; N]) -> f64,
    gradient: &[f64; N],
    q: &[f64; N],
    scale: f64,
) -> f64 {
    let h = 1e-4 * scale;
    let norm = gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
    assert!(norm > 0.0, "the gradient is zero at the tested state");
    let mut worst: f64 = 0.0;
    for i in 0..N {
        let at = |s: f64| {
            let mut moved = *q;
            moved[i] += s * h;
            energy(&moved)
        };
        let slope = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * h);
        worst = worst.max((slope - gradient[i]).abs() / norm);
    }
    worst
}

/// Largest relative difference between a Hessian and central differences of a gradient.
pub fn hessian_error<const N: usize>(
    gradient: impl Fn(&[f64; N]) -> [f64; N],
    hessian: &[[f64; N]; N],
    q: &[f64; N],
    scale: f64,
) -> f64 {
    let h = 1e-4 * scale;
    let norm = hessian.iter().flatten().map(|g| g * g).sum::<f64>().sqrt();
    assert!(norm > 0.0, "the Hessian is zero at the tested state");
    let mut worst: f64 = 0.0;
    for i in 0..N {
        let at = |s: f64| {
            let mut moved = *q;
            moved[i] += s * h;
            gradient(&moved)
        };
        let (a, b, c, d) = (at(1.0), at(-1.0), at(2.0), at(-2.0));
        for j in 0..N {
            let slope = (8.0 * (a[j] - b[j]) - (c[j] - d[j])) / (12.0 * h);
            worst = worst.max((slope - hessian[i][j]).abs() / norm);
        }
    }
    worst
}

/// Smallest eigenvalue of a symmetric matrix over its largest in size.
#[must_use]
pub fn relative_smallest_eigenvalue<const N: usize>(matrix: &[[f64; N]; N]) -> f64 {
    let (values, _) = crate::eigen::symmetric_eigen(matrix);
    let largest = values.iter().fold(0.0f64, |m, value| m.max(value.abs()));
    values.iter().copied().fold(f64::INFINITY, f64::min) / largest.max(f64::MIN_POSITIVE)
}
