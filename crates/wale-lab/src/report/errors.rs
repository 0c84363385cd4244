//! How far a fit is from what was measured, direction by direction.

use super::Told;
use crate::shell::{StretchCurve, StretchPoint};
use crate::yarn_fit::of_fabric::COMFORT;
use crate::yarn_fit::problem::Evaluation;
use crate::yarn_fit::run::YarnFit;
use crate::yarn_fit::{BendingTarget, Target};
use crate::yarn_tile::BendingAnswer;

/// Mean errors of one direction \[–\], in comfort and over the whole range; none where nothing was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionErrors {
    /// From the weft \[rad\].
    pub direction: f64,
    /// Of force or stress.
    pub force: [Option<f64>; 2],
    /// Of compression.
    pub compression: [Option<f64>; 2],
}

/// Errors of a shell, over the mean of what was measured in all directions [Sperl2022, Fig. 13].
#[derive(Clone, Debug, PartialEq)]
pub struct ShellErrors {
    /// By direction of the stretch tests.
    pub stretch: Vec<DirectionErrors>,
    /// Of the loops' aspect by their direction \[rad\].
    pub loops: Vec<[f64; 2]>,
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    (count > 0.0).then(|| sum / count)
}

/// Where comfort ends in each stretch test, as [`crate::yarn_fit::of_fabric::uniform_targets`] has it.
fn comforts(told: &Told<'_>) -> Vec<f64> {
    let curves: Vec<Vec<StretchPoint>> = told
        .fabric
        .stretch
        .iter()
        .zip(&told.shell.membrane.points)
        .map(|(test, points)| {
            let a_width = |[measured, _]: &[StretchPoint; 2]| StretchPoint {
                force: measured.force / test.specimen.width,
                ..*measured
            };
            points.iter().map(a_width).collect()
        })
        .collect();
    let largest = curves.iter().flatten().fold(0.0f64, |m, point| m.max(point.force));
    curves
        .into_iter()
        .map(|points| {
            if points.is_empty() {
                0.0
            } else {
                Target::new(&StretchCurve { angle: 0.0, points }, false, COMFORT * largest).comfort
            }
        })
        .collect()
}

/// Errors of the shell.
#[must_use]
pub fn shell_errors(told: &Told<'_>) -> ShellErrors {
    let membrane = &told.shell.membrane;
    let all = || told.fabric.stretch.iter().zip(&membrane.points);
    let mean_force = mean(all().flat_map(|(_, points)| points).map(|[measured, _]| measured.force));
    let measured_compression = all().filter(|(test, _)| test.curve.compression.is_some());
    let mean_compression = mean(measured_compression.flat_map(|(_, points)| points).map(|[m, _]| m.compression.abs()));
    let comforts = comforts(told);
    let stretch = all()
        .zip(comforts)
        .map(|((test, points), comfort)| {
            let within =
                |limit: f64| points.iter().filter(move |[measured, _]| measured.stretch <= limit * (1.0 + 1e-9));
            let over = |by: Option<f64>, limit: f64, of: fn(&StretchPoint) -> f64| {
                let by = by.filter(|by| *by > 0.0)?;
                mean(within(limit).map(|[measured, found]| (of(measured) - of(found)).abs() / by))
            };
            let both = |by: Option<f64>, of: fn(&StretchPoint) -> f64| {
                [comfort, f64::INFINITY].map(|limit| over(by, limit, of))
            };
            DirectionErrors {
                direction: test.direction,
                force: both(mean_force, |point| point.force),
                compression: both(mean_compression.filter(|_| test.curve.compression.is_some()), |point| {
                    point.compression
                }),
            }
        })
        .collect();
    let loops = told.shell.bending.iter().flat_map(|fit| told.fabric.bending.iter().zip(&fit.points));
    let mean_aspect = mean(told.fabric.bending.iter().flat_map(|test| test.curve.aspect_ratio.iter().copied()));
    let loops = loops.filter_map(|(test, found)| {
        let pairs = test.curve.aspect_ratio.iter().zip(found);
        Some([test.direction, mean(pairs.map(|(measured, found)| (measured - found.aspect).abs()))? / mean_aspect?])
    });
    ShellErrors { stretch, loops: loops.collect() }
}

/// Errors of a yarn by direction, over the values at the end of comfort [Sperl2022, Fig. 15].
#[must_use]
pub fn yarn_errors(fit: &YarnFit) -> Vec<DirectionErrors> {
    let one = |(target, answers): (&Target, &Vec<crate::yarn_fit::Answer<{ crate::yarn_fit::problem::P }>>)| {
        let [stress, compression] = target.comfort_values();
        let off = |limit: f64, of: &dyn Fn(&[f64; 3], &StretchPoint) -> f64| {
            let pairs = target.points.iter().zip(answers).filter(|(point, _)| point[0] <= limit * (1.0 + 1e-9));
            mean(pairs.map(|(point, answer)| of(point, &answer.point)))
        };
        let force = |point: &[f64; 3], found: &StretchPoint| (found.force - point[1]).abs() / (1.0 + point[0]) / stress;
        let narrows = |point: &[f64; 3], found: &StretchPoint| (found.compression - point[2]).abs() / compression;
        let limits = [target.comfort, f64::INFINITY];
        DirectionErrors {
            direction: target.angle,
            force: limits.map(|limit| off(limit, &force)),
            compression: limits.map(|limit| if target.compression { off(limit, &narrows) } else { None }),
        }
    };
    fit.targets.iter().zip(&fit.evaluation.stretch).map(one).collect()
}

/// Mean error of bending stiffnesses over their targets \[–\] [Sperl2022, section 9.1].
#[must_use]
pub fn bending_error(targets: &[BendingTarget], evaluation: &Evaluation) -> Option<f64> {
    let off = |(target, answer): (&BendingTarget, &BendingAnswer)| (answer.stiffness / target.stiffness - 1.0).abs();
    mean(targets.iter().zip(&evaluation.bending).map(off))
}
