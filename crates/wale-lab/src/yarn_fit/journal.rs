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
use thiserror::Error;

use super::problem::{Answers, Evaluation, Question};

/// A question with its answer: none where the tile cannot be tested.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// What was asked.
    pub question: Question,
    /// What was answered.
    pub answer: Option<Evaluation>,
}

/// The first line of a journal: of which problem its answers are.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Head {
    problem: String,
}

/// Why there is no journal.
#[derive(Debug, Error)]
pub enum JournalError {
    /// It cannot be read or written.
    #[error("{}: {error}", .path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why not.
        error: io::Error,
    },
    /// Its answers are of another problem.
    #[error("{}: its answers are of another fabric or of other settings", .path.display())]
    Other {
        /// The file.
        path: PathBuf,
    },
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
    /// Opens the journal of a problem, told by its fingerprint, with all entries that are whole: the last line of a fit that was killed
    /// may not be, and is cut off. What does not fit its question, as in a file that was edited, is passed over.
    ///
    /// # Errors
    /// [`JournalError`].
    pub fn open(path: &Path, problem: &str, fits: impl Fn(&Entry) -> bool) -> Result<Self, JournalError> {
        let failed = |error: io::Error| JournalError::File { path: path.to_owned(), error };
        let text = match std::fs::read(path) {
            Ok(bytes) => String::from_utf8_lossy(&bytes).into_owned(),
            Err(error) if error.kind() == io::ErrorKind::NotFound => String::new(),
            Err(error) => return Err(failed(error)),
        };
        let mut known = HashMap::new();
        let mut lines = text.split_inclusive('\n');
        let mut whole = 0;
        if let Some(line) = lines.next().filter(|line| line.ends_with('\n')) {
            if serde_json::from_str::<Head>(line).ok().is_none_or(|head| head.problem != problem) {
                return Err(JournalError::Other { path: path.to_owned() });
            }
            whole = line.len();
        }
        for line in lines {
            let Some(entry) = line.strip_suffix('\n').and_then(|line| serde_json::from_str::<Entry>(line).ok()) else {
                break;
            };
            whole += line.len();
            if fits(&entry) {
                known.entry(key(&entry.question)).or_insert(entry.answer);
            }
        }
        let mut file = OpenOptions::new().create(true).append(true).open(path).map_err(failed)?;
        file.set_len(whole as u64).map_err(failed)?;
        if whole == 0 {
            let head = Head { problem: problem.to_owned() };
            let line = serde_json::to_string(&head).expect("words are JSON") + "\n";
            file.write_all(line.as_bytes()).map_err(failed)?;
        }
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
