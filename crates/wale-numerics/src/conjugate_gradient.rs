//! Preconditioned conjugate gradients, stopped on the preconditioned residual.

use crate::block_matrix::{BlockMatrix, PaddedBlock};
use crate::preconditioner::Preconditioner;
use crate::vector;

/// A symmetric matrix, known by its product.
pub trait LinearOperator {
    /// Length of the vectors.
    fn dimension(&self) -> usize;
    /// `out = A x`; may use scratch memory of its own.
    fn apply(&mut self, x: &[f64], out: &mut [f64]);
}

impl LinearOperator for &BlockMatrix {
    fn dimension(&self) -> usize {
        BlockMatrix::dimension(self)
    }
    fn apply(&mut self, x: &[f64], out: &mut [f64]) {
        self.multiply(x, out);
    }
}

/// A matrix of 32 bits, which takes half the time to read, with memory to round vectors into.
#[derive(Debug)]
pub struct Single<'a> {
    /// The matrix.
    pub matrix: &'a BlockMatrix<f32>,
    /// One block a row.
    pub rounded: &'a mut [PaddedBlock],
}

impl LinearOperator for Single<'_> {
    fn dimension(&self) -> usize {
        self.matrix.dimension()
    }
    fn apply(&mut self, x: &[f64], out: &mut [f64]) {
        self.matrix.multiply_rounded(x, self.rounded, out);
    }
}

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConjugateGradientSettings {
    /// Largest number of iterations.
    pub max_iterations: usize,
    /// Stop when `√(rᵀM⁻¹r)` has fallen to this fraction of its value at the start.
    pub relative_tolerance: f64,
    /// Stop when `√(rᵀM⁻¹r)` has fallen to this value.
    pub absolute_tolerance: f64,
    /// Do not stop before the last three updates of `x` were each at most this part of `x`, in Euclidean norm: a stiff
    /// part of the residual may be gone long before `x` has moved along the soft one.
    pub relative_update: f64,
    /// Stop when the last three updates of `x` were each at most this, and the residual within three times its goal.
    pub absolute_update: f64,
}

impl Default for ConjugateGradientSettings {
    /// Loose, as inside a Newton iteration.
    fn default() -> Self {
        Self {
            max_iterations: 100,
            relative_tolerance: 0.1,
            absolute_tolerance: 0.0,
            relative_update: f64::INFINITY,
            absolute_update: 0.0,
        }
    }
}

/// Why the iteration ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConjugateGradientEnd {
    /// A tolerance was reached.
    Converged,
    /// The allowed iterations are used up; the solution so far is the best in its space.
    IterationLimit,
    /// A search direction of zero or negative curvature was met: the matrix is not positive
    /// definite. The solution is that before this direction (still a descent direction unless no
    /// iteration was made); the direction is [`ConjugateGradient::direction`].
    NegativeCurvature,
    /// The preconditioner is not positive definite, or a number is not finite.
    Breakdown,
}

/// What an iteration did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConjugateGradientReport {
    /// Search directions used: products with the matrix, less one if curvature was negative.
    pub iterations: usize,
    /// Why it ended.
    pub end: ConjugateGradientEnd,
    /// `√(rᵀM⁻¹r)` at the start.
    pub initial_residual: f64,
    /// `√(rᵀM⁻¹r)` at the end.
    pub final_residual: f64,
    /// `|M⁻¹r|` at the start: what one application of the preconditioner would move `x` by.
    pub initial_update: f64,
    /// Largest norm of the last three updates of `x`.
    pub last_update: f64,
}

/// Memory of the iteration, taken once.
#[derive(Clone, Debug)]
pub struct ConjugateGradient {
    residual: Vec<f64>,
    preconditioned: Vec<f64>,
    direction: Vec<f64>,
    product: Vec<f64>,
    history: Vec<f64>,
}

impl ConjugateGradient {
    /// Memory for vectors of length `dimension`.
    pub fn new(dimension: usize) -> Self {
        Self {
            residual: vec![0.0; dimension],
            preconditioned: vec![0.0; dimension],
            direction: vec![0.0; dimension],
            product: vec![0.0; dimension],
            history: Vec::new(),
        }
    }

    /// The last search direction.
    pub fn direction(&self) -> &[f64] {
        &self.direction
    }

    /// The matrix times the last search direction.
    pub fn product(&self) -> &[f64] {
        &self.product
    }

    /// `√(rᵀM⁻¹r)` before each iteration of the last solve, and at its end.
    pub fn history(&self) -> &[f64] {
        &self.history
    }

    /// Solves `A x = b` for the free slots, starting from the given `x`.
    ///
    /// `free`, if given, holds one flag a slot: `x` stays as it is on the others, and `b` is not
    /// read there. It is not needed when the fixed slots were taken out of the matrix
    /// ([`BlockMatrix::fix_slots`]) and `b` and `x` are zero there.
    ///
    /// # Panics
    /// If a length differs from that of the memory.
    pub fn solve(
        &mut self,
        mut matrix: impl LinearOperator,
        preconditioner: &mut (impl Preconditioner + ?Sized),
        b: &[f64],
        x: &mut [f64],
        free: Option<&[bool]>,
        settings: &ConjugateGradientSettings,
    ) -> ConjugateGradientReport {
        let dimension = self.residual.len();
        assert!(matrix.dimension() == dimension && b.len() == dimension && x.len() == dimension);
        let filter = |v: &mut [f64]| {
            if let Some(free) = free {
                vector::keep_free(v, free);
            }
        };
        self.history.clear();
        self.history.reserve(settings.max_iterations + 1);
        if x.iter().all(|&x| x == 0.0) {
            vector::copy(b, &mut self.residual);
        } else {
            matrix.apply(x, &mut self.residual);
            vector::scale_and_add(&mut self.residual, -1.0, b);
        }
        filter(&mut self.residual);
        preconditioner.apply(&self.residual, &mut self.preconditioned);
        filter(&mut self.preconditioned);
        vector::copy(&self.preconditioned, &mut self.direction);
        let mut energy = vector::dot(&self.residual, &self.preconditioned);
        let initial_residual = energy.max(0.0).sqrt();
        let initial_update = vector::norm(&self.preconditioned);
        let goal = (settings.relative_tolerance * initial_residual).max(settings.absolute_tolerance);
        let mut iterations = 0;
        let mut updates = [f64::INFINITY; 3];
        let end = loop {
            if !(energy >= 0.0 && energy.is_finite()) {
                break ConjugateGradientEnd::Breakdown;
            }
            self.history.push(energy.sqrt());
            let update = updates.iter().fold(0.0, |m: f64, &u| m.max(u));
            let settled = settings.relative_update == f64::INFINITY
                || iterations > 0 && update <= settings.relative_update * vector::norm(x);
            let small = update <= settings.absolute_update && energy.sqrt() <= 3.0 * goal;
            if energy == 0.0 || energy.sqrt() <= goal && settled || small {
                break ConjugateGradientEnd::Converged;
            }
            if iterations == settings.max_iterations {
                break ConjugateGradientEnd::IterationLimit;
            }
            matrix.apply(&self.direction, &mut self.product);
            filter(&mut self.product);
            let curvature = vector::dot(&self.direction, &self.product);
            if !curvature.is_finite() {
                break ConjugateGradientEnd::Breakdown;
            }
            if curvature <= 0.0 {
                break ConjugateGradientEnd::NegativeCurvature;
            }
            let step = energy / curvature;
            updates[iterations % 3] = step * vector::norm(&self.direction);
            vector::add_scaled(x, step, &self.direction);
            vector::add_scaled(&mut self.residual, -step, &self.product);
            preconditioner.apply(&self.residual, &mut self.preconditioned);
            filter(&mut self.preconditioned);
            let previous = energy;
            energy = vector::dot(&self.residual, &self.preconditioned);
            vector::scale_and_add(&mut self.direction, energy / previous, &self.preconditioned);
            iterations += 1;
        };
        let final_residual = energy.max(0.0).sqrt();
        let last_update = updates[..iterations.min(3)].iter().fold(0.0, |m: f64, &u| m.max(u));
        ConjugateGradientReport { iterations, end, initial_residual, final_residual, initial_update, last_update }
    }
}
