//! One implicit Euler step: the minimum of inertia, energies, friction and damping.

use glam::DVec3;
use rayon::prelude::*;
use thiserror::Error;
use wale_numerics::block_matrix::BlockMatrix;

use super::linear::{Linear, LinearReport, LinearSettings};
use super::system::{System, Terms, Workspace};
use crate::fabric::coordinates::BLOCK;
use crate::fabric::elements::Linearisation;

/// How a step is solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewtonSettings {
    /// Most iterations.
    pub max_iterations: usize,
    /// Largest move of a node in the last iteration \[m\].
    pub tolerance: f64,
    /// Convexity of the Hessian that a step begins with: 1 is Gauss–Newton, 0 is Newton's own matrix wherever that is
    /// positive definite (`docs/design/002-newton.md` has the measurements).
    pub convexity: f64,
}

/// What a step took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NewtonReport {
    /// Newton iterations.
    pub iterations: usize,
    /// Iterations of the linear solver.
    pub linear_iterations: usize,
    /// Halvings of the line search.
    pub backtracks: usize,
    /// Largest move of a node in the last iteration \[m\].
    pub last_move: f64,
    /// Whether that is below the tolerance.
    pub converged: bool,
}

/// Why a step failed.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum StepError {
    /// A number became infinite or not a number.
    #[error("a coordinate, energy or force is no longer finite")]
    NotFinite,
    /// No step along the search direction lowers the energy.
    #[error("no step along the search direction lowers the energy")]
    LineSearch,
    /// Newton's method ended far from a solution.
    #[error("Newton's method did not converge: the last iteration moved a node by {last_move:e} m")]
    NotConverged {
        /// Largest move of the last iteration \[m\].
        last_move: f64,
    },
    /// The linear system could not be solved.
    #[error("the linear system could not be solved: {0}")]
    Linear(String),
}

/// Memory that Newton's method keeps between steps.
pub struct Newton {
    matrix: BlockMatrix,
    gradient: Vec<f64>,
    direction: Vec<f64>,
    trial: Vec<f64>,
    /// Which slots are unknowns.
    free: Vec<bool>,
    linear: Linear,
    linear_settings: LinearSettings,
    /// Convexity of the Hessian that the next iteration tries.
    convexity: f64,
    /// Scratch of sums.
    pub work: Workspace,
}

impl Newton {
    /// Takes the memory that steps of a system need.
    #[must_use]
    pub fn new(system: &System, linear_settings: LinearSettings) -> Self {
        let n = system.coordinates.len();
        Self {
            matrix: BlockMatrix::zeros(system.pattern().clone()),
            gradient: vec![0.0; n],
            direction: vec![0.0; n],
            trial: vec![0.0; n],
            free: system.coordinates.free().to_vec(),
            linear: Linear::None,
            linear_settings,
            convexity: 1.0,
            work: Workspace::default(),
        }
    }

    /// Name of the linear solver in use.
    #[must_use]
    pub fn solver_name(&self) -> &'static str {
        self.linear.name()
    }

    /// Says which slots are unknowns; the rest keep their values.
    pub fn set_free(&mut self, free: &[bool]) {
        if self.free != free {
            self.free.copy_from_slice(free);
            self.linear = Linear::None;
        }
    }

    /// Moves `q` to the minimum of the terms near it. `renew` is called with `q` before every iteration, for contacts
    /// that are found anew.
    ///
    /// # Errors
    /// If numbers are not finite, a system cannot be solved, or the search ends far from a minimum.
    pub fn minimise(
        &mut self,
        system: &mut System,
        q: &mut [f64],
        settings: &NewtonSettings,
        mut renew: impl FnMut(&mut System, &[f64]),
    ) -> Result<NewtonReport, StepError> {
        // Every step starts alike, whatever came before: a resumed run must find the same bits.
        self.convexity = settings.convexity;
        let mut report = NewtonReport { last_move: f64::INFINITY, ..NewtonReport::default() };
        while report.iterations < settings.max_iterations {
            renew(system, q);
            let (energy, solved) = self.solve(system, q)?;
            report.linear_iterations += solved.iterations;
            report.iterations += 1;
            let slope: f64 = self.direction.iter().zip(&self.gradient).map(|(d, g)| d * g).sum();
            if !slope.is_finite() {
                return Err(StepError::NotFinite);
            }
            let length = match self.line_search(system, q, energy, slope, &mut report) {
                Ok(length) => length,
                // A step that got somewhere stands; the report says that it did not converge.
                Err(StepError::LineSearch) if report.iterations > 1 => break,
                Err(error) => return Err(error),
            };
            let largest = largest_move(&self.direction, system.coordinates.node_count());
            report.last_move = length * largest;
            if report.last_move <= settings.tolerance {
                report.converged = true;
                break;
            }
        }
        Ok(report)
    }

    /// Finds the search direction at `q`: Newton's own where its matrix is positive definite, else the least convex
    /// blend that is. Returns the energy and what the linear solve took.
    fn solve(&mut self, system: &System, q: &[f64]) -> Result<(f64, LinearReport), StepError> {
        if matches!(self.linear, Linear::None) {
            self.linear = Linear::new(system, &self.free, self.linear_settings)
                .map_err(|error| StepError::Linear(error.to_string()))?;
        }
        loop {
            let energy = system.linearise(
                Terms::Dynamic,
                Linearisation::Blended(self.convexity),
                q,
                &mut self.gradient,
                &mut self.matrix,
                &mut self.work,
            );
            if !energy.is_finite() {
                return Err(StepError::NotFinite);
            }
            for ((d, g), free) in self.direction.iter_mut().zip(&self.gradient).zip(&self.free) {
                *d = if *free { -g } else { 0.0 };
            }
            self.matrix.fix_slots(&self.free, 1.0);
            match self.linear.solve(&self.matrix, &mut self.direction) {
                Ok(report) => {
                    // Try again with less next time.
                    self.convexity = if self.convexity > 0.05 { 0.5 * self.convexity } else { 0.0 };
                    return Ok((energy, report));
                }
                Err(error) if self.convexity >= 1.0 => return Err(StepError::Linear(error.to_string())),
                Err(_) => self.convexity = (2.0 * self.convexity).clamp(0.1, 1.0),
            }
        }
    }

    /// Moves `q` along the direction as far as the energy falls enough; returns the step length.
    fn line_search(
        &mut self,
        system: &System,
        q: &mut [f64],
        energy: f64,
        slope: f64,
        report: &mut NewtonReport,
    ) -> Result<f64, StepError> {
        let mut length = system.longest_step(q, &self.direction);
        // Differences below round-off of the total say nothing: the step is accepted then.
        let noise = 1e-13 * energy.abs() + 1e-30;
        if -slope <= noise {
            return Ok(self.apply(q, length));
        }
        for _ in 0..30 {
            for ((trial, x), d) in self.trial.iter_mut().zip(q.iter()).zip(&self.direction) {
                *trial = x + length * d;
            }
            let new = system.energy(Terms::Dynamic, &self.trial, &mut self.work);
            if new <= energy + 1e-4 * length * slope + noise {
                q.copy_from_slice(&self.trial);
                return Ok(length);
            }
            length *= 0.5;
            report.backtracks += 1;
        }
        Err(StepError::LineSearch)
    }

    fn apply(&self, q: &mut [f64], length: f64) -> f64 {
        for (x, d) in q.iter_mut().zip(&self.direction) {
            *x += length * d;
        }
        length
    }

    /// Gradient of all terms at `q`: minus the force that holds a slot where it is.
    pub fn reaction(&mut self, system: &System, q: &[f64]) -> &[f64] {
        system.gradient(Terms::Dynamic, q, &mut self.gradient, &mut self.work);
        &self.gradient
    }

    /// Bytes of matrix and vectors.
    #[must_use]
    pub fn bytes(&self) -> usize {
        (self.matrix.values.len() + 3 * self.gradient.len()) * size_of::<f64>()
    }
}

/// Longest move of a node in a global vector \[m\].
fn largest_move(direction: &[f64], node_count: usize) -> f64 {
    direction[..BLOCK * node_count]
        .par_chunks(BLOCK)
        .with_min_len(4096)
        .map(|d| DVec3::from_slice(d).length_squared())
        .reduce(|| 0.0, f64::max)
        .sqrt()
}
