//! Small dense symmetric systems.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt;
use faer::{Conj, MatMut, MatRef, Par, Spec};

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

/// The Cholesky factor of a matrix of a handful of rows.
#[derive(Clone, Debug, Default)]
pub struct SmallCholesky {
    n: usize,
    /// Lower triangle by rows.
    lower: Vec<f64>,
}

impl SmallCholesky {
    /// Factors the `n × n` matrix with these entries, of which those on and below the diagonal are asked for; whether it is
    /// positive definite.
    pub fn factor(&mut self, n: usize, entry: impl Fn(usize, usize) -> f64) -> bool {
        self.n = n;
        self.lower.clear();
        self.lower.resize(n * n, 0.0);
        let lower = &mut self.lower;
        for i in 0..n {
            for j in 0..=i {
                let before: f64 = (0..j).map(|k| lower[i * n + k] * lower[j * n + k]).sum();
                let left = entry(i, j) - before;
                if i == j {
                    // A pivot that is nothing but round-off is none.
                    if left.is_nan() || left <= PIVOT * entry(i, i).abs() {
                        return false;
                    }
                    lower[i * n + i] = left.sqrt();
                } else {
                    lower[i * n + j] = left / lower[j * n + j];
                }
            }
        }
        true
    }

    /// Replaces a right side by the solution.
    ///
    /// # Panics
    /// If it has not the length of the matrix.
    pub fn solve(&self, x: &mut [f64]) {
        let n = self.n;
        assert_eq!(x.len(), n);
        for i in 0..n {
            let before: f64 = (0..i).map(|k| self.lower[i * n + k] * x[k]).sum();
            x[i] = (x[i] - before) / self.lower[i * n + i];
        }
        for i in (0..n).rev() {
            let after: f64 = (i + 1..n).map(|k| self.lower[k * n + i] * x[k]).sum();
            x[i] = (x[i] - after) / self.lower[i * n + i];
        }
    }
}

/// Part of its diagonal entry below which a pivot counts as none.
const PIVOT: f64 = 1e-14;

#[cfg(test)]
mod tests {
    use super::*;

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
    fn a_small_factor_solves_and_says_when_there_is_none() {
        let matrix = [[4.0, 1.0, 0.5], [1.0, 3.0, -0.2], [0.5, -0.2, 2.0]];
        let mut factor = SmallCholesky::default();
        assert!(factor.factor(3, |i, j| matrix[i][j]));
        let exact = [1.0, -2.0, 0.5];
        let mut x = matrix.map(|row| row.iter().zip(exact).map(|(a, b)| a * b).sum::<f64>());
        factor.solve(&mut x);
        assert!(x.iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-14));
        for broken in [-1.0, 0.0, f64::NAN] {
            assert!(!factor.factor(2, |i, j| if i == j { [1.0, broken][i] } else { 0.0 }));
        }
        assert!(factor.factor(0, |_, _| 0.0));
        factor.solve(&mut []);
    }
}
