//! Tests as questions that other machines answer: JSON lines out, JSON lines in. Each line has all that it takes.

use std::collections::HashMap;
use std::io::{self, BufRead, BufReader};
use std::path::Path;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::fabric::Fabric;
use super::failure::TestFailure;
use super::models::run;
use super::report::Report;
use crate::arguments::lab::{By, Test};
use crate::exit::{Code, Failure};
use crate::output::line;

/// A test of one fabric, in one direction if it has any.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Question {
    /// Version of the program that asks: another may give other numbers.
    wale: String,
    /// The test.
    pub test: Test,
    /// By which model.
    pub by: By,
    /// The fabric.
    pub fabric: Fabric,
}

/// What a test found.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Found {
    /// What the instrument prints.
    Report(Report),
    /// Why it prints nothing.
    Failure(TestFailure),
}

/// A line that is asked.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Asked {
    id: String,
    question: Question,
}

/// A line that is answered.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Told {
    id: String,
    found: Found,
}

/// Lines that are answered together, in parallel.
const TOGETHER: usize = 64;

/// Answers by the question's fingerprint.
pub type Answers = HashMap<String, Found>;

impl Question {
    /// A question of this program.
    pub fn new(test: Test, by: By, fabric: Fabric) -> Self {
        Self { wale: env!("CARGO_PKG_VERSION").to_owned(), test, by, fabric }
    }

    /// What tells it from all others.
    ///
    /// # Errors
    /// Never.
    pub fn id(&self) -> Result<String, Failure> {
        let digest = Sha256::digest(json(self)?.as_bytes());
        Ok(digest.iter().map(|byte| format!("{byte:02x}")).collect())
    }

    /// Does the test; `place` is what errors call the fabric.
    pub fn answer(&self, place: &Path) -> Result<Found, Failure> {
        let specimen = self.fabric.specimen(&self.test, self.by, place)?;
        let found = run(&self.test, &specimen, self.fabric.title()).and_then(Report::checked);
        Ok(found.map_or_else(Found::Failure, Found::Report))
    }
}

fn json(value: &impl Serialize) -> Result<String, Failure> {
    serde_json::to_string(value).map_err(|error| Failure::new(Code::Bug, error))
}

/// Prints a question.
///
/// # Errors
/// If it cannot be printed.
pub fn print(question: &Question) -> Result<(), Failure> {
    line(format_args!("{}", json(&Asked { id: question.id()?, question: question.clone() })?))
}

/// Answers the questions of standard input.
///
/// # Errors
/// At the first line that is none; what was answered before is printed.
pub fn answer() -> Result<(), Failure> {
    let name = "standard input";
    let mut lines = io::stdin().lock().lines().enumerate();
    loop {
        let mut asked = Vec::new();
        for (index, text) in lines.by_ref().take(TOGETHER) {
            let text = text.map_err(|error| Failure::new(Code::Io, format_args!("{name}: {error}")))?;
            if text.trim().is_empty() {
                continue;
            }
            let one: Asked = parse(name, index, &text)?;
            let refused = |what: String| Failure::new(Code::BadInput, format_args!("{name}:{}: {what}", index + 1));
            if one.question.wale != env!("CARGO_PKG_VERSION") {
                let (theirs, own) = (&one.question.wale, env!("CARGO_PKG_VERSION"));
                return Err(refused(format!("wale {theirs} asks, and this is {own}: use the same version")));
            }
            if one.question.id()? != one.id {
                return Err(refused(
                    "the question is not the one that was asked: it was changed on its way".to_owned(),
                ));
            }
            asked.push((format!("{name}:{}", index + 1), one));
        }
        if asked.is_empty() {
            return Ok(());
        }
        let told: Vec<Result<Told, Failure>> = asked
            .into_par_iter()
            .map(|(place, Asked { id, question })| Ok(Told { id, found: question.answer(Path::new(&place))? }))
            .collect();
        for one in told {
            line(format_args!("{}", json(&one?)?))?;
        }
    }
}

/// Reads answers to some questions from a file, or from standard input.
///
/// # Errors
/// If a line is none, or answers what was not asked, or a question was answered in two ways.
pub fn answers(file: &Path, asked: &[String]) -> Result<Answers, Failure> {
    let (name, reader): (String, Box<dyn BufRead>) = if file == Path::new("-") {
        ("standard input".to_owned(), Box::new(io::stdin().lock()))
    } else {
        let opened = std::fs::File::open(file).map_err(|error| Failure::io(file, "open", error))?;
        (file.display().to_string(), Box::new(BufReader::new(opened)))
    };
    let mut answers: Answers = HashMap::new();
    for (index, text) in reader.lines().enumerate() {
        let text = text.map_err(|error| Failure::new(Code::Io, format_args!("{name}: {error}")))?;
        if text.trim().is_empty() {
            continue;
        }
        let told: Told = parse(&name, index, &text)?;
        let refused = |what: &str| Failure::new(Code::BadInput, format_args!("{name}:{}: {what}", index + 1));
        if !asked.contains(&told.id) {
            let what = "this answers another question than this test asks of these fabrics; ask again with `--ask`";
            return Err(refused(what));
        }
        if let Some(before) = answers.get(&told.id) {
            if json(before)? != json(&told.found)? {
                return Err(refused("this question was answered before, in another way"));
            }
            continue;
        }
        answers.insert(told.id, told.found);
    }
    Ok(answers)
}

fn parse<T: for<'de> Deserialize<'de>>(name: &str, index: usize, text: &str) -> Result<T, Failure> {
    serde_json::from_str(text)
        .map_err(|error| Failure::new(Code::BadInput, format_args!("{name}:{}: {error}", index + 1)))
}
