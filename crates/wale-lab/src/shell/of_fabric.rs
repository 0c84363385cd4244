//! The thin shell of a fabric file: what its tests tell of it, and how well [Sperl2022, section 5].

use thiserror::Error;
use wale::energy::BendingStiffness;

use crate::card_file::CardFile;
use crate::fabric_file::{FabricFile, Rigidity};
use crate::shell::bending_fit::{BendingFit, PearCurve, fit_bending};
use crate::shell::membrane_fit::{MeasuredStretch, MembraneFit, MembraneFitSettings, StretchTest, fit_membrane};
use crate::shell::stretch_curve::{StretchCurve, StretchPoint};
use crate::shell::{ClampedStretch, PearLoop, ShellCard, ShellError};

/// Edge of the mesh over the smaller side of a specimen \[–\].
const EDGE: f64 = 0.1;

/// What was fitted.
#[derive(Clone, Debug)]
pub struct ShellFit {
    /// In-plane stiffnesses, by stretch tests as they were made: between clamps, at the specimens' sizes, or uniform.
    pub membrane: MembraneFit,
    /// Bending stiffnesses, if loops were measured and the mass is known.
    pub bending: Option<BendingFit>,
    /// The card of both.
    pub card: CardFile,
    /// What stays open, in words.
    pub open: Vec<String>,
}

/// Why nothing was fitted.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ShellFitError {
    /// There is no stretch test.
    #[error("the fabric has no stretch test to fit; add one as [[stretch]] with direction and file")]
    NoStretchTest,
    /// The shell could not be fitted.
    #[error(transparent)]
    Shell(#[from] ShellError),
}

/// A clamped test as if its swatch were a uniform strip.
fn strip(measured: &MeasuredStretch, test: &crate::fabric_file::StretchTest) -> MeasuredStretch {
    let mut one = measured.clone();
    one.test = StretchTest::Uniform;
    one.curve.points.iter_mut().for_each(|point| point.force /= test.specimen.width);
    one
}

/// Bending stiffnesses from rigidities that instruments printed, if there are those of weft and warp.
pub(crate) fn printed(rigidity: &[Rigidity], open: &mut Vec<String>) -> Option<BendingStiffness> {
    let along = |degrees: f64| rigidity.iter().find(|test| (test.direction.to_degrees() - degrees).abs() < 1.0);
    let [weft, warp] = [along(0.0)?.value, along(90.0)?.value];
    let mean = || {
        open.push("bending along the bias is taken for the mean of those along weft and warp".to_owned());
        (weft * warp).sqrt()
    };
    let bias = along(45.0).map_or_else(mean, |test| test.value);
    // B = 2k_θ.
    Some(BendingStiffness::from_array([weft, bias, warp].map(|rigidity| 0.5 * rigidity)))
}

/// Fits a thin shell to the tests of a fabric.
///
/// # Errors
/// [`ShellFitError`].
pub fn fit_shell(fabric: &FabricFile, settings: &MembraneFitSettings) -> Result<ShellFit, ShellFitError> {
    if fabric.stretch.is_empty() {
        return Err(ShellFitError::NoStretchTest);
    }
    let mut open = fabric.gaps();
    open.extend(fabric.assumed.iter().map(|what| format!("assumed: {what}")));
    let measured: Vec<MeasuredStretch> = fabric
        .stretch
        .iter()
        .map(|test| {
            let zeros = vec![0.0; test.curve.stretch.len()];
            let compression = test.curve.compression.as_ref().unwrap_or(&zeros);
            let points = test.curve.stretch.iter().zip(&test.curve.force).zip(compression);
            let mut points: Vec<StretchPoint> = points
                .map(|((&stretch, &force), &compression)| StretchPoint { stretch, force, compression })
                .filter(|point| point.stretch > 0.0)
                .collect();
            points.dedup_by(|b, a| b.stretch <= a.stretch);
            let size = test.specimen;
            let clamped = ClampedStretch {
                length: size.length,
                width: size.width,
                angle: test.direction,
                edge: EDGE * size.length.min(size.width),
                ..ClampedStretch::default()
            };
            MeasuredStretch {
                curve: StretchCurve { angle: test.direction, points },
                test: if test.uniform { StretchTest::Uniform } else { StretchTest::Clamped(clamped) },
                compression: test.curve.compression.is_some(),
            }
        })
        .collect();
    // A swatch is nearly a uniform strip, which costs nothing: from the best of many starts with strips, one is enough with swatches.
    let strips: Vec<MeasuredStretch> =
        measured.iter().zip(&fabric.stretch).map(|(one, test)| strip(one, test)).collect();
    let near = fit_membrane(&strips, settings)?;
    let membrane = fit_membrane(&measured, &MembraneFitSettings { begin: Some(near.stiffness), ..*settings })?;
    open.extend(membrane.undetermined().iter().map(|name| format!("{name} is not determined by these tests")));
    let bending = match fabric.areal_mass {
        _ if fabric.bending.is_empty() => None,
        None => {
            open.push("bending is not fitted: loops tell it by their weight, and areal_mass is not given".to_owned());
            None
        }
        Some(areal_mass) => {
            let card =
                ShellCard { membrane: membrane.stiffness, bending: BendingStiffness::isotropic(0.0), areal_mass };
            let curves: Vec<PearCurve> = fabric
                .bending
                .iter()
                .map(|test| PearCurve {
                    test: PearLoop {
                        length: test.specimen.length,
                        width: test.specimen.width,
                        angle: test.direction,
                        edge: EDGE * test.specimen.length.min(test.specimen.width),
                        ..PearLoop::default()
                    },
                    points: test.curve.distance.iter().zip(&test.curve.aspect_ratio).map(|(&d, &r)| [d, r]).collect(),
                })
                .collect();
            let fit = fit_bending(&curves, &card, settings.least_noise)?;
            open.extend(fit.undetermined().iter().map(|name| format!("{name} is not determined by these tests")));
            Some(fit)
        }
    };
    let card = CardFile {
        title: fabric.title.clone(),
        areal_mass: fabric.areal_mass,
        membrane: membrane.stiffness,
        membrane_within: membrane.least_squares.uncertainty,
        bending: bending.as_ref().map(|fit| fit.stiffness).or_else(|| printed(&fabric.rigidity, &mut open)),
        bending_within: bending.as_ref().map(|fit| fit.least_squares.uncertainty),
        yarn: None,
        contacts: None,
        open: open.clone(),
    };
    Ok(ShellFit { membrane, bending, card, open })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn printed_rigidities_become_a_card_as_far_as_they_go() {
        let test = |degrees: f64, value: f64| Rigidity { direction: degrees.to_radians(), value };
        let mut open = Vec::new();
        assert_eq!(printed(&[test(0.0, 1e-6)], &mut open), None);
        let found = printed(&[test(0.0, 1e-6), test(90.0, 4e-6)], &mut open).unwrap();
        assert!((found.bias - 1e-6).abs() < 1e-18 && open.len() == 1);
        assert_eq!((found.weft, found.warp), (0.5e-6, 2e-6), "B is twice the stiffness");
        let found = printed(&[test(0.0, 1e-6), test(45.0, 3e-6), test(90.0, 4e-6)], &mut open).unwrap();
        assert!(found.bias == 1.5e-6 && open.len() == 1);
    }
}
