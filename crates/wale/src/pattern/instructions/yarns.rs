//! The yarns that instructions name: `with B`.

use super::lexer::Line;
use super::{InstructionError, InstructionErrorReason as Reason, MOST_YARNS};

/// The yarns named so far, and the one in hand.
#[derive(Default)]
pub(super) struct Yarns {
    /// In upper case, in the order in which they come.
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

    /// `with B`, `with yarn B`, `change to B`, `join B`: takes a yarn in hand.
    pub fn switch(&mut self, line: &mut Line<'_>) -> Result<u8, InstructionError> {
        line.advance(1);
        line.take_word(&["to", "in"]);
        line.take_word(&["yarn", "color", "colour"]);
        self.name(line)
    }

    fn name(&mut self, line: &mut Line<'_>) -> Result<u8, InstructionError> {
        let Some(name) = line.word().map(str::to_uppercase) else { return Err(line.expected("the name of a yarn")) };
        let known = self.names.iter().position(|known| *known == name);
        let index = known.unwrap_or(self.names.len());
        if index == MOST_YARNS {
            return Err(line.error(Reason::Yarns));
        }
        if known.is_none() {
            self.names.push(name);
        }
        line.advance(1);
        // Below sixteen.
        self.current = index as u8;
        Ok(self.current)
    }
}
