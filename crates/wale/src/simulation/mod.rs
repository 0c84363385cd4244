//! The time loop: a fabric, what happens to it, and the steps from one frame to the next.

mod pull_out;
mod relax;
mod start;

pub use relax::RelaxReport;
pub use start::{Start, StartReport};

use glam::DVec3;
use thiserror::Error;

use crate::dynamics::State;
use crate::dynamics::chunks::Chunks;
use crate::dynamics::grips::{GripReport, Grips};
use crate::dynamics::implicit_euler::{Newton, NewtonReport, NewtonSettings, StepError};
use crate::dynamics::linear::LinearSettings;
use crate::dynamics::soft_start::{progress, stretch_share};
use crate::dynamics::step::Touch;
use crate::dynamics::system::{Energies, System};
use crate::dynamics::workspace::Workspace;
use crate::energy::Load;
use crate::fabric::coordinates::{BLOCK, dof};
use crate::model::{FabricCard, Frame, Network, Plan, Yarns};

/// A fabric on its way through time.
pub struct Simulation {
    network: Network,
    system: System,
    newton: Newton,
    plan: Plan,
    grips: Grips,
    state: State,
    touches: Vec<Touch>,
    compression: Vec<f64>,
    forces: Vec<DVec3>,
    free: Vec<bool>,
    q: Vec<f64>,
}

/// What one step took and found.
#[derive(Clone, Debug, PartialEq)]
pub struct StepReport {
    /// Steps taken so far.
    pub step: u64,
    /// Simulated time at its end \[s\].
    pub time: f64,
    /// Its length \[s\].
    pub step_size: f64,
    /// Attempts that were rolled back before it.
    pub rejected: u32,
    /// Newton iterations.
    pub newton_iterations: usize,
    /// Iterations of the linear solver.
    pub linear_iterations: usize,
    /// Whether Newton's method reached its tolerance.
    pub converged: bool,
    /// Energies by kind \[J\].
    pub energies: Energies,
    /// Largest ratio of a yarn segment's length to its rest length \[–\].
    pub largest_stretch: f64,
    /// Smallest rest length of a segment \[m\].
    pub smallest_spacing: f64,
    /// Nodes in contact with obstacles.
    pub contacts: usize,
    /// Grips.
    pub grips: Vec<GripReport>,
}

/// Why a simulation cannot go on.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("no step longer than {smallest:e} s succeeds at {time} s: {cause}")]
pub struct SimulationError {
    /// Time at which it stands \[s\].
    pub time: f64,
    /// Shortest step allowed \[s\].
    pub smallest: f64,
    /// What failed.
    pub cause: StepError,
}

/// Newton iterations up to which the next step is longer.
const EASY: usize = 3;
/// Newton iterations from which the next step is shorter: two steps of half the length then cost less than one.
const HARD: usize = 8;
/// A step whose last iteration still moved a node this far is taken again, shorter \[yarn radii\].
const FAR_FROM_CONVERGED: f64 = 1.0;
/// A step in which strands that may meet move further past each other is taken again, shorter \[yarn radii\]: where they lie beside
/// their nodes is held for a step, and where it turns they must not be on the other side by then.
const FAR_PAST: f64 = 1.0;
/// Attempts after which yarn that is pulled through other yarn is let through: the run goes on, and `wale check` tells of it.
const MOST_REFUSED: u32 = 8;

impl Simulation {
    /// Sets up a fabric at rest where its plan places it.
    #[must_use]
    pub fn new(network: Network, yarns: impl Into<Yarns>, card: impl Into<FabricCard>, plan: Plan) -> Self {
        let network = placed(network, &plan);
        let (system, newton) = equations(&network, yarns, card, &plan);
        let grips = Grips::new(&plan.grips, &network, &network.position);
        let coordinates = system.coordinates.initial(&network);
        let state = State {
            time: 0.0,
            step: 0,
            next_step_size: plan.simulation.largest_step,
            velocities: vec![0.0; coordinates.len()],
            anchors: system.anchors_at(&coordinates),
            coordinates,
            obstacle_anchors: Vec::new(),
            grip_memory: vec![0.0; grips.memory_len()],
        };
        let mut simulation = Self {
            free: system.coordinates.free().to_vec(),
            q: state.coordinates.clone(),
            forces: vec![DVec3::ZERO; network.node_count()],
            touches: Vec::new(),
            compression: Vec::new(),
            network,
            system,
            newton,
            plan,
            grips,
            state,
        };
        simulation.set_up_loads();
        simulation
    }

    /// The network, at its initial world place.
    #[must_use]
    pub fn network(&self) -> &Network {
        &self.network
    }
    /// The fabric's terms.
    #[must_use]
    pub fn system(&self) -> &System {
        &self.system
    }
    /// The plan of the run.
    #[must_use]
    pub fn plan(&self) -> &Plan {
        &self.plan
    }
    /// Everything the next step depends on.
    #[must_use]
    pub fn state(&self) -> &State {
        &self.state
    }
    /// Goes on from a state of the same fabric; returns whether its sizes fit.
    pub fn restore(&mut self, state: State) -> bool {
        let fits = state.coordinates.len() == self.state.coordinates.len()
            && state.velocities.len() == self.state.velocities.len()
            && state.anchors.len() == self.state.anchors.len()
            && state.grip_memory.len() == self.state.grip_memory.len()
            && state.obstacle_anchors.len().is_multiple_of(5);
        if fits {
            self.state = state;
            self.forget_contacts();
        }
        fits
    }
    /// A snapshot of now.
    #[must_use]
    pub fn frame(&self) -> Frame {
        self.system.coordinates.frame(self.state.time, &self.state.coordinates)
    }
    /// Number of the frame due now, if one is.
    #[must_use]
    pub fn frame_due(&self) -> Option<u64> {
        let frame = self.state.time * self.plan.simulation.frame_rate;
        ((frame - frame.round()).abs() < 1e-6).then_some(frame.round() as u64)
    }
    /// Whether the whole duration has passed.
    #[must_use]
    pub fn finished(&self) -> bool {
        self.state.time >= self.plan.simulation.duration - 1e-12
    }

    /// Next time that a step must not go past: a frame, an event of a grip, the end.
    fn next_stop(&self) -> f64 {
        let settings = &self.plan.simulation;
        let frame = ((self.state.time * settings.frame_rate + 1e-6).floor() + 1.0) / settings.frame_rate;
        let event = self.grips.next_event(self.state.time).unwrap_or(f64::INFINITY);
        frame.min(event).min(settings.duration.max(self.state.time + settings.smallest_step))
    }

    /// Takes one step; a step that fails is rolled back and tried shorter.
    ///
    /// # Errors
    /// If no step of at least the smallest length succeeds; the state is then that before the step.
    pub fn step(&mut self) -> Result<StepReport, SimulationError> {
        let settings = self.plan.simulation.clone();
        let stop = self.next_stop();
        let mut wanted = self.state.next_step_size.clamp(settings.smallest_step, settings.largest_step);
        self.grips.take_hold(&self.system.coordinates, &mut self.state);
        let mut rejected = 0;
        loop {
            let pieces = ((stop - self.state.time) / wanted - 1e-9).ceil().max(1.0);
            let h = (stop - self.state.time) / pieces;
            let end = if pieces > 1.0 { self.state.time + h } else { stop };
            let refuses = rejected < MOST_REFUSED && 0.5 * h >= settings.smallest_step;
            match self.attempt(h, end, refuses) {
                Ok(report) => {
                    let next = match report.iterations {
                        0..=EASY if rejected == 0 => wanted * 1.5,
                        HARD.. => wanted * 0.7,
                        _ => wanted,
                    };
                    let next = next.max(settings.smallest_step);
                    self.accept(h, end, next.min(settings.largest_step));
                    return Ok(self.report(h, rejected, report));
                }
                Err(cause) => {
                    rejected += 1;
                    wanted = 0.5 * h;
                    if wanted < settings.smallest_step {
                        return Err(SimulationError { time: self.state.time, smallest: settings.smallest_step, cause });
                    }
                }
            }
        }
    }

    /// Solves a step into `self.q` and leaves the state as it is. One in which strands pass through each other, or move so far past
    /// each other that they might, is an error if it `refuses`.
    fn attempt(&mut self, h: f64, end: f64, refuses: bool) -> Result<NewtonReport, StepError> {
        self.renew_loads(h, end);
        let begun = progress(end, self.plan.simulation.soft_start);
        self.system.soften(stretch_share(begun));
        let settings = &self.plan.simulation;
        self.system.begin_step(&self.state, h, settings.friction, &mut self.compression);
        self.system.find_touches(&self.plan.obstacles, &self.state, h, &mut self.touches);
        if settings.self_contact {
            self.system.find_self_contacts(&self.state, h);
            self.system.find_strand_contacts(&self.state, h, begun.unwrap_or(0.0));
        }
        self.free.copy_from_slice(self.system.coordinates.free());
        // Start where the velocities lead, as far as the order of the nodes along the yarns allows.
        self.q.copy_from_slice(&self.state.velocities);
        for (d, free) in self.q.iter_mut().zip(&self.free) {
            *d *= if *free { h } else { 0.0 };
        }
        let reach = self.system.longest_step(&self.state.coordinates, &self.q);
        for (d, x) in self.q.iter_mut().zip(&self.state.coordinates) {
            *d = x + reach * *d;
        }
        self.grips.hold(&self.state, end, &mut self.free, &mut self.q);
        self.newton.set_free(&self.free);
        let newton = NewtonSettings {
            max_iterations: settings.newton_iterations as usize,
            tolerance: settings.newton_tolerance * self.system.least_radius(),
        };
        let (obstacles, touches) = (&self.plan.obstacles, &self.touches);
        let report = self.newton.minimise(&mut self.system, &mut self.q, &newton, |system, q| {
            system.renew_touches(obstacles, q, end, touches);
        })?;
        if !report.converged && report.last_move > FAR_FROM_CONVERGED * self.system.least_radius() {
            return Err(StepError::NotConverged { last_move: report.last_move });
        }
        if refuses && self.plan.simulation.strand_contact {
            let before = &self.state.coordinates;
            if self.system.strands_shift(before, &self.q) > FAR_PAST * self.system.least_radius() {
                return Err(StepError::TooFar);
            }
            if self.system.strands_pass(before, &self.q) {
                return Err(StepError::Passage);
            }
        }
        Ok(report)
    }

    /// Makes the solved step the state.
    fn accept(&mut self, h: f64, end: f64, next_step_size: f64) {
        if !self.grips.is_empty() {
            let gradient = self.newton.reaction(&self.system, &self.q);
            let mut memory = std::mem::take(&mut self.state.grip_memory);
            self.grips.measure(&self.state, &self.q, end, gradient, &mut memory);
            self.state.grip_memory = memory;
        }
        self.system.drag_anchors(&self.q, &mut self.state.anchors);
        self.system.hold_touches(&self.plan.obstacles, &self.q, end, &self.touches, &mut self.state.obstacle_anchors);
        for ((v, x), new) in self.state.velocities.iter_mut().zip(&mut self.state.coordinates).zip(&self.q) {
            *v = (new - *x) / h;
            *x = *new;
        }
        self.state.time = end;
        self.state.step += 1;
        self.state.next_step_size = next_step_size;
        if self.let_ends_slip() {
            self.forget_contacts();
        }
    }

    /// A report of the state as it stands, as of a step of no length.
    pub fn standing(&mut self) -> StepReport {
        self.system.soften(stretch_share(progress(self.state.time, self.plan.simulation.soft_start)));
        self.report(0.0, 0, NewtonReport::default())
    }

    fn report(&mut self, h: f64, rejected: u32, newton: NewtonReport) -> StepReport {
        let (largest_stretch, smallest_spacing) = self.system.extremes(&self.state.coordinates);
        StepReport {
            step: self.state.step,
            time: self.state.time,
            step_size: h,
            rejected,
            newton_iterations: newton.iterations,
            linear_iterations: newton.linear_iterations,
            converged: newton.converged,
            energies: self.system.energies(&self.state.coordinates, &mut self.newton.work),
            largest_stretch,
            smallest_spacing,
            contacts: self.state.obstacle_anchors.len() / 5,
            grips: self.grips.reports(&self.state.grip_memory),
        }
    }

    /// One load a node where there is air or a pulling grip.
    fn set_up_loads(&mut self) {
        if self.plan.simulation.air_drag <= 0.0 && !self.grips.any_force() {
            return;
        }
        for node in 0..self.network.node_count() {
            let first = dof(BLOCK * node);
            let still = Load { force: [0.0; 3], drag: 0.0, previous: [0.0; 3] };
            self.system.push_load(still, [first, first + 1, first + 2]);
        }
        self.system.plan_loads();
    }

    fn renew_loads(&mut self, h: f64, end: f64) {
        if self.system.load_count() == 0 {
            return;
        }
        self.forces.fill(DVec3::ZERO);
        self.grips.add_forces(&self.state, end, &mut self.forces);
        let drag = self.plan.simulation.air_drag / h;
        let (forces, coordinates) = (&self.forces, &self.state.coordinates);
        self.system.renew_loads(|node, yarn_length| Load {
            force: forces[node].to_array(),
            drag: drag * yarn_length,
            previous: DVec3::from_slice(&coordinates[BLOCK * node..BLOCK * node + 3]).to_array(),
        });
    }

    /// Scratch memory of sums, for measuring between steps.
    pub fn workspace(&mut self) -> &mut Workspace {
        &mut self.newton.work
    }

    /// Number of chunks that sums are cut into.
    #[must_use]
    pub fn chunk_count(&self) -> usize {
        Chunks::new(self.system.coordinates.block_count()).count()
    }
}

/// The terms of a fabric under gravity, and their solver.
fn equations(network: &Network, yarns: impl Into<Yarns>, card: impl Into<FabricCard>, plan: &Plan) -> (System, Newton) {
    let mut system = System::new(network, yarns, card);
    system.set_gravity(plan.simulation.gravity);
    if plan.simulation.strand_contact {
        system.keep_strands_apart(network);
    }
    let linear = LinearSettings { solver: plan.simulation.linear_solver, tolerance: plan.simulation.linear_tolerance };
    let newton = Newton::new(&system, linear);
    (system, newton)
}

/// The network with its middle and orientation where the plan places it.
fn placed(mut network: Network, plan: &Plan) -> Network {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for x in &network.position {
        low = low.min(*x);
        high = high.max(*x);
    }
    let middle = 0.5 * (low + high);
    for (x, front) in network.position.iter_mut().zip(&mut network.front) {
        *x = plan.placement.center + plan.placement.rotation * (*x - middle);
        *front = plan.placement.rotation * *front;
    }
    network
}
