//! What a virtual test reports: numbers as instruments print them and in SI, a table, a plot; and where it goes.

use std::borrow::Cow;
use std::fmt::Write;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};
use wale::picture::Plot;
use wale::record::atomic_file::write_bytes_atomically;
pub use wale_lab::fabric_file::direction_name;
use wale_lab::report::PrintedGroup;

use super::failure::TestFailure;
use super::folder::write_page;
use crate::arguments::lab::By;
use crate::exit::{Code, Failure};
use crate::{output, say};

/// A number that a test reports.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Number {
    /// Name and unit in SI, as a key of JSON: `B_N_m`.
    pub key: Cow<'static, str>,
    /// In SI.
    pub value: f64,
    /// What the laboratory calls it.
    pub name: Cow<'static, str>,
    /// As an instrument prints it.
    pub shown: String,
}

impl Number {
    /// A number that instruments print in a unit of this size in SI.
    pub fn new(key: &'static str, value: f64, name: &'static str, unit: f64, unit_name: &str) -> Self {
        let shown = format!("{} {unit_name}", digits(value / unit));
        Self { key: key.into(), value, name: name.into(), shown: shown.trim_end().to_owned() }
    }

    /// What everything elastic has: no result.
    pub fn trivial(key: &'static str, value: f64, name: &'static str, shown: &str) -> Self {
        Self { key: key.into(), value, name: name.into(), shown: format!("{shown}   (an elastic model cannot tell)") }
    }

    /// A count.
    pub fn count(key: &'static str, count: usize, name: &'static str) -> Self {
        Self { key: key.into(), value: count as f64, name: name.into(), shown: count.to_string() }
    }
}

/// Numbers of one direction, or of the whole specimen.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Group {
    /// In words: `weft`.
    pub name: String,
    /// From the weft \[rad\], where there is one.
    pub direction: Option<f64>,
    /// The numbers.
    pub numbers: Vec<Number>,
}

/// A file beside table and plot.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Extra {
    /// What follows the test's name: `-sheet.svg`.
    pub suffix: Cow<'static, str>,
    /// What is in it.
    pub text: String,
}

/// All that a test reports.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Report {
    /// What was done, in words.
    pub what: String,
    /// Numbers.
    pub groups: Vec<Group>,
    /// Columns of the table, with their units.
    pub heads: Vec<Cow<'static, str>>,
    /// Its rows.
    pub rows: Vec<Vec<f64>>,
    /// The plot.
    pub plot: Plot,
    /// What the numbers do not tell.
    pub remarks: Vec<String>,
    /// Other files.
    pub extras: Vec<Extra>,
}

/// Names of columns.
pub fn heads<const N: usize>(names: [&'static str; N]) -> Vec<Cow<'static, str>> {
    names.into_iter().map(Cow::Borrowed).collect()
}

/// Four significant digits, in full where that is short.
pub fn digits(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let before = value.abs().log10().floor() as i32 + 1;
    if (-3..=6).contains(&before) {
        format!("{value:.*}", (4 - before).clamp(0, 7) as usize)
    } else {
        format!("{value:.3e}")
    }
}

impl Report {
    /// Files that it writes.
    pub fn suffixes(extras: &[&'static str]) -> Vec<&'static str> {
        [".csv", ".svg", ".json"].into_iter().chain(extras.iter().copied()).collect()
    }

    /// Reports of several directions as one; all are of the same test.
    pub fn join(reports: Vec<Self>) -> Option<Self> {
        reports.into_iter().reduce(|mut all, next| {
            all.groups.extend(next.groups);
            all.rows.extend(next.rows);
            for (panel, more) in all.plot.panels.iter_mut().zip(next.plot.panels) {
                panel.series.extend(more.series);
            }
            for remark in next.remarks {
                if !all.remarks.contains(&remark) {
                    all.remarks.push(remark);
                }
            }
            all.extras.extend(next.extras);
            all
        })
    }

    /// That all its numbers are finite.
    ///
    /// # Errors
    /// [`TestFailure`] if not: JSON has no word for them.
    pub fn checked(self) -> Result<Self, TestFailure> {
        let numbers = self.groups.iter().flat_map(|group| &group.numbers).map(|number| number.value);
        let lines = self.plot.panels.iter().flat_map(|panel| &panel.series);
        let drawn = lines.flat_map(|line| line.xs.iter().chain(&line.ys).copied());
        if numbers.chain(self.rows.iter().flatten().copied()).chain(drawn).all(f64::is_finite) {
            return Ok(self);
        }
        Err(TestFailure::not_converged("the test gave numbers that are not finite"))
    }

    fn printed(&self) -> Vec<PrintedGroup> {
        let number = |number: &Number| [number.name.clone().into_owned(), number.shown.clone()];
        let group = |group: &Group| PrintedGroup {
            name: group.name.clone(),
            numbers: group.numbers.iter().map(number).collect(),
        };
        self.groups.iter().map(group).collect()
    }

    fn json(&self, test: &str, by: By, title: &str, folder: &Path) -> Value {
        let group = |group: &Group| {
            let mut map = Map::new();
            map.insert("name".to_owned(), json!(group.name));
            if let Some(direction) = group.direction {
                map.insert("direction_rad".to_owned(), json!(direction));
            }
            for number in &group.numbers {
                map.insert(number.key.clone().into_owned(), json!(number.value));
            }
            Value::Object(map)
        };
        json!({
            "test": test,
            "by": by,
            "title": title,
            "what": self.what,
            "folder": folder,
            "results": self.groups.iter().map(group).collect::<Vec<_>>(),
            "printed": self.printed(),
            "columns": self.heads,
            "rows": self.rows,
            "remarks": self.remarks,
        })
    }

    fn csv(&self) -> String {
        let mut text = self.heads.join(",");
        text.push('\n');
        for row in &self.rows {
            let cells: Vec<String> = row.iter().map(f64::to_string).collect();
            let _ = writeln!(text, "{}", cells.join(","));
        }
        text
    }

    /// Writes table, plot and numbers into a folder, and the page of all its tests anew, and tells the numbers.
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn deliver(&self, test: &str, by: By, title: &str, folder: &Path, as_json: bool) -> Result<(), Failure> {
        std::fs::create_dir_all(folder).map_err(|error| Failure::io(folder, "create", error))?;
        let svg = self.plot.to_svg().map_err(|error| Failure::new(Code::NotConverged, error))?;
        let json = self.json(test, by, title, folder);
        let json_text = serde_json::to_string_pretty(&json).map_err(|error| Failure::new(Code::Bug, error))? + "\n";
        let mut files = vec![(".csv", self.csv()), (".svg", svg), (".json", json_text)];
        files.extend(self.extras.iter().map(|extra| (&*extra.suffix, extra.text.clone())));
        for (suffix, text) in &files {
            let path = folder.join(format!("{test}{suffix}"));
            write_bytes_atomically(&path, text.as_bytes())?;
        }
        let page = write_page(folder)?;
        if as_json {
            return output::json(&json);
        }
        say!("{}: {}", if title.is_empty() { "a fabric" } else { title }, self.what)?;
        for group in &self.groups {
            say!("  {}", group.name)?;
            for number in &group.numbers {
                say!("    {:<22} {}", number.name, number.shown)?;
            }
        }
        for remark in &self.remarks {
            say!("  {remark}")?;
        }
        let names: Vec<&str> = files.iter().map(|(suffix, _)| *suffix).collect();
        say!("  {} ({})", folder.join(test).display(), names.join(", "))?;
        say!("  {}", page.display())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits() {
        for (value, text) in [
            (0.0, "0"),
            (0.041_23, "0.04123"),
            (1.0, "1.000"),
            (-12.345_6, "-12.35"),
            (123_456.0, "123456"),
            (1e-9, "1.000e-9"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(digits(value), text);
        }
    }
}
