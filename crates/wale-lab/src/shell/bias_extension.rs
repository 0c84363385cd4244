//! Extension along the bias under a light load, and the shear rigidity that is read from it (FAST-3).

use std::f64::consts::FRAC_PI_4;

use wale::energy::MembraneStiffness;

use super::error::{ShellError, positive};
use super::uniform::uniform_stretch;

/// The load of the test, 5 gf/cm \[N/m\].
pub const BIAS_LOAD: f64 = 4.903_325;

/// What the test reports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BiasExtension {
    /// Stretch along the bias under the load \[–\]; `EB5` in per cent for the load of the test.
    pub stretch: f64,
    /// Shear rigidity: load over four times the stretch, that of a cloth whose yarns do not stretch \[N/m\]. For the load of the
    /// test it is the `G = 123/EB5` that laboratories use.
    pub shear_rigidity: f64,
}

/// Loads a strip along the bias, uniform and free to contract, with a force a width \[N/m\].
///
/// # Errors
/// [`ShellError`] if the load is not positive, or the strip collapses before it bears the load.
pub fn bias_extension(stiffness: &MembraneStiffness, load: f64) -> Result<BiasExtension, ShellError> {
    positive("load", load)?;
    let stress = |stretch: f64| Ok::<f64, ShellError>(uniform_stretch(stiffness, FRAC_PI_4, stretch)?.point.force);
    let (mut low, mut high) = (0.0, 0.01);
    while stress(high)? < load {
        low = high;
        high *= 2.0;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if stress(middle)? < load { low = middle } else { high = middle }
    }
    Ok(BiasExtension { stretch: high, shear_rigidity: load / (4.0 * high) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cloth_of_stiff_yarns_tells_its_shear_stiffness() {
        // Without an area term a light load along the bias of inextensible yarns meets k_ss alone.
        let cloth =
            MembraneStiffness { xx: 1e5, xy: 0.0, yy: 1e5, ss: 26.0, n1: 0.0, n2: 0.0, ..MembraneStiffness::NONE };
        let light = bias_extension(&cloth, 0.01).unwrap();
        assert!((light.shear_rigidity / 26.0 - 1.0).abs() < 2e-3, "{light:?}");
        // The laboratories' formula, with the stretch in per cent.
        let report = bias_extension(&cloth, BIAS_LOAD).unwrap();
        assert!((123.0 / (100.0 * report.stretch) / report.shear_rigidity - 1.0).abs() < 4e-3, "{report:?}");
        assert!(bias_extension(&cloth, 0.0).is_err());
    }
}
