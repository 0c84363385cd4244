//! Weaves by name.

use super::draft::Draft;

/// What names of weaves look like.
pub const NAMES: &str = "\"plain\", \"twill 2/1\", \"satin 5\", \"satin 8 by 3\", \"sateen 5\", \"basket 2x2\"";

/// One repeat of a weave by its name: `plain` or `tabby`; `twill over/under`; `satin size`, perhaps `by step`, and `sateen`,
/// its other side; `basket ends x picks`, also `hopsack` and `rib`. `None` if there is none of that name.
#[must_use]
pub fn named_weave(name: &str) -> Option<Draft> {
    let name = name.to_lowercase().replace(" by ", " ");
    let (kind, rest) = name.trim().split_once(' ').unwrap_or((name.trim(), ""));
    let numbers: Option<Vec<usize>> = rest
        .split(|c: char| c.is_whitespace() || c == '/' || c == 'x' || c == '×')
        .filter(|part| !part.is_empty())
        .map(|part| part.parse().ok())
        .collect();
    match (kind, numbers?.as_slice()) {
        ("plain" | "tabby", []) => Some(Draft::plain()),
        ("twill", [over, under]) => Draft::twill(*over, *under).ok(),
        ("satin", &[size]) => satin(size),
        ("satin", &[size, step]) => Draft::satin(size, step).ok(),
        ("sateen", &[size]) => satin(size).map(|satin| satin.other_side()),
        ("basket" | "hopsack", &[n]) => Draft::basket(n, n).ok(),
        ("basket" | "hopsack" | "rib", &[ends, picks]) => Draft::basket(ends, picks).ok(),
        _ => None,
    }
}

/// The satin of the smallest step that makes one.
fn satin(size: usize) -> Option<Draft> {
    Draft::check_size(size as u64, size as u64).ok()?;
    (2..size).find_map(|step| Draft::satin(size, step).ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names() {
        assert_eq!(named_weave("Plain"), Some(Draft::plain()));
        assert_eq!(named_weave("twill 3/1"), Draft::twill(3, 1).ok());
        assert_eq!(named_weave("satin 8 by 3"), Draft::satin(8, 3).ok());
        assert_eq!(named_weave("satin 8"), Draft::satin(8, 3).ok());
        assert_eq!(named_weave("basket 2x3"), Draft::basket(2, 3).ok());
        assert_eq!(named_weave("sateen 5").unwrap().longest_floats(), [4, 4]);
        for wrong in
            ["", "satin 4", "satin 999999", "twill 2", "twill 0/1", "plain 3", "leno", "twill 18446744073709551615/1"]
                .into_iter()
                .chain(["satin 18446744073709551615", "satin 5 by 18446744073709551614", "sateen 99999999999999"])
        {
            assert_eq!(named_weave(wrong), None, "{wrong}");
        }
    }
}
