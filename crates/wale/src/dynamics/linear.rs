//! Linear systems of a step: sparse Cholesky or conjugate gradients, behind one door.

use thiserror::Error;
use wale_numerics::block_matrix::{BlockMatrix, PaddedBlock};
use wale_numerics::coarse_space::CoarseSpace;
use wale_numerics::conjugate_gradient::{
    ConjugateGradient, ConjugateGradientEnd, ConjugateGradientReport, ConjugateGradientSettings, LinearOperator, Single,
};
use wale_numerics::incomplete_cholesky::{IncompleteCholesky, IncompleteCholeskySettings};
use wale_numerics::preconditioner::{Additive, Preconditioner};
use wale_numerics::prolongation::Prolongation;
use wale_numerics::sparse_cholesky::{BlockOrder, CholeskyError, SparseCholesky};
use wale_numerics::vector;

use super::selected::Selected;
use super::system::System;
use super::workspace::Workspace;
use crate::fabric::coordinates::BLOCK;
use crate::model::LinearSolver;

/// What a linear solve took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinearReport {
    /// Iterations of conjugate gradients; zero for a direct solve.
    pub iterations: usize,
    /// Whether they met a direction of negative curvature and stopped there: what they found in more than one iteration
    /// goes downhill still.
    pub negative_curvature: bool,
    /// Norm of what [`Linear::approximate`] makes of the right side.
    pub approximate: f64,
    /// Norm of the largest of the last updates of conjugate gradients.
    pub last_update: f64,
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

/// Nodes in contact: of the stiffness of `Σ wᵢ δᵢ` the matrix has `2 |wᵢ|` on the diagonal blocks and none between them
/// ([`crate::energy::SelfContact`], [`crate::energy::StrandContact`]); conjugate gradients see the true one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupling {
    /// First slots of the nodes.
    pub slots: [u32; 4],
    /// Share `w` of each node in the distance of what touches; those of either side add up to one, or minus one.
    pub weights: [f64; 4],
    /// `√k n` by node, zero along slots that are not free.
    pub directions: [[f64; 3]; 4],
}

/// The matrix with the true stiffness of contacts.
struct Coupled<'a, M> {
    matrix: M,
    couplings: &'a [Coupling],
}

impl<M: LinearOperator> LinearOperator for Coupled<'_, M> {
    fn dimension(&self) -> usize {
        self.matrix.dimension()
    }
    fn apply(&mut self, x: &[f64], out: &mut [f64]) {
        self.matrix.apply(x, out);
        for Coupling { slots, weights, directions } in self.couplings {
            let moves: [f64; 4] = std::array::from_fn(|i| {
                let first = slots[i] as usize;
                (0..3).map(|k| directions[i][k] * x[first + k]).sum()
            });
            let sum: f64 = (0..4).map(|i| weights[i] * moves[i]).sum();
            for i in 0..4 {
                let change = weights[i] * sum - 2.0 * weights[i].abs() * moves[i];
                for k in 0..3 {
                    out[slots[i] as usize + k] += directions[i][k] * change;
                }
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
const COARSE_LOOPS: f64 = 4.0;
/// Updates at which conjugate gradients may stop, relative to the solution, in parts of the tolerance of their residual.
const UPDATE: f64 = 0.2;
/// Most iterations of conjugate gradients.
const MOST_ITERATIONS: usize = 300;

/// Part of all negative curvature that makes a node one of those that have it.
const YIELDING: f64 = 0.01;

/// Residual to which contacts are put into a direct solve.
const CONTACTS: f64 = 1e-3;

fn reported(report: ConjugateGradientReport) -> Result<LinearReport, LinearError> {
    let iterations = report.iterations;
    let negative_curvature = match report.end {
        ConjugateGradientEnd::Converged | ConjugateGradientEnd::IterationLimit => false,
        ConjugateGradientEnd::NegativeCurvature => true,
        ConjugateGradientEnd::Breakdown => return Err(LinearError::NegativeCurvature),
    };
    Ok(LinearReport {
        iterations,
        negative_curvature,
        approximate: report.initial_update,
        last_update: report.last_update,
    })
}

/// A symmetric positive definite block system and its solver.
pub enum Linear {
    /// Sparse Cholesky factors with the symbolic part kept.
    Cholesky(Box<Direct>),
    /// Conjugate gradients, preconditioned by block IC(0) and a bilinear coarse space.
    ConjugateGradient(Box<Iterative>),
}

/// Memory of the direct solver. Contacts are not in its factor: where there are some, conjugate gradients put them in,
/// with the factor as preconditioner.
pub struct Direct {
    matrix: BlockMatrix<f64>,
    factor: Factor,
    gradient: ConjugateGradient,
    right_side: Vec<f64>,
}

/// A factor as a preconditioner.
struct Factor {
    cholesky: SparseCholesky,
    solution: Vec<f64>,
}

impl Preconditioner for Factor {
    fn add(&mut self, residual: &[f64], out: &mut [f64]) {
        self.solution.copy_from_slice(residual);
        self.cholesky.solve_in_place(&mut self.solution);
        vector::add_scaled(out, 1.0, &self.solution);
    }
}

/// Memory of the iterative solver. Its matrix has 32 bits: what is rounded off is far less than what conjugate gradients
/// leave, and products take half the time.
pub struct Iterative {
    matrix: BlockMatrix<f32>,
    rounded: Vec<PaddedBlock>,
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
            let cholesky = SparseCholesky::new(pattern.clone(), free, BlockOrder::MinimumDegree)?;
            return Ok(Self::Cholesky(Box::new(Direct {
                matrix: BlockMatrix::zeros(pattern),
                factor: Factor { cholesky, solution: vec![0.0; free.len()] },
                gradient: ConjugateGradient::new(free.len()),
                right_side: vec![0.0; free.len()],
            })));
        }
        let prolongation = Prolongation::bilinear(system.chart_place(), COARSE_LOOPS)
            .without_blocks_from(system.coordinates.node_count());
        // A domain or two of a fabric nearly always need a shift; found by trial it costs a factor more. The next shift is sixteen times
        // as large: one that only just does leaves a factor that is nearly singular, and lace took twice the iterations with it.
        let incomplete =
            IncompleteCholeskySettings { shifts: vec![4e-3, 6.4e-2, 1.0], ..IncompleteCholeskySettings::default() };
        Ok(Self::ConjugateGradient(Box::new(Iterative {
            matrix: BlockMatrix::zeros(pattern.clone()),
            rounded: vec![[0.0; 8]; pattern.rows()],
            preconditioner: Additive(
                IncompleteCholesky::new(pattern.clone(), incomplete),
                CoarseSpace::new(pattern, prolongation, free)?,
            ),
            gradient: ConjugateGradient::new(free.len()),
            right_side: vec![0.0; free.len()],
            settings: ConjugateGradientSettings {
                max_iterations: MOST_ITERATIONS,
                relative_tolerance: settings.tolerance,
                absolute_tolerance: 0.0,
                relative_update: UPDATE * settings.tolerance,
                absolute_update: 0.0,
            },
        })))
    }

    /// Name of the solver, for reports.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Cholesky(_) => "sparse Cholesky",
            Self::ConjugateGradient(_) => "conjugate gradients with block IC(0) and a coarse space",
        }
    }

    /// Bytes of the matrix.
    #[must_use]
    pub fn bytes(&self) -> usize {
        match self {
            Self::Cholesky(direct) => size_of_val(&direct.matrix.values[..]),
            Self::ConjugateGradient(iterative) => size_of_val(&iterative.matrix.values[..]),
        }
    }

    /// Writes the matrix and the gradient of a system at `q`; returns its energy.
    pub fn linearise(
        &mut self,
        system: &System,
        q: &[f64],
        convexity: f64,
        gradient: &mut [f64],
        work: &mut Workspace,
    ) -> f64 {
        match self {
            Self::Cholesky(direct) => system.linearise(q, convexity, gradient, &mut direct.matrix, work),
            Self::ConjugateGradient(iterative) => system.linearise(q, convexity, gradient, &mut iterative.matrix, work),
        }
    }

    /// Takes the fixed slots out of the matrix and factors it; a `convex` one can be indefinite by its rounding alone.
    ///
    /// # Errors
    /// If the matrix is not positive definite or not finite, as far as that shows here.
    pub fn factor(&mut self, free: &[bool], convex: bool) -> Result<(), LinearError> {
        match self {
            Self::Cholesky(direct) => {
                direct.matrix.fix_slots(free, 1.0);
                let Direct { matrix, factor, .. } = &mut **direct;
                if convex {
                    factor.cholesky.factor_rounded(matrix)?;
                } else {
                    factor.cholesky.factor(matrix, 0.0)?;
                }
            }
            Self::ConjugateGradient(iterative) => {
                iterative.matrix.fix_slots(free, 1.0);
                let Additive(local, coarse) = &mut iterative.preconditioner;
                let matrix = &iterative.matrix;
                let (local, coarse) = rayon::join(|| local.factor(matrix), || coarse.factor(matrix));
                local.map_err(|_| LinearError::NegativeCurvature)?;
                coarse?;
            }
        }
        Ok(())
    }

    /// Solves `A x = b` with the matrix that was factored last; `x` holds `b` on entry, zero in fixed slots. Contacts are
    /// coupled by conjugate gradients, which stop where `x` settles within `close`.
    ///
    /// # Errors
    /// If the matrix is not positive definite or not finite.
    pub fn solve(&mut self, couplings: &[Coupling], x: &mut [f64], close: f64) -> Result<LinearReport, LinearError> {
        match self {
            Self::Cholesky(direct) if couplings.is_empty() => {
                direct.factor.cholesky.solve_in_place(x);
                Ok(LinearReport { approximate: vector::norm(x), ..LinearReport::default() })
            }
            Self::Cholesky(direct) => {
                direct.right_side.copy_from_slice(x);
                x.fill(0.0);
                let settings = ConjugateGradientSettings {
                    max_iterations: MOST_ITERATIONS,
                    relative_tolerance: CONTACTS,
                    absolute_update: close,
                    ..ConjugateGradientSettings::default()
                };
                let matrix = Coupled { matrix: &direct.matrix, couplings };
                reported(direct.gradient.solve(matrix, &mut direct.factor, &direct.right_side, x, None, &settings))
            }
            Self::ConjugateGradient(iterative) => {
                iterative.right_side.copy_from_slice(x);
                x.fill(0.0);
                let settings = ConjugateGradientSettings { absolute_update: close, ..iterative.settings };
                let matrix = Single { matrix: &iterative.matrix, rounded: &mut iterative.rounded };
                reported(iterative.gradient.solve(
                    Coupled { matrix, couplings },
                    &mut iterative.preconditioner,
                    &iterative.right_side,
                    x,
                    None,
                    &settings,
                ))
            }
        }
    }

    /// Blocks that have the negative curvature which conjugate gradients met last: those that yield to the direction.
    pub fn yielding(&self, blocks: &mut Vec<u32>) {
        blocks.clear();
        let Self::ConjugateGradient(iterative) = self else { return };
        let [along, product] = [iterative.gradient.direction(), iterative.gradient.product()];
        let products = along.as_chunks::<BLOCK>().0.iter().zip(product.as_chunks::<BLOCK>().0);
        let curvature = products.map(|(d, p)| d.iter().zip(p).map(|(d, p)| d * p).sum::<f64>());
        let negative: f64 = curvature.clone().filter(|&c| c < 0.0).sum();
        blocks.extend((0..).zip(curvature).filter(|(_, c)| *c < YIELDING * negative).map(|(block, _)| block));
    }

    /// Makes the matrix that was taken at `q` with a convexity the convex one in some elements; the preconditioner stays.
    pub fn stiffen(&mut self, system: &System, selected: &Selected, q: &[f64], convexity: f64, free: &[bool]) {
        match self {
            Self::Cholesky(direct) => {
                system.stiffen(selected, q, convexity, &mut direct.matrix);
                direct.matrix.fix_slots(free, 1.0);
            }
            Self::ConjugateGradient(iterative) => {
                system.stiffen(selected, q, convexity, &mut iterative.matrix);
                iterative.matrix.fix_slots(free, 1.0);
            }
        }
    }

    /// What a single sweep of the preconditioner, or the factor, makes of a right side: `out ≈ A⁻¹ b`.
    pub fn approximate(&mut self, b: &[f64], out: &mut [f64]) {
        match self {
            Self::Cholesky(direct) => {
                out.copy_from_slice(b);
                direct.factor.cholesky.solve_in_place(out);
            }
            Self::ConjugateGradient(iterative) => iterative.preconditioner.apply(b, out),
        }
    }
}
