//! The lines of a program.

use std::ops::Range;
use std::sync::Arc;

use super::beds::{FARTHEST_RACK, Needle};
use super::{KnitoutError, KnitoutErrorReason as Reason, LONGEST_NAME, MOST_CARRIERS, MOST_EXTENSIONS, Remark};
use crate::pattern::instructions::shortened;

/// A program line by line; what moves no loop is left out.
pub(super) struct Program {
    /// Carriers that the header names, if it does.
    pub carriers: Option<Vec<String>>,
    pub lines: Vec<Line>,
    pub remarks: Vec<Remark>,
}

pub(super) struct Line {
    pub operation: Operation,
    pub place: Place,
}

/// Where a line stands, for errors.
#[derive(Clone, Debug)]
pub(super) struct Place {
    pub line: usize,
    pub span: Range<usize>,
    /// Shared by all lines that follow the note.
    pub source_note: Option<Arc<str>>,
}

impl Place {
    pub fn error(&self, reason: Reason) -> KnitoutError {
        let (line, span) = (self.line, self.span.clone());
        let source_note = self.source_note.as_deref().map(str::to_owned);
        KnitoutError { line, span, reason: Box::new(reason), source_note }
    }
}

pub(super) enum Operation {
    In { carriers: Vec<String>, hook: bool },
    Out { carriers: Vec<String>, hook: bool },
    Release { carriers: Vec<String> },
    Rack(f64),
    Knit { rightward: bool, needle: Needle, carriers: Vec<String> },
    Tuck { rightward: bool, needle: Needle, carriers: Vec<String> },
    Split { rightward: bool, needle: Needle, to: Needle, carriers: Vec<String> },
    Miss { carriers: Vec<String> },
    Transfer { from: Needle, to: Needle },
    Drop { needle: Needle },
}

type Parsed<T> = Result<T, KnitoutError>;

pub(super) fn read(text: &str) -> Parsed<Program> {
    let mut program = Program { carriers: None, lines: Vec::new(), remarks: Vec::new() };
    let mut source_note: Option<Arc<str>> = None;
    let mut header = true;
    let mut extensions = std::collections::BTreeSet::new();
    let mut start = 0;
    for (index, raw) in text.split_inclusive('\n').enumerate() {
        let line = raw.trim_end_matches(['\n', '\r']);
        let span = start..start + line.len();
        start += raw.len();
        let mut place = Place { line: index + 1, span: span.clone(), source_note: None };
        if index == 0 {
            let digits = line.trim_start_matches('\u{feff}').strip_prefix(";!knitout-").map(str::trim_end);
            let version = digits.filter(|digits| !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit()));
            let version = version.ok_or_else(|| place.error(Reason::Magic))?;
            if version != "2" {
                let what = format!("knitout of version {version} is read as version 2");
                program.remarks.push(Remark { line: 1, what });
            }
            continue;
        }
        if header && let Some(entry) = line.strip_prefix(";;") {
            if let Some(names) = entry.strip_prefix("Carriers:") {
                let names = names.split([' ', '\t', ',', ';']).filter(|name| !name.is_empty());
                program.carriers = Some(carriers_of(names, &place)?);
            }
            continue;
        }
        header = false;
        let (code, comment) = line.split_once(';').unwrap_or((line, ""));
        if let Some(note) = comment.strip_prefix("!source:") {
            let note: String = note.trim().chars().take(80).collect();
            source_note = Some(note.into());
        }
        let words: Vec<&str> = code.split_ascii_whitespace().collect();
        let Some((operation, parameters)) = words.split_first() else { continue };
        place.source_note.clone_from(&source_note);
        place.span.end = place.span.start + code.trim_end().len();
        if operation.starts_with("x-") {
            if extensions.len() < MOST_EXTENSIONS && extensions.insert(*operation) {
                let what = format!("the extension `{}` is passed over", shortened(operation));
                program.remarks.push(Remark { line: place.line, what });
            }
            continue;
        }
        if let Some(operation) = parse(operation, parameters, &place)? {
            program.lines.push(Line { operation, place });
        }
    }
    if start == 0 {
        return Err(Place { line: 1, span: 0..0, source_note: None }.error(Reason::Magic));
    }
    if program.carriers.is_none() {
        program.remarks.push(Remark { line: 1, what: "the header names no carriers".to_owned() });
    }
    Ok(program)
}

/// The names of carriers, which are few and short.
fn carriers_of<'a>(names: impl Iterator<Item = &'a str> + Clone, place: &Place) -> Parsed<Vec<String>> {
    let count = names.clone().count();
    if count > MOST_CARRIERS {
        return Err(place.error(Reason::TooManyCarriers { count }));
    }
    match names.clone().find(|name| name.chars().nth(LONGEST_NAME).is_some()) {
        Some(name) => Err(place.error(Reason::CarrierName { carrier: shortened(name) })),
        None => Ok(names.map(str::to_owned).collect()),
    }
}

/// The operation of a line; `None` where it moves no loop and no carrier.
fn parse(word: &str, parameters: &[&str], place: &Place) -> Parsed<Option<Operation>> {
    let needs = |operation: &'static str, needs: &'static str| place.error(Reason::Parameters { operation, needs });
    let needle = |text: &str| Needle::read(text).ok_or_else(|| place.error(Reason::Needle { needle: shortened(text) }));
    let direction = |text: &str| match text {
        "+" => Some(true),
        "-" => Some(false),
        _ => None,
    };
    let owned = |words: &[&str]| carriers_of(words.iter().copied(), place);
    let carriers = |operation| {
        if parameters.is_empty() { Err(needs(operation, "the carriers")) } else { owned(parameters) }
    };
    Ok(Some(match word {
        "in" => Operation::In { carriers: carriers("in")?, hook: false },
        "inhook" => Operation::In { carriers: carriers("inhook")?, hook: true },
        "out" => Operation::Out { carriers: carriers("out")?, hook: false },
        "outhook" => Operation::Out { carriers: carriers("outhook")?, hook: true },
        "releasehook" => Operation::Release { carriers: carriers("releasehook")? },
        "stitch" => match parameters {
            [a, b] if a.parse::<f64>().is_ok() && b.parse::<f64>().is_ok() => return Ok(None),
            _ => return Err(needs("stitch", "two numbers")),
        },
        "pause" => return Ok(None),
        "rack" => match parameters {
            [by] => {
                let rack = by.parse::<f64>().ok().filter(|rack| rack.abs() <= FARTHEST_RACK);
                Operation::Rack(rack.ok_or_else(|| place.error(Reason::Rack { rack: shortened(by) }))?)
            }
            _ => return Err(needs("rack", "one number of needles")),
        },
        "knit" | "tuck" | "miss" => {
            let operation = match word {
                "knit" => "knit",
                "tuck" => "tuck",
                _ => "miss",
            };
            let [way, at, feed @ ..] = parameters else {
                return Err(needs(operation, "a direction (+ or -), a needle and carriers"));
            };
            let rightward = direction(way).ok_or_else(|| needs(operation, "a direction (+ or -) first"))?;
            let (needle, carriers) = (needle(at)?, owned(feed)?);
            match (word, carriers.is_empty()) {
                ("knit", true) => Operation::Drop { needle },
                ("knit", false) => Operation::Knit { rightward, needle, carriers },
                // A tuck of nothing only moves the needle.
                ("tuck", true) => return Ok(None),
                ("tuck", false) => Operation::Tuck { rightward, needle, carriers },
                (_, true) => return Err(needs("miss", "carriers")),
                (_, false) => Operation::Miss { carriers },
            }
        }
        "split" => {
            let [way, at, to, feed @ ..] = parameters else {
                return Err(needs("split", "a direction (+ or -), two needles and carriers"));
            };
            let rightward = direction(way).ok_or_else(|| needs("split", "a direction (+ or -) first"))?;
            let (needle, to, carriers) = (needle(at)?, needle(to)?, owned(feed)?);
            if carriers.is_empty() {
                Operation::Transfer { from: needle, to }
            } else {
                Operation::Split { rightward, needle, to, carriers }
            }
        }
        "xfer" => match parameters {
            [from, to] => Operation::Transfer { from: needle(from)?, to: needle(to)? },
            _ => return Err(needs("xfer", "two needles")),
        },
        "drop" => match parameters {
            [at] => Operation::Drop { needle: needle(at)? },
            _ => return Err(needs("drop", "one needle")),
        },
        "amiss" => match parameters {
            [at] => {
                needle(at)?;
                return Ok(None);
            }
            _ => return Err(needs("amiss", "one needle")),
        },
        _ => return Err(place.error(Reason::Operation { word: shortened(word) })),
    }))
}
