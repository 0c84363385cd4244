//! A delimited table of numbers, whatever wrote it: commas, semicolons or tabs, decimal points or commas, remarks, a head of
//! names and perhaps a second one of units.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::CurveError;

/// Most bytes of a table.
const LARGEST_FILE: usize = 64 << 20;
/// Most columns.
const MOST_COLUMNS: usize = 1000;

/// A table as it was read.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    file: String,
    /// What separates cells.
    pub delimiter: char,
    /// Whether numbers have a decimal comma.
    pub decimal_comma: bool,
    heads: Vec<String>,
    /// Each row's line, from 1, and cells.
    rows: Vec<(usize, Vec<String>)>,
}

impl Table {
    /// Reads a file.
    ///
    /// # Errors
    /// If it cannot be read, is larger than 64 MiB, no text in UTF-8, or no table.
    pub fn read(path: &Path) -> Result<Self, CurveError> {
        let file = path.display().to_string();
        let error =
            |what: String, mend: &str| CurveError { file: file.clone(), line: None, what, mend: mend.to_owned() };
        let mut bytes = Vec::new();
        File::open(path)
            .and_then(|opened| opened.take(LARGEST_FILE as u64 + 1).read_to_end(&mut bytes))
            .map_err(|failed| error(format!("cannot be read: {failed}"), "name a table of numbers"))?;
        if bytes.len() > LARGEST_FILE {
            return Err(error("is larger than 64 MiB".to_owned(), "thin the curve out"));
        }
        let text = String::from_utf8(bytes)
            .map_err(|_| error("is not text in UTF-8".to_owned(), "save it as CSV in UTF-8"))?;
        Self::from_text(&text, &file)
    }

    /// Reads text; `file` stands in errors.
    ///
    /// # Errors
    /// If it is no table.
    pub fn from_text(text: &str, file: &str) -> Result<Self, CurveError> {
        let error = |line: Option<usize>, what: &str, mend: &str| CurveError {
            file: file.to_owned(),
            line,
            what: what.to_owned(),
            mend: mend.to_owned(),
        };
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let lines: Vec<(usize, &str)> = text
            .lines()
            .enumerate()
            .map(|(index, line)| (index + 1, line))
            .filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with('#'))
            .collect();
        let delimiter = delimiter_of(&lines);
        let mut reader = csv::ReaderBuilder::new();
        reader.delimiter(delimiter as u8).has_headers(false).flexible(true);
        let cells = |line: &str| -> Vec<String> {
            let mut record = csv::StringRecord::new();
            // One line at a time, so that a stray quote spoils one line and not the rest of the file.
            let read = reader.from_reader(line.as_bytes()).read_record(&mut record);
            if read.is_err() {
                return vec![line.to_owned()];
            }
            record.iter().map(|cell| cell.trim().to_owned()).collect()
        };
        let mut all: Vec<(usize, Vec<String>)> = lines.iter().map(|&(line, text)| (line, cells(text))).collect();
        let decimal_comma = delimiter != ',' && all.iter().flat_map(|(_, row)| row).any(|cell| has_decimal_comma(cell));
        let number = |cell: &String| number(cell, decimal_comma).is_some();
        // Instruments begin with a page about themselves: the head is the last row of words before rows of numbers.
        let Some(first) =
            all.iter().position(|(_, row)| row.len() > 1 && row.iter().filter(|cell| number(cell)).count() > 1)
        else {
            return Err(error(None, "has no row with two numbers", "name a table of numbers, one row a sample"));
        };
        let rows = all.split_off(first);
        let width = rows[0].1.len();
        if width > MOST_COLUMNS {
            return Err(error(Some(rows[0].0), "has more than a thousand columns", "write one row a sample"));
        }
        let mut above: Vec<Vec<String>> =
            all.into_iter().rev().map(|(_, row)| row).take_while(|row| row.len() > 1).take(2).collect();
        let units = above.first().filter(|row| above.len() > 1 && row.iter().all(|cell| is_unit_cell(cell))).is_some();
        let mut heads = if units {
            let units = above.remove(0);
            let names = above.remove(0);
            names.into_iter().zip(units).map(|(name, unit)| format!("{name} {unit}").trim().to_owned()).collect()
        } else if above.is_empty() {
            Vec::new()
        } else {
            above.remove(0)
        };
        heads.resize(width, String::new());
        Ok(Self { file: file.to_owned(), delimiter, decimal_comma, heads, rows })
    }

    /// Names of the columns, empty where they have none.
    #[must_use]
    pub fn heads(&self) -> &[String] {
        &self.heads
    }

    /// Lines and cells of the rows.
    pub(super) fn rows(&self) -> &[(usize, Vec<String>)] {
        &self.rows
    }

    /// A cell's number.
    ///
    /// # Errors
    /// If it is none, or not finite.
    pub(super) fn number(&self, row: &(usize, Vec<String>), column: usize) -> Result<f64, CurveError> {
        let (line, cells) = row;
        let cell = cells.get(column).map_or("", String::as_str);
        let name = format!("column {} ", column + 1) + &quoted(self.heads.get(column).map_or("", String::as_str));
        let name = name.trim();
        let value = number(cell, self.decimal_comma).ok_or_else(|| {
            let (what, mend) = if cell.is_empty() {
                (format!("{name} is empty"), "fill it in, or leave the row out".to_owned())
            } else if cell.starts_with(|c: char| c.is_ascii_digit()) {
                let mend = "a unit belongs in the head of the column, one for all its rows";
                (format!("{name} holds \"{}\", more than a number", shortened(cell)), mend.to_owned())
            } else {
                (format!("{name} holds \"{}\", no number", shortened(cell)), "write a number".to_owned())
            };
            self.error(Some(*line), what, mend)
        })?;
        if value.is_finite() {
            Ok(value)
        } else {
            Err(self.error(
                Some(*line),
                format!("{name} holds \"{}\"", shortened(cell)),
                "leave rows without a value out",
            ))
        }
    }

    pub(super) fn error(&self, line: Option<usize>, what: impl Into<String>, mend: impl Into<String>) -> CurveError {
        CurveError { file: self.file.clone(), line, what: what.into(), mend: mend.into() }
    }
}

fn quoted(text: &str) -> String {
    if text.is_empty() { String::new() } else { format!("(\"{}\")", shortened(text)) }
}

/// At most forty characters.
pub(super) fn shortened(text: &str) -> String {
    if text.chars().count() <= 40 { text.to_owned() } else { text.chars().take(39).chain(['…']).collect() }
}

/// The delimiter by which most lines fall into the same number of parts; a decimal comma is none where another one is.
fn delimiter_of(lines: &[(usize, &str)]) -> char {
    let score = |delimiter: char| {
        let counts: Vec<usize> = lines.iter().rev().take(50).map(|(_, line)| line.matches(delimiter).count()).collect();
        let most = counts.iter().copied().filter(|&count| count > 0).max();
        most.map_or(0, |_| counts.iter().filter(|&&count| count > 0 && count == counts[0]).count())
    };
    ['\t', ';', ','].into_iter().find(|&delimiter| 2 * score(delimiter) > lines.len().min(50)).unwrap_or(',')
}

fn has_decimal_comma(cell: &str) -> bool {
    cell.matches(',').count() == 1 && !cell.contains('.') && number(cell, true).is_some()
}

fn number(cell: &str, decimal_comma: bool) -> Option<f64> {
    let cell = cell.trim().replace('−', "-");
    let cell = if decimal_comma { cell.replace(',', ".") } else { cell };
    cell.parse().ok()
}

/// Whether a cell of a second head is a unit, in brackets or alone, or nothing.
fn is_unit_cell(cell: &str) -> bool {
    let bare = cell.trim_matches(['(', ')', '[', ']']);
    cell.is_empty()
        || cell != bare
        || super::units::split_head(&format!("x ({bare})")).1.is_some_and(|unit| unit.len() <= 4)
}
