//! What was asked and answered, on paper: a fit that was killed goes on, and other machines may answer.
//!
//! A fit is a function of the answers to its questions and of nothing else. So whoever has the answers can run it again from the
//! beginning, in no time, up to the first question without one.

use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use serde::{Deserialize, Serialize};

use super::problem::{Answers, Evaluation, Question};

/// A question with its answer: none where the tile cannot be tested.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// What was asked.
    pub question: Question,
    /// What was answered.
    pub answer: Option<Evaluation>,
}

/// Answers by their questions, kept in a file of JSON lines.
#[derive(Debug)]
pub struct Journal {
    known: Mutex<HashMap<String, Option<Evaluation>>>,
    file: Mutex<File>,
    path: PathBuf,
}

fn key(question: &Question) -> String {
    serde_json::to_string(question).expect("finite numbers are JSON")
}

impl Journal {
    /// Opens the journal, with all entries that are whole: the last line of a fit that was killed may not be, and is cut off.
    ///
    /// # Errors
    /// If the file cannot be read or written.
    pub fn open(path: &Path) -> io::Result<Self> {
        let text = match std::fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => String::new(),
            Err(error) => return Err(error),
        };
        let mut known = HashMap::new();
        let mut whole = 0;
        for line in text.split_inclusive('\n') {
            let Some(entry) = line.strip_suffix('\n').and_then(|line| serde_json::from_str::<Entry>(line).ok()) else {
                break;
            };
            known.entry(key(&entry.question)).or_insert(entry.answer);
            whole += line.len();
        }
        let file = OpenOptions::new().create(true).append(true).open(path)?;
        file.set_len(whole as u64)?;
        Ok(Self { known: Mutex::new(known), file: Mutex::new(file), path: path.to_owned() })
    }

    /// Number of answers.
    ///
    /// # Panics
    /// Never: nobody panics with the lock.
    #[must_use]
    pub fn len(&self) -> usize {
        self.known.lock().expect("nobody panics with it").len()
    }

    /// Whether it has none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Where it is kept.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The answer to a question, if it is known.
    fn known(&self, question: &Question) -> Option<Option<Evaluation>> {
        self.known.lock().expect("nobody panics with it").get(&key(question)).cloned()
    }

    /// Adds an answer, if there was none; whether it did. The first answer stays, so that one that is told twice does no harm.
    ///
    /// # Errors
    /// If the file cannot be written.
    ///
    /// # Panics
    /// Never: nobody panics with the lock, and entries are JSON.
    pub fn add(&self, entry: &Entry) -> io::Result<bool> {
        let mut known = self.known.lock().expect("nobody panics with it");
        let key = key(&entry.question);
        if known.contains_key(&key) {
            return Ok(false);
        }
        let mut line = serde_json::to_string(entry).expect("finite numbers are JSON");
        line.push('\n');
        self.file.lock().expect("nobody panics with it").write_all(line.as_bytes())?;
        known.insert(key, entry.answer.clone());
        Ok(true)
    }
}

/// Answers from the journal, and from somebody else where it has none; these are added.
#[derive(Debug)]
pub struct Recorded<'a, A> {
    /// The journal.
    pub journal: &'a Journal,
    /// Who else answers.
    pub by: A,
}

impl<A: Answers> Answers for Recorded<'_, A>
where
    A::Unanswered: Into<Stopped>,
{
    type Unanswered = Stopped;

    fn answer(&self, question: &Question) -> Result<Option<Evaluation>, Stopped> {
        if let Some(known) = self.journal.known(question) {
            return Ok(known);
        }
        let answer = self.by.answer(question).map_err(Into::into)?;
        // A journal that cannot be written must not be taken for one that can.
        let entry = Entry { question: *question, answer };
        self.journal.add(&entry).map_err(|error| Stopped::Journal(error.to_string()))?;
        Ok(entry.answer)
    }
}

/// Why a fit ended before its end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Stopped {
    /// A question has no answer yet.
    Asked,
    /// The journal could not be written.
    Journal(String),
    /// Somebody wanted it.
    Interrupted,
}

impl From<std::convert::Infallible> for Stopped {
    fn from(never: std::convert::Infallible) -> Self {
        match never {}
    }
}

/// Nobody answers: questions are collected.
#[derive(Debug, Default)]
pub struct Asked {
    questions: Mutex<Vec<Question>>,
}

impl Asked {
    /// All questions, each once, in an order that does not depend on threads.
    ///
    /// # Panics
    /// Never: nobody panics with the lock.
    #[must_use]
    pub fn questions(&self) -> Vec<Question> {
        let mut lines: Vec<(String, Question)> =
            self.questions.lock().expect("nobody panics with it").iter().map(|q| (key(q), *q)).collect();
        lines.sort_by(|a, b| a.0.cmp(&b.0));
        lines.dedup_by(|a, b| a.0 == b.0);
        lines.into_iter().map(|(_, question)| question).collect()
    }
}

impl Answers for &Asked {
    type Unanswered = Stopped;

    fn answer(&self, question: &Question) -> Result<Option<Evaluation>, Stopped> {
        self.questions.lock().expect("nobody panics with it").push(*question);
        Err(Stopped::Asked)
    }
}
