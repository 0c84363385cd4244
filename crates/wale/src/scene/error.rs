//! What is wrong with a scene: the file, the line, the underlined value, why, and the mend.

use std::fmt;
use std::ops::Range;

use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};

/// Why a scene cannot be had.
#[derive(Clone, Debug)]
pub struct SceneError(Box<Contents>);

#[derive(Clone, Debug)]
struct Contents {
    class: ErrorClass,
    what: String,
    why: Option<String>,
    mend: Option<String>,
    file: String,
    /// The bytes concerned, their line and their column, both from 1.
    place: Option<(Range<usize>, usize, usize)>,
    text: NamedSource<String>,
}

/// What a program that ends with an error tells its caller.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ErrorClass {
    /// The input is wrong; exit code 3.
    BadInput,
    /// The input is right but asks for too much; exit code 4.
    ResourceLimit,
    /// Reading failed; exit code 6.
    InputOutput,
}

impl ErrorClass {
    /// Exit code of a program that ends so.
    #[must_use]
    pub fn exit_code(self) -> u8 {
        match self {
            Self::BadInput => 3,
            Self::ResourceLimit => 4,
            Self::InputOutput => 6,
        }
    }
}

impl SceneError {
    /// An error in a file's text; `span` are the bytes concerned, if any part is.
    pub(super) fn new(complaint: Complaint, file: &str, text: &str, span: Option<Range<usize>>) -> Self {
        let place = span.map(|span| {
            let span = whole_characters(text, span);
            let before = &text[..span.start];
            let line_start = before.rfind('\n').map_or(0, |at| at + 1);
            let line = before.matches('\n').count() + 1;
            let column = before[line_start..].chars().count() + 1;
            (span, line, column)
        });
        let Complaint { class, what, why, mend, .. } = complaint;
        let text = NamedSource::new(file, text.to_owned());
        Self(Box::new(Contents { class, what, why, mend, file: file.to_owned(), place, text }))
    }

    /// What kind of error this is.
    #[must_use]
    pub fn class(&self) -> ErrorClass {
        self.0.class
    }
    /// What is wrong, in one sentence.
    #[must_use]
    pub fn what(&self) -> &str {
        &self.0.what
    }
    /// Why it is wrong.
    #[must_use]
    pub fn why(&self) -> Option<&str> {
        self.0.why.as_deref()
    }
    /// How to mend it.
    #[must_use]
    pub fn mend(&self) -> Option<&str> {
        self.0.mend.as_deref()
    }
    /// The file as it was named.
    #[must_use]
    pub fn file(&self) -> &str {
        &self.0.file
    }
    /// Line and column, from 1, of the underlined text.
    #[must_use]
    pub fn line_and_column(&self) -> Option<(usize, usize)> {
        self.0.place.as_ref().map(|(_, line, column)| (*line, *column))
    }
    /// The underlined text.
    #[must_use]
    pub fn underlined(&self) -> Option<&str> {
        self.0.place.as_ref().map(|(span, ..)| &self.0.text.inner()[span.clone()])
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line_and_column() {
            Some((line, column)) => write!(f, "{}:{line}:{column}: {}", self.0.file, self.0.what),
            None => write!(f, "{}: {}", self.0.file, self.0.what),
        }
    }
}

impl std::error::Error for SceneError {}

impl Diagnostic for SceneError {
    fn code<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(match self.0.class {
            ErrorClass::BadInput => "wale::scene::bad_input",
            ErrorClass::ResourceLimit => "wale::scene::resource_limit",
            ErrorClass::InputOutput => "wale::scene::input_output",
        }))
    }
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.0.mend.as_ref().map(|mend| Box::new(mend) as Box<dyn fmt::Display>)
    }
    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.0.place.as_ref().map(|_| &self.0.text as &dyn SourceCode)
    }
    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let (span, ..) = self.0.place.as_ref()?;
        let label = LabeledSpan::new(self.0.why.clone(), span.start, span.len());
        Some(Box::new(std::iter::once(label)))
    }
}

/// Something wrong with a value, before its place in the file is looked up.
#[derive(Clone, Debug)]
pub(super) struct Complaint {
    pub class: ErrorClass,
    /// Keys and array indices joined by dots, as in `obstacle.0.sphere`.
    pub path: String,
    pub what: String,
    pub why: Option<String>,
    pub mend: Option<String>,
}

impl Complaint {
    pub fn new(path: impl Into<String>, what: impl Into<String>) -> Self {
        Self { class: ErrorClass::BadInput, path: path.into(), what: what.into(), why: None, mend: None }
    }
    pub fn why(mut self, why: impl Into<String>) -> Self {
        self.why = Some(why.into());
        self
    }
    pub fn mend(mut self, mend: impl Into<String>) -> Self {
        self.mend = Some(mend.into());
        self
    }
    pub fn class(mut self, class: ErrorClass) -> Self {
        self.class = class;
        self
    }
}

/// The first sixty characters.
pub(super) fn shortened(text: &str) -> String {
    match text.char_indices().nth(60) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

/// The candidate that a misspelt word most likely meant.
pub(super) fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let allowed = (word.chars().count() / 3).max(1);
    candidates
        .into_iter()
        .map(|candidate| (edit_distance(&word.to_lowercase(), &candidate.to_lowercase()), candidate))
        .filter(|(distance, candidate)| *distance <= allowed && *distance < candidate.chars().count())
        .min()
        .map(|(_, candidate)| candidate)
}

/// Insertions, deletions and exchanges that lead from one word to another [Levenshtein 1966]. Words are cut at sixty
/// characters: longer ones resemble no key.
fn edit_distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().take(60).collect(), b.chars().take(60).collect());
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.iter().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

/// A span within the text that cuts no character.
fn whole_characters(text: &str, span: Range<usize>) -> Range<usize> {
    let mut start = span.start.min(text.len());
    while !text.is_char_boundary(start) {
        start -= 1;
    }
    let mut end = span.end.clamp(start, text.len());
    while !text.is_char_boundary(end) {
        end += 1;
    }
    start..end
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn misspelt_words_find_their_neighbour_and_strange_ones_none() {
        let keys = ["duration", "frame_rate", "gravity"];
        assert_eq!(nearest("durration", keys), Some("duration"));
        assert_eq!(nearest("Gravty", keys), Some("gravity"));
        assert_eq!(nearest("colour", keys), None);
        assert_eq!(edit_distance("kitten", "sitting"), 3);
    }

    #[test]
    fn places_are_counted_in_lines_and_characters() {
        let error = SceneError::new(Complaint::new("", "wrong"), "a.toml", "é = 1\nü = 22\n", Some(12..14));
        assert_eq!(error.line_and_column(), Some((2, 5)));
        assert_eq!(error.underlined(), Some("22"));
        assert_eq!(error.to_string(), "a.toml:2:5: wrong");
        let outside = SceneError::new(Complaint::new("", "wrong"), "a.toml", "é", Some(1..99));
        assert_eq!(outside.underlined(), Some("é"));
    }
}
