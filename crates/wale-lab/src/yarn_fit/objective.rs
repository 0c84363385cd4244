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
