//! `Row 2 and all WS rows: purl`: every second row that no line says.

use std::collections::BTreeMap;

use super::InstructionError;
use super::file::Rows;
use super::lexer::Line;
use crate::pattern::working::Side;

/// What is worked in every second row from one on: of odd rows, and of even ones.
#[derive(Default)]
pub(super) struct Alternates([BTreeMap<u64, usize>; 2]);

impl Alternates {
    /// A row is said with those that alternate from it.
    pub fn say(&mut self, row: u64, body: usize) {
        self.0[(row % 2) as usize].insert(row, body);
    }

    /// What is worked in a row that no line says.
    pub fn body_of(&self, row: u64) -> Option<usize> {
        self.0[(row % 2) as usize].range(..row).next_back().map(|(_, body)| *body)
    }

    /// The rows in their order, and those between them that are said as alternate ones. A gap is one row at most, so that there
    /// are no more new rows than lines.
    pub fn filled(&self, mut rows: Vec<Rows>) -> Vec<Rows> {
        rows.sort_by_key(|rows| rows.first);
        let mut filled: Vec<Rows> = Vec::with_capacity(rows.len());
        for rows in rows {
            let missing = filled.last().map_or(0, |last| last.last) + 1;
            if rows.first == missing + 1
                && let Some(body) = self.body_of(missing)
            {
                filled.push(Rows { first: missing, last: missing, body, place: rows.place.clone() });
            }
            filled.push(rows);
        }
        filled
    }
}

/// What the words after `and` call the rows.
#[derive(Default)]
pub(super) struct Called {
    pub side: Option<Side>,
    /// Whether their numbers are even.
    pub even: Option<bool>,
}

/// `all WS rows`, `every alternate row`, `all following even-numbered rnds`, behind `all` or `every`.
pub(super) fn called(line: &mut Line<'_>) -> Result<Called, InstructionError> {
    let mut called = Called::default();
    let mut known = false;
    let every = line.word() == Some("every");
    line.advance(1);
    loop {
        match line.word() {
            Some("ws" | "wrong") => called.side = Some(Side::WrongSide),
            Some("rs" | "right") => called.side = Some(Side::RightSide),
            Some("even") => called.even = Some(true),
            Some("odd") => called.even = Some(false),
            Some("alternate" | "alt") => {}
            // `all other rows` are not every second one; `all other WS rows` are.
            Some("other" | "following" | "foll" | "remaining" | "rem") => {
                known |= every && line.word() == Some("other");
                line.advance(1);
                continue;
            }
            _ => break,
        }
        known = true;
        line.advance(1);
        line.take_sign('-');
        line.take_word(&["side", "numbered"]);
    }
    if !known || !line.take_word(&["row", "rows", "rnd", "rnds", "round", "rounds"]) {
        return Err(line.expected("`WS rows`, `even rows` or `alternate rows`"));
    }
    Ok(called)
}
