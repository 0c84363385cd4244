//! Tables of numbers as CSV: `#` lines of metadata, one header line with units in brackets, decimal points, UTF-8.

use std::io::Write;

use super::ExportError;
use super::settings::one_line;

/// A column of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Name.
    pub name: String,
    /// Unit; empty for a pure number.
    pub unit: String,
}

impl Column {
    /// A column with its unit.
    #[must_use]
    pub fn new(name: &str, unit: &str) -> Self {
        Self { name: name.into(), unit: unit.into() }
    }
}

/// Numbers in rows, with what they mean.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Facts about the whole table: key and value.
    pub metadata: Vec<(String, String)>,
    /// The columns.
    pub columns: Vec<Column>,
    /// Rows, each as long as there are columns. NaN means no value and is left empty.
    pub rows: Vec<Vec<f64>>,
}

/// Writes a table.
///
/// # Errors
/// [`ExportError::Inconsistent`] if a row has not as many numbers as there are columns; what the stream returns.
pub fn write_csv(out: &mut impl Write, table: &Table) -> Result<(), ExportError> {
    for (key, value) in &table.metadata {
        writeln!(out, "# {}: {}", one_line(key), one_line(value))?;
    }
    let header: Vec<String> = table
        .columns
        .iter()
        .map(|column| {
            let unit = if column.unit.is_empty() { "-" } else { &column.unit };
            quoted(&format!("{} [{unit}]", column.name))
        })
        .collect();
    writeln!(out, "{}", header.join(","))?;
    for (i, row) in table.rows.iter().enumerate() {
        if row.len() != table.columns.len() {
            return Err(ExportError::Inconsistent(format!(
                "row {i} has {} numbers for {} columns",
                row.len(),
                table.columns.len()
            )));
        }
        for (k, value) in row.iter().enumerate() {
            if k > 0 {
                write!(out, ",")?;
            }
            if !value.is_nan() {
                // The shortest text that reads back as the same number.
                write!(out, "{value:?}")?;
            }
        }
        writeln!(out)?;
    }
    Ok(())
}

/// A cell of text: quoted if it holds what separates cells, or would be taken for a metadata line.
fn quoted(text: &str) -> String {
    let text = one_line(text);
    if text.contains([',', '"', ';']) || text.starts_with('#') {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_reads_back() {
        let table = Table {
            metadata: vec![("scene".into(), "curl\n.toml".into())],
            columns: vec![Column::new("time", "s"), Column::new("width, rel.", "")],
            rows: vec![vec![0.0, 1e-9], vec![0.1, f64::NAN]],
        };
        let mut out = Vec::new();
        write_csv(&mut out, &table).unwrap();
        assert_eq!(
            String::from_utf8(out).unwrap(),
            "# scene: curl .toml\ntime [s],\"width, rel. [-]\"\n0.0,1e-9\n0.1,\n"
        );
    }

    #[test]
    fn ragged_tables_are_refused() {
        let table = Table { columns: vec![Column::new("a", "m")], rows: vec![vec![1.0, 2.0]], ..Table::default() };
        assert!(write_csv(&mut Vec::new(), &table).is_err());
    }
}
