//! What an ablation shows, by its numbers alone, and whether [Sperl2022] says the same.

use super::Told;
use crate::yarn_fit::YarnFitError;
use crate::yarn_fit::ablation::{Ablated, AblationKind};
use crate::yarn_fit::problem::{P, Question, YarnProblem};
use crate::yarn_fit::run::YarnFit;

/// How an error changes when a part is taken away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Change {
    Rises,
    Falls,
    Stays,
}

/// Changes by less than a tenth of an error, or by less than half a percentage point, are none: fits that begin elsewhere differ by
/// as much.
const LEAST_PART: f64 = 0.1;
const LEAST_POINTS: f64 = 0.005;

impl Change {
    fn of(from: f64, to: f64) -> Self {
        match to - from {
            off if off.abs() <= LEAST_POINTS.max(LEAST_PART * from) => Self::Stays,
            off if off > 0.0 => Self::Rises,
            _ => Self::Falls,
        }
    }

    fn verb(self) -> &'static str {
        match self {
            Self::Rises => "rises",
            Self::Falls => "falls",
            Self::Stays => "stays",
        }
    }
}

/// What an ablation shows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Conclusion {
    /// In words.
    pub sentence: String,
    /// Whether the paper concludes the same; none where it says nothing.
    pub as_the_paper: Option<bool>,
}

/// What [Sperl2022] finds: how the errors of stress, compression and bending change.
fn paper(kind: AblationKind) -> &'static [(&'static str, Change)] {
    match kind {
        AblationKind::LocalOnly => &[("stress", Change::Rises)],
        AblationKind::OnePhase | AblationKind::NoRestShapes => {
            &[("stress", Change::Rises), ("compression", Change::Rises)]
        }
        AblationKind::WithBending => {
            &[("stress", Change::Rises), ("compression", Change::Rises), ("bending", Change::Falls)]
        }
        AblationKind::Swarm | AblationKind::NothingHolds => &[],
    }
}

/// What an ablation is compared with: the whole fit, or for COBYLA alone the swarm, as in the paper, where there is one.
fn reference<'a>(told: &Told<'a>, kind: AblationKind) -> Option<&'a YarnFit> {
    let swarm = told.ablated.iter().find(|one| one.kind == AblationKind::Swarm);
    let swarm = swarm.filter(|_| kind == AblationKind::LocalOnly).and_then(|one| one.fit.as_ref());
    swarm.or(told.yarn.map(|(_, fit)| fit))
}

/// Sum of squares of a fit at all measured points, of stretch alone: the same measure for every fit of a fabric.
#[must_use]
pub fn sum_of_squares(problem: &YarnProblem, fit: &YarnFit) -> f64 {
    let samples = fit.targets.first().map_or(1, |target| target.points.len());
    let question = Question::of([1.0; P], samples, false);
    let stretch_alone = YarnProblem { bending: Vec::new(), ..problem.clone() };
    stretch_alone.residuals(&question, &fit.evaluation).cost()
}

/// What an ablation shows; none if there is no whole fit.
#[must_use]
pub fn conclusion(told: &Told<'_>, ablated: &Ablated) -> Option<Conclusion> {
    let (problem, whole) = told.yarn?;
    let kind = ablated.kind;
    let Some(fit) = &ablated.fit else {
        let sentence = "The tile could be tested nowhere: no fit.".to_owned();
        return Some(Conclusion { sentence, as_the_paper: None });
    };
    let from = reference(told, kind)?;
    let against = if std::ptr::eq(from, whole) { "" } else { "Against swarm and COBYLA, " };
    let mut sentence = format!("{against}{}", changes(&from.error, &fit.error));
    let mut found = vec![("stress", of_stress(&from.error, &fit.error))];
    found.push(("compression", Change::of(from.error.compression, fit.error.compression)));
    if let Some([before, after]) = ablated.bending {
        let change = Change::of(before, after);
        sentence.push_str(&format!("; {}", words("of bending", before, after)));
        found.push(("bending", change));
    }
    sentence.push('.');
    let as_the_paper = verdict(kind, &found, &mut sentence);
    let [before, after] = [whole, fit].map(|fit| sum_of_squares(problem, fit));
    if kind.is_within_the_whole() && after < (1.0 - 0.01) * before {
        sentence.push_str(&format!(
            " Its sum of squares is smaller, {after:.4} against {before:.4}, though the whole fit may take the same numbers: \
             that has not found its best."
        ));
    }
    Some(Conclusion { sentence: capital(&sentence), as_the_paper })
}

/// How stress changes: by comfort, unless only the whole range changes.
fn of_stress(from: &YarnFitError, to: &YarnFitError) -> Change {
    match [Change::of(from.comfort, to.comfort), Change::of(from.full, to.full)] {
        [Change::Stays, full] => full,
        [comfort, _] => comfort,
    }
}

/// Compares with the paper, and says so.
fn verdict(kind: AblationKind, found: &[(&str, Change)], sentence: &mut String) -> Option<bool> {
    let figure = kind.figure()?;
    let claims = paper(kind);
    let other: Vec<String> = claims
        .iter()
        .filter_map(|(name, claim)| {
            let (_, change) = found.iter().find(|(found, _)| found == name)?;
            (change != claim).then(|| format!("the error of {name} {} there and {} here", claim.verb(), change.verb()))
        })
        .collect();
    if other.is_empty() {
        sentence.push_str(&format!(" The same as in the paper ({figure})."));
    } else {
        sentence.push_str(&format!(" Not as in the paper ({figure}): {}.", other.join(", ")));
    }
    Some(other.is_empty())
}

fn changes(from: &YarnFitError, to: &YarnFitError) -> String {
    [
        words("of stress in comfort", from.comfort, to.comfort),
        words("of stress over the whole range", from.full, to.full),
        words("of compression", from.compression, to.compression),
    ]
    .join("; ")
}

fn words(what: &str, from: f64, to: f64) -> String {
    let [a, b] = [from, to].map(|part| 100.0 * part);
    match Change::of(from, to) {
        Change::Stays => format!("the error {what} stays ({a:.1} and {b:.1} %)"),
        change => format!("the error {what} {} from {a:.1} to {b:.1} %", change.verb()),
    }
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(comfort: f64, full: f64, compression: f64) -> YarnFitError {
        YarnFitError { comfort, full, compression }
    }

    #[test]
    fn small_changes_are_none() {
        assert_eq!(Change::of(0.10, 0.109), Change::Stays);
        assert_eq!(Change::of(0.10, 0.12), Change::Rises);
        assert_eq!(Change::of(0.10, 0.08), Change::Falls);
        assert_eq!(Change::of(0.01, 0.014), Change::Stays);
    }

    #[test]
    fn a_verdict_follows_from_the_numbers() {
        let whole = error(0.07, 0.09, 0.15);
        for (other, same, says) in [
            (error(0.12, 0.16, 0.30), true, "The same as in the paper (Fig. 16)"),
            (error(0.12, 0.16, 0.10), false, "the error of compression rises there and falls here"),
            (error(0.07, 0.09, 0.15), false, "the error of stress rises there and stays here"),
            // Comfort stays, and the whole range does not.
            (error(0.07, 0.20, 0.30), true, "The same"),
        ] {
            let found = [
                ("stress", of_stress(&whole, &other)),
                ("compression", Change::of(whole.compression, other.compression)),
            ];
            let mut sentence = changes(&whole, &other);
            assert_eq!(verdict(AblationKind::OnePhase, &found, &mut sentence), Some(same), "{sentence}");
            assert!(sentence.contains(says), "{sentence}");
        }
        assert_eq!(verdict(AblationKind::NothingHolds, &[], &mut String::new()), None);
    }
}
