//! Questions of a fit that other machines answer: JSON lines out, JSON lines in.

use std::io::{self, BufRead, BufReader};
use std::path::Path;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use wale_lab::yarn_fit::journal::Entry;
use wale_lab::yarn_fit::problem::{Answers, Evaluation, Here, Question, fingerprint};

use super::yarn::{ANSWERS, open, problems};
use crate::exit::{Code, Failure};
use crate::output::{line, note};

/// A line that is asked.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Ask {
    problem: String,
    question: Question,
}

/// A line that is answered; no answer where the tile cannot be tested.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Told {
    problem: String,
    question: Question,
    answer: Option<Evaluation>,
}

/// Most points a curve that a question may ask for: fits ask for twenty at most.
const MOST_SAMPLES: usize = 1000;
/// Lines that are answered together, in parallel.
const TOGETHER: usize = 64;

fn json(value: &impl Serialize) -> Result<String, Failure> {
    serde_json::to_string(value).map_err(|error| Failure::new(Code::Bug, error))
}

/// Prints questions.
pub fn print(questions: &[(String, Question)]) -> Result<(), Failure> {
    for (problem, question) in questions {
        line(format_args!("{}", json(&Ask { problem: problem.clone(), question: *question })?))?;
    }
    Ok(())
}

/// Answers the questions of standard input.
pub fn answer(folder: &Path) -> Result<(), Failure> {
    let problems = problems(folder)?;
    let fingerprint = fingerprint(&problems);
    let here = Here::of(&problems);
    let mut lines = io::stdin().lock().lines().enumerate();
    loop {
        let mut asked = Vec::new();
        for (index, text) in lines.by_ref().take(TOGETHER) {
            let text = text.map_err(|error| Failure::new(Code::Io, format_args!("standard input: {error}")))?;
            if !text.trim().is_empty() {
                let ask = read::<Ask>("standard input", index, &text, &fingerprint, |ask| &ask.problem)?;
                if ask.question.fabric >= problems.len() {
                    let what = format!("fabric is {}, and there are {}", ask.question.fabric, problems.len());
                    return Err(Failure::new(Code::BadInput, format_args!("standard input:{}: {what}", index + 1)));
                }
                if !(1..=MOST_SAMPLES).contains(&ask.question.samples) {
                    let what = format!("samples is {}, and should be 1 to {MOST_SAMPLES}", ask.question.samples);
                    return Err(Failure::new(Code::BadInput, format_args!("standard input:{}: {what}", index + 1)));
                }
                asked.push(ask);
            }
        }
        if asked.is_empty() {
            return Ok(());
        }
        let answered: Vec<Told> = asked
            .into_par_iter()
            .map(|Ask { problem, question }| {
                let Ok(answer) = here.answer(&question);
                Told { problem, question, answer }
            })
            .collect();
        for told in answered {
            line(format_args!("{}", json(&told)?))?;
        }
    }
}

/// Takes answers from a file, or from standard input.
pub fn tell(folder: &Path, file: &Path) -> Result<(), Failure> {
    let problems = problems(folder)?;
    let fingerprint = fingerprint(&problems);
    let (name, reader): (String, Box<dyn BufRead>) = if file == Path::new("-") {
        ("standard input".to_owned(), Box::new(io::stdin().lock()))
    } else {
        let opened = std::fs::File::open(file).map_err(|error| Failure::io(file, "open", error))?;
        (file.display().to_string(), Box::new(BufReader::new(opened)))
    };
    // All are read before the first is taken, so that a bad line leaves nothing behind.
    let mut told = Vec::new();
    for (index, text) in reader.lines().enumerate() {
        let text = text.map_err(|error| Failure::new(Code::Io, format_args!("{name}: {error}")))?;
        if text.trim().is_empty() {
            continue;
        }
        let one = read::<Told>(&name, index, &text, &fingerprint, |told| &told.problem)?;
        if !one.question.is_answered_by(one.answer.as_ref(), &problems) {
            let what =
                "the answer has not as many points as the question asks for, or is of a fabric that is not there";
            return Err(Failure::new(Code::BadInput, format_args!("{name}:{}: {what}", index + 1)));
        }
        told.push(one);
    }
    let path = folder.join(ANSWERS);
    let journal = open(&path, &problems)?;
    let mut new = 0;
    for Told { question, answer, .. } in told {
        let added = journal.add(&Entry { question, answer });
        new += usize::from(added.map_err(|error| Failure::io(&path, "write", error))?);
    }
    note(&format!("{new} new answers, {} in all", journal.len()));
    Ok(())
}

/// A line of the right problem.
fn read<T: for<'de> Deserialize<'de>>(
    name: &str,
    index: usize,
    text: &str,
    fingerprint: &str,
    problem: impl Fn(&T) -> &String,
) -> Result<T, Failure> {
    let place = index + 1;
    let value: T = serde_json::from_str(text)
        .map_err(|error| Failure::new(Code::BadInput, format_args!("{name}:{place}: {error}")))?;
    if problem(&value) != fingerprint {
        let what = "this is of another problem than the folder's; ask for its questions again";
        return Err(Failure::new(Code::BadInput, format_args!("{name}:{place}: {what}")));
    }
    Ok(value)
}
