//! One implicit Euler step: the minimum of inertia, energies, friction and damping.

use glam::DVec3;
use thiserror::Error;
use wale_numerics::block_matrix::BlockMatrix;

use super::linear::{Coupling, Linear, LinearReport, LinearSettings};
use super::system::{System, Workspace};
use crate::fabric::coordinates::BLOCK;

/// How a step is solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewtonSettings {
    /// Most iterations.
    pub max_iterations: usize,
    /// Move of the nodes in the last iteration, root mean square \[m\]; no single node may move ten times as far.
    pub tolerance: f64,
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
    /// Whether the last iteration's moves are below the tolerance.
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

/// How much further than the root mean square a single node may move in the last iteration.
const SINGLE_NODE: f64 = 10.0;
/// Convexity of a step's first matrix: a tenth of the convex one makes most of them positive definite.
const FIRST_CONVEXITY: f64 = 0.1;
/// Convexity below which the exact matrix is tried.
const LEAST_CONVEXITY: f64 = 0.05;
/// Most halvings of a step that does not lower the energy.
const MOST_HALVINGS: usize = 30;

/// Memory that Newton's method keeps between steps.
pub struct Newton {
    matrix: BlockMatrix,
    couplings: Vec<Coupling>,
    gradient: Vec<f64>,
    direction: Vec<f64>,
    trial: Vec<f64>,
    /// Which slots are unknowns.
    free: Vec<bool>,
    linear: Linear,
    linear_settings: LinearSettings,
    /// Convexity of the next matrix.
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
            couplings: Vec::new(),
            gradient: vec![0.0; n],
            direction: vec![0.0; n],
            trial: vec![0.0; n],
            free: system.coordinates.free().to_vec(),
            linear: Linear::None,
            linear_settings,
            convexity: FIRST_CONVEXITY,
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

    /// Moves `q` to the minimum of the terms near it. `renew` is called with the place that is looked at next, for
    /// contacts that are found anew.
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
        let mut report = NewtonReport { last_move: f64::INFINITY, ..NewtonReport::default() };
        let mut previous = 0.0;
        // Every step starts alike, whatever came before: a resumed run must find the same bits.
        self.convexity = FIRST_CONVEXITY;
        renew(system, q);
        let mut energy = self.linearise(system, q)?;
        while report.iterations < settings.max_iterations {
            let solved = self.solve(system, q)?;
            report.linear_iterations += solved.iterations;
            report.iterations += 1;
            let slope: f64 = self.direction.iter().zip(&self.gradient).map(|(d, g)| d * g).sum();
            if !slope.is_finite() {
                return Err(StepError::NotFinite);
            }
            let mut length = system.longest_step(q, &self.direction);
            let (mean, largest) = moves(&self.direction, system.coordinates.node_count());
            // What is left after this move shrinks as fast as the moves do [Hairer1996, section IV.8], and is not less
            // than what the linear solve left.
            let whole = length == 1.0 && !solved.negative_curvature;
            let ratio = if whole { mean / previous } else { 1.0 };
            let left = if ratio < 0.5 { (ratio / (1.0 - ratio)).max(self.linear_settings.tolerance) } else { 1.0 };
            previous = mean;
            if !solved.negative_curvature
                && left * mean <= settings.tolerance
                && left * largest <= SINGLE_NODE * settings.tolerance
            {
                self.try_length(q, length);
                q.copy_from_slice(&self.trial);
                report.last_move = length * largest;
                report.converged = true;
                break;
            }
            // A whole step nearly always lowers the energy: linearise there at once, instead of asking first.
            self.try_length(q, length);
            renew(system, &self.trial);
            let trial = std::mem::take(&mut self.trial);
            let mut new = self.linearise(system, &trial);
            self.trial = trial;
            // Differences below round-off of the total say nothing.
            let noise = 1e-13 * energy.abs() + 1e-30;
            let low = |energy_there: f64, length: f64| energy_there <= energy + 1e-4 * length * slope + noise;
            if !new.as_ref().is_ok_and(|&new| low(new, length)) {
                let mut shorter = 0;
                loop {
                    length *= 0.5;
                    shorter += 1;
                    self.try_length(q, length);
                    renew(system, &self.trial);
                    if low(system.energy(&self.trial, &mut self.work), length) {
                        break;
                    }
                    if shorter == MOST_HALVINGS {
                        // A step that got somewhere stands; the report says that it did not converge.
                        return if report.iterations > 1 { Ok(report) } else { Err(StepError::LineSearch) };
                    }
                }
                report.backtracks += shorter;
                self.more_convex();
                let trial = std::mem::take(&mut self.trial);
                new = self.linearise(system, &trial);
                self.trial = trial;
            }
            energy = new?;
            q.copy_from_slice(&self.trial);
            report.last_move = length * largest;
        }
        Ok(report)
    }

    /// Gradient and matrix at `q`; returns the energy.
    fn linearise(&mut self, system: &System, q: &[f64]) -> Result<f64, StepError> {
        let energy = system.linearise(q, self.convexity, &mut self.gradient, &mut self.matrix, &mut self.work);
        system.active_self_contacts(q, &self.free, &mut self.couplings);
        if energy.is_finite() { Ok(energy) } else { Err(StepError::NotFinite) }
    }

    /// Finds the search direction from gradient and matrix at `q`: of the exact matrix where it is positive definite, else
    /// of one more convex.
    fn solve(&mut self, system: &System, q: &[f64]) -> Result<LinearReport, StepError> {
        let failed = |error: super::linear::LinearError| StepError::Linear(error.to_string());
        if matches!(self.linear, Linear::None) {
            self.linear = Linear::new(system, &self.free, self.linear_settings).map_err(failed)?;
        }
        loop {
            for ((d, g), free) in self.direction.iter_mut().zip(&self.gradient).zip(&self.free) {
                *d = if *free { -g } else { 0.0 };
            }
            self.matrix.fix_slots(&self.free, 1.0);
            match self.linear.solve(&self.matrix, &self.couplings, &mut self.direction) {
                Ok(report) if report.negative_curvature => {
                    self.more_convex();
                    return Ok(report);
                }
                Ok(report) => {
                    self.convexity = if self.convexity > LEAST_CONVEXITY { 0.5 * self.convexity } else { 0.0 };
                    return Ok(report);
                }
                Err(error) if self.convexity >= 1.0 => return Err(failed(error)),
                Err(_) => {
                    self.more_convex();
                    self.linearise(system, q)?;
                }
            }
        }
    }

    fn more_convex(&mut self) {
        self.convexity = (4.0 * self.convexity).clamp(FIRST_CONVEXITY, 1.0);
    }

    /// Sets the trial to `q` and a part of the direction.
    fn try_length(&mut self, q: &[f64], length: f64) {
        for ((trial, x), d) in self.trial.iter_mut().zip(q).zip(&self.direction) {
            *trial = x + length * d;
        }
    }

    /// Gradient of all terms at `q`: minus the force that holds a slot where it is.
    pub fn reaction(&mut self, system: &System, q: &[f64]) -> &[f64] {
        system.gradient(q, &mut self.gradient, &mut self.work);
        &self.gradient
    }

    /// Bytes of matrix and vectors.
    #[must_use]
    pub fn bytes(&self) -> usize {
        (self.matrix.values.len() + 3 * self.gradient.len()) * size_of::<f64>()
    }
}

/// Moves of the nodes in a global vector: root mean square and largest \[m\].
fn moves(direction: &[f64], node_count: usize) -> (f64, f64) {
    let (mut sum, mut largest) = (0.0, 0.0f64);
    for d in direction[..BLOCK * node_count].as_chunks::<BLOCK>().0 {
        let square = DVec3::from_slice(d).length_squared();
        sum += square;
        largest = largest.max(square);
    }
    ((sum / node_count.max(1) as f64).sqrt(), largest.sqrt())
}
