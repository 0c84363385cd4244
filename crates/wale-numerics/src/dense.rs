//! Small dense symmetric systems: direct Newton directions of tiles.

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};

/// How a descent direction was found.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum DirectionKind {
    /// The matrix is positive definite: Newton's own direction.
    Newton,
    /// It is not: each eigenvalue was replaced by its size, bounded from below.
    SaddleFree,
    /// It is not, and it is too large for an eigen-decomposition: a multiple of the identity was added.
    Shifted,
}

/// Largest size for which an indefinite matrix is decomposed instead of shifted.
const LARGEST_DECOMPOSED: usize = 420;

/// Solves `A d = −g` for a descent direction; `matrix` is the full symmetric matrix, row by row.
///
/// Returns `None` if no direction could be found (numbers that are not finite).
#[must_use]
pub fn descent_direction(matrix: &[f64], gradient: &[f64]) -> Option<(Vec<f64>, DirectionKind)> {
    let n = gradient.len();
    if !matrix.iter().chain(gradient).all(|x| x.is_finite()) {
        return None;
    }
    let a = Mat::from_fn(n, n, |i, j| matrix[i * n + j]);
    let rhs = Mat::from_fn(n, 1, |i, _| -gradient[i]);
    let column = |x: Mat<f64>| (0..n).map(|i| x[(i, 0)]).collect::<Vec<_>>();
    if let Ok(factor) = a.llt(Side::Lower) {
        return Some((column(factor.solve(&rhs)), DirectionKind::Newton));
    }
    let largest = (0..n).map(|i| a[(i, i)].abs()).fold(0.0, f64::max).max(f64::MIN_POSITIVE);
    if n <= LARGEST_DECOMPOSED {
        let eigen = a.self_adjoint_eigen(Side::Lower).ok()?;
        let (u, s) = (eigen.U(), eigen.S().column_vector());
        let mut coefficients = u.transpose() * &rhs;
        for i in 0..n {
            coefficients[(i, 0)] /= s[i].abs().max(1e-10 * largest);
        }
        return Some((column(u * coefficients), DirectionKind::SaddleFree));
    }
    let mut shift = 1e-6 * largest;
    for _ in 0..40 {
        let shifted = Mat::from_fn(n, n, |i, j| a[(i, j)] + if i == j { shift } else { 0.0 });
        if let Ok(factor) = shifted.llt(Side::Lower) {
            return Some((column(factor.solve(&rhs)), DirectionKind::Shifted));
        }
        shift *= 4.0;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn definite_and_indefinite_directions_descend() {
        let (d, kind) = descent_direction(&[2.0, 0.5, 0.5, 1.0], &[1.0, -1.0]).unwrap();
        assert_eq!(kind, DirectionKind::Newton);
        // [2 ½; ½ 1]⁻¹ (−1, 1) = (−1.5, 2.5)/1.75
        assert!((d[0] + 1.5 / 1.75).abs() < 1e-12 && (d[1] - 2.5 / 1.75).abs() < 1e-12);
        let (d, kind) = descent_direction(&[2.0, 0.0, 0.0, -4.0], &[1.0, 1.0]).unwrap();
        assert_eq!(kind, DirectionKind::SaddleFree);
        assert!((d[0] + 0.5).abs() < 1e-12 && (d[1] + 0.25).abs() < 1e-12);
        assert!(descent_direction(&[f64::NAN], &[1.0]).is_none());
    }

    #[test]
    fn large_indefinite_matrices_are_shifted() {
        let n = LARGEST_DECOMPOSED + 1;
        let mut a = vec![0.0; n * n];
        for i in 0..n {
            a[i * n + i] = if i == 7 { -1.0 } else { 2.0 };
        }
        let g: Vec<f64> = (0..n).map(|i| 1.0 + i as f64).collect();
        let (d, kind) = descent_direction(&a, &g).unwrap();
        assert_eq!(kind, DirectionKind::Shifted);
        assert!(d.iter().zip(&g).map(|(d, g)| d * g).sum::<f64>() < 0.0);
    }
}
