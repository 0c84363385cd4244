//! A file of settings in TOML, and errors that underline what is wrong in it.

use std::fs::File;
use std::io::Read;
use std::ops::Range;
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;

use super::error::{Complaint, ErrorClass, SceneError, nearest, shortened};
use super::{SCHEMA, locate};

/// Most bytes of a file.
const LARGEST_FILE: usize = 16 << 20;

/// A file's text.
#[derive(Clone, Debug)]
pub struct TextFile {
    name: String,
    text: String,
    directory: Option<PathBuf>,
}

impl TextFile {
    /// A text; `name` stands in errors. No other file can lie beside it.
    #[must_use]
    pub fn new(text: &str, name: &str) -> Self {
        // A byte order mark is no part of it.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        Self { name: name.to_owned(), text: text.to_owned(), directory: None }
    }

    /// Reads a file; `kind` is what it is called in errors.
    ///
    /// # Errors
    /// If it cannot be read, is larger than 16 MiB, or no text in UTF-8.
    pub fn read(path: &Path, kind: &str) -> Result<Self, SceneError> {
        let name = path.display().to_string();
        let text = read_text(path, kind).map_err(|complaint| SceneError::new(complaint, &name, "", None))?;
        Ok(Self { directory: path.parent().map(Path::to_owned), ..Self::new(&text, &name) })
    }

    /// Where it lies.
    #[must_use]
    pub fn directory(&self) -> Option<&Path> {
        self.directory.as_deref()
    }

    /// What it says, in the words of a schema.
    ///
    /// # Errors
    /// If it is no TOML, or has other words.
    pub fn parse<T: DeserializeOwned>(&self) -> Result<T, SceneError> {
        toml::from_str(&self.text).map_err(|error| {
            let (complaint, span) = explained(&error);
            SceneError::new(complaint, &self.name, &self.text, span)
        })
    }

    /// An error about the value of a key, such as `stretch.0.file`, with its mend.
    #[must_use]
    pub fn error(&self, key: &str, what: impl Into<String>, mend: impl Into<String>) -> SceneError {
        self.complain(Complaint::new(key, what).mend(mend))
    }

    pub(super) fn complain(&self, complaint: Complaint) -> SceneError {
        let span = locate::span_of(&self.text, &complaint.path);
        SceneError::new(complaint, &self.name, &self.text, span)
    }
}

fn read_text(path: &Path, kind: &str) -> Result<String, Complaint> {
    let failed = |error: std::io::Error| {
        let complaint = Complaint::new("", format!("the {kind} cannot be read: {error}"));
        match error.kind() {
            std::io::ErrorKind::NotFound if kind == "scene" => {
                complaint.mend("check the name, or write a scene with `wale new`")
            }
            std::io::ErrorKind::NotFound => complaint.mend("check the name"),
            std::io::ErrorKind::IsADirectory => complaint.mend("name a .toml file"),
            _ => complaint.class(ErrorClass::InputOutput),
        }
    };
    let mut bytes = Vec::new();
    let limit = LARGEST_FILE as u64 + 1;
    File::open(path).and_then(|file| file.take(limit).read_to_end(&mut bytes)).map_err(failed)?;
    if bytes.len() > LARGEST_FILE {
        let what = format!("the {kind} is larger than {LARGEST_FILE} bytes");
        return Err(Complaint::new("", what).class(ErrorClass::ResourceLimit));
    }
    String::from_utf8(bytes).map_err(|_| Complaint::new("", format!("the {kind} is not text in UTF-8")))
}

/// The reader's message with a mend: after a line break where our own types gave one, the nearest word where it lists
/// the words that it knows.
fn explained(error: &toml::de::Error) -> (Complaint, Option<Range<usize>>) {
    let message = error.message();
    let (what, mend) = match message.split_once('\n') {
        Some((what, mend)) => (what, Some(mend.replace('\n', " "))),
        None => (message, None),
    };
    let mut quoted = what.split('`').skip(1).step_by(2);
    let mut complaint = Complaint::new("", what);
    let unknown_key = what.starts_with("unknown field");
    if unknown_key || what.starts_with("unknown variant") {
        let word = quoted.next().unwrap_or_default();
        let known: Vec<&str> = quoted.collect();
        let kind = if unknown_key { "key" } else { "value" };
        complaint = Complaint::new("", format!("unknown {kind} `{}`", shortened(word)));
        complaint = complaint.why(if unknown_key { "no such key here" } else { "no such value here" });
        let list = known.join(", ");
        complaint = complaint.mend(match nearest(word, known.iter().copied()) {
            Some(near) => format!("did you mean `{near}`? known here: {list}"),
            None => format!("known here: {list}"),
        });
    } else if let Some(key) = what.strip_prefix("missing field").and(quoted.next()) {
        complaint = Complaint::new("", format!("`{key}` is missing")).mend(match key {
            "schema" => format!("write schema = {SCHEMA} in the first line"),
            "fabric" => "add [fabric.chart] with pattern = \"garter\", columns = 20 and rows = 20".to_owned(),
            key => format!("add {key} = …"),
        });
        // The reader points at everything that lacks the key; where that is the whole file, at nothing.
        let whole = key == "schema" || key == "fabric";
        return (complaint, error.span().filter(|_| !whole));
    } else if let Some(mend) = mend {
        complaint = complaint.mend(mend);
    }
    (complaint, error.span())
}
