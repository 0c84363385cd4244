//! A picture frame whose square of fabric is a tile: sheared evenly, as it is in the frame.

use std::f64::consts::FRAC_PI_4;

use super::{TestedTile, UniformTestError, positive};
use crate::virtual_test::picture_frame::FramePoint;
use crate::virtual_test::units::DEG;
use crate::virtual_test::{PictureFrameResult, PictureFrameTest};
use crate::yarn_tile::{CoarseDeformation, TileError, TileSolver};

/// Shears a tile as the bars of a frame do, that stay as long as they are: `F_s/L = dΨ/ds` with `s = sin γ`, as of a shell.
///
/// # Errors
/// [`UniformTestError`].
pub fn tile_picture_frame(
    tested: &TestedTile,
    test: &PictureFrameTest,
) -> Result<PictureFrameResult, UniformTestError> {
    positive("side of the frame", test.side)?;
    if !(test.largest > 0.0 && test.largest <= 85.0 * DEG) {
        let must = "above 0 and at most 85°, in radians";
        return Err(UniformTestError::Number { what: "largest angle of shear", value: test.largest, must });
    }
    let TestedTile { tile, material, settings } = tested;
    let mut solver = TileSolver::new(tile, material, settings.equilibrium).map_err(UniformTestError::at("rest"))?;
    // Shear force by length, and energy by area.
    let mut solve = |angle: f64| -> Result<[f64; 2], UniformTestError> {
        let place = format!("{:.1}° of shear", angle / DEG);
        let sine = angle.sin();
        let rate_angle = test.angle;
        let deformation = framed(rate_angle, sine);
        let found = solver.solve(&deformation).map_err(UniformTestError::at(place.clone()))?;
        if found.residual > settings.accepted {
            return Err(UniformTestError::at(place)(TileError::NoEquilibrium { residual: found.residual }));
        }
        let rate = turned(rate_angle, |sign| sign / (2.0 * (1.0 + sign * sine).sqrt()));
        let force = (0..2).map(|i| (0..2).map(|j| found.stress.plane[i][j] * rate[i][j]).sum::<f64>()).sum();
        Ok([force, found.energy_density])
    };
    let rest = solve(0.0)?;
    let count = test.points.max(2);
    let step = test.largest / count as f64;
    let back = solve(-step)?;
    let mut points = Vec::new();
    let mut rigidity = 0.0;
    for k in 0..=count {
        let angle = step * k as f64;
        let [shear_force, energy] = solve(angle)?;
        if k == 1 {
            rigidity = (shear_force - back[0]) / (2.0 * step.sin());
        }
        let half = FRAC_PI_4 - 0.5 * angle;
        points.push(FramePoint {
            angle,
            travel: 2.0 * test.side * (half.cos() - FRAC_PI_4.cos()),
            force: 2.0 * half.cos() * shear_force * test.side,
            shear_force,
            energy: test.side * test.side * (energy - rest[1]),
        });
    }
    Ok(PictureFrameResult { points, rigidity })
}

/// The deformation `U = √C` of a frame whose first bar is at an angle \[rad\]: `C` has ones and `s = sin γ` along the bars.
fn framed(angle: f64, sine: f64) -> CoarseDeformation {
    let plane = turned(angle, |sign| (1.0 + sign * sine).sqrt());
    CoarseDeformation { plane, ..CoarseDeformation::stretched(angle, 0.0, 0.0) }
}

/// `Σ λ(±1) v v^T` over the diagonals `v` of a frame at an angle, by rows.
fn turned(angle: f64, eigenvalue: impl Fn(f64) -> f64) -> [[f64; 2]; 2] {
    let (sin, cos) = (angle + FRAC_PI_4).sin_cos();
    let (long, short) = (eigenvalue(1.0), eigenvalue(-1.0));
    let across = (long - short) * sin * cos;
    [[long * cos * cos + short * sin * sin, across], [across, long * sin * sin + short * cos * cos]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::uniform_test::bending::tests::woven;

    #[test]
    fn bars_keep_their_length_and_stand_at_the_angle() {
        let (angle, gamma) = (0.3, 0.4f64);
        let u = framed(angle, gamma.sin()).plane;
        let bar = |a: f64| [0, 1].map(|i: usize| u[i][0] * a.cos() + u[i][1] * a.sin());
        let (one, other) = (bar(angle), bar(angle + 2.0 * FRAC_PI_4));
        assert!((one[0].hypot(one[1]) - 1.0).abs() < 1e-14 && (other[0].hypot(other[1]) - 1.0).abs() < 1e-14);
        assert!((one[0] * other[0] + one[1] * other[1] - gamma.sin()).abs() < 1e-14);
    }

    #[test]
    fn work_of_the_frame_is_what_the_tile_stores() {
        let test = PictureFrameTest { largest: 15.0 * DEG, points: 30, angle: 0.2, ..PictureFrameTest::default() };
        let found = tile_picture_frame(&woven(), &test).unwrap();
        let work: f64 =
            found.points.windows(2).map(|p| 0.5 * (p[1].travel - p[0].travel) * (p[0].force + p[1].force)).sum();
        let last = found.points[found.points.len() - 1];
        assert!((work / last.energy - 1.0).abs() < 2e-3, "{work} {last:?}");
        assert!(found.rigidity > 0.0);
        assert!(tile_picture_frame(&woven(), &PictureFrameTest { largest: 2.0, ..test }).is_err());
    }
}
