//! Eigenvalues and eigenvectors of small symmetric matrices, by Jacobi rotations.

/// Most sweeps over all pairs; ten are enough for any matrix of a dozen rows.
const SWEEPS: usize = 60;

/// Eigenvalues, ascending, and for each its unit eigenvector: `matrix · vectors[k] = values[k] vectors[k]`.
///
/// Only meaningful for a symmetric matrix of finite numbers.
#[must_use]
pub fn symmetric_eigen<const N: usize>(matrix: &[[f64; N]; N]) -> ([f64; N], [[f64; N]; N]) {
    let mut a = *matrix;
    let mut vectors: [[f64; N]; N] = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    let size = a.iter().flatten().fold(0.0f64, |m, v| m.max(v.abs()));
    for _ in 0..SWEEPS {
        let mut off = 0.0f64;
        for p in 0..N {
            for q in p + 1..N {
                off = off.max(a[p][q].abs());
                if a[p][q].abs() <= f64::EPSILON * f64::EPSILON * size {
                    continue;
                }
                let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
                let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
                let c = 1.0 / (t * t + 1.0).sqrt();
                let s = t * c;
                for k in 0..N {
                    (a[k][p], a[k][q]) = (c * a[k][p] - s * a[k][q], s * a[k][p] + c * a[k][q]);
                }
                for k in 0..N {
                    (a[p][k], a[q][k]) = (c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]);
                    (vectors[p][k], vectors[q][k]) =
                        (c * vectors[p][k] - s * vectors[q][k], s * vectors[p][k] + c * vectors[q][k]);
                }
            }
        }
        if off <= f64::EPSILON * f64::EPSILON * size {
            break;
        }
    }
    let mut order: [usize; N] = std::array::from_fn(|k| k);
    order.sort_by(|&i, &j| a[i][i].total_cmp(&a[j][j]));
    (order.map(|k| a[k][k]), order.map(|k| vectors[k]))
}

/// The nearest positive semi-definite matrix: negative eigenvalues become zero.
#[must_use]
pub fn positive_part<const N: usize>(matrix: &[[f64; N]; N]) -> [[f64; N]; N] {
    let (values, vectors) = symmetric_eigen(matrix);
    if values[0] >= 0.0 {
        return *matrix;
    }
    let mut out = [[0.0; N]; N];
    for (value, vector) in values.iter().zip(&vectors).filter(|(value, _)| **value > 0.0) {
        for i in 0..N {
            for j in 0..N {
                out[i][j] += value * vector[i] * vector[j];
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    const MATRIX: [[f64; 3]; 3] = [[2.0, -1.0, 0.5], [-1.0, -3.0, 0.25], [0.5, 0.25, 1.0]];

    #[test]
    fn eigenvectors_are_stretched_by_their_eigenvalues() {
        let (values, vectors) = symmetric_eigen(&MATRIX);
        assert!(values[0] < values[1] && values[1] < values[2]);
        for (value, vector) in values.iter().zip(&vectors) {
            for i in 0..3 {
                let image: f64 = (0..3).map(|j| MATRIX[i][j] * vector[j]).sum();
                assert!((image - value * vector[i]).abs() < 1e-14);
            }
            assert!((vector.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-14);
        }
        assert!((values.iter().sum::<f64>() - 0.0).abs() < 1e-14, "the trace");
    }

    #[test]
    fn the_positive_part_keeps_what_is_positive_and_drops_the_rest() {
        let (values, vectors) = symmetric_eigen(&MATRIX);
        let part = positive_part(&MATRIX);
        for (value, vector) in values.iter().zip(&vectors) {
            for i in 0..3 {
                let image: f64 = (0..3).map(|j| part[i][j] * vector[j]).sum();
                assert!((image - value.max(0.0) * vector[i]).abs() < 1e-14);
            }
        }
        let definite = [[2.0, 0.1], [0.1, 1.0]];
        assert_eq!(positive_part(&definite), definite);
        assert_eq!(positive_part(&[[0.0; 2]; 2]), [[0.0; 2]; 2]);
    }
}
