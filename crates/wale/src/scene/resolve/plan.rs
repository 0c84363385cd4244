//! Settings of the simulation and its output, with their defaults.

use glam::DVec3;

use super::{si, vector};
use crate::model::{Output, Simulation};
use crate::scene::dimensions::STANDARD_GRAVITY;
use crate::scene::error::{Complaint, ErrorClass};
use crate::scene::schema::{OutputText, SimulationText};

/// Most frames of a run.
const MOST_FRAMES: f64 = 1e6;
/// Shortest that the longest step may be \[s\].
const LEAST_STEP: f64 = 1e-9;
/// Most threads.
const MOST_THREADS: u32 = 1024;

pub(super) fn simulation(text: &SimulationText) -> Result<Simulation, Complaint> {
    let gravity = text.gravity.map_or(DVec3::new(0.0, 0.0, -STANDARD_GRAVITY), |gravity| vector(&gravity.0));
    let simulation = Simulation {
        duration: si(text.duration).unwrap_or(1.0),
        frame_rate: si(text.frame_rate).unwrap_or(30.0),
        gravity,
        air_drag: si(text.air_drag).unwrap_or(0.0),
        relax_first: text.relax_first.unwrap_or(false),
        rest_shape_compensation: text.rest_shape_compensation.unwrap_or(true),
        friction: text.friction.unwrap_or(true),
        self_contact: text.self_contact.unwrap_or(true),
        strand_contact: text.strand_contact.unwrap_or(false),
        soft_start: si(text.soft_start).unwrap_or(0.0),
        seed: u64::from(text.seed.unwrap_or(1)),
        largest_step: si(text.largest_step).unwrap_or(5e-3),
        smallest_step: si(text.smallest_step).unwrap_or(1e-6),
        newton_iterations: text.newton_iterations.unwrap_or(15),
        newton_tolerance: si(text.newton_tolerance).unwrap_or(0.005),
        linear_solver: text.linear_solver.unwrap_or_default(),
        linear_tolerance: si(text.linear_tolerance).unwrap_or(0.1),
        threads: text.threads.map(|threads| threads as usize),
    };
    let here = |key: &str| format!("simulation.{key}");
    let frames = simulation.duration * simulation.frame_rate;
    if frames > MOST_FRAMES {
        let key = if text.frame_rate.is_some() { "frame_rate" } else { "duration" };
        return Err(Complaint::new(here(key), format!("the run would write {frames:.0} frames"))
            .class(ErrorClass::ResourceLimit)
            .why(format!("a run has at most {MOST_FRAMES:.0}"))
            .mend("take a shorter duration or a lower frame_rate"));
    }
    if simulation.largest_step < LEAST_STEP {
        return Err(Complaint::new(here("largest_step"), format!("steps of {:?} s at most", simulation.largest_step))
            .why(format!("with steps shorter than {LEAST_STEP:?} s no run comes to its end")));
    }
    if simulation.smallest_step > simulation.largest_step {
        let key = if text.smallest_step.is_some() { "smallest_step" } else { "largest_step" };
        let what = format!(
            "the smallest step ({:?} s) is longer than the largest ({:?} s)",
            simulation.smallest_step, simulation.largest_step
        );
        return Err(Complaint::new(here(key), what));
    }
    if !(1..=10_000).contains(&simulation.newton_iterations) {
        let what = format!("{} Newton iterations", simulation.newton_iterations);
        return Err(Complaint::new(here("newton_iterations"), what).why("a step takes 1 to 10000"));
    }
    for (key, tolerance) in
        [("newton_tolerance", simulation.newton_tolerance), ("linear_tolerance", simulation.linear_tolerance)]
    {
        if tolerance >= 1.0 {
            let what = format!("a {key} of {tolerance}");
            return Err(Complaint::new(here(key), what).why("a tolerance of 1 and above solves nothing"));
        }
    }
    if let Some(threads) = text.threads
        && !(1..=MOST_THREADS).contains(&threads)
    {
        return Err(Complaint::new(here("threads"), format!("{threads} threads"))
            .why(format!("a run takes 1 to {MOST_THREADS}"))
            .mend("leave it out to take all processors"));
    }
    Ok(simulation)
}

pub(super) fn output(text: &OutputText) -> Output {
    let mut exports = text.exports.clone().unwrap_or_default();
    exports.sort();
    exports.dedup();
    Output {
        pictures: text.pictures.unwrap_or_default(),
        view: text.view.unwrap_or(true),
        exports,
        checkpoint_every: si(text.checkpoint_every).unwrap_or(0.1),
    }
}
