//! `wale resume`: on with a run that was stopped or killed, to the same bits.

use wale::record::{Environment, Interrupted, RecordError, Status};

use crate::arguments::Resume;
use crate::exit::Failure;
use crate::opened::OpenedScene;
use crate::run_loop::RunLoop;
use crate::signals::Signals;
use crate::{observe, output};

/// Resumes it.
pub fn resume(arguments: &Resume) -> Result<(), Failure> {
    // The number of threads is no part of the comparison: results do not depend on it.
    let here = Environment::here(0);
    let interrupted = Interrupted::open(&arguments.run, &here, arguments.allow_changed)?;
    for note in &interrupted.notes {
        output::note(&format!("note: {note}"));
    }
    if interrupted.status == Status::Done {
        output::note(&format!("{}: done already, nothing to resume", arguments.run.display()));
        return Ok(());
    }
    let scene = OpenedScene::read(&interrupted.scene_path())?;
    scene.check_memory(arguments.limits.max_memory)?;
    let threads = scene.use_threads(arguments.manner.threads)?;
    let signals = Signals::listen().map_err(|error| Failure::io(&arguments.run, "listen to signals", error))?;
    let mut simulation = scene.simulation();
    let columns = observe::columns(&simulation.standing());
    if let Some(checkpoint) = &interrupted.checkpoint
        && !simulation.restore(checkpoint.state.clone())
    {
        return Err(RecordError::OtherScene { path: arguments.run.clone() }.into());
    }
    if !arguments.manner.quiet {
        let state = simulation.state();
        output::note(&format!(
            "{}: goes on from step {} at {:.4} s on {threads} threads",
            arguments.run.display(),
            state.step,
            state.time
        ));
    }
    let run = interrupted.resume(&columns)?;
    let (yarns, card) = (scene.scene.yarns, scene.scene.fabric);
    RunLoop { simulation, run, yarns, card, signals, quiet: arguments.manner.quiet }.go()
}
