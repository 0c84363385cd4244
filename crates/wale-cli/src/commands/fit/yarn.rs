//! The fit of one yarn to its fabrics: the problems, the journal of their answers, and how far it has come.

use std::fmt::Display;
use std::path::Path;
use std::time::Instant;

use wale::scene::Scene;
use wale_lab::fabric_file::{FabricFile, Structure};
use wale_lab::network_fit::{NetworkFit, SceneFitError, fit_scene};
use wale_lab::shell::of_fabric::ShellFit;
use wale_lab::yarn_fit::ablation::Ablation;
use wale_lab::yarn_fit::gradients::GradientSettings;
use wale_lab::yarn_fit::journal::{Asked, Entry, Journal, JournalError, Recorded, Stopped};
use wale_lab::yarn_fit::of_fabric::uniform_targets;
use wale_lab::yarn_fit::problem::{Answers, Evaluation, Here, Question, YarnProblem, fingerprint};
use wale_lab::yarn_fit::run::{Interruptible, Way, YarnFit, fit_together};
use wale_lab::yarn_fit::swarm::SwarmSettings;
use wale_lab::yarn_fit::{Progress, Step};
use wale_lab::yarn_tile::YarnTile;

use super::write;
use crate::arguments::fit::{Fit, Part, Way as Asks};
use crate::exit::{Code, Failure};
use crate::output::note;
use crate::signals::Signals;

/// Points of each measured curve that are fitted.
pub const TARGETS: usize = 8;
/// Files in the folder of a fit that goes on: the problems, and the answers to their questions.
pub const PROBLEM: &str = "problem.json";
pub const ANSWERS: &str = "answers.jsonl";

/// What is left out of the model, as the arguments say.
pub fn ablation(arguments: &Fit) -> Ablation {
    Ablation {
        one_phase: arguments.without.contains(&Part::Phases),
        no_rest_shapes: arguments.without.contains(&Part::RestShapes),
        nothing_holds: arguments.without.contains(&Part::Holding),
        with_bending: arguments.with_bending,
    }
}

/// Writes problems into the folder of their fit, where no answers of others may lie.
pub fn prepare(folder: &Path, problems: &[YarnProblem], force: bool) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|error| Failure::io(folder, "create", error))?;
    let path = folder.join(ANSWERS);
    if force && path.exists() {
        std::fs::remove_file(&path).map_err(|error| Failure::io(&path, "remove", error))?;
    }
    // Answers of another problem are refused before theirs is overwritten.
    open(&path, problems)?;
    let text = serde_json::to_string(problems).map_err(|error| Failure::new(Code::Bug, error))?;
    write(&folder.join(PROBLEM), text.as_bytes())
}

/// Settings of the swarm, and of COBYLA after it or alone.
pub fn swarm(arguments: &Fit) -> SwarmSettings {
    let settings = if arguments.quick { SwarmSettings::quick() } else { SwarmSettings::default() };
    SwarmSettings { seed: arguments.seed, ..settings }
}

/// How the yarn is fitted.
pub fn way(arguments: &Fit) -> Way {
    match arguments.way {
        Asks::Gradients if arguments.quick => Way::Gradients(GradientSettings::quick()),
        Asks::Gradients => Way::Gradients(GradientSettings::default()),
        Asks::Swarm => Way::Swarm(swarm(arguments)),
        Asks::Local => Way::Local(swarm(arguments)),
    }
}

/// The questions that a fit asks now, with the problem that they belong to.
pub fn ask(arguments: &Fit, folder: &Path, problems: &[YarnProblem]) -> Result<Vec<(String, Question)>, Failure> {
    let fingerprint = fingerprint(problems);
    let journal = open(&folder.join(ANSWERS), problems)?;
    let asked = Asked::default();
    let silent = |_: &Step| {};
    let answers = Recorded { journal: &journal, by: &asked };
    match fit_together(problems, &answers, &way(arguments), &Progress::new(&silent)) {
        Err(Stopped::Asked) => Ok(asked.questions().into_iter().map(|q| (fingerprint.clone(), q)).collect()),
        Err(stopped) => Err(ended(&stopped, None)),
        Ok(_) => {
            note("every question is answered; run the command without --ask for the card");
            Ok(Vec::new())
        }
    }
}

/// A fabric's share of a yarn that was fitted: what it does, and the tile with its rest shapes.
pub struct FittedYarn {
    pub fit: YarnFit,
    pub tile: YarnTile,
}

/// A fit of a yarn to its fabrics, with a journal of its own.
pub struct Task<'a> {
    /// Folder of the journal.
    pub folder: &'a Path,
    /// What is fitted.
    pub problems: &'a [YarnProblem],
    /// How.
    pub way: Way,
    /// What it is called while it lasts.
    pub name: &'a str,
    /// Whether it tells how far it has come.
    pub tells: bool,
}

impl Task<'_> {
    /// Fits the yarn, from the answers that the folder has: a part for each fabric, none if their tiles could be tested nowhere.
    pub fn fit(&self, signals: &Signals) -> Result<Option<Vec<FittedYarn>>, Failure> {
        let journal = open(&self.folder.join(ANSWERS), self.problems)?;
        let stop = || signals.stop().is_some();
        let here = Here::of(self.problems);
        let answers = Interruptible { by: Recorded { journal: &journal, by: here.clone() }, stop: &stop };
        let (began, last) = (Instant::now(), std::sync::Mutex::new(Instant::now()));
        let tell = |step: &Step| {
            let mut last = last.lock().expect("nobody panics with it");
            if self.tells && last.elapsed().as_secs() >= 5 {
                *last = Instant::now();
                let (count, seconds, best) = (step.evaluations, began.elapsed().as_secs_f64(), step.best);
                note(&format!("{}: {count} evaluations in {seconds:.0} s, least sum of squares {best:.3e}", self.name));
            }
        };
        if !journal.is_empty() {
            note(&format!("{}: going on with {} answers of {}", self.name, journal.len(), journal.path().display()));
        }
        let found = fit_together(self.problems, &answers, &self.way, &Progress::new(&tell));
        let found = found.map_err(|stopped| ended(&stopped, signals.stop()))?;
        let with_tile = |(fabric, fit): (usize, YarnFit)| {
            let tile = here.rested(fabric, &fit.material.parameters())?;
            Some(FittedYarn { tile: (*tile).clone(), fit })
        };
        Ok(found.and_then(|fits| fits.into_iter().enumerate().map(with_tile).collect()))
    }

    /// The answer to one more question.
    pub fn answer(&self, question: &Question) -> Result<Option<Evaluation>, Failure> {
        let journal = open(&self.folder.join(ANSWERS), self.problems)?;
        let answers = Recorded { journal: &journal, by: Here::of(self.problems) };
        answers.answer(question).map_err(|stopped| ended(&stopped, None))
    }
}

/// The contact model of a fabric of which there is a chart or a draft; why there is none is left open, in words.
pub fn fit_contacts(fabric: &FabricFile, shell: &mut ShellFit) -> Option<(Scene, NetworkFit)> {
    let Some(Structure::Scene(scene)) = &fabric.structure else { return None };
    let targets = uniform_targets(fabric, shell).ok()?;
    match fit_scene(scene, &targets) {
        Ok(found) => Some(found),
        Err(SceneFitError::NoRepeat) => None,
        Err(error) => {
            shell.open.push(format!("the contact model was not fitted: {error}"));
            None
        }
    }
}

/// The journal of problems in a folder.
pub fn open(path: &Path, problems: &[YarnProblem]) -> Result<Journal, Failure> {
    let fits = |entry: &Entry| entry.question.is_answered_by(entry.answer.as_ref(), problems);
    Journal::open(path, &fingerprint(problems), fits).map_err(|error| match error {
        JournalError::File { path, error } => Failure::io(&path, "open", error),
        JournalError::Other { .. } => Failure::new(
            Code::BadInput,
            format_args!("{error}; begin anew with `--force`, or choose another folder with `--out`"),
        ),
    })
}

/// The problems that a folder holds.
pub fn problems(folder: &Path) -> Result<Vec<YarnProblem>, Failure> {
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
    let wrong = |error: &dyn Display| Failure::new(Code::BadInput, format_args!("{}: {error}", path.display()));
    let problems: Vec<YarnProblem> = serde_json::from_str(&text).map_err(|error| wrong(&error))?;
    match problems.iter().find_map(YarnProblem::fault) {
        Some(fault) => Err(wrong(&fault)),
        None => Ok(problems),
    }
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
