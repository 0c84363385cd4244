//! Linear systems of a step: sparse Cholesky or conjugate gradients, behind one door.

use thiserror::Error;
use wale_numerics::block_matrix::BlockMatrix;
use wale_numerics::coarse_space::CoarseSpace;
use wale_numerics::conjugate_gradient::{
    ConjugateGradient, ConjugateGradientEnd, ConjugateGradientSettings, LinearOperator,
};
use wale_numerics::incomplete_cholesky::{IncompleteCholesky, IncompleteCholeskySettings};
use wale_numerics::preconditioner::Additive;
use wale_numerics::prolongation::Prolongation;
use wale_numerics::sparse_cholesky::{BlockOrder, CholeskyError, SparseCholesky};

use super::system::System;
use crate::model::LinearSolver;

/// What a linear solve took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinearReport {
    /// Iterations of conjugate gradients; zero for a direct solve.
    pub iterations: usize,
    /// Whether they met a direction of negative curvature and stopped there: what they found goes downhill still.
    pub negative_curvature: bool,
}

/// Why a linear system could not be solved.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum LinearError {
    /// The matrix is not positive definite, not finite, or its factor too large.
    #[error(transparent)]
    Factor(#[from] CholeskyError),
    /// Conjugate gradients or their preconditioner met a direction of negative curvature.
    #[error("conjugate gradients met negative curvature")]
    NegativeCurvature,
}

/// Two nodes in contact: the matrix has twice its stiffness on both diagonal blocks and none between them
/// ([`crate::energy::SelfContact`]); conjugate gradients see the true one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupling {
    /// First slots of the nodes.
    pub slots: [u32; 2],
    /// `√k n` by node, zero along slots that are not free.
    pub directions: [[f64; 3]; 2],
}

/// The matrix with the true stiffness of contacts.
struct Coupled<'a> {
    matrix: &'a BlockMatrix,
    couplings: &'a [Coupling],
}

impl LinearOperator for Coupled<'_> {
    fn dimension(&self) -> usize {
        self.matrix.dimension()
    }
    fn apply(&self, x: &[f64], out: &mut [f64]) {
        self.matrix.apply(x, out);
        // (δ₂ − δ₁)² is what 2δ₁² + 2δ₂² is less (δ₁ + δ₂)².
        for Coupling { slots, directions } in self.couplings {
            let [a, b] = slots.map(|slot| slot as usize);
            let [n, m] = directions;
            let sum: f64 = (0..3).map(|k| n[k] * x[a + k] + m[k] * x[b + k]).sum();
            for k in 0..3 {
                out[a + k] -= n[k] * sum;
                out[b + k] -= m[k] * sum;
            }
        }
    }
}

/// Which solver, and how exact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearSettings {
    /// Which solver.
    pub solver: LinearSolver,
    /// Preconditioned residual, relative to the start, at which conjugate gradients stop \[–\].
    pub tolerance: f64,
}

impl Default for LinearSettings {
    fn default() -> Self {
        Self { solver: LinearSolver::Automatic, tolerance: 0.03 }
    }
}

/// Unknowns up to which factors are cheaper than conjugate gradients (`wale bench solver` measures both).
pub const DIRECT_UNKNOWNS: usize = 12_000;
/// Loops between the nodes of the coarse space.
const COARSE_LOOPS: f64 = 3.0;
/// Most iterations of conjugate gradients.
const MOST_ITERATIONS: usize = 300;

/// A linear solver of symmetric positive definite block systems.
pub enum Linear {
    /// Not set up yet, or the free slots changed.
    None,
    /// Sparse Cholesky factors with the symbolic part kept.
    Cholesky(Box<SparseCholesky>),
    /// Conjugate gradients, preconditioned by block IC(0) and a bilinear coarse space.
    ConjugateGradient(Box<Iterative>),
}

/// Memory of the iterative solver.
pub struct Iterative {
    preconditioner: Additive<IncompleteCholesky, CoarseSpace>,
    gradient: ConjugateGradient,
    right_side: Vec<f64>,
    settings: ConjugateGradientSettings,
}

impl Linear {
    /// Takes the memory for a system whose unknowns are the `free` slots.
    ///
    /// # Errors
    /// If a factor would be too large.
    pub fn new(system: &System, free: &[bool], settings: LinearSettings) -> Result<Self, LinearError> {
        let unknowns = free.iter().filter(|free| **free).count();
        let direct = match settings.solver {
            LinearSolver::Automatic => unknowns <= DIRECT_UNKNOWNS,
            LinearSolver::Cholesky => true,
            LinearSolver::ConjugateGradient => false,
        };
        let pattern = system.pattern().clone();
        if direct {
            let factor = SparseCholesky::new(pattern, free, BlockOrder::MinimumDegree)?;
            return Ok(Self::Cholesky(Box::new(factor)));
        }
        let prolongation = Prolongation::bilinear(system.chart_place(), COARSE_LOOPS);
        Ok(Self::ConjugateGradient(Box::new(Iterative {
            preconditioner: Additive(
                IncompleteCholesky::new(pattern.clone(), IncompleteCholeskySettings::default()),
                CoarseSpace::new(pattern, prolongation, free)?,
            ),
            gradient: ConjugateGradient::new(free.len()),
            right_side: vec![0.0; free.len()],
            settings: ConjugateGradientSettings {
                max_iterations: MOST_ITERATIONS,
                relative_tolerance: settings.tolerance,
                absolute_tolerance: 0.0,
            },
        })))
    }

    /// Name of the solver, for reports.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Cholesky(_) => "sparse Cholesky",
            Self::ConjugateGradient(_) => "conjugate gradients with block IC(0) and a coarse space",
        }
    }

    /// Solves `A x = b`; `x` holds `b` on entry, zero in fixed slots, which were taken out of the matrix. Contacts are
    /// coupled by conjugate gradients; factors take the matrix as it is, which bounds them.
    ///
    /// # Errors
    /// If the matrix is not positive definite or not finite.
    pub fn solve(
        &mut self,
        matrix: &BlockMatrix,
        couplings: &[Coupling],
        x: &mut [f64],
    ) -> Result<LinearReport, LinearError> {
        match self {
            Self::None => Err(LinearError::NegativeCurvature),
            Self::Cholesky(factor) => {
                factor.factor(matrix, 0.0)?;
                factor.solve_in_place(x);
                Ok(LinearReport::default())
            }
            Self::ConjugateGradient(iterative) => {
                let Additive(local, coarse) = &mut iterative.preconditioner;
                let (local, coarse) = rayon::join(|| local.factor(matrix), || coarse.factor(matrix));
                local.map_err(|_| LinearError::NegativeCurvature)?;
                coarse?;
                iterative.right_side.copy_from_slice(x);
                x.fill(0.0);
                let report = iterative.gradient.solve(
                    &Coupled { matrix, couplings },
                    &mut iterative.preconditioner,
                    &iterative.right_side,
                    x,
                    None,
                    &iterative.settings,
                );
                let iterations = report.iterations;
                match report.end {
                    ConjugateGradientEnd::Converged | ConjugateGradientEnd::IterationLimit => {
                        Ok(LinearReport { iterations, negative_curvature: false })
                    }
                    ConjugateGradientEnd::NegativeCurvature if iterations > 1 => {
                        Ok(LinearReport { iterations, negative_curvature: true })
                    }
                    ConjugateGradientEnd::NegativeCurvature | ConjugateGradientEnd::Breakdown => {
                        Err(LinearError::NegativeCurvature)
                    }
                }
            }
        }
    }
}
