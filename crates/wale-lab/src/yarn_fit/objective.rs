//! How far a model is from its targets [Sperl2022, Eq. 11].

use serde::{Deserialize, Serialize};

use super::pull::Answer;
use super::target::Target;
use crate::least_squares::Residuals;
use crate::yarn_tile::{BendingAnswer, RodParameter};

/// A bending stiffness that the tile should have.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BendingTarget {
    /// Direction of the curvature from the weft \[rad\].
    pub angle: f64,
    /// Stiffness \[N·m\].
    pub stiffness: f64,
    /// Curvature to which the tile is bent both ways \[1/m\].
    pub curvature: f64,
}

/// Errors as [Sperl2022, Fig. 15] shows them, over the values at the end of comfort \[–\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct YarnFitError {
    /// Mean error of the stress in the range of comfort.
    pub comfort: f64,
    /// Mean error of the stress over the whole range.
    pub full: f64,
    /// Mean error of the compression over the whole range.
    pub compression: f64,
}

/// Weight of a datum: one in comfort, less beyond [Sperl2022, section 7.3.1].
fn weight(comfort: f64, target: f64) -> f64 {
    comfort / comfort.max(target.abs())
}

/// Residuals of one direction: second Piola-Kirchhoff stress and compression, over their values at the end of comfort. `to_coordinates`
/// turns derivatives by the numbers of the model into those by the coordinates of the fit.
pub fn add_residuals<const P: usize>(
    target: &Target,
    answers: &[Answer<P>],
    to_coordinates: impl Fn([f64; P]) -> [f64; P],
    out: &mut Residuals<P>,
) {
    let [stress, compression] = target.comfort_values();
    // So that a curve of many points weighs as much as one of few.
    let share = (1.0 / target.points.len() as f64).sqrt();
    for (&[s, force, c], answer) in target.points.iter().zip(answers) {
        let wanted = force / (1.0 + s);
        let factor = share * weight(stress, wanted).sqrt() / stress;
        let slope = answer.stress_slope.map(|d| factor * d / (1.0 + s));
        out.push(factor * (answer.point.force / (1.0 + s) - wanted), to_coordinates(slope));
        if target.compression {
            let factor = share * weight(compression, c).sqrt() / compression;
            let slope = answer.compression_slope.map(|d| factor * d);
            out.push(factor * (answer.point.compression - c), to_coordinates(slope));
        }
    }
}

/// Residuals of bending stiffnesses, over their targets [Sperl2022, section 9.1].
pub fn add_bending_residuals(
    targets: &[BendingTarget],
    answers: &[BendingAnswer],
    to_coordinates: impl Fn([f64; RodParameter::COUNT]) -> [f64; RodParameter::COUNT],
    out: &mut Residuals<{ RodParameter::COUNT }>,
) {
    let share = (1.0 / targets.len().max(1) as f64).sqrt();
    for (target, answer) in targets.iter().zip(answers) {
        let factor = share / target.stiffness;
        out.push(factor * (answer.stiffness - target.stiffness), to_coordinates(answer.slope.map(|d| factor * d)));
    }
}

/// Errors over several directions.
#[must_use]
pub fn errors<const P: usize>(targets: &[Target], answers: &[Vec<Answer<P>>]) -> YarnFitError {
    let (mut sums, mut counts) = ([0.0; 3], [0usize; 3]);
    for (target, answers) in targets.iter().zip(answers) {
        let [stress, compression] = target.comfort_values();
        for (&[s, force, c], answer) in target.points.iter().zip(answers) {
            let off = (answer.point.force - force).abs() / (1.0 + s) / stress;
            let mut add = |k: usize, value: f64| {
                sums[k] += value;
                counts[k] += 1;
            };
            if s <= target.comfort * (1.0 + 1e-9) {
                add(0, off);
            }
            add(1, off);
            if target.compression {
                add(2, (answer.point.compression - c).abs() / compression);
            }
        }
    }
    let [comfort, full, compression] = std::array::from_fn(|k| sums[k] / counts[k].max(1) as f64);
    YarnFitError { comfort, full, compression }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shell::{StretchCurve, StretchPoint};

    #[test]
    fn residuals_are_second_piola_stresses_and_compressions_over_those_at_the_end_of_comfort() {
        let point = |stretch, force, compression| StretchPoint { stretch, force, compression };
        let curve = StretchCurve { angle: 0.0, points: vec![point(0.1, 11.0, 0.02), point(0.2, 36.0, 0.05)] };
        let target = Target::new(&curve, true, 11.0);
        // A tenth more force than measured, and half as much again of compression.
        let answer = |stretch, force: f64, compression: f64| Answer {
            point: point(stretch, 1.1 * force, 1.5 * compression),
            stress_slope: [1.0],
            compression_slope: [0.5],
        };
        let answers = [answer(0.1, 11.0, 0.02), answer(0.2, 36.0, 0.05)];
        let mut out = Residuals::default();
        add_residuals(&target, &answers, |slope: [f64; 1]| slope.map(|s| 2.0 * s), &mut out);
        // 11 N/m at 10 % is a stress of 10 N/m; the 30 N/m at 20 % weigh a third of it, the compression there two fifths.
        let share = 0.5f64.sqrt();
        let beyond = [(1.0 / 3.0f64).sqrt(), 0.4f64.sqrt()];
        let wanted = [share * 0.1, share * 0.5, share * beyond[0] * 0.3, share * beyond[1] * 1.25];
        for (found, wanted) in out.values.iter().zip(wanted) {
            assert!((found - wanted).abs() < 1e-12, "{:?} {wanted}", out.values);
        }
        assert!((out.slopes[0][0] - 2.0 * share / 10.0 / 1.1).abs() < 1e-12);
        assert!((out.slopes[3][0] - 2.0 * share * beyond[1] / 0.02 * 0.5).abs() < 1e-12);
        let errors = errors(&[target], &[answers.to_vec()]);
        let close = |found: f64, wanted: f64| (found - wanted).abs() < 1e-12;
        assert!(
            close(errors.comfort, 0.1) && close(errors.full, 0.2) && close(errors.compression, 0.875),
            "{errors:?}"
        );
    }
}
