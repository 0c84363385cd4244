//! The table of measured quantities: one row a frame, units in the header.

use std::fmt::Write as _;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use super::append_file::AppendFile;
use super::error::{RecordError, reading};

/// A column of the table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// What is measured.
    pub name: String,
    /// Its unit, `-` for a plain number.
    pub unit: String,
}

impl Column {
    /// A column.
    #[must_use]
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { name: name.into(), unit: unit.into() }
    }
}

/// `metrics.csv` while it is being written: `step [-]` and then the columns.
#[derive(Debug)]
pub struct Metrics {
    file: AppendFile,
    column_count: usize,
}

impl Metrics {
    /// An empty table with its header.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn create(path: &Path, columns: &[Column]) -> Result<Self, RecordError> {
        let mut file = AppendFile::create(path)?;
        file.append(header(columns).as_bytes())?;
        Ok(Self { file, column_count: columns.len() })
    }

    /// Goes on with a table that had `length` bytes \[bytes\] when the checkpoint was taken.
    ///
    /// # Errors
    /// [`RecordError::Damaged`] when the table is shorter or its columns are others.
    pub fn resume(path: &Path, columns: &[Column], length: u64) -> Result<Self, RecordError> {
        let mut first = String::new();
        File::open(path)
            .and_then(|file| BufReader::new(file).read_line(&mut first))
            .map_err(|error| reading(path, error))?;
        if first != header(columns) {
            return Err(RecordError::Damaged {
                path: path.to_path_buf(),
                reason: "its columns are not those of this scene: begin a new run".to_owned(),
            });
        }
        Ok(Self { file: AppendFile::resume(path, length)?, column_count: columns.len() })
    }

    /// Appends a row, one value a column.
    ///
    /// # Errors
    /// A full disk and other failures to write.
    ///
    /// # Panics
    /// If there are not as many values as columns.
    pub fn append(&mut self, step: u64, values: &[f64]) -> Result<(), RecordError> {
        assert_eq!(values.len(), self.column_count, "one value a column");
        let mut row = step.to_string();
        for value in values {
            row.push(',');
            push_number(&mut row, *value);
        }
        row.push('\n');
        self.file.append(row.as_bytes())
    }

    /// Brings the table to the disk, and says how long it is \[bytes\].
    ///
    /// # Errors
    /// When the disk fails.
    pub fn sync(&self) -> Result<u64, RecordError> {
        self.file.sync()
    }
}

fn header(columns: &[Column]) -> String {
    let mut header = String::from("step [-]");
    for Column { name, unit } in columns {
        let title = format!("{name} [{unit}]");
        // Names of grips come from the scene file; a comma in one must not become a column.
        if title.contains([',', '"', '\n', '\r']) {
            let one_line = title.replace(['\n', '\r'], " ").replace('"', "\"\"");
            let _ = write!(header, ",\"{one_line}\"");
        } else {
            let _ = write!(header, ",{title}");
        }
    }
    header.push('\n');
    header
}

/// The shortest text that reads back to the same bits, with an exponent where that is the shorter.
fn push_number(row: &mut String, value: f64) {
    let size = value.abs();
    let _ = if size == 0.0 || (1e-4..1e9).contains(&size) || !value.is_finite() {
        write!(row, "{value}")
    } else {
        write!(row, "{value:e}")
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns() -> Vec<Column> {
        vec![Column::new("time", "s"), Column::new("force of \"left, low\"", "N")]
    }

    #[test]
    fn the_header_has_units_and_rows_read_back_to_the_bit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("metrics.csv");
        let mut metrics = Metrics::create(&path, &columns()).unwrap();
        let values = [0.1 + 0.2, -1.0 / 3.0, 1e-300, 6.02e23, 0.0, -0.0, f64::MIN_POSITIVE];
        for (step, &value) in values.iter().enumerate() {
            metrics.append(step as u64, &[value, 1.0]).unwrap();
        }
        let text = std::fs::read_to_string(&path).unwrap();
        assert_eq!(metrics.sync().unwrap(), text.len() as u64);
        let mut lines = text.lines();
        assert_eq!(lines.next().unwrap(), r#"step [-],time [s],"force of ""left, low"" [N]""#);
        for (line, value) in lines.zip(values) {
            let cell: f64 = line.split(',').nth(1).unwrap().parse().unwrap();
            assert_eq!(cell.to_bits(), value.to_bits(), "{line}");
        }
    }

    #[test]
    fn killed_anywhere_and_resumed_gives_the_same_table() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("metrics.csv");
        let row = |metrics: &mut Metrics, step: u64| {
            metrics.append(step, &[step as f64 / 7.0, 1e-9 * step as f64]).unwrap();
        };
        let mut metrics = Metrics::create(&path, &columns()).unwrap();
        (0..3).for_each(|step| row(&mut metrics, step));
        let mark = metrics.sync().unwrap();
        (3..6).for_each(|step| row(&mut metrics, step));
        let whole = std::fs::read(&path).unwrap();
        for kill in mark as usize..=whole.len() {
            std::fs::write(&path, &whole[..kill]).unwrap();
            let mut metrics = Metrics::resume(&path, &columns(), mark).unwrap();
            (3..6).for_each(|step| row(&mut metrics, step));
            assert_eq!(std::fs::read(&path).unwrap(), whole);
        }
    }

    #[test]
    fn other_columns_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("metrics.csv");
        let mark = Metrics::create(&path, &columns()).unwrap().sync().unwrap();
        let error = Metrics::resume(&path, &columns()[..1], mark).unwrap_err();
        assert!(matches!(error, RecordError::Damaged { .. }), "{error}");
    }
}
