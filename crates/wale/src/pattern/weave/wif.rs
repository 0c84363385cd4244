//! WIF, the Weaving Information File of 1997, with the dialects that programs write.

use std::collections::BTreeMap;
use std::ops::Range;

use thiserror::Error;

use super::draft::{Draft, DraftError, Thread};
use super::ini::{self, At, Entry, Ini, Section, shortened};
use super::shed::{Lifts, Sheds};
use crate::pattern::remark::Remark;

/// Most bytes of a file.
pub const LARGEST_WIF: usize = 16 << 20;
/// Most shafts or treadles.
const MOST_SHAFTS: u64 = 10_000;

/// What a file says.
#[derive(Clone, PartialEq, Debug)]
pub struct Wif {
    /// The draft.
    pub draft: Draft,
    /// What was unusual but could be read, by line; of lengths of the threads, what a fabric makes of them.
    pub remarks: Vec<Remark>,
}

/// Why bytes are no WIF.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
#[error("line {line}: {reason}")]
pub struct WifError {
    /// Line of the file, from 1.
    pub line: usize,
    /// The bytes that are wrong, of the file as [`String::from_utf8_lossy`] reads it.
    pub span: Range<usize>,
    /// What is wrong.
    pub reason: Box<WifErrorReason>,
}

/// What is wrong with a file.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
pub enum WifErrorReason {
    /// More than [`LARGEST_WIF`].
    #[error("the file has {bytes} bytes, the limit is {LARGEST_WIF}")]
    TooLong {
        /// Its bytes.
        bytes: usize,
    },
    /// Two bytes a character.
    #[error("the file is in UTF-16; save it as plain text (ASCII or UTF-8)")]
    Utf16,
    /// No section `[WIF]`.
    #[error("this is no WIF: there is no section [WIF]")]
    NoWif,
    /// A section that is needed.
    #[error("there is no section [{section}], which says {says}")]
    NoSection {
        /// Its name.
        section: &'static str,
        /// What it says.
        says: &'static str,
    },
    /// A key that is needed.
    #[error("section [{section}] does not say {key}")]
    NoKey {
        /// The section.
        section: String,
        /// The key.
        key: &'static str,
    },
    /// A value that is not what it should be.
    #[error("`{value}` is no {expected}")]
    Value {
        /// The value.
        value: String,
        /// What it should be.
        expected: &'static str,
    },
    /// Two values for one key.
    #[error("[{section}] {key} was given as `{first}` at line {since} and is given as `{second}` here", first = .values[0], second = .values[1])]
    Conflict {
        /// The section.
        section: String,
        /// The key.
        key: String,
        /// Both values.
        values: [String; 2],
        /// Line of the first.
        since: usize,
    },
    /// A number that is larger than there are.
    #[error("{what} {number} does not exist: there are {count}")]
    Beyond {
        /// A thread, shaft, treadle or colour.
        what: &'static str,
        /// Its number.
        number: u64,
        /// How many there are.
        count: u64,
    },
    /// A colour that is not in the table.
    #[error("colour {number} is not in [COLOR TABLE]")]
    Color {
        /// Its number.
        number: u64,
    },
    /// Too many threads, shafts or treadles.
    #[error("{0}")]
    Size(#[from] DraftError),
    /// Too many shafts or treadles.
    #[error("{count} {what} are more than {MOST_SHAFTS}")]
    TooMany {
        /// Shafts or treadles.
        what: &'static str,
        /// How many.
        count: u64,
    },
}

use WifErrorReason as Reason;

type Parsed<T> = Result<T, WifError>;

/// Reads a file.
///
/// # Errors
/// With the line, if it is no WIF, contradicts itself, names threads, shafts, treadles or colours that do not exist, or
/// asks for too much; sizes are checked before anything is allocated for them.
pub fn read_wif(bytes: &[u8]) -> Parsed<Wif> {
    let nowhere = At { line: 1, span: 0..0 };
    if bytes.len() > LARGEST_WIF {
        return Err(nowhere.error(Reason::TooLong { bytes: bytes.len() }));
    }
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) || bytes.iter().take(64).any(|b| *b == 0) {
        return Err(nowhere.error(Reason::Utf16));
    }
    // Titles and notes come in whatever code page; all that counts is ASCII.
    let text = String::from_utf8_lossy(bytes);
    let mut file = File { ini: ini::read(&text)? };
    if !file.ini.sections.contains_key("WIF") {
        let first_line = text.lines().next().unwrap_or_default();
        return Err(At { line: 1, span: 0..first_line.len() }.error(Reason::NoWif));
    }
    let draft = file.draft()?;
    Ok(Wif { draft, remarks: file.ini.remarks.sorted() })
}

struct File {
    ini: Ini,
}

/// What the sections WARP and WEFT say of their threads.
struct Threads {
    count: usize,
    threads: Vec<Thread>,
}

impl File {
    fn section(&self, name: &'static str, says: &'static str) -> Parsed<&Section> {
        self.ini.sections.get(name).ok_or_else(|| self.missing(name, says))
    }

    /// A section that is not there stands nowhere: the place is where the contents promise it, or else the file's head.
    fn missing(&self, section: &'static str, says: &'static str) -> WifError {
        let sections = &self.ini.sections;
        let promised = sections.get("CONTENTS").and_then(|contents| contents.entries.get(&section.to_lowercase()));
        let at = promised.map_or(&sections["WIF"].at, |entry| &entry.at);
        at.error(Reason::NoSection { section, says })
    }

    fn draft(&mut self) -> Parsed<Draft> {
        let weaving = self.section("WEAVING", "how many shafts there are")?;
        let shafts = count(weaving, "WEAVING", "shafts", "Shafts")?;
        let treadles = weaving.entries.get("treadles").map_or(Ok(shafts), number)?;
        for (what, found) in [("shafts", shafts), ("treadles", treadles)] {
            if found > MOST_SHAFTS {
                return Err(weaving.at.error(Reason::TooMany { what, count: found }));
            }
        }
        let rising = weaving.entries.get("rising shed").map_or(Ok(true), boolean)?;
        let colors = self.colors()?;
        let ends = count(self.section("WARP", "how many warp ends there are")?, "WARP", "threads", "Threads")?;
        let weft = self.section("WEFT", "how many weft picks there are")?;
        let picks = count(weft, "WEFT", "threads", "Threads")?;
        Draft::check_size(ends, picks).map_err(|size| weft.entries["threads"].at.error(Reason::Size(size)))?;
        let warp = self.threads("WARP", ends, &colors)?;
        let weft = self.threads("WEFT", picks, &colors)?;
        let threading = self.section("THREADING", "which shaft each end is on")?.clone();
        let threading = self.lists("THREADING", &threading, ("end", ends), ("shaft", shafts))?;
        let sheds = Sheds::new(warp.count, shafts as usize, &threading);
        let lifts = self.lifts(picks, shafts, treadles)?;
        let warp_up = (1..=picks).map(|pick| sheds.warp_up(&lifts.at(pick), rising)).collect();
        let mut draft = Draft::new(warp_up).map_err(|size| At { line: 1, span: 0..0 }.error(Reason::Size(size)))?;
        (draft.warp, draft.weft) = (warp.threads, weft.threads);
        Ok(draft)
    }

    /// What lifts shafts at every pick: the lift plan, or the treadles that are pressed.
    fn lifts(&mut self, picks: u64, shafts: u64, treadles: u64) -> Parsed<Lifts> {
        let plan = self.ini.sections.get("LIFTPLAN").filter(|plan| !plan.entries.is_empty()).cloned();
        let treadling = self.ini.sections.get("TREADLING").filter(|plan| !plan.entries.is_empty()).cloned();
        match (plan, treadling) {
            (Some(plan), treadling) => {
                if treadling.is_some() {
                    let what = || "both a lift plan and treadling: the lift plan counts".to_owned();
                    self.ini.remarks.add(plan.at.line, what);
                }
                let lifted = self.lists("LIFTPLAN", &plan, ("pick", picks), ("shaft", shafts))?;
                Ok(Lifts::new(shafts as usize, lifted, None))
            }
            (None, Some(treadling)) => {
                let tieup = self.section("TIEUP", "which shafts each treadle lifts")?.clone();
                let tieup = self.lists("TIEUP", &tieup, ("treadle", treadles), ("shaft", shafts))?;
                let pressed = self.lists("TREADLING", &treadling, ("pick", picks), ("treadle", treadles))?;
                Ok(Lifts::new(shafts as usize, pressed, Some(tieup)))
            }
            (None, None) => Err(self.missing("TREADLING", "what is woven (nor is there a [LIFTPLAN])")),
        }
    }

    /// Lines `thread=number,number…` of a section; zeros and empty values are none.
    fn lists(
        &mut self,
        name: &str,
        section: &Section,
        (key_is, keys): (&'static str, u64),
        (value_is, values): (&'static str, u64),
    ) -> Parsed<BTreeMap<u64, Vec<u64>>> {
        let mut found = BTreeMap::new();
        for (key, entry) in &section.entries {
            let key: u64 = key.parse().map_err(|_| {
                entry.at.error(Reason::Value { value: shortened(key), expected: "number of a thread, treadle or pick" })
            })?;
            let mut list = Vec::new();
            for number in entry.value.split(',').map(str::trim).filter(|number| !number.is_empty()) {
                let number: u64 = number.parse().map_err(|_| {
                    entry.at.error(Reason::Value { value: shortened(number), expected: "whole number" })
                })?;
                if number > values {
                    return Err(entry.at.error(Reason::Beyond { what: value_is, number, count: values }));
                }
                if number > 0 {
                    list.push(number);
                }
            }
            list.sort_unstable();
            list.dedup();
            found.insert(key, (list, entry.at.clone()));
        }
        // Some programs count from 0.
        if found.contains_key(&0) && !found.contains_key(&keys) {
            self.ini.remarks.add(section.at.line, || format!("[{name}] counts from 0"));
            found = found.into_iter().map(|(key, value)| (key.saturating_add(1), value)).collect();
        }
        let mut lists = BTreeMap::new();
        for (key, (list, at)) in found {
            if key == 0 || key > keys {
                // Programs tie up treadles that no loom of the file has; only pressing one is an error.
                if list.is_empty() || key_is == "treadle" {
                    self.ini.remarks.add(at.line, || format!("there is no {key_is} {key}"));
                    continue;
                }
                return Err(at.error(Reason::Beyond { what: key_is, number: key, count: keys }));
            }
            lists.insert(key, list);
        }
        Ok(lists)
    }

    /// The colours of the table.
    fn colors(&self) -> Parsed<BTreeMap<u64, [u8; 3]>> {
        let mut range = [0.0, 255.0];
        if let Some(entry) = self.ini.sections.get("COLOR PALETTE").and_then(|palette| palette.entries.get("range")) {
            let bounds = numbers::<2>(entry)?;
            if bounds[1] > bounds[0] {
                range = bounds;
            }
        }
        let mut colors = BTreeMap::new();
        for (key, entry) in self.ini.sections.get("COLOR TABLE").into_iter().flat_map(|table| &table.entries) {
            let value = || entry.at.error(Reason::Value { value: shortened(key), expected: "number of a colour" });
            let key: u64 = key.parse().map_err(|_| value())?;
            let rgb = numbers::<3>(entry)?;
            if rgb.iter().any(|channel| !(range[0]..=range[1]).contains(channel)) {
                let expected = "colour within the palette's Range";
                return Err(entry.at.error(Reason::Value { value: shortened(&entry.value), expected }));
            }
            colors.insert(key, rgb.map(|channel| (255.0 * (channel - range[0]) / (range[1] - range[0])).round() as u8));
        }
        Ok(colors)
    }

    fn threads(&mut self, name: &'static str, count: u64, colors: &BTreeMap<u64, [u8; 3]>) -> Parsed<Threads> {
        let section = self.section(name, "how many threads there are")?.clone();
        let own = |suffix: &str| self.ini.sections.get(&format!("{name} {suffix}"));
        let color_of = |entry: &Entry| -> Parsed<Option<[u8; 3]>> {
            let first = entry.value.split(',').next().unwrap_or_default().trim();
            if first.is_empty() {
                return Ok(None);
            }
            let value = || entry.at.error(Reason::Value { value: shortened(first), expected: "number of a colour" });
            let number: u64 = first.parse().map_err(|_| value())?;
            match colors.get(&number) {
                Some(color) => Ok(Some(*color)),
                None if number == 0 || colors.is_empty() => Ok(None),
                None => Err(entry.at.error(Reason::Color { number })),
            }
        };
        let unit = match section.entries.get("units").map(|entry| (entry.value.trim().to_lowercase(), &entry.at)) {
            None => None,
            Some((unit, at)) => Some(match unit.as_str() {
                "centimeters" | "centimetres" | "cm" => 0.01,
                "inches" | "inch" | "in" => 0.0254,
                "decipoints" => 0.0254 / 720.0,
                _ => {
                    let expected = "unit; WIF has centimeters, inches and decipoints";
                    return Err(at.error(Reason::Value { value: shortened(&unit), expected }));
                }
            }),
        };
        let length = |entry: Option<&Entry>| -> Parsed<Option<f64>> {
            let Some(entry) = entry.filter(|entry| !entry.value.is_empty()) else { return Ok(None) };
            let value = || entry.at.error(Reason::Value { value: shortened(&entry.value), expected: "length" });
            let number: f64 = entry.value.parse().map_err(|_| value())?;
            let length = unit.map(|unit| number * unit);
            if number.is_finite() && number >= 0.0 { Ok(length.filter(|length| *length > 0.0)) } else { Err(value()) }
        };
        let default = Thread {
            yarn: u8::from(name == "WEFT"),
            color: section.entries.get("color").map_or(Ok(None), color_of)?,
            spacing: length(section.entries.get("spacing"))?,
            thickness: length(section.entries.get("thickness"))?,
        };
        // Checked against the limit of crossings before.
        let mut threads = vec![default; count as usize];
        for suffix in ["COLORS", "SPACING", "THICKNESS"] {
            for (key, entry) in own(suffix).into_iter().flat_map(|section| &section.entries) {
                let value = || entry.at.error(Reason::Value { value: shortened(key), expected: "number of a thread" });
                let number: u64 = key.parse().map_err(|_| value())?;
                let Some(thread) = number.checked_sub(1).and_then(|at| threads.get_mut(at as usize)) else {
                    let what = if name == "WARP" { "end" } else { "pick" };
                    return Err(entry.at.error(Reason::Beyond { what, number, count }));
                };
                match suffix {
                    "COLORS" => thread.color = color_of(entry)?.or(thread.color),
                    "SPACING" => thread.spacing = length(Some(entry))?.or(thread.spacing),
                    _ => thread.thickness = length(Some(entry))?.or(thread.thickness),
                }
            }
        }
        self.remark_on_lengths(name, &section, unit.is_some(), &threads);
        Ok(Threads { count: count as usize, threads })
    }

    /// What the file says of its threads' lengths and a fabric does not take, or not as it is said.
    fn remark_on_lengths(&mut self, name: &str, section: &Section, has_units: bool, threads: &[Thread]) {
        let Ini { sections, remarks } = &mut self.ini;
        // The first line that gives one: that of all threads, or that of one.
        let first = |key: &str| {
            let own = sections.get(&format!("{name} {}", key.to_uppercase()));
            let said = section.entries.get(key).into_iter().chain(own.into_iter().flat_map(|own| own.entries.values()));
            said.filter(|entry| entry.value.parse().is_ok_and(|length: f64| length > 0.0))
                .map(|entry| entry.at.line)
                .min()
        };
        if let Some(line) = first("spacing") {
            if !has_units {
                remarks.add(line, || format!("[{name}] has no Units, so that its spacing is passed over"));
            } else if threads.windows(2).any(|pair| pair[0].spacing != pair[1].spacing) {
                let what = || {
                    format!(
                        "the threads of [{name}] are not evenly spaced: a fabric has their mean everywhere, or the scene's sett"
                    )
                };
                remarks.add(line, what);
            }
        }
        if let Some(line) = first("thickness") {
            remarks.add(line, || format!("thickness of [{name}] is passed over: the yarns say how thick they are"));
        }
    }
}

fn count(section: &Section, name: &str, key: &str, shown: &'static str) -> Parsed<u64> {
    let entry = section.entries.get(key);
    let entry = entry.ok_or_else(|| section.at.error(Reason::NoKey { section: name.to_owned(), key: shown }))?;
    number(entry)
}

fn number(entry: &Entry) -> Parsed<u64> {
    let value = || entry.at.error(Reason::Value { value: shortened(&entry.value), expected: "whole number" });
    entry.value.parse().map_err(|_| value())
}

fn boolean(entry: &Entry) -> Parsed<bool> {
    match entry.value.to_lowercase().as_str() {
        "true" | "on" | "yes" | "1" | "t" | "y" => Ok(true),
        "false" | "off" | "no" | "0" | "f" | "n" => Ok(false),
        _ => Err(entry.at.error(Reason::Value { value: shortened(&entry.value), expected: "yes or no" })),
    }
}

/// So many numbers with commas between them.
fn numbers<const N: usize>(entry: &Entry) -> Parsed<[f64; N]> {
    let value = || {
        let expected = if N == 2 { "pair of numbers" } else { "red, green and blue" };
        entry.at.error(Reason::Value { value: shortened(&entry.value), expected })
    };
    let list: Result<Vec<f64>, _> = entry.value.split(',').map(|number| number.trim().parse::<f64>()).collect();
    let list = list.map_err(|_| value())?;
    let list: [f64; N] = list.try_into().map_err(|_| value())?;
    if list.iter().all(|number| number.is_finite()) { Ok(list) } else { Err(value()) }
}
