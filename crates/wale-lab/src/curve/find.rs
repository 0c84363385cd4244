//! Which column of a table holds what, in which unit, and which of its rows are asked for.

use super::columns::{ColumnName, Meaning, Request};
use super::table::shortened;
use super::units::{Kind, claimed_units, split_head};
use super::{CurveError, Table};

/// How far two columns may be from each other and still hold the same, over their largest value \[–\]: what rounding does to them.
const ROUNDING: f64 = 5e-3;

/// A column that was found.
#[derive(Clone, Debug)]
pub(super) struct Column {
    pub index: usize,
    /// SI units for one of the table's.
    unit_size: f64,
    /// Whether its head or the request says its unit.
    pub has_unit: bool,
    /// How it was read, to be shown.
    pub read_as: String,
}

impl Column {
    pub fn value(&self, table: &Table, row: &(usize, Vec<String>)) -> Result<f64, CurveError> {
        Ok(table.number(row, self.index)? * self.unit_size)
    }
}

/// The column that holds something; `None` if none does.
///
/// # Errors
/// If it was given and is not there, its unit is none, not told or contradicted, or several could be it and differ.
pub(super) fn column(table: &Table, request: &Request, meaning: Meaning) -> Result<Option<Column>, CurveError> {
    let mut candidates = match request.columns.get(&meaning) {
        Some(name) => named(table, name, meaning)?,
        None => recognised(table, meaning),
    };
    // Beside a force with a unit, one without is some other reading of the instrument.
    let has_unit = |&index: &usize| {
        meaning.kind() == Kind::Ratio
            || request.units.contains_key(&meaning)
            || split_head(&table.heads()[index]).1.is_some()
    };
    if candidates.iter().any(has_unit) {
        candidates.retain(has_unit);
    }
    let mut columns = candidates.into_iter().map(|index| measured(table, request, meaning, index));
    let Some(first) = columns.next().transpose()? else { return Ok(None) };
    for other in columns {
        agree(table, request, meaning, &first, &other?)?;
    }
    Ok(Some(first))
}

/// The columns that a name means: one as a rule, more where heads are alike.
fn named(table: &Table, name: &ColumnName, meaning: Meaning) -> Result<Vec<usize>, CurveError> {
    let heads = table.heads();
    match name {
        ColumnName::Number(number) => {
            let index = number.checked_sub(1).filter(|&index| index < heads.len()).ok_or_else(|| {
                let what = format!("has no column {number}");
                table.error(None, what, format!("its columns are 1 to {}", heads.len()))
            })?;
            Ok(vec![index])
        }
        ColumnName::Head(name) => {
            let with = |is: &dyn Fn(&String) -> bool| (0..heads.len()).filter(|&k| is(&heads[k])).collect::<Vec<_>>();
            let mut found = with(&|head| head == name);
            if found.is_empty() {
                found = with(&|head| plain(&split_head(head).0) == plain(name));
            }
            if found.iter().any(|&k| unit_fits(&heads[k], meaning)) {
                found.retain(|&k| unit_fits(&heads[k], meaning));
            }
            if found.is_empty() {
                let known: Vec<String> = heads.iter().map(|head| format!("\"{}\"", shortened(head))).collect();
                let what = format!("has no column \"{}\"", shortened(name));
                return Err(table.error(None, what, format!("its columns are {}", known.join(", "))));
            }
            Ok(found)
        }
    }
}

/// The columns whose heads are words of a meaning, or else begin with one; those of its first word first.
fn recognised(table: &Table, meaning: Meaning) -> Vec<usize> {
    let fitting = table.heads().iter().enumerate().filter(|(_, head)| unit_fits(head, meaning));
    let heads: Vec<(usize, String)> = fitting.map(|(index, head)| (index, plain(&split_head(head).0))).collect();
    let with = |is: fn(&str, &str) -> bool| {
        let of = |word| heads.iter().filter(move |(_, head)| is(head, word)).map(|(index, _)| *index);
        meaning.words().iter().flat_map(|word| of(*word)).collect::<Vec<usize>>()
    };
    let whole = with(|head, word| head == word);
    if whole.is_empty() {
        with(|head, word| head.strip_prefix(word).is_some_and(|rest| rest.starts_with(' ')))
    } else {
        whole
    }
}

fn plain(text: &str) -> String {
    text.to_lowercase().replace(['_', '-'], " ")
}

/// Whether a head claims no unit, or one that such columns may have.
fn unit_fits(head: &str, meaning: Meaning) -> bool {
    let claims = claimed_units(head);
    claims.is_empty() || claims.iter().any(|unit| meaning.kind().size(unit).is_some())
}

/// A column with its unit: the one that was given, or else the one of its head.
fn measured(table: &Table, request: &Request, meaning: Meaning, index: usize) -> Result<Column, CurveError> {
    let kind = meaning.kind();
    let head = shortened(&table.heads()[index]);
    let number = index + 1;
    let claims = match request.units.get(&meaning) {
        Some(unit) => vec![unit.clone()],
        None => claimed_units(&table.heads()[index]),
    };
    let (unit_size, unit) = match claims.as_slice() {
        [unit] => {
            let size = kind.size(unit).ok_or_else(|| {
                let what = format!("column {number} is {} in \"{}\", no unit of it", meaning.name(), shortened(unit));
                table.error(None, what, format!("known: {}", kind.known()))
            })?;
            (size, unit.as_str())
        }
        [unit, other, ..] => {
            let what = format!("column {number} (\"{head}\") claims to be in {unit} and in {other}");
            let likely = claims.iter().find(|unit| kind.size(unit).is_some()).unwrap_or(unit);
            let mend = format!("mend the head, or say which it is: units = {{ {} = \"{likely}\" }}", meaning.name());
            return Err(table.error(table.head_line(), what, mend));
        }
        // A ratio without a unit is one; nothing else is told by itself.
        [] if kind == Kind::Ratio => (1.0, "1"),
        [] => {
            let what = format!("column {number} (\"{head}\") has no unit");
            let mend = format!("give it: units = {{ {} = \"…\" }}, one of {}", meaning.name(), kind.known());
            return Err(table.error(None, what, mend));
        }
    };
    let read_as = format!("{}: column {number}, \"{head}\", in {unit}", meaning.name());
    Ok(Column { index, unit_size, has_unit: !claims.is_empty(), read_as })
}

/// That two columns which could both be meant hold the same.
fn agree(table: &Table, request: &Request, meaning: Meaning, first: &Column, other: &Column) -> Result<(), CurveError> {
    let pairs: Vec<_> = rows(table, request)?
        .into_iter()
        .filter_map(|row| Some((row, first.value(table, row).ok()?, other.value(table, row).ok()?)))
        .collect();
    let largest = pairs.iter().fold(0.0f64, |most, (_, a, b)| most.max(a.abs()).max(b.abs()));
    let Some(((line, cells), ..)) = pairs.into_iter().find(|(_, a, b)| (a - b).abs() > ROUNDING * largest) else {
        return Ok(());
    };
    let told = |column: &Column| {
        format!(
            "{} (\"{}\": {})",
            column.index + 1,
            shortened(&table.heads()[column.index]),
            shortened(&cells[column.index])
        )
    };
    let what = format!("columns {} and {} could both be {} and differ", told(first), told(other), meaning.name());
    let column = |column: &Column| format!("columns = {{ {} = {} }}", meaning.name(), column.index + 1);
    let mend = format!("say which it is: {} or {}", column(first), column(other));
    Err(table.error(Some(*line), what, mend))
}

/// Rows with the words that were asked for.
///
/// # Errors
/// If a column that is asked for is not there, or no row is left.
pub(super) fn rows<'a>(table: &'a Table, request: &Request) -> Result<Vec<&'a (usize, Vec<String>)>, CurveError> {
    let mut left: Vec<&(usize, Vec<String>)> = table.rows().iter().collect();
    for (head, word) in &request.only {
        let index = table.heads().iter().position(|known| known == head).ok_or_else(|| {
            let what = format!("has no column \"{}\" to choose rows by", shortened(head));
            table.error(None, what, format!("its columns are {}", shortened(&table.heads().join(", "))))
        })?;
        left.retain(|(_, cells)| cells.get(index) == Some(word));
        if left.is_empty() {
            let what = format!("no row has \"{}\" in \"{}\"", shortened(word), shortened(head));
            return Err(table.error(None, what, "words are compared letter by letter"));
        }
    }
    Ok(left)
}
