//! Units that stand in the heads of columns.

/// A unit: how it may be written, and its size in SI units.
type Unit = (&'static str, f64);

const FORCE: &[Unit] = &[
    ("N", 1.0),
    ("mN", 1e-3),
    ("cN", 1e-2),
    ("kN", 1e3),
    ("gf", 9.806_65e-3),
    ("kgf", 9.806_65),
    ("lbf", 4.448_221_615),
];
const LENGTH: &[Unit] = &[("mm", 1e-3), ("cm", 1e-2), ("m", 1.0), ("um", 1e-6), ("µm", 1e-6), ("in", 0.0254)];
const RATIO: &[Unit] =
    &[("%", 1e-2), ("percent", 1e-2), ("1", 1.0), ("-", 1.0), ("–", 1.0), ("mm/mm", 1.0), ("m/m", 1.0)];
const LINE_FORCE: &[Unit] = &[
    ("N/m", 1.0),
    ("N/mm", 1e3),
    ("N/cm", 1e2),
    ("cN/cm", 1.0),
    ("mN/mm", 1.0),
    ("gf/cm", 0.980_665),
    ("N_per_m", 1.0),
    ("N_per_mm", 1e3),
    ("N_per_cm", 1e2),
];

/// What a column is measured in.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Kind {
    Force,
    Length,
    Ratio,
    LineForce,
}

impl Kind {
    fn units(self) -> &'static [Unit] {
        match self {
            Self::Force => FORCE,
            Self::Length => LENGTH,
            Self::Ratio => RATIO,
            Self::LineForce => LINE_FORCE,
        }
    }

    /// Size of a unit \[SI\]; `None` if it is none of this kind.
    pub fn size(self, unit: &str) -> Option<f64> {
        self.units().iter().find(|(name, _)| *name == unit).map(|(_, size)| *size)
    }

    fn of(unit: &str) -> Option<(Self, f64)> {
        let kinds = [Self::Force, Self::Length, Self::Ratio, Self::LineForce];
        kinds.into_iter().find_map(|kind| Some((kind, kind.size(unit)?)))
    }

    /// The units of this kind, for messages.
    pub fn known(self) -> String {
        self.units().iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ")
    }
}

/// Whether some kind has this unit.
pub(super) fn is_unit(text: &str) -> bool {
    Kind::of(text).is_some()
}

/// The words of a head and its unit: `Load (cN)`, `Dehnung [%]`, `force_N`, `line_force_N_per_mm`, `Load, N`, `Load / N`.
pub(super) fn split_head(head: &str) -> (String, Option<String>) {
    let head = head.trim();
    for (open, close) in [('(', ')'), ('[', ']'), ('<', '>')] {
        if let Some((words, rest)) = head.split_once(open)
            && let Some((unit, _)) = rest.split_once(close)
        {
            return (words.trim().to_owned(), Some(unit.trim().to_owned()));
        }
    }
    if head.ends_with('%') {
        return (head.trim_end_matches('%').trim().to_owned(), Some("%".to_owned()));
    }
    for separator in [", ", " / ", " in ", "_", " "] {
        for (at, _) in head.match_indices(separator) {
            let unit = &head[at + separator.len()..];
            if is_unit(unit) && unit != "1" && unit != "-" {
                return (head[..at].trim().to_owned(), Some(unit.to_owned()));
            }
        }
    }
    (head.to_owned(), None)
}

/// All units that a head claims: the one that [`split_head`] finds, and then those that contradict it. `Load (N) (cN)` claims two,
/// and so does `force_N (cN)`.
pub(super) fn claimed_units(head: &str) -> Vec<String> {
    let (words, unit) = split_head(head);
    let Some(unit) = unit else { return Vec::new() };
    let Some(first) = Kind::of(&unit) else { return vec![unit] };
    let brackets = head.split(['(', '[', '<']).skip(1).filter_map(|part| part.split([')', ']', '>']).next());
    // `Weg in (mm)` is in millimetres, not in inches.
    let words = words.strip_suffix(" in").unwrap_or(&words);
    let contradicts = |claim: &String| {
        // Beside a force, `(1)` and `(-)` are no units.
        let is_sign = first.0 != Kind::Ratio && ["1", "-", "–"].contains(&claim.as_str());
        !is_sign && Kind::of(claim).is_some_and(|claim| claim != first)
    };
    let others: Vec<String> =
        brackets.map(|text| text.trim().to_owned()).chain(split_head(words).1).filter(contradicts).collect();
    [unit].into_iter().chain(others).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heads_may_claim_units_that_contradict_each_other() {
        let one = ["Load (N)", "Load (N) (N)", "Load (1) (MPa)", "Weg in (mm)", "Load (N) (1)", "Strain % (percent)"];
        for head in one.into_iter().chain(["line_force_N_per_mm (N/mm)", "Load (N) (raw)"]) {
            assert_eq!(claimed_units(head).len(), 1, "{head}");
        }
        assert_eq!(claimed_units("Load (N) (cN)"), ["N", "cN"]);
        assert_eq!(claimed_units("force_N (cN)"), ["cN", "N"]);
        assert_eq!(claimed_units("Strain (%) (-)"), ["%", "-"]);
        assert_eq!(claimed_units("Force (N) [N/mm]"), ["N", "N/mm"]);
        assert!(claimed_units("Load").is_empty());
    }

    #[test]
    fn heads_are_words_and_a_unit() {
        let split = |head: &str| {
            let (words, unit) = split_head(head);
            (words, unit.unwrap_or_default())
        };
        let is = |words: &str, unit: &str| (words.to_owned(), unit.to_owned());
        assert_eq!(split("Load (cN)"), is("Load", "cN"));
        assert_eq!(split("Dehnung [%]"), is("Dehnung", "%"));
        assert_eq!(split("force_N"), is("force", "N"));
        assert_eq!(split("line_force_N_per_mm"), is("line_force", "N_per_mm"));
        assert_eq!(split("Extension, mm"), is("Extension", "mm"));
        assert_eq!(split("Strain %"), is("Strain", "%"));
        assert_eq!(split("axial_strain_clamp"), is("axial_strain_clamp", ""));
        assert_eq!(split("force"), is("force", ""));
    }

    #[test]
    fn units_have_the_size_that_textbooks_give() {
        assert_eq!(Kind::LineForce.size("gf/cm"), Some(0.980_665));
        assert_eq!(Kind::Force.size("gf"), Some(9.806_65e-3));
        assert_eq!(Kind::Length.size("N"), None);
    }
}
