//! What the tile of a fitted yarn foretells of a thin shell where no test was made: stiffnesses that stay open, and bending.
//!
//! A fabric that was pulled along courses and wales alone has a shell that does not know how it shears, and one of which nobody
//! measured bending does not hang. The yarn that was fitted to the same tests does know, since it has to lie somehow
//! between the courses and wales: its tile is pulled along the directions without a test, and bent.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use wale::energy::{BendingStiffness, MembraneStiffness};

use crate::fabric_file::{FabricFile, direction_name};
use crate::least_squares::{LeastSquaresSettings, Residuals, fit_positive};
use crate::shell::of_fabric::ShellFit;
use crate::shell::uniform::uniform_stretch;
use crate::shell::{StretchCurve, StretchPoint};
use crate::uniform_test::{TestedTile, TileBendingTest};
use crate::yarn_fit::pull;

/// Points of a curve that is foretold.
const POINTS: usize = 8;
/// How often a tile that does not come to rest is pulled half as far.
const HALVINGS: usize = 3;
/// The stiffnesses that may be foretold: `k_xx`, `k_xy`, `k_yy`, `k_ss`, in the order of [`MembraneStiffness::NAMES`].
const FORETOLD: usize = 4;
/// Bounds of a stiffness, over the largest modulus that is foretold \[–\].
const BOUNDS: [f64; 2] = [1e-4, 1e2];

/// Puts into a shell's card what its yarn foretells, and says so.
pub fn foretell(fabric: &FabricFile, shell: &mut ShellFit, tested: &TestedTile) {
    if let Some((stiffness, curves)) = membrane(fabric, shell, tested) {
        let along: Vec<String> = curves.iter().map(|curve| direction_name(curve.angle)).collect();
        for k in open_stiffnesses(shell).collect::<Vec<_>>() {
            let (name, value) = (MembraneStiffness::NAMES[k], stiffness.to_array()[k]);
            let along = along.join(" and ");
            shell.open.push(format!("{name} is {value:.4} N/m as the fitted yarn foretells it along the {along}"));
        }
        shell.card.membrane = stiffness;
    }
    if shell.card.bending.is_none()
        && let Some(stiffness) = bending(tested)
    {
        shell.card.bending = Some(stiffness);
        let [weft, bias, warp] = stiffness.to_array().map(|hinge| 2e6 * hinge);
        let what = format!("bending is {weft:.1}, {bias:.1} and {warp:.1} µN·m as the fitted yarn foretells it");
        shell.open.push(what);
    }
}

/// Which of the stiffnesses that may be foretold the tests leave open.
fn open_stiffnesses(shell: &ShellFit) -> impl Iterator<Item = usize> {
    shell.membrane.least_squares.undetermined().into_iter().filter(|&k| k < FORETOLD)
}

/// The shell whose open stiffnesses are such that it stretches, along the directions without a test, as its yarn foretells; with what that
/// foretold.
fn membrane(
    fabric: &FabricFile,
    shell: &ShellFit,
    tested: &TestedTile,
) -> Option<(MembraneStiffness, Vec<StretchCurve>)> {
    let open: Vec<usize> = open_stiffnesses(shell).collect();
    let largest = fabric.stretch.iter().filter_map(|test| test.curve.stretch.last().copied()).reduce(f64::min)?;
    let curves: Vec<StretchCurve> = fabric.unstretched().filter_map(|angle| curve(tested, angle, largest)).collect();
    if open.is_empty() || curves.is_empty() {
        return None;
    }
    Some((completed(&shell.card.membrane, &open, &curves)?, curves))
}

/// How a tile stretches along a direction, as far as it comes to rest.
fn curve(tested: &TestedTile, angle: f64, largest: f64) -> Option<StretchCurve> {
    (0..=HALVINGS).find_map(|halving| {
        let largest = largest * 0.5f64.powi(halving as i32);
        let stretches: Vec<f64> = (1..=POINTS).map(|k| largest * k as f64 / POINTS as f64).collect();
        let found = pull(&tested.tile, &tested.material, angle, &stretches, false, &tested.settings).ok()?;
        let points: Vec<StretchPoint> = found.into_iter().map(|answer| answer.point).collect();
        points.iter().all(|point| point.force > 0.0).then_some(StretchCurve { angle, points })
    })
}

/// A shell of which some stiffnesses are such that uniform stretches come nearest to given curves, in the sense of [Sperl2022, Eq. 2];
/// the others stay. `None` if there are none.
fn completed(stiffness: &MembraneStiffness, open: &[usize], curves: &[StretchCurve]) -> Option<MembraneStiffness> {
    let points = || curves.iter().flat_map(|curve| curve.points.iter().map(|point| (curve.angle, *point)));
    let mean = |of: fn(&StretchPoint) -> f64| {
        points().map(|(_, point)| of(&point).abs()).sum::<f64>() / points().count().max(1) as f64
    };
    let (force, compression) = (mean(|point| point.force), mean(|point| point.compression).max(f64::MIN_POSITIVE));
    let modulus = points().map(|(_, point)| point.force / point.stretch).fold(0.0, f64::max);
    let base = stiffness.to_array();
    let of = |numbers: &[f64; FORETOLD]| {
        let mut all = base;
        open.iter().for_each(|&k| all[k] = numbers[k]);
        MembraneStiffness::from_array(all)
    };
    let evaluate = |numbers: &[f64; FORETOLD]| {
        let mut out = Residuals::default();
        for (angle, point) in points() {
            let found = uniform_stretch(&of(numbers), angle, point.stretch).ok()?;
            let slopes = |slope: &[f64], unit: f64| std::array::from_fn(|k| slope[k] * numbers[k] / unit);
            out.push((found.point.force - point.force) / force, slopes(&found.force_slope, force));
            let narrower = found.point.compression - point.compression;
            out.push(narrower / compression, slopes(&found.compression_slope, compression));
        }
        Some(out)
    };
    let bounds: [[f64; 2]; FORETOLD] =
        std::array::from_fn(|k| if open.contains(&k) { BOUNDS.map(|part| part * modulus) } else { [1.0; 2] });
    let start = |part: f64| std::array::from_fn(|k| if open.contains(&k) { part * modulus } else { 1.0 });
    let settings = LeastSquaresSettings::to_the_end(60, bounds, 0.01);
    Some(of(&fit_positive(evaluate, &[start(0.1), start(0.5), start(2.0)], &settings)?.parameters))
}

/// How a tile bends along weft, bias and warp, if it does: `B = 2k_θ`.
fn bending(tested: &TestedTile) -> Option<BendingStiffness> {
    let rigidity = |angle: f64| {
        let found = TileBendingTest { angle, points: 2, ..TileBendingTest::default() }.run(tested).ok()?;
        (found.rigidity > 0.0).then_some(0.5 * found.rigidity)
    };
    Some(BendingStiffness { weft: rigidity(0.0)?, bias: rigidity(FRAC_PI_4)?, warp: rigidity(FRAC_PI_2)? })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shell::uniform::uniform_curve;

    #[test]
    fn what_tests_leave_open_is_found_from_the_curves_of_other_directions() {
        let whole = MembraneStiffness::quadratic([40.0, 9.0, 110.0, 6.0, 0.3, 0.5]);
        let bias = uniform_curve(&whole, FRAC_PI_4, 0.4, POINTS).unwrap();
        let unsheared = MembraneStiffness { ss: 1e-3, ..whole };
        let found = completed(&unsheared, &[3], std::slice::from_ref(&bias)).unwrap();
        assert!((found.ss / whole.ss - 1.0).abs() < 1e-6 && (found.xx, found.xy, found.yy) == (40.0, 9.0, 110.0));
        let warp = uniform_curve(&whole, FRAC_PI_2, 0.4, POINTS).unwrap();
        let along_weft = MembraneStiffness { ss: 1e-3, yy: 1.0, ..whole };
        let found = completed(&along_weft, &[2, 3], &[bias, warp]).unwrap();
        assert!((found.ss / whole.ss - 1.0).abs() < 1e-6 && (found.yy / whole.yy - 1.0).abs() < 1e-6, "{found:?}");
    }
}
