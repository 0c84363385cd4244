//! How a table is written: what separates its cells, and which sign its decimals follow.

use serde::{Deserialize, Serialize};

/// Lines at the end of a table by which its delimiter is told.
const TELLING_LINES: usize = 50;

/// What separates the cells of a row.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub enum Delimiter {
    /// `,`
    #[serde(rename = ",")]
    Comma,
    /// `;`
    #[serde(rename = ";")]
    Semicolon,
    /// A tab.
    #[serde(rename = "\t", alias = "tab")]
    Tab,
    /// `|`; tables do not tell this one by themselves.
    #[serde(rename = "|")]
    Bar,
}

impl Delimiter {
    /// What it is called.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Comma => "comma",
            Self::Semicolon => "semicolon",
            Self::Tab => "tab",
            Self::Bar => "bar",
        }
    }

    pub(super) fn sign(self) -> char {
        match self {
            Self::Comma => ',',
            Self::Semicolon => ';',
            Self::Tab => '\t',
            Self::Bar => '|',
        }
    }

    /// The delimiter by which most lines fall into the same number of parts; a decimal comma is none where another one is.
    pub(super) fn of(lines: &[(usize, &str)]) -> Self {
        // What stands in quotes separates nothing.
        let count = |line: &str, sign: char| line.split('"').step_by(2).map(|part| part.matches(sign).count()).sum();
        let score = |delimiter: Self| {
            let counts: Vec<usize> =
                lines.iter().rev().take(TELLING_LINES).map(|(_, line)| count(line, delimiter.sign())).collect();
            counts.iter().filter(|&&count| count > 0 && count == counts[0]).count()
        };
        let most = |&delimiter: &Self| 2 * score(delimiter) > lines.len().min(TELLING_LINES);
        [Self::Tab, Self::Semicolon, Self::Comma].into_iter().find(most).unwrap_or(Self::Comma)
    }
}

/// The sign before the decimals of a number.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub enum Decimal {
    /// `0.5`
    #[serde(rename = ".")]
    Point,
    /// `0,5`
    #[serde(rename = ",")]
    Comma,
}

impl Decimal {
    /// What it is called.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Point => "decimal point",
            Self::Comma => "decimal comma",
        }
    }

    /// The sign by which the numbers of a table are read, or a line and cell that may be meant either way.
    pub(super) fn of(rows: &[(usize, Vec<String>)], delimiter: Delimiter) -> Result<Self, (usize, String)> {
        let with_comma = |cell: &&String| {
            cell.matches(',').count() == 1 && !cell.contains('.') && Self::Comma.number(cell).is_some()
        };
        if delimiter != Delimiter::Comma {
            let any = rows.iter().flat_map(|(_, cells)| cells).any(|cell| with_comma(&cell));
            return Ok(if any { Self::Comma } else { Self::Point });
        }
        // A comma within a cell stood in quotes there: a decimal comma, or one between thousands.
        let is_number = |cell: &&String| Self::Comma.number(cell).is_some();
        let samples = || rows.iter().filter(|(_, cells)| cells.iter().filter(is_number).count() > 1);
        let mut commas = samples()
            .flat_map(|(line, cells)| cells.iter().filter(with_comma).map(move |cell| (*line, cell)))
            .peekable();
        let point = samples().flat_map(|(_, cells)| cells).any(|cell| cell.contains('.') && is_number(&cell));
        let Some(&(line, cell)) = commas.peek().filter(|_| !point) else { return Ok(Self::Point) };
        if commas.all(|(_, cell)| may_be_thousands(cell)) { Err((line, cell.clone())) } else { Ok(Self::Comma) }
    }

    /// The number that a cell holds, if it is one.
    pub(super) fn number(self, cell: &str) -> Option<f64> {
        let cell = cell.trim().replace('−', "-");
        let cell = if self == Self::Comma { cell.replace(',', ".") } else { cell };
        cell.parse().ok()
    }
}

/// Whether the comma of a number may stand before thousands: `1,234` and not `0,234` or `1,23`.
fn may_be_thousands(cell: &str) -> bool {
    let digits = cell.trim_start_matches(['+', '-', '−']);
    digits
        .split_once(',')
        .is_some_and(|(before, after)| (1..=3).contains(&before.len()) && !before.starts_with('0') && after.len() == 3)
}

/// What is said of how a table is written; what is not said is told by its look.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct TableFormat {
    /// What separates its cells.
    pub delimiter: Option<Delimiter>,
    /// The sign before its decimals.
    pub decimal: Option<Decimal>,
}
