//! Patterns by the names that knitters use, as text: `"garter"`, `"rib 2x2"`, `"welting 2+2"`.

use thiserror::Error;

use super::chart::{Chart, ChartError};
use super::library::patterns;

/// The plain names that [`named_pattern`] knows beside those of the library, with an example of the counts that some
/// take.
pub const PLAIN: [&str; 8] =
    ["stockinette", "reverse stockinette", "garter", "rib 2x2", "seed", "moss", "basket 4x4", "welting 2+2"];

/// All names that [`named_pattern`] knows.
pub fn names() -> impl Iterator<Item = &'static str> {
    PLAIN.into_iter().chain(patterns().iter().map(|pattern| pattern.name.as_str()))
}

/// Why a text names no pattern.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
pub enum NamedPatternError {
    /// No such name.
    #[error("`{name}` is no pattern that wale knows")]
    Unknown {
        /// What was asked for.
        name: String,
    },
    /// The name needs two counts.
    #[error("`{name}` needs two whole numbers, as in \"{example}\"")]
    Counts {
        /// What was asked for.
        name: String,
        /// How it is written.
        example: &'static str,
    },
    /// The counts make no pattern.
    #[error(transparent)]
    Size(#[from] ChartError),
}

/// The smallest repeat of a named pattern. Case and extra spaces do not matter.
///
/// # Errors
/// If the name is unknown, or its counts are missing, zero or too large.
pub fn named_pattern(text: &str) -> Result<Chart, NamedPatternError> {
    let lower = text.to_lowercase();
    let spaced = lower.split_whitespace().collect::<Vec<_>>().join(" ");
    if let Some(pattern) = patterns().iter().find(|pattern| pattern.name == spaced) {
        return Ok(pattern.chart.clone());
    }
    let split = lower.find(|c: char| c.is_ascii_digit());
    let (name, counts) = lower.split_at(split.unwrap_or(lower.len()));
    let name = name.split_whitespace().collect::<Vec<_>>().join(" ");
    let plain = |chart: Chart| {
        if counts.is_empty() { Ok(chart) } else { Err(NamedPatternError::Unknown { name: text.to_owned() }) }
    };
    let pair = |example| {
        let separated = counts.split_once(['x', '×', '+', '/']);
        let numbers = separated
            .and_then(|(a, b)| -> Option<(usize, usize)> { Some((a.trim().parse().ok()?, b.trim().parse().ok()?)) });
        numbers.ok_or_else(|| NamedPatternError::Counts { name: text.to_owned(), example })
    };
    match name.as_str() {
        "stockinette" | "stocking stitch" | "jersey" => plain(Chart::stockinette()),
        "reverse stockinette" => plain(Chart::reverse_stockinette()),
        "garter" => plain(Chart::garter()),
        "seed" => plain(Chart::seed()),
        "moss" => plain(Chart::moss()),
        "rib" => pair("rib 2x2").and_then(|(m, n)| Ok(Chart::rib(m, n)?)),
        "basket" => pair("basket 4x4").and_then(|(m, n)| Ok(Chart::basket(m, n)?)),
        "welting" => pair("welting 2+2").and_then(|(m, n)| Ok(Chart::welting(m, n)?)),
        _ => Err(NamedPatternError::Unknown { name: text.to_owned() }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_listed_name_is_known() {
        for name in names() {
            assert!(named_pattern(name).is_ok(), "{name}");
        }
        assert_eq!(named_pattern(" Rib 1 x 3").unwrap(), Chart::rib(1, 3).unwrap());
    }

    #[test]
    fn others_are_refused_with_the_reason() {
        let text = |name: &str| named_pattern(name).unwrap_err().to_string();
        assert!(text("lace").contains("no pattern"));
        assert!(text("garter 2x2").contains("no pattern"));
        assert!(text("rib").contains("\"rib 2x2\""));
        assert!(text("rib 2x").contains("two whole numbers"));
        assert!(text("rib 0x0").contains("empty"));
        assert!(text("basket 99999999x99999999").contains("limit"));
        assert!(text("rib 99999999999999999999x1").contains("two whole numbers"));
    }
}
