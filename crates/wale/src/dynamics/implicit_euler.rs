//! One implicit Euler step: the minimum of inertia, energies, friction and damping.

use thiserror::Error;
use wale_numerics::vector;

use super::few::FewNodes;
use super::linear::{Coupling, Linear, LinearError, LinearReport, LinearSettings};
use super::remaining::{Left, MOST_FAR, far_nodes, moves};
use super::system::System;
use super::workspace::Workspace;

/// How a step is solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewtonSettings {
    /// Most iterations.
    pub max_iterations: usize,
    /// How far the nodes may still have to go, root mean square \[m\], and a single one twenty times as far.
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
    /// Whether what is left to go is below the tolerance.
    pub converged: bool,
}

/// Why a step failed.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum StepError {
    /// A number became infinite or not a number.
    #[error("a coordinate, energy or force is no longer finite")]
    NotFinite,
    /// Two strands of yarn would pass through each other.
    #[error("two strands of yarn would pass through each other")]
    Passage,
    /// Strands of yarn that may meet would move too far past each other to be kept apart.
    #[error("strands of yarn would move too far past each other")]
    TooFar,
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

/// How much further than the root mean square a single node may still have to go.
const SINGLE_NODE: f64 = 20.0;
/// Convexity of a step's first matrix: a tenth of the convex one makes most of them positive definite.
const FIRST_CONVEXITY: f64 = 0.1;
/// Convexity below which the exact matrix is tried.
const LEAST_CONVEXITY: f64 = 0.05;
/// Part of a move that may be left for the matrix to serve once more.
const KEEP_MATRIX: f64 = 0.1;
/// Parts of the tolerance within which the linear solver's updates are to settle.
const CLOSE: f64 = 0.1;
/// Updates as large as the last that conjugate gradients would still have made, about.
const UNSETTLED: f64 = 5.0;
/// Most times that a matrix is made convex where it is not.
const MOST_STIFFENED: usize = 4;
/// Parts of the tolerance that a node has left to go where it is solved for itself.
const HOT: f64 = 5.0;
/// Times that far nodes are solved for themselves after a move.
const MOST_MENDS: usize = 3;
/// Times the mean move that a node moves where it may be to blame for a step that does not lower the energy.
const FAR_MOVE: f64 = 8.0;
/// Most halvings of a step that does not lower the energy.
const MOST_HALVINGS: usize = 30;

/// Memory that Newton's method keeps between steps.
pub struct Newton {
    couplings: Vec<Coupling>,
    gradient: Vec<f64>,
    direction: Vec<f64>,
    trial: Vec<f64>,
    estimate: Vec<f64>,
    /// Which slots are unknowns.
    free: Vec<bool>,
    /// Taken when a step first needs it, and anew when other slots are free.
    linear: Option<Linear>,
    linear_settings: LinearSettings,
    /// Convexity of the matrix, or of the next.
    convexity: f64,
    few: FewNodes,
    /// Blocks that have negative curvature, or that are solved for themselves.
    blocks: Vec<u32>,
    /// Scratch of sums.
    pub work: Workspace,
}

impl Newton {
    /// Takes the memory that steps of a system need.
    #[must_use]
    pub fn new(system: &System, linear_settings: LinearSettings) -> Self {
        let n = system.coordinates.len();
        Self {
            couplings: Vec::new(),
            gradient: vec![0.0; n],
            direction: vec![0.0; n],
            trial: vec![0.0; n],
            estimate: vec![0.0; n],
            free: system.coordinates.free().to_vec(),
            linear: None,
            linear_settings,
            convexity: FIRST_CONVEXITY,
            few: FewNodes::new(system.coordinates.block_count()),
            blocks: Vec::with_capacity(system.coordinates.block_count().min(MOST_FAR)),
            work: Workspace::default(),
        }
    }

    /// Name of the linear solver in use.
    #[must_use]
    pub fn solver_name(&self) -> &'static str {
        self.linear.as_ref().map_or("none", Linear::name)
    }

    /// Says which slots are unknowns; the rest keep their values.
    pub fn set_free(&mut self, free: &[bool]) {
        if self.free != free {
            self.free.copy_from_slice(free);
            self.linear = None;
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
        let mut linear = match self.linear.take() {
            Some(linear) => linear,
            None => Linear::new(system, &self.free, self.linear_settings).map_err(failed)?,
        };
        let report = self.descend(system, &mut linear, q, settings, &mut renew);
        self.linear = Some(linear);
        report
    }

    fn descend(
        &mut self,
        system: &mut System,
        linear: &mut Linear,
        q: &mut [f64],
        settings: &NewtonSettings,
        renew: &mut impl FnMut(&mut System, &[f64]),
    ) -> Result<NewtonReport, StepError> {
        let mut report = NewtonReport { last_move: f64::INFINITY, ..NewtonReport::default() };
        let node_count = system.coordinates.node_count();
        let close = CLOSE * settings.tolerance * (node_count as f64).sqrt();
        // Every step starts alike, whatever came before: a resumed run must find the same bits.
        self.convexity = FIRST_CONVEXITY;
        renew(system, q);
        let mut energy = self.linearise(system, linear, q)?;
        let mut fresh = true;
        // The gradient alone is asked for first where it may be all that is needed.
        let mut gradient_first = true;
        while report.iterations < settings.max_iterations {
            // The first solve of a step is what moves the fabric as a whole: it is not to end with small updates.
            let enough = if report.iterations == 0 { 0.0 } else { close };
            let solved = self.solve(system, linear, q, fresh, enough)?;
            report.linear_iterations += solved.iterations;
            report.iterations += 1;
            let slope: f64 = self.direction.iter().zip(&self.gradient).map(|(d, g)| d * g).sum();
            if !slope.is_finite() {
                return Err(StepError::NotFinite);
            }
            let mut length = system.longest_step(q, &self.direction);
            let mut whole = length == 1.0 && !solved.negative_curvature;
            let (mean, largest) = moves(&self.direction, node_count);
            self.try_length(q, length);
            renew(system, &self.trial);
            gradient_first &= whole;
            let mut new = self.look(system, linear, !gradient_first);
            // Differences below round-off of the total say nothing.
            let noise = 1e-13 * energy.abs() + 1e-30;
            let low = |energy_there: f64, length: f64| energy_there <= energy + 1e-4 * length * slope + noise;
            let mut left = Left::ALL;
            if whole
                && !new.as_ref().is_ok_and(|&new| low(new, length))
                && far_nodes(&self.direction, node_count, FAR_MOVE * mean, &mut self.blocks)
                && self.mend(system, settings.tolerance)
            {
                new = self.look(system, linear, !gradient_first);
            }
            if new.as_ref().is_ok_and(|&new| low(new, length)) {
                if whole {
                    left = self.left(linear, &solved, node_count);
                }
            } else {
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
                whole = false;
                self.more_convex();
                gradient_first = false;
                new = self.look(system, linear, true);
            }
            energy = new?;
            report.last_move = length * largest;
            let within =
                |mean: f64, largest: f64| mean <= settings.tolerance && largest <= SINGLE_NODE * settings.tolerance;
            // A few loops that snap over are not worth another iteration of all.
            let mut mends = if whole && gradient_first && left.ratio < 1.0 { MOST_MENDS } else { 0 };
            while mends > 0 && !within(left.mean.min(mean), left.largest.min(largest)) {
                let far = far_nodes(&self.estimate, node_count, HOT * settings.tolerance, &mut self.blocks);
                if !far || !self.mend(system, settings.tolerance) {
                    break;
                }
                energy = self.look(system, linear, false)?;
                left = self.left(linear, &solved, node_count);
                mends -= 1;
            }
            q.copy_from_slice(&self.trial);
            if whole && within(left.mean.min(mean), left.largest.min(largest)) {
                report.converged = true;
                break;
            }
            let stands = left.ratio < KEEP_MATRIX;
            if gradient_first && !stands && report.iterations < settings.max_iterations {
                self.linearise(system, linear, q)?;
            }
            fresh = !(gradient_first && stands);
            gradient_first = stands;
        }
        Ok(report)
    }

    /// Solves `self.blocks` for themselves at the trial; returns whether they moved.
    fn mend(&mut self, system: &System, tolerance: f64) -> bool {
        self.few.minimise(system, &self.free, &mut self.trial, &self.blocks, tolerance)
    }

    /// Energy and gradient at the trial, and the matrix if wanted.
    fn look(&mut self, system: &System, linear: &mut Linear, with_matrix: bool) -> Result<f64, StepError> {
        let trial = std::mem::take(&mut self.trial);
        let energy = if with_matrix {
            self.linearise(system, linear, &trial)
        } else {
            let energy = system.gradient(&trial, &mut self.gradient, &mut self.work);
            if energy.is_finite() { Ok(energy) } else { Err(StepError::NotFinite) }
        };
        self.trial = trial;
        energy
    }

    /// What is left to go after a whole move: what the preconditioner makes of the gradient there, a series that shrinks
    /// as it shrank from what it made of the gradient before, and what the linear solver did not wait for.
    fn left(&mut self, linear: &mut Linear, solved: &LinearReport, node_count: usize) -> Left {
        self.face_downhill();
        linear.approximate(&self.direction, &mut self.estimate);
        let ratio = vector::norm(&self.estimate) / solved.approximate;
        if ratio.is_nan() || ratio >= 1.0 {
            return Left::ALL;
        }
        let (mean, largest) = moves(&self.estimate, node_count);
        let unsettled = UNSETTLED * solved.last_update / (node_count.max(1) as f64).sqrt();
        Left { ratio, mean: mean / (1.0 - ratio) + unsettled, largest }
    }

    /// Gradient and matrix at `q`; returns the energy.
    fn linearise(&mut self, system: &System, linear: &mut Linear, q: &[f64]) -> Result<f64, StepError> {
        let energy = linear.linearise(system, q, self.convexity, &mut self.gradient, &mut self.work);
        system.active_self_contacts(q, &self.free, &mut self.couplings);
        system.active_strand_contacts(q, &self.free, &mut self.couplings);
        if energy.is_finite() { Ok(energy) } else { Err(StepError::NotFinite) }
    }

    /// Finds the search direction from the gradient at `q` and the matrix there if it is fresh (the exact one where that
    /// is positive definite, else one more convex), or the one before.
    fn solve(
        &mut self,
        system: &System,
        linear: &mut Linear,
        q: &[f64],
        mut fresh: bool,
        close: f64,
    ) -> Result<LinearReport, StepError> {
        let mut stiffened = 0;
        loop {
            self.face_downhill();
            let factored =
                if fresh && stiffened == 0 { linear.factor(&self.free, self.convexity >= 1.0) } else { Ok(()) };
            let solved = factored.and_then(|()| linear.solve(&self.couplings, &mut self.direction, close));
            match solved {
                Ok(report) if !report.negative_curvature => {
                    self.convexity = if self.convexity > LEAST_CONVEXITY { 0.5 * self.convexity } else { 0.0 };
                    return Ok(report);
                }
                Ok(_) if fresh && stiffened < MOST_STIFFENED && self.convexity < 1.0 => {
                    linear.yielding(&mut self.blocks);
                    let selected = self.few.touching(system, &self.blocks);
                    linear.stiffen(system, selected, q, self.convexity, &self.free);
                    stiffened += 1;
                }
                Ok(report) if report.iterations > 1 => {
                    self.more_convex();
                    return Ok(report);
                }
                solved if self.convexity >= 1.0 => {
                    return Err(failed(solved.err().unwrap_or(LinearError::NegativeCurvature)));
                }
                _ => {
                    self.more_convex();
                    self.linearise(system, linear, q)?;
                    (fresh, stiffened) = (true, 0);
                }
            }
        }
    }

    /// Sets the direction to minus the gradient, zero in slots that are not free.
    fn face_downhill(&mut self) {
        for ((d, g), free) in self.direction.iter_mut().zip(&self.gradient).zip(&self.free) {
            *d = if *free { -g } else { 0.0 };
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
        self.linear.as_ref().map_or(0, Linear::bytes) + 4 * size_of_val(&self.gradient[..])
    }
}

fn failed(error: LinearError) -> StepError {
    StepError::Linear(error.to_string())
}
