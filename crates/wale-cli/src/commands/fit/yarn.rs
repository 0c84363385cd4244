//! The fit of a fabric's yarn: its problem, the journal of its answers, and how far it has come.

use std::path::Path;
use std::time::Instant;

use wale::scene::Scene;
use wale_lab::fabric_file::{FabricFile, Structure};
use wale_lab::fabric_fit::FabricFit;
use wale_lab::network_fit::{NetworkFit, SceneFitError, fit_scene};
use wale_lab::yarn_fit::gradients::GradientSettings;
use wale_lab::yarn_fit::journal::{Asked, Journal, JournalError, Recorded, Stopped};
use wale_lab::yarn_fit::of_fabric::{Ablation, structure_tile, uniform_targets, yarn_problem};
use wale_lab::yarn_fit::problem::{Here, Question, YarnProblem};
use wale_lab::yarn_fit::run::{Interruptible, Way, fit_yarn};
use wale_lab::yarn_fit::swarm::SwarmSettings;
use wale_lab::yarn_fit::{Progress, Step};

use super::{FittedYarn, write};
use crate::arguments::fit::{Fit, Part, Way as Asks};
use crate::exit::{Code, Failure};
use crate::output::note;
use crate::signals::Signals;

/// Points of each measured curve that are fitted.
pub const TARGETS: usize = 8;
/// Files in the folder of a fit that goes on: the problem, and the answers to its questions.
pub const PROBLEM: &str = "problem.json";
pub const ANSWERS: &str = "answers.jsonl";

/// That the fabric's yarns can be laid at all.
pub fn check(arguments: &Fit, fabric: &FabricFile) -> Result<(), Failure> {
    structure_tile(fabric).map(drop).map_err(|error| refused(arguments, &error))
}

fn refused(arguments: &Fit, error: &impl std::fmt::Display) -> Failure {
    Failure::new(Code::BadInput, format_args!("{}: {error}", arguments.fabric.display()))
}

/// The problem of a fabric, written into the folder of its fit.
pub fn problem_of(
    arguments: &Fit,
    fabric: &FabricFile,
    shell: &FabricFit,
    folder: &Path,
) -> Result<YarnProblem, Failure> {
    let ablation = Ablation {
        one_phase: arguments.without.contains(&Part::Phases),
        no_rest_shapes: arguments.without.contains(&Part::RestShapes),
        nothing_holds: arguments.without.contains(&Part::Holding),
        with_bending: arguments.with_bending,
    };
    if ablation.with_bending && shell.bending.is_none() {
        let what = "--with-bending asks for loops, as [[bending]] in the fabric file, and for areal_mass";
        return Err(refused(arguments, &what));
    }
    let problem = yarn_problem(fabric, shell, ablation).map_err(|error| refused(arguments, &error))?;
    std::fs::create_dir_all(folder).map_err(|error| Failure::io(folder, "create", error))?;
    let path = folder.join(ANSWERS);
    if arguments.force && path.exists() {
        std::fs::remove_file(&path).map_err(|error| Failure::io(&path, "remove", error))?;
    }
    // Answers of another problem are refused before theirs is overwritten.
    open(&path, &problem.fingerprint())?;
    let text = serde_json::to_string(&problem).map_err(|error| Failure::new(Code::Bug, error))?;
    write(&folder.join(PROBLEM), text.as_bytes())?;
    Ok(problem)
}

fn way(arguments: &Fit) -> Way {
    let (gradients, swarm) = match arguments.quick {
        true => (GradientSettings::quick(), SwarmSettings::quick()),
        false => (GradientSettings::default(), SwarmSettings::default()),
    };
    let seeded = SwarmSettings { seed: arguments.seed, ..swarm };
    match arguments.way {
        Asks::Gradients => Way::Gradients(gradients),
        Asks::Swarm => Way::Swarm(seeded),
        Asks::Local => Way::Local(seeded),
    }
}

/// The questions that a fit asks now, with the problem that they belong to.
pub fn ask(arguments: &Fit, folder: &Path, problem: &YarnProblem) -> Result<Vec<(String, Question)>, Failure> {
    let fingerprint = problem.fingerprint();
    let journal = open(&folder.join(ANSWERS), &fingerprint)?;
    let asked = Asked::default();
    let silent = |_: &Step| {};
    let answers = Recorded { journal: &journal, by: &asked };
    match fit_yarn(problem, &answers, &way(arguments), &Progress::new(&silent)) {
        Err(Stopped::Asked) => Ok(asked.questions().into_iter().map(|q| (fingerprint.clone(), q)).collect()),
        Err(stopped) => Err(ended(&stopped, None)),
        Ok(_) => {
            note("every question is answered; run the command without --ask for the card");
            Ok(Vec::new())
        }
    }
}

/// Fits a yarn, from the answers that the folder has.
pub fn fit(arguments: &Fit, folder: &Path, problem: &YarnProblem) -> Result<FittedYarn, Failure> {
    let path = folder.join(ANSWERS);
    let journal = open(&path, &problem.fingerprint())?;
    let signals = Signals::listen().map_err(|error| Failure::new(Code::Io, error))?;
    let stop = || signals.stop().is_some();
    let here = Here::new(problem);
    let answers = Interruptible { by: Recorded { journal: &journal, by: here.clone() }, stop: &stop };
    let (began, last) = (Instant::now(), std::sync::Mutex::new(Instant::now()));
    let tell = |step: &Step| {
        let mut last = last.lock().expect("nobody panics with it");
        if !arguments.json && last.elapsed().as_secs() >= 5 {
            *last = Instant::now();
            let (count, seconds, best) = (step.evaluations, began.elapsed().as_secs_f64(), step.best);
            note(&format!("yarn: {count} evaluations in {seconds:.0} s, least sum of squares {best:.3e}"));
        }
    };
    if !journal.is_empty() {
        note(&format!("going on with {} answers of {}", journal.len(), path.display()));
    }
    let found = fit_yarn(problem, &answers, &way(arguments), &Progress::new(&tell));
    let found = found.map_err(|stopped| ended(&stopped, signals.stop()))?;
    let parameters = found.as_ref().map(|found| found.material.parameters());
    let tile = parameters.and_then(|parameters| here.rested(&parameters));
    let (Some(fit), Some(tile)) = (found, tile) else {
        let what = "the tile could be tested nowhere within the bounds: do its yarns pass through each other?";
        return Err(Failure::new(Code::NotConverged, format_args!("{}: {what}", arguments.fabric.display())));
    };
    Ok(FittedYarn { fit, tile: (*tile).clone() })
}

/// The contact model of a fabric of which there is a chart; why there is none is left open, in words.
pub fn fit_contacts(fabric: &FabricFile, shell: &mut FabricFit) -> Option<(Scene, NetworkFit)> {
    let Some(Structure::Scene(scene)) = &fabric.structure else { return None };
    let targets = uniform_targets(fabric, shell).ok()?;
    match fit_scene(scene, &targets) {
        Ok(found) => Some(found),
        Err(SceneFitError::NoChart) => None,
        Err(error) => {
            shell.open.push(format!("the contact model was not fitted: {error}"));
            None
        }
    }
}

/// The journal of a problem in a folder.
pub fn open(path: &Path, fingerprint: &str) -> Result<Journal, Failure> {
    Journal::open(path, fingerprint).map_err(|error| match error {
        JournalError::File { path, error } => Failure::io(&path, "open", error),
        JournalError::Other { .. } => Failure::new(
            Code::BadInput,
            format_args!("{error}; begin anew with `--force`, or choose another folder with `--out`"),
        ),
    })
}

/// The problem that a folder holds.
pub fn problem(folder: &Path) -> Result<YarnProblem, Failure> {
    let path = folder.join(PROBLEM);
    let text = std::fs::read_to_string(&path).map_err(|error| match error.kind() {
        std::io::ErrorKind::NotFound => Failure::new(
            Code::BadInput,
            format_args!(
                "{}: there is no problem to be answered; ask for its questions with `--ask` first",
                path.display()
            ),
        ),
        _ => Failure::io(&path, "read", error),
    })?;
    serde_json::from_str(&text)
        .map_err(|error| Failure::new(Code::BadInput, format_args!("{}: {error}", path.display())))
}

fn ended(stopped: &Stopped, signal: Option<Code>) -> Failure {
    match stopped {
        Stopped::Interrupted => {
            note("stopped; the same command goes on from here");
            Failure::silent(signal.unwrap_or(Code::Interrupted))
        }
        Stopped::Journal(error) => Failure::new(Code::Io, format_args!("the answers cannot be kept: {error}")),
        Stopped::Asked => Failure::new(Code::Bug, "a question was not answered"),
    }
}
