//! Words, numbers and signs of one line of instructions, with their place in the text.

use std::ops::Range;

use super::{InstructionError, InstructionErrorReason};
use crate::pattern::chart::Chart;

/// A word in lower case (letters and digits), or a sign.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Token {
    Word(String),
    Sign(char),
}

/// The tokens of one line and a place among them.
pub(super) struct Line<'a> {
    text: &'a str,
    tokens: Vec<(Token, Range<usize>)>,
    at: usize,
    end: usize,
    pub(super) row: Option<u64>,
}

type Parsed<T> = Result<T, InstructionError>;

impl<'a> Line<'a> {
    /// Cuts the bytes `start..end` of the text into tokens; a comment ends the line.
    pub(super) fn new(text: &'a str, start: usize, end: usize) -> Self {
        let line = &text[start..end];
        let line = line.split('#').next().unwrap_or_default();
        let mut tokens: Vec<(Token, Range<usize>)> = Vec::new();
        let mut word_open = false;
        for (offset, c) in line.char_indices() {
            let span = start + offset..start + offset + c.len_utf8();
            if c.is_alphanumeric() {
                match tokens.last_mut() {
                    Some((Token::Word(word), place)) if word_open => {
                        word.extend(c.to_lowercase());
                        place.end = span.end;
                    }
                    _ => tokens.push((Token::Word(c.to_lowercase().collect()), span)),
                }
                word_open = true;
            } else {
                word_open = false;
                let sign = if c == '–' || c == '—' { '-' } else { c };
                if !c.is_whitespace() && c != '\u{feff}' {
                    tokens.push((Token::Sign(sign), span));
                }
            }
        }
        let end = tokens.last().map_or(start, |(_, place)| place.end);
        Self { text, tokens, at: 0, end, row: None }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.at == self.tokens.len()
    }

    /// Where it is, for [`Self::back_to`].
    pub(super) fn mark(&self) -> usize {
        self.at
    }

    /// Goes back to where it was.
    pub(super) fn back_to(&mut self, mark: usize) {
        self.at = mark;
    }

    pub(super) fn word(&self) -> Option<&str> {
        self.word_after(0)
    }

    /// The word `skip` tokens ahead.
    pub(super) fn word_after(&self, skip: usize) -> Option<&str> {
        match self.tokens.get(self.at + skip) {
            Some((Token::Word(word), _)) => Some(word),
            _ => None,
        }
    }

    pub(super) fn sign(&self) -> Option<char> {
        self.sign_after(0)
    }

    /// The sign `skip` tokens ahead.
    pub(super) fn sign_after(&self, skip: usize) -> Option<char> {
        match self.tokens.get(self.at + skip) {
            Some((Token::Sign(sign), _)) => Some(*sign),
            _ => None,
        }
    }

    pub(super) fn advance(&mut self, count: usize) {
        self.at = (self.at + count).min(self.tokens.len());
    }

    /// Passes over one of these words.
    pub(super) fn take_word(&mut self, words: &[&str]) -> bool {
        let found = self.word().is_some_and(|word| words.contains(&word));
        self.advance(usize::from(found));
        found
    }

    /// Passes over a sign.
    pub(super) fn take_sign(&mut self, sign: char) -> bool {
        let found = self.sign() == Some(sign);
        self.advance(usize::from(found));
        found
    }

    /// Passes over commas and the like between the parts of a row.
    pub(super) fn skip_separators(&mut self) {
        while matches!(self.sign(), Some(',' | ';' | '.')) || matches!(self.word(), Some("and" | "then")) {
            self.advance(1);
        }
    }

    /// Passes over a count.
    pub(super) fn number(&mut self, expected: &'static str) -> Parsed<u64> {
        match self.word() {
            Some(word) if word.starts_with(|c: char| c.is_ascii_digit()) => {
                let number = self.count(word)?;
                self.advance(1);
                Ok(number)
            }
            _ => Err(self.expected(expected)),
        }
    }

    /// Checks digits as a count from 1 to [`Chart::MAX_LOOPS`].
    pub(super) fn count(&self, digits: &str) -> Parsed<u64> {
        match digits.parse() {
            Ok(number) if (1..=Chart::MAX_LOOPS).contains(&number) => Ok(number),
            _ => {
                let found = shortened(digits);
                Err(self.error(InstructionErrorReason::Count { found }))
            }
        }
    }

    /// The place of the next token, or the end of the line.
    pub(super) fn place(&self) -> Range<usize> {
        let token = self.tokens.get(self.at);
        token.map_or(self.end..self.end, |(_, place)| place.clone())
    }

    /// The end of the token before.
    pub(super) fn end_of_last(&self) -> usize {
        match self.at.checked_sub(1) {
            Some(last) => self.tokens[last].1.end,
            None => self.place().start,
        }
    }

    /// The text of a place, shortened for messages.
    pub(super) fn source(&self, place: &Range<usize>) -> String {
        shortened(&self.text[place.clone()])
    }

    pub(super) fn error(&self, reason: InstructionErrorReason) -> InstructionError {
        self.error_at(self.place(), reason)
    }

    pub(super) fn error_at(&self, place: Range<usize>, reason: InstructionErrorReason) -> InstructionError {
        InstructionError::new(place, self.row, reason)
    }

    pub(super) fn expected(&self, expected: &'static str) -> InstructionError {
        let found = if self.is_empty() {
            "the end of the line".to_owned()
        } else {
            format!("`{}`", self.source(&self.place()))
        };
        self.error(InstructionErrorReason::Expected { expected, found })
    }
}

/// The first forty characters.
pub(crate) fn shortened(text: &str) -> String {
    match text.char_indices().nth(40) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}
