//! The yarns that instructions name: `with B`.

use super::lexer::Line;
use super::{InstructionError, InstructionErrorReason as Reason, MOST_YARNS};

/// The yarns named so far, and the one in hand.
#[derive(Default)]
pub(super) struct Yarns {
    /// In upper case, in the order in which they come; of yarns that are held together those of all, with spaces between.
    pub names: Vec<String>,
    pub current: u8,
}

impl Yarns {
    /// `Yarns A, B`: names them in their order.
    pub fn declare(&mut self, line: &mut Line<'_>) -> Result<(), InstructionError> {
        let current = self.current;
        line.advance(1);
        line.take_sign(':');
        while !line.is_empty() {
            self.name(line)?;
            line.skip_separators();
        }
        self.current = current;
        Ok(())
    }

    /// `with B`, `with yarn B`, `change to B`, `join B`, `with A and B held together`: takes a yarn in hand.
    pub fn switch(&mut self, line: &mut Line<'_>) -> Result<u8, InstructionError> {
        line.advance(1);
        line.take_word(&["to", "in"]);
        line.take_word(&["yarn", "yarns", "color", "colour", "colors", "colours"]);
        match held_together(line) {
            Some((names, tokens)) => {
                let index = self.index_of(names.join(" "), line)?;
                line.advance(tokens);
                Ok(index)
            }
            None => self.name(line),
        }
    }

    fn name(&mut self, line: &mut Line<'_>) -> Result<u8, InstructionError> {
        let Some(name) = line.word().map(str::to_uppercase) else { return Err(line.expected("the name of a yarn")) };
        let index = self.index_of(name, line)?;
        line.advance(1);
        Ok(index)
    }

    fn index_of(&mut self, name: String, line: &Line<'_>) -> Result<u8, InstructionError> {
        let known = self.names.iter().position(|known| *known == name);
        let index = known.unwrap_or(self.names.len());
        if index == MOST_YARNS {
            return Err(line.error(Reason::Yarns));
        }
        if known.is_none() {
            self.names.push(name);
        }
        // Below sixteen.
        self.current = index as u8;
        Ok(self.current)
    }
}

/// Yarns that are held together, and the tokens that say so: `A and B held together`, `A, B and C together`, `A held double`,
/// `two strands of A`, `one strand each of A and B`.
fn held_together(line: &Line<'_>) -> Option<(Vec<String>, usize)> {
    let mut at = 0;
    let strands = |at: usize| matches!(line.word_after(at), Some("strand" | "strands"));
    let mut two_strands = false;
    if strands(1) {
        two_strands = matches!(line.word_after(0), Some("2" | "two"));
        at = 2 + usize::from(line.word_after(2) == Some("each"));
        if line.word_after(at) != Some("of") {
            return None;
        }
        at += 1;
    }
    let mut names = Vec::new();
    // No more than there can be are looked for, so that a long line stays quick to read.
    while names.len() < MOST_YARNS {
        names.push(line.word_after(at)?.to_uppercase());
        at += 1;
        let held = line.word_after(at) == Some("held");
        let word = line.word_after(at + usize::from(held));
        let (together, double) = (word == Some("together"), held && word == Some("double"));
        let end = at + usize::from(held) + 1;
        if names.len() == 1 && (double || two_strands) {
            names.push(names[0].clone());
            return Some((names, if double || together { end } else { at }));
        }
        if names.len() > 1 && together {
            return Some((names, end));
        }
        let separators = |at: usize| usize::from(matches!(line.sign_after(at), Some(',' | '+' | '&')));
        let comma = separators(at);
        let and = usize::from(line.word_after(at + comma) == Some("and"));
        if comma + and == 0 {
            return None;
        }
        at += comma + and;
    }
    None
}
