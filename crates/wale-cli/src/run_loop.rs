//! The loop that `run` and `resume` share: step, frame → metrics → checkpoint, and one way to end for every reason.

use std::time::{Duration, Instant};

use serde_json::{Value, json};
use wale::measure::{Census, Shape};
use wale::model::{FabricCard, Yarns};
use wale::record::{RecordError, RunFolder, Status};
use wale::simulation::{Simulation, StepReport};

use crate::exit::{Code, Failure};
use crate::output::{self, span};
use crate::progress::Progress;
use crate::signals::Signals;
use crate::{observe, products};

/// Longest wall time without a checkpoint.
const CHECKPOINT_INTERVAL: Duration = Duration::from_secs(600);

/// A run on its way.
pub struct RunLoop {
    /// The fabric.
    pub simulation: Simulation,
    /// Where it is written.
    pub run: RunFolder,
    /// The yarns.
    pub yarns: Yarns,
    /// The fabric card.
    pub card: FabricCard,
    /// Flags of the operating system's signals.
    pub signals: Signals,
    /// Whether only errors are told.
    pub quiet: bool,
}

impl RunLoop {
    /// Goes to the end of the plan, and ends the run folder with the status that it deserves.
    ///
    /// # Errors
    /// A failed step, a failed write, or a signal; the last good state is in a checkpoint if that could be written.
    pub fn go(mut self) -> Result<(), Failure> {
        let outcome = self.steps();
        let status = match &outcome {
            Ok(()) => Status::Done,
            Err(failure) if matches!(failure.code, Code::Interrupted | Code::Terminated) => Status::Stopped,
            Err(failure) => Status::Failed(failure.code as u8),
        };
        let told = self.run.set_status(status);
        outcome?;
        Ok(told?)
    }

    fn steps(&mut self) -> Result<(), Failure> {
        let duration = self.simulation.plan().simulation.duration;
        let mut progress = Progress::new(self.simulation.state().time, duration, self.quiet);
        let ended = self.steps_with(&mut progress);
        progress.end();
        ended?;
        let (seconds, steps) = progress.spent();
        let summary = self.summary(seconds, steps);
        self.run.write_summary(&summary)?;
        let made = products::make(self.run.path(), &self.simulation.plan().output)?;
        if !self.quiet {
            output::note(&format!(
                "{}: done; {} steps and {} frames in {}",
                self.run.path().display(),
                self.simulation.state().step,
                self.run.frame_count(),
                span(seconds)
            ));
            for path in made {
                output::note(&format!("  {}", path.display()));
            }
        }
        Ok(())
    }

    fn steps_with(&mut self, progress: &mut Progress) -> Result<(), Failure> {
        if self.run.frame_count() == 0 {
            if self.simulation.plan().simulation.relax_first {
                self.relax();
            }
            let report = self.simulation.standing();
            self.write_frame(&report)?;
            self.run.checkpoint(self.simulation.state())?;
        }
        let mut saved = (self.simulation.state().step, Instant::now());
        while !self.simulation.finished() {
            let before = self.simulation.state().time;
            let report = match self.simulation.step() {
                Ok(report) => report,
                Err(error) => {
                    self.run.checkpoint(self.simulation.state())?;
                    return Err(Failure::new(
                        Code::NotConverged,
                        format_args!("{error}; the last good state is kept in {}", self.run.path().display()),
                    ));
                }
            };
            self.run.log(&observe::entry(&report))?;
            if self.simulation.frame_due().is_some() {
                self.write_frame(&report)?;
            }
            let stop = self.signals.stop();
            let every = self.simulation.plan().output.checkpoint_every;
            let due = is_due(before, report.time, every)
                || self.simulation.finished()
                || stop.is_some()
                || self.signals.take_checkpoint_request()
                || saved.1.elapsed() >= CHECKPOINT_INTERVAL;
            if due {
                self.run.checkpoint(self.simulation.state())?;
                saved = (report.step, Instant::now());
            }
            let detail = format!("step {:.2} ms, {} Newton", 1e3 * report.step_size, report.newton_iterations);
            progress.step(report.time, &detail);
            if let (Some(code), false) = (stop, self.simulation.finished()) {
                progress.end();
                output::note(&format!(
                    "stopped at {:.4} s, checkpoint of step {} written; go on with `wale resume {}`",
                    report.time,
                    saved.0,
                    self.run.path().display()
                ));
                return Err(Failure::silent(code));
            }
        }
        Ok(())
    }

    fn relax(&mut self) {
        let report = self.simulation.relax();
        if !self.quiet {
            let end = if report.converged { "at rest" } else { "not quite at rest" };
            output::note(&format!("relaxed without friction in {} steps: {end}", report.steps));
        }
    }

    fn write_frame(&mut self, report: &StepReport) -> Result<(), RecordError> {
        let frame = self.simulation.frame();
        self.run.write_frame(&frame)?;
        self.run.write_metrics(report.step, &observe::values(report, &frame))
    }

    fn summary(&mut self, seconds: f64, steps: u64) -> Value {
        let report = self.simulation.standing();
        let network = self.simulation.network();
        let census = Census::of(network, &self.yarns, &self.card);
        let shape = Shape::of(network, &self.simulation.frame());
        let areal_mass = census.areal_mass(shape.stitch_density_per_m2);
        let grips: Vec<Value> = report
            .grips
            .iter()
            .map(|grip| {
                json!({
                    "name": grip.name,
                    "force_N": grip.force.to_array(),
                    "displacement_m": grip.displacement.to_array(),
                    "work_J": grip.work,
                })
            })
            .collect();
        let entry = observe::entry(&report);
        json!({
            "time_s": report.time,
            "steps": report.step,
            "frames": self.run.frame_count(),
            "fabric": census,
            "shape": shape,
            "areal_mass_kg_per_m2": areal_mass,
            "energies_J": entry["energies"],
            "largest_stretch": report.largest_stretch,
            "smallest_spacing_m": report.smallest_spacing,
            "obstacle_contacts": report.contacts,
            "grips": grips,
            "this_session": { "wall_time_s": seconds, "steps": steps, "threads": rayon::current_num_threads() },
        })
    }
}

impl Drop for RunLoop {
    fn drop(&mut self) {
        // A bug must not leave a run that looks as if it were still going.
        if std::thread::panicking() {
            let _ = self.run.set_status(Status::Failed(Code::Bug as u8));
        }
    }
}

/// Whether a multiple of `every` lies in `(before, now]`.
fn is_due(before: f64, now: f64, every: f64) -> bool {
    let count = |time: f64| (time / every + 1e-9).floor();
    count(now) > count(before)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checkpoints_are_due_at_multiples() {
        assert!(!is_due(0.0, 0.05, 0.1));
        assert!(is_due(0.05, 0.1, 0.1));
        assert!(!is_due(0.1, 0.15, 0.1));
        assert!(is_due(0.1, 0.4, 0.1));
        // Three tenths are a little less than 0.3 in binary.
        assert!(is_due(0.25, 0.1 + 0.2, 0.1) && !is_due(0.1 + 0.2, 0.35, 0.1));
    }
}
