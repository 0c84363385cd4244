//! Equilibrium of a whole fabric without friction: damped steps that grow until they are Newton's own.

use super::Simulation;
use crate::dynamics::grips::Grips;
use crate::fabric::coordinates::BLOCK;

/// What a relaxation took and found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelaxReport {
    /// Steps taken.
    pub steps: usize,
    /// Newton iterations in all of them.
    pub newton_iterations: usize,
    /// Speed of the fastest node at the end \[m/s\], in a time in which only the damping of the yarn resists.
    pub speed: f64,
    /// Whether the fabric came to rest.
    pub converged: bool,
}

/// Longest pseudo time step \[s\].
const LONGEST: f64 = 1.0;
/// A node at rest moves less than this many yarn radii in the damping time.
const AT_REST: f64 = 2e-3;
/// Most steps.
const MOST_STEPS: usize = 300;
/// Least damping time \[s\].
const LEAST_DAMPING: f64 = 0.05;

impl Simulation {
    /// Brings the fabric to rest without friction, gravity, obstacles and grips, and sets the friction anchors anew
    /// there; time does not pass.
    ///
    /// Velocities are forgotten at every step, so that only the damping of the yarn's own rates stands in the way, and
    /// the steps grow as long as Newton's method finds them easy.
    pub fn relax(&mut self) -> RelaxReport {
        let keep = (self.plan.clone(), std::mem::take(&mut self.grips), self.system.stiffness_damping());
        self.plan.obstacles.clear();
        self.plan.simulation.friction = false;
        self.plan.simulation.soft_start = 0.0;
        self.plan.simulation.newton_iterations = self.plan.simulation.newton_iterations.max(30);
        self.grips = Grips::default();
        self.system.set_gravity(glam::DVec3::ZERO);
        let damping = keep.2.max(LEAST_DAMPING);
        self.system.set_stiffness_damping(damping);
        let report = self.relax_steps(damping);
        (self.plan, self.grips) = (keep.0, keep.1);
        self.system.set_stiffness_damping(keep.2);
        self.system.set_gravity(self.plan.simulation.gravity);
        self.state.velocities.fill(0.0);
        self.state.anchors = self.system.anchors_at(&self.state.coordinates);
        report
    }

    fn relax_steps(&mut self, damping: f64) -> RelaxReport {
        let mut report = RelaxReport { steps: 0, newton_iterations: 0, speed: f64::INFINITY, converged: false };
        let mut h = self.plan.simulation.largest_step;
        let limit = AT_REST * self.system.least_radius() / damping;
        let time = self.state.time;
        while report.steps < MOST_STEPS && h > self.plan.simulation.smallest_step {
            self.state.velocities.fill(0.0);
            report.steps += 1;
            match self.attempt(h, time, true) {
                Err(_) => h *= 0.25,
                Ok(newton) => {
                    report.newton_iterations += newton.iterations;
                    let moved = largest_move(&self.state.coordinates, &self.q, self.system.coordinates.node_count());
                    self.state.coordinates.copy_from_slice(&self.q);
                    report.speed = moved / h;
                    if report.speed < limit && h >= damping {
                        report.converged = true;
                        break;
                    }
                    if newton.iterations <= 8 {
                        h = (2.0 * h).min(LONGEST);
                    } else if newton.iterations > 20 {
                        h *= 0.7;
                    }
                }
            }
        }
        report
    }
}

/// Longest move of a node between two global vectors \[m\].
fn largest_move(a: &[f64], b: &[f64], node_count: usize) -> f64 {
    let square = |k: usize| (0..3).map(|i| (a[BLOCK * k + i] - b[BLOCK * k + i]).powi(2)).sum::<f64>();
    (0..node_count).map(square).fold(0.0, f64::max).sqrt()
}
