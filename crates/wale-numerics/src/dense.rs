//! Small dense symmetric systems: direct Newton directions of tiles, and of a few nodes.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt;
use faer::linalg::solvers::Solve;
use faer::{Conj, Mat, MatMut, MatRef, Par, Side, Spec};

/// A system `A x = b` of a size that changes from one to the next, in memory that only grows.
#[derive(Default)]
pub struct SmallSystem {
    /// The matrix by columns, of which the lower triangle is read; after solving its factor.
    pub matrix: Vec<f64>,
    /// The right side; after solving the solution.
    pub right_side: Vec<f64>,
    memory: Option<MemBuffer>,
}

impl SmallSystem {
    /// Takes memory for up to `n` unknowns.
    #[must_use]
    pub fn with_capacity(n: usize) -> Self {
        let mut system = Self { matrix: Vec::with_capacity(n * n), right_side: Vec::with_capacity(n), memory: None };
        reserve(&mut system.memory, n);
        system
    }

    /// Makes it a system of zeros.
    pub fn clear(&mut self, n: usize) {
        self.matrix.clear();
        self.matrix.resize(n * n, 0.0);
        self.right_side.clear();
        self.right_side.resize(n, 0.0);
    }

    /// Solves it in its place; returns whether the matrix is positive definite and finite. If not, nothing in it is of
    /// use.
    ///
    /// # Panics
    /// If the matrix has not the square of the length of the right side.
    #[must_use]
    pub fn solve(&mut self) -> bool {
        let n = self.right_side.len();
        assert_eq!(self.matrix.len(), n * n);
        let memory = MemStack::new(reserve(&mut self.memory, n));
        let (matrix, right_side) = (&mut self.matrix, &mut self.right_side);
        let lower = MatMut::from_column_major_slice_mut(matrix, n, n);
        if llt::factor::cholesky_in_place(lower, Default::default(), Par::Seq, memory, Spec::default()).is_err() {
            return false;
        }
        llt::solve::solve_in_place_with_conj(
            MatRef::from_column_major_slice(matrix, n, n),
            Conj::No,
            MatMut::from_column_major_slice_mut(right_side, n, 1),
            Par::Seq,
            memory,
        );
        right_side.iter().all(|x| x.is_finite())
    }
}

fn reserve(memory: &mut Option<MemBuffer>, n: usize) -> &mut MemBuffer {
    let request = llt::factor::cholesky_in_place_scratch::<f64>(n, Par::Seq, Spec::default())
        .or(llt::solve::solve_in_place_scratch::<f64>(n, 1, Par::Seq));
    if memory.as_ref().is_some_and(|memory| memory.len() < request.unaligned_bytes_required()) {
        *memory = None;
    }
    memory.get_or_insert_with(|| MemBuffer::new(request))
}

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
    fn a_small_system_is_solved_in_its_place() {
        let mut system = SmallSystem::default();
        let mut solve = |matrix: &[f64], right_side: &[f64]| {
            system.clear(right_side.len());
            system.matrix.copy_from_slice(matrix);
            system.right_side.copy_from_slice(right_side);
            system.solve().then(|| system.right_side.clone())
        };
        let x = solve(&[2.0, 0.5, f64::NAN, 1.0], &[-1.0, 1.0]).expect("the upper triangle is not read");
        assert!((x[0] + 1.5 / 1.75).abs() < 1e-12 && (x[1] - 2.5 / 1.75).abs() < 1e-12);
        assert_eq!(solve(&[1.0, 2.0, 2.0, 1.0], &[1.0, 1.0]), None);
        assert_eq!(solve(&[f64::NAN], &[1.0]), None);
        let x = solve(&[4.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 2.0], &[4.0, 8.0, 2.0]).expect("memory grows");
        assert!(x.iter().zip([1.0, 2.0, 1.0]).all(|(x, exact)| (x - exact).abs() < 1e-12));
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
