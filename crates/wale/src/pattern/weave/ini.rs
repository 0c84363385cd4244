//! The sections and keys of a WIF file, as programs write them: Windows INI with liberties.

use std::collections::BTreeMap;
use std::ops::Range;

use super::wif::{WifError, WifErrorReason as Reason};
use crate::pattern::remark::Remark;

/// A key with its value, both as written.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub value: String,
    pub at: At,
}

/// A line of the file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct At {
    pub line: usize,
    pub span: Range<usize>,
}

impl At {
    pub fn error(&self, reason: Reason) -> WifError {
        WifError { line: self.line, span: self.span.clone(), reason: Box::new(reason) }
    }
}

/// Keys of a section in lower case.
#[derive(Clone, Debug, Default)]
pub(super) struct Section {
    pub at: At,
    pub entries: BTreeMap<String, Entry>,
}

/// The sections by their names in upper case, and what was passed over.
pub(super) struct Ini {
    pub sections: BTreeMap<String, Section>,
    pub remarks: Remarks,
}

/// What was unusual, with its line. A file of sixteen megabytes can be so in every line; the first hundred tell enough.
#[derive(Default)]
pub(super) struct Remarks {
    list: Vec<Remark>,
}

impl Remarks {
    const MOST: usize = 100;

    pub fn add(&mut self, line: usize, what: impl FnOnce() -> String) {
        if self.list.len() < Self::MOST {
            self.list.push(Remark { line, what: what() });
        }
    }

    pub fn sorted(mut self) -> Vec<Remark> {
        self.list.sort();
        self.list
    }
}

/// Reads the lines of a file. A key that is given twice with the same value counts once.
pub(super) fn read(text: &str) -> Result<Ini, WifError> {
    let mut ini = Ini { sections: BTreeMap::new(), remarks: Remarks::default() };
    let mut current: Option<String> = None;
    let mut start = 0;
    for (index, raw) in text.split_inclusive('\n').enumerate() {
        let at = At { line: index + 1, span: start..start + raw.trim_end().len() };
        start += raw.len();
        let line = raw.split(';').next().unwrap_or_default().trim().trim_start_matches('\u{feff}');
        if line.is_empty() {
            continue;
        }
        if let Some(name) = line.strip_prefix('[') {
            let name = name.split(']').next().unwrap_or_default().trim().to_uppercase();
            if ini.sections.contains_key(&name) {
                ini.remarks.add(at.line, || format!("section [{}] goes on here", shortened(&name)));
            }
            ini.sections.entry(name.clone()).or_insert_with(|| Section { at, entries: BTreeMap::new() });
            current = Some(name);
            continue;
        }
        let Some(section) = current.as_ref() else {
            ini.remarks.add(at.line, || "text before the first section is passed over".to_owned());
            continue;
        };
        // Notes and private sections are nobody's business.
        if section == "NOTES" || section.starts_with("PRIVATE") || section == "TEXT" {
            continue;
        }
        let (key, value) = match line.split_once('=') {
            Some((key, value)) => (key.trim(), value.trim()),
            None => {
                ini.remarks.add(at.line, || format!("`{}` has no `=` and counts as empty", shortened(line)));
                (line, "")
            }
        };
        let (key, value) = (key.to_lowercase(), value.to_owned());
        let Some(section_of) = ini.sections.get_mut(section) else { continue };
        match section_of.entries.get(&key) {
            Some(known) if known.value != value && section != "CONTENTS" => {
                let reason = Reason::Conflict {
                    section: shortened(section),
                    key: shortened(&key),
                    values: [shortened(&known.value), shortened(&value)],
                    since: known.at.line,
                };
                return Err(at.error(reason));
            }
            Some(_) => ini.remarks.add(at.line, || format!("`{}` is given twice", shortened(&key))),
            None => {
                section_of.entries.insert(key, Entry { value, at });
            }
        }
    }
    Ok(ini)
}

/// The first forty characters.
pub(super) fn shortened(text: &str) -> String {
    crate::pattern::instructions::shortened(text)
}
