//! The lines of a text of instructions, and the rows they amount to.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::ops::Range;

use super::alternate::{self, Alternates};
use super::lexer::Line;
use super::parts::{Row, work};
use super::row;
use super::yarns::Yarns;
use super::{InstructionError, InstructionErrorReason as Reason, Written};
use crate::pattern::chart::Chart;
use crate::pattern::stitch::Stitch;
use crate::pattern::working::{Side, Working};

type Parsed<T> = Result<T, InstructionError>;

/// What some rows are said to be.
enum Body {
    /// What is worked in the row.
    Parts(Row),
    /// The same as these earlier rows, in turn.
    Again { first: u64, last: u64 },
}

/// A range of rows with one body.
pub(super) struct Rows {
    pub first: u64,
    pub last: u64,
    pub body: usize,
    pub place: Range<usize>,
}

/// All that the lines have said so far.
#[derive(Default)]
struct Reader {
    cast_on: Option<u64>,
    /// Whether rounds were seen (`true`), or rows.
    round: Option<bool>,
    bodies: Vec<Body>,
    rows: Vec<Rows>,
    /// The last row so far.
    last: u64,
    alternates: Alternates,
    /// Rows that are said to be a repeat, without a count.
    open_repeat: Option<(u64, u64, Range<usize>)>,
    /// The first line that says its side: the row's number, and the side.
    side: Option<(u64, Side)>,
    yarns: Yarns,
}

pub(super) fn read(text: &str, columns: Option<usize>) -> Parsed<Written> {
    let mut reader = Reader::default();
    let mut start = 0;
    for raw in text.split_inclusive('\n') {
        let end = start + raw.trim_end_matches(['\n', '\r']).len();
        let mut line = Line::new(text, start, end);
        if !line.is_empty() {
            reader.line(&mut line)?;
        }
        start += raw.len();
    }
    reader.finish(columns)
}

impl Reader {
    fn line(&mut self, line: &mut Line<'_>) -> Parsed<()> {
        match (line.word(), line.word_after(1)) {
            (Some("cast"), Some("on")) => self.cast_on(line),
            (Some("bind" | "cast"), Some("off")) => Ok(()),
            (Some("join"), Some("in" | "to") | None) => self.work_in(line, true),
            (Some("row" | "rows"), _) => self.row(line, false),
            (Some("rnd" | "rnds" | "round" | "rounds"), _) => self.row(line, true),
            (Some("rep" | "repeat"), _) => self.append(line),
            (Some("yarns" | "colors" | "colours"), _) => self.yarns.declare(line),
            (Some("with" | "change" | "join"), _) => {
                self.yarns.switch(line)?;
                line.skip_separators();
                if line.is_empty() { Ok(()) } else { Err(line.expected("the end of the line")) }
            }
            _ => {
                let found = line.source(&line.place());
                Err(line.error(Reason::UnknownLine { found }))
            }
        }
    }

    fn cast_on(&mut self, line: &mut Line<'_>) -> Parsed<()> {
        if self.cast_on.is_some() {
            return Err(line.error(Reason::SecondCastOn));
        }
        line.advance(2);
        self.cast_on = Some(line.number("the number of stitches")?);
        line.take_word(&["st", "sts", "stitch", "stitches"]);
        line.skip_separators();
        if line.word() == Some("join") {
            self.work_in(line, true)?;
        } else if !line.is_empty() {
            return Err(line.expected("the end of the line"));
        }
        Ok(())
    }

    fn work_in(&mut self, line: &Line<'_>, round: bool) -> Parsed<()> {
        if *self.round.get_or_insert(round) == round { Ok(()) } else { Err(line.error(Reason::MixedWorking)) }
    }

    /// `Rows 1, 3 and 5-7 (RS): …`, `Row 2 (WS) and all WS rows: …`.
    fn row(&mut self, line: &mut Line<'_>, round: bool) -> Parsed<()> {
        self.work_in(line, round)?;
        line.advance(1);
        let body = self.bodies.len();
        let first_of_line = self.rows.len();
        loop {
            let place = line.place();
            let (first, last) = range(line)?;
            self.rows.push(Rows { first, last, body, place });
            self.last = self.last.max(last);
            line.row.get_or_insert(first);
            if self.alternate_rows(line, round)? || !(line.take_sign(',') | line.take_word(&["and"])) {
                break;
            }
        }
        if line.sign() == Some('(') && line.word_after(1) == Some("and") {
            line.advance(1);
            self.alternate_rows(line, round)?;
            if !line.take_sign(')') {
                return Err(line.expected("`)`"));
            }
        } else if line.take_sign('(') {
            let place = line.place();
            let side = match line.word() {
                Some("rs") => Side::RightSide,
                Some("ws") => Side::WrongSide,
                _ => return Err(line.expected("`RS` or `WS`")),
            };
            line.advance(1);
            if !line.take_sign(')') {
                return Err(line.expected("`)`"));
            }
            for index in first_of_line..self.rows.len() {
                self.check_side(line, index, side, round, &place)?;
            }
            self.alternate_rows(line, round)?;
        }
        if !line.take_sign(':') {
            return Err(line.expected("`:`"));
        }
        let again = matches!(line.word(), Some("rep" | "repeat"))
            || (line.word() == Some("as") && matches!(line.word_after(1), Some("row" | "rnd")));
        let parsed = if again {
            line.advance(1);
            let (first, last) = self.earlier_rows(line)?;
            line.skip_separators();
            if !line.is_empty() {
                return Err(line.expected("the end of the line"));
            }
            Body::Again { first, last }
        } else {
            Body::Parts(row::parse(line, &mut self.yarns)?)
        };
        self.bodies.push(parsed);
        Ok(())
    }

    /// `and all WS rows` behind the number of a row, if that is what stands here.
    fn alternate_rows(&mut self, line: &mut Line<'_>, round: bool) -> Parsed<bool> {
        let comma = usize::from(line.sign() == Some(','));
        if line.word_after(comma) != Some("and") || !matches!(line.word_after(comma + 1), Some("all" | "every")) {
            return Ok(false);
        }
        line.advance(comma + 1);
        let start = line.place().start;
        let called = alternate::called(line)?;
        let place = start..line.end_of_last();
        let index = self.rows.len() - 1;
        let Rows { last: first, body, .. } = self.rows[index];
        if let Some(side) = called.side {
            self.check_side(line, index, side, round, &place)?;
        }
        if called.even.is_some_and(|even| even != (first % 2 == 0)) {
            let rows = line.source(&place);
            return Err(line.error_at(place, Reason::NotAlternate { rows, row: first }));
        }
        self.alternates.say(first, body);
        Ok(true)
    }

    /// Sides alternate from the first one that is stated; in the round there is only the right side.
    fn check_side(
        &mut self,
        line: &Line<'_>,
        index: usize,
        side: Side,
        round: bool,
        place: &Range<usize>,
    ) -> Parsed<()> {
        let rows = &self.rows[index];
        let found = side_name(side);
        let because = if round {
            "rounds are worked from the right side".to_owned()
        } else if rows.first != rows.last {
            "a range of rows has both".to_owned()
        } else {
            let (row, first) = *self.side.get_or_insert((rows.first, side));
            if (side == first) == (row % 2 == rows.first % 2) {
                return Ok(());
            }
            format!("row {row} is a {} row", side_name(first))
        };
        if round && side == Side::RightSide {
            return Ok(());
        }
        Err(line.error_at(place.clone(), Reason::Side { found, because }))
    }

    /// `rows 3-6` after `rep`.
    fn earlier_rows(&self, line: &mut Line<'_>) -> Parsed<(u64, u64)> {
        if !line.take_word(&["row", "rows", "rnd", "rnds", "round", "rounds"]) {
            return Err(line.expected("`rows`"));
        }
        range(line)
    }

    /// `Rep rows 1-4 5 more times`: appends rows. `Rep rows 1-4`: all there are, as often as the scene says.
    fn append(&mut self, line: &mut Line<'_>) -> Parsed<()> {
        let place = line.place();
        line.advance(1);
        let (first, last) = self.earlier_rows(line)?;
        let pattern = line.take_word(&["for"]) && line.take_word(&["pattern", "patt", "pat"]);
        line.skip_separators();
        if pattern || line.is_empty() {
            self.open_repeat = Some((first, last, place.start..line.end_of_last()));
            return if line.is_empty() { Ok(()) } else { Err(line.expected("the end of the line")) };
        }
        let times = if line.take_word(&["once"]) {
            1
        } else if line.take_word(&["twice"]) {
            2
        } else {
            let times = line.number("how many times")?;
            line.take_word(&["more"]);
            if !line.take_word(&["times", "time"]) {
                return Err(line.expected("`times`"));
            }
            times
        };
        line.take_word(&["more"]);
        line.skip_separators();
        if !line.is_empty() {
            return Err(line.expected("the end of the line"));
        }
        // Counts are at most 16 million each, their product far below 2⁶⁴; `finish` limits the sum.
        self.close_pair();
        let before = self.last;
        let after = before.saturating_add((last - first + 1) * times);
        self.last = after;
        self.rows.push(Rows { first: before + 1, last: after, body: self.bodies.len(), place });
        self.bodies.push(Body::Again { first, last });
        Ok(())
    }

    /// Rows come in pairs: the second row of the last one, where it is among the alternate rows.
    fn close_pair(&mut self) {
        let row = self.last + 1;
        if row.is_multiple_of(2)
            && let (Some(body), Some(last)) = (self.alternates.body_of(row), self.rows.last())
        {
            let place = last.place.clone();
            self.rows.push(Rows { first: row, last: row, body, place });
            self.last = row;
        }
    }

    fn finish(mut self, columns: Option<usize>) -> Parsed<Written> {
        let nowhere = |reason| InstructionError::new(0..0, None, reason);
        self.close_pair();
        self.rows = self.alternates.filled(std::mem::take(&mut self.rows));
        let mut count = 0_u64;
        for rows in &self.rows {
            let reason = if rows.first <= count {
                Reason::SecondRow { again: rows.first }
            } else if rows.first > count + 1 {
                Reason::MissingRow { missing: count + 1 }
            } else {
                count = rows.last;
                continue;
            };
            return Err(InstructionError::new(rows.place.clone(), None, reason));
        }
        if count == 0 {
            return Err(nowhere(Reason::NoRows));
        }
        if let Some((first, last, place)) = &self.open_repeat
            && (*first, *last) != (1, count)
        {
            let reason = Reason::OpenRepeat { first: *first, last: *last, count };
            return Err(InstructionError::new(place.clone(), None, reason));
        }
        let total = self.cast_on.or(columns.map(|columns| columns as u64));
        let total = total.ok_or_else(|| nowhere(Reason::NoCastOn))?;
        Chart::check_size(total, count).map_err(|size| nowhere(Reason::Size(size)))?;

        let first_row = match self.side {
            Some((row, side)) if row % 2 == 0 => opposite(side),
            Some((_, side)) => side,
            None => Side::RightSide,
        };
        let working = if self.round == Some(true) { Working::Round } else { Working::Flat { first_row } };
        let cells = self.work(total, count, working)?;
        let chart = Chart::from_cells(cells).map_err(|size| nowhere(Reason::Size(size)))?;
        Ok(Written { chart, working, cast_on: self.cast_on, yarns: self.yarns.names })
    }

    /// All rows as seen from the front. A body of parts is worked once for every number of stitches it is worked on.
    fn work(&self, cast_on: u64, count: u64, working: Working) -> Parsed<Vec<Vec<(Stitch, u8)>>> {
        let mut worked: HashMap<(usize, u64), Vec<(Stitch, u8)>> = HashMap::new();
        // The body of parts behind each row, repeats followed.
        let mut source: Vec<usize> = Vec::new();
        let mut front = Vec::new();
        let (mut total, mut loops) = (cast_on, 0_u64);
        for rows in &self.rows {
            let error = |reason| InstructionError::new(rows.place.clone(), Some(rows.first), reason);
            let repeat = match &self.bodies[rows.body] {
                Body::Parts(_) => None,
                Body::Again { first, last } if *last >= rows.first => {
                    let (first, last) = (*first, *last);
                    return Err(error(Reason::RepeatsLater { first, last }));
                }
                Body::Again { first, last } => {
                    let (length, repeat) = (rows.last - rows.first + 1, last - first + 1);
                    if !length.is_multiple_of(repeat) {
                        return Err(error(Reason::UnevenRepeat { rows: length, repeat }));
                    }
                    Some((*first, repeat))
                }
            };
            for row in rows.first..=rows.last.min(count) {
                let body = match repeat {
                    None => rows.body,
                    Some((first, repeat)) => source[(first - 1 + (row - rows.first) % repeat) as usize],
                };
                source.push(body);
                let stitches = match (worked.entry((body, total)), &self.bodies[body]) {
                    (Entry::Occupied(known), _) => known.into_mut(),
                    (Entry::Vacant(new), Body::Parts(parts)) => new.insert(work(parts, total, row)?),
                    // Repeats are followed to parts.
                    (Entry::Vacant(new), Body::Again { .. }) => new.insert(Vec::new()),
                };
                total = stitches.iter().map(|(stitch, _)| stitch.leaves() as u64).sum();
                loops += total;
                Chart::check_size(loops, 1).map_err(|size| error(Reason::Size(size)))?;
                front.push(seen_from_front(stitches, working.side(row as usize - 1)));
            }
        }
        Ok(front)
    }
}

/// Left to right as seen from the front, from stitches in the order and as seen by the knitter.
fn seen_from_front(worked: &[(Stitch, u8)], side: Side) -> Vec<(Stitch, u8)> {
    match side {
        Side::RightSide => worked.iter().rev().copied().collect(),
        Side::WrongSide => worked.iter().map(|(stitch, yarn)| (stitch.from_behind(), *yarn)).collect(),
    }
}

fn opposite(side: Side) -> Side {
    match side {
        Side::RightSide => Side::WrongSide,
        Side::WrongSide => Side::RightSide,
    }
}

fn side_name(side: Side) -> &'static str {
    match side {
        Side::RightSide => "right-side (RS)",
        Side::WrongSide => "wrong-side (WS)",
    }
}

/// `3` or `3-8`.
fn range(line: &mut Line<'_>) -> Parsed<(u64, u64)> {
    let place = line.place();
    let first = line.number("a row number")?;
    if !(line.take_sign('-') || line.take_word(&["to"])) {
        return Ok((first, first));
    }
    let last = line.number("a row number")?;
    if last < first {
        let found = format!("{first}-{last}");
        let reason = Reason::Expected { expected: "rows in ascending order", found };
        return Err(line.error_at(place.start..line.end_of_last(), reason));
    }
    Ok((first, last))
}
