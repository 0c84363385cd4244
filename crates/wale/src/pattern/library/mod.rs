//! The library of stitch patterns that come with wale.

use std::sync::LazyLock;

use serde::Deserialize;

use super::chart::Chart;
use super::symbols::{default_legend, read_symbols};

/// A pattern of the library.
#[derive(Clone, Debug)]
pub struct Pattern {
    /// Its name, in lower case.
    pub name: String,
    /// What it is listed under.
    pub group: String,
    /// One line about it.
    pub about: String,
    /// One repeat of it.
    pub chart: Chart,
}

/// What `patterns.toml` says.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Text {
    pattern: Vec<PatternText>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PatternText {
    name: String,
    group: String,
    about: String,
    rows: Vec<String>,
    #[serde(default)]
    yarns: Vec<String>,
}

static PATTERNS: LazyLock<Vec<Pattern>> = LazyLock::new(|| read(include_str!("patterns.toml")));

/// All patterns of the library, in its order.
#[must_use]
pub fn patterns() -> &'static [Pattern] {
    &PATTERNS
}

/// The patterns of a text that is part of this program; a test reads it whole, so that nothing is left out unseen.
fn read(text: &str) -> Vec<Pattern> {
    let patterns = toml::from_str::<Text>(text).map(|text| text.pattern).unwrap_or_default();
    let legend = default_legend();
    let chart = |text: &PatternText| {
        let chart = read_symbols(&text.rows, &legend).ok()?;
        if text.yarns.is_empty() {
            return Some(chart);
        }
        let row = |line: &String| line.bytes().map(|name| name.wrapping_sub(b'A')).collect();
        chart.with_yarns(text.yarns.iter().rev().map(row).collect()).ok()
    };
    let pattern = |text: PatternText| {
        let chart = chart(&text)?;
        Some(Pattern { name: text.name, group: text.group, about: text.about, chart })
    };
    patterns.into_iter().filter_map(pattern).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_pattern_is_whole_and_repeats() {
        let text: Text = toml::from_str(include_str!("patterns.toml")).unwrap();
        for pattern in &text.pattern {
            let chart = read_symbols(&pattern.rows, &default_legend());
            let chart = chart.unwrap_or_else(|error| panic!("{}: {error}", pattern.name));
            chart.check_repeats().unwrap_or_else(|error| panic!("{}: {error}", pattern.name));
        }
        assert_eq!(patterns().len(), text.pattern.len());
        assert!(patterns().len() >= 40);
        let names: BTreeSet<&str> = patterns().iter().map(|pattern| pattern.name.as_str()).collect();
        assert_eq!(names.len(), patterns().len());
        let charts: BTreeSet<String> = patterns()
            .iter()
            .map(|p| {
                format!(
                    "{:?}",
                    p.chart
                        .repeat(2 * p.chart.cast_on(), p.chart.row_count())
                        .map(|c| (c.smallest_repeat(), c.yarn_count()))
                )
            })
            .collect();
        assert_eq!(charts.len(), patterns().len(), "two patterns are the same");
        for pattern in patterns() {
            assert_eq!(pattern.chart.smallest_repeat(), pattern.chart, "{} repeats a smaller piece", pattern.name);
            assert_eq!(pattern.name, pattern.name.to_lowercase());
            assert!(pattern.about.ends_with('.'));
        }
    }
}
