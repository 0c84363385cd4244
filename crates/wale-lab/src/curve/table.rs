//! A delimited table of numbers, whatever wrote it: commas, semicolons or tabs, decimal points or commas, remarks, a head of
//! names and perhaps a second one of units.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::layout::{Decimal, Delimiter, TableFormat};
use super::units::is_unit;
use super::{CurveError, Request};

/// Most of a table \[MiB\].
const LARGEST_FILE: usize = 64;
/// Most columns.
const MOST_COLUMNS: usize = 1000;

/// A table as it was read.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    file: String,
    /// What separates cells.
    pub delimiter: Delimiter,
    /// The sign before decimals.
    pub decimal: Decimal,
    heads: Vec<String>,
    /// Line of the heads, from 1, or of the units below them; none if there are no heads.
    head_line: Option<usize>,
    /// Each row's line, from 1, and cells.
    rows: Vec<(usize, Vec<String>)>,
}

impl Table {
    /// Reads a file.
    ///
    /// # Errors
    /// If it cannot be read, is larger than 64 MiB, no text in UTF-8, or no table.
    pub fn read(path: &Path, format: TableFormat) -> Result<Self, CurveError> {
        Self::from_text(&text_of(path, LARGEST_FILE)?, &path.display().to_string(), format)
    }

    /// Reads text; `file` stands in errors.
    ///
    /// # Errors
    /// If it is no table, or does not tell its decimal sign.
    pub fn from_text(text: &str, file: &str, format: TableFormat) -> Result<Self, CurveError> {
        let error = |line: Option<usize>, what: String, mend: &str| CurveError {
            file: file.to_owned(),
            line,
            what,
            mend: mend.to_owned(),
        };
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let lines: Vec<(usize, &str)> = text
            .lines()
            .enumerate()
            .map(|(index, line)| (index + 1, line))
            .filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with('#'))
            .collect();
        let delimiter = format.delimiter.unwrap_or_else(|| Delimiter::of(&lines));
        let mut reader = csv::ReaderBuilder::new();
        reader.delimiter(delimiter.sign() as u8).has_headers(false).flexible(true);
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
        let decimal = match format.decimal {
            Some(decimal) => decimal,
            None => Decimal::of(&all, delimiter).map_err(|(line, cell)| {
                let what = format!("\"{}\" has a comma before decimals or before thousands", shortened(&cell));
                error(Some(line), what, "write thousands without a comma, or say decimal = \",\" in the fabric file")
            })?,
        };
        let number = |cell: &String| decimal.number(cell).is_some();
        // Instruments begin with a page about themselves: the head is the last row of words before rows of numbers.
        let Some(first) =
            all.iter().position(|(_, row)| row.len() > 1 && row.iter().filter(|cell| number(cell)).count() > 1)
        else {
            let mend = "name a table of numbers, one row a sample; delimiter and decimal in the fabric file say how it \
                        is written";
            return Err(error(None, "has no row with two numbers".to_owned(), mend));
        };
        let rows = all.split_off(first);
        let width = rows[0].1.len();
        if width > MOST_COLUMNS {
            let what = "has more than a thousand columns".to_owned();
            return Err(error(Some(rows[0].0), what, "write one row a sample"));
        }
        let (head_line, mut heads) = heads_of(all);
        if let Some((line, count)) = split_numbers(&rows, heads.len(), delimiter) {
            let what = format!("{count} cells stand under {} heads", heads.len());
            let mend = "put numbers with a decimal comma in quotes, or semicolons between cells, and name every column";
            return Err(error(Some(line), what, mend));
        }
        heads.resize(width, String::new());
        Ok(Self { file: file.to_owned(), delimiter, decimal, heads, head_line, rows })
    }

    /// Names of the columns, empty where they have none.
    #[must_use]
    pub fn heads(&self) -> &[String] {
        &self.heads
    }

    /// Line of the heads, from 1, or of the units below them.
    pub(super) fn head_line(&self) -> Option<usize> {
        self.head_line
    }

    /// Lines and cells of the rows.
    pub(super) fn rows(&self) -> &[(usize, Vec<String>)] {
        &self.rows
    }

    /// How it was read when `chosen` of its rows were, to be shown to whoever asked.
    pub(super) fn read_as(&self, request: &Request, chosen: usize) -> String {
        let before = self.rows[0].0 - 1;
        let only: Vec<String> =
            request.only.iter().map(|(head, word)| format!("{} = \"{}\"", shortened(head), shortened(word))).collect();
        let rows = if only.is_empty() {
            format!("{chosen} rows")
        } else {
            format!("{chosen} of {} rows, only {}", self.rows.len(), only.join(", "))
        };
        let lines = if before == 1 { "line" } else { "lines" };
        format!(
            "table: {} between cells, {}, {before} {lines} before the numbers, {rows}",
            self.delimiter.name(),
            self.decimal.name()
        )
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
        let value = self.decimal.number(cell).ok_or_else(|| {
            let (what, mend) = if cell.is_empty() {
                (format!("{name} is empty"), "fill it in, or leave the row out".to_owned())
            } else if self.decimal == Decimal::Point && Decimal::Comma.number(cell).is_some() {
                let mend = "the table has decimal points; say decimal = \",\" in the fabric file if it has commas";
                (format!("{name} holds \"{}\", with a comma", shortened(cell)), mend.to_owned())
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

/// The text of a file of at most so many MiB.
fn text_of(path: &Path, largest: usize) -> Result<String, CurveError> {
    let error = |what: String, mend: &str| CurveError {
        file: path.display().to_string(),
        line: None,
        what,
        mend: mend.to_owned(),
    };
    let most = largest << 20;
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|opened| opened.take(most as u64 + 1).read_to_end(&mut bytes))
        .map_err(|failed| error(format!("cannot be read: {failed}"), "name a table of numbers"))?;
    if bytes.len() > most {
        return Err(error(format!("is larger than {largest} MiB"), "thin the curve out"));
    }
    String::from_utf8(bytes).map_err(|_| error("is not text in UTF-8".to_owned(), "save it as CSV in UTF-8"))
}

/// The heads among the rows before the numbers, each with the unit that stands below it, and their last line.
fn heads_of(before: Vec<(usize, Vec<String>)>) -> (Option<usize>, Vec<String>) {
    let mut above = before.into_iter().rev().take_while(|(_, row)| row.len() > 1);
    let Some((line, last)) = above.next() else { return (None, Vec::new()) };
    let heads = match above.next() {
        Some((_, names)) if is_unit_row(&last) => {
            let with_unit = |(name, unit): (String, String)| {
                // In brackets, so that a unit is none of the words.
                if is_unit(&unit) { format!("{name} ({unit})") } else { format!("{name} {unit}") }.trim().to_owned()
            };
            names.into_iter().zip(last).map(with_unit).collect()
        }
        _ => last,
    };
    (Some(line), heads)
}

/// The first row whose decimal commas, not in quotes, have made more cells than there are heads; its line and cells.
fn split_numbers(rows: &[(usize, Vec<String>)], heads: usize, delimiter: Delimiter) -> Option<(usize, usize)> {
    let point = || rows.iter().flat_map(|(_, cells)| cells).any(|cell| cell.contains('.'));
    // Words beside the numbers are remarks.
    let is_digits = |cell: &String| !cell.is_empty() && cell.chars().all(|c| c.is_ascii_digit());
    let (line, cells) = rows.iter().find(|(_, cells)| cells.iter().skip(heads).any(is_digits))?;
    (delimiter == Delimiter::Comma && heads > 1 && !point()).then_some((*line, cells.len()))
}

fn quoted(text: &str) -> String {
    if text.is_empty() { String::new() } else { format!("(\"{}\")", shortened(text)) }
}

/// At most forty characters.
pub(super) fn shortened(text: &str) -> String {
    if text.chars().count() <= 40 { text.to_owned() } else { text.chars().take(39).chain(['…']).collect() }
}

/// Whether a row of a second head holds units, in brackets or alone, or nothing.
fn is_unit_row(row: &[String]) -> bool {
    let sure = |cell: &String| is_unit(cell) || cell.starts_with(['(', '[']) && cell.ends_with([')', ']']);
    let may_be = |cell: &String| cell.len() <= 4 || sure(cell);
    // One at least must be sure: `Weg` and `Last` are as short as a unit.
    row.iter().all(may_be) && (row.iter().any(sure) || row.iter().all(String::is_empty))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_too_large_is_refused() {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), vec![b'0'; (1 << 20) + 1]).unwrap();
        let error = text_of(file.path(), 1).unwrap_err().to_string();
        assert!(error.contains("is larger than 1 MiB; thin the curve out"), "{error}");
        std::fs::write(file.path(), vec![b'0'; 1 << 20]).unwrap();
        assert_eq!(text_of(file.path(), 1).unwrap().len(), 1 << 20);
    }
}
