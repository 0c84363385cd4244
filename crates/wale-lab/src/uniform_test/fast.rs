//! FAST of a tile: extension at three loads and along the bias, and what follows from them with its bending rigidity.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use super::UniformTestError;
use super::strip::UniformStrip;
use super::tensile::stretch_at_load;
use crate::shell::bias_extension::BIAS_LOAD;
use crate::virtual_test::fast::LOADS;

/// What a direction reports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UniformFastDirection {
    /// `E5`, `E20`, `E100`: stretch at the loads \[–\].
    pub extension: [f64; 3],
    /// Bending rigidity `B` that was given \[N·m\], and formability `F = (E20 − E5) B/14.7` \[m²\].
    pub bending: Option<[f64; 2]>,
}

/// What the tests report.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UniformFastResult {
    /// Weft and warp.
    pub directions: [UniformFastDirection; 2],
    /// `EB5`: stretch along the bias at 5 gf/cm \[–\].
    pub bias_extension: f64,
    /// Shear rigidity `G = 123/EB5`, with the stretch in per cent \[N/m\].
    pub shear_rigidity: f64,
}

/// Tests strips that `new` makes along a direction \[rad\], with the bending rigidities \[N·m\] along weft and warp if they are known.
///
/// # Errors
/// [`UniformTestError`].
pub fn uniform_fast<S: UniformStrip>(
    new: impl Fn(f64) -> Result<S, UniformTestError>,
    rigidity: Option<[f64; 2]>,
) -> Result<UniformFastResult, UniformTestError> {
    let mut directions = [UniformFastDirection { extension: [0.0; 3], bending: None }; 2];
    for (axis, angle) in [0.0, FRAC_PI_2].into_iter().enumerate() {
        let mut strip = new(angle)?;
        let mut extension = [0.0; 3];
        for (stretch, load) in extension.iter_mut().zip(LOADS) {
            *stretch = stretch_at_load(&mut strip, load)?.stretch;
        }
        let formability = |b: f64| (extension[1] - extension[0]) * b / (LOADS[1] - LOADS[0]);
        let bending = rigidity.map(|both| [both[axis], formability(both[axis])]);
        directions[axis] = UniformFastDirection { extension, bending };
    }
    let bias_extension = stretch_at_load(&mut new(FRAC_PI_4)?, BIAS_LOAD)?.stretch;
    Ok(UniformFastResult { directions, bias_extension, shear_rigidity: BIAS_LOAD / (4.0 * bias_extension) })
}
