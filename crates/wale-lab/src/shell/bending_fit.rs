//! The three bending stiffnesses whose pear loops come out as measured [Sperl2022, section 5.2].

use rayon::prelude::*;
use wale::energy::BendingStiffness;

use super::card::ShellCard;
use super::error::{ShellError, positive};

use super::pear_loop::{PearLoop, PearPoint};
use crate::least_squares::{LeastSquaresFit, LeastSquaresSettings, Residuals, fit_positive};

/// Pear loops of a strip along one direction.
#[derive(Clone, Debug, PartialEq)]
pub struct PearCurve {
    /// How they were measured: the strip, its direction, its clamps.
    pub test: PearLoop,
    /// Distance between the clamps \[m\], and height over width of the loop \[–\].
    pub points: Vec<[f64; 2]>,
}

/// A fabric whose bending was fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct BendingFit {
    /// The three stiffnesses \[N·m\].
    pub stiffness: BendingStiffness,
    /// Mean error of the aspect over its mean measured value \[–\].
    pub aspect_error: f64,
    /// The fitted fabric's loops, curve by curve.
    pub points: Vec<Vec<PearPoint>>,
    /// How well each stiffness is known, in the order of [`BendingStiffness::NAMES`].
    pub least_squares: LeastSquaresFit<{ BendingStiffness::COUNT }>,
}

impl BendingFit {
    /// Names of the stiffnesses that the data do not determine within a factor of three.
    #[must_use]
    pub fn undetermined(&self) -> Vec<&'static str> {
        self.least_squares.undetermined().into_iter().map(|k| BendingStiffness::NAMES[k]).collect()
    }
}

/// Distances between the clamps of [Sperl2022, section 5.2]: seven, evenly from 3 to 34 mm \[m\].
#[must_use]
pub fn distances() -> [f64; 7] {
    std::array::from_fn(|k| 0.003 + 0.031 * k as f64 / 6.0)
}

/// Lengths `(2k_θ/W)^⅓` over which a fabric of weight `W` an area bends, at the starts \[m\].
const STARTS: [f64; 3] = [0.012, 0.02, 0.03];
/// Those below which it is too limp for any mesh, and above which its weight plays no role.
const BOUNDS: [f64; 2] = [0.002, 0.3];
/// Most evaluations a start.
const MOST_EVALUATIONS: usize = 40;

/// Fits the three bending stiffnesses to measured loops, of whichever directions there are. `card` says the rest.
///
/// Minimises `Σ (r − r_i)²` by Levenberg–Marquardt in the logarithms with exact derivatives through equilibrium. Loops know the
/// stiffness only by what their weight does to them; without weight there is nothing to fit.
///
/// # Errors
/// [`ShellError::Fit`] if nothing was measured or no start can be tested, [`ShellError::Number`] without weight.
pub fn fit_bending(curves: &[PearCurve], card: &ShellCard, least_noise: f64) -> Result<BendingFit, ShellError> {
    let measured: Vec<f64> = curves.iter().flat_map(|curve| curve.points.iter().map(|[_, r]| *r)).collect();
    let mean = measured.iter().map(|r| r.abs()).sum::<f64>() / measured.len() as f64;
    // Written so that a NaN fails.
    if !(mean > 0.0 && mean < f64::INFINITY) {
        return Err(ShellError::Fit("no loop was measured".into()));
    }
    let gravity = curves[0].test.gravity.iter().map(|g| g * g).sum::<f64>().sqrt();
    let weight = card.areal_mass * gravity;
    positive("weight an area", weight)?;
    let stiffness = |length: f64| 0.5 * weight * length.powi(3);

    let loops = |parameters: &[f64; BendingStiffness::COUNT]| -> Option<Vec<Vec<PearPoint>>> {
        let card = ShellCard { bending: BendingStiffness::from_array(*parameters), ..*card };
        let of = |curve: &PearCurve| {
            let distances: Vec<f64> = curve.points.iter().map(|[distance, _]| *distance).collect();
            curve.test.run(&card, &distances).ok()
        };
        curves.par_iter().map(of).collect()
    };
    let evaluate = |parameters: &[f64; BendingStiffness::COUNT]| {
        let mut out = Residuals::default();
        for (point, measured) in loops(parameters)?.iter().flatten().zip(&measured) {
            let slopes = std::array::from_fn(|k| point.aspect_slope[k] * parameters[k] / mean);
            out.push((point.aspect - measured) / mean, slopes);
        }
        Some(out)
    };
    let starts = STARTS.map(|length| [stiffness(length); BendingStiffness::COUNT]);
    let settings = LeastSquaresSettings::to_the_end(
        MOST_EVALUATIONS,
        [BOUNDS.map(stiffness); BendingStiffness::COUNT],
        least_noise,
    );
    let failed = || ShellError::Fit("no start led to a fabric whose loops came to rest".into());
    let least_squares = fit_positive(evaluate, &starts, &settings).ok_or_else(failed)?;
    let points = loops(&least_squares.parameters).ok_or_else(failed)?;
    let off: f64 = points.iter().flatten().zip(&measured).map(|(point, r)| (point.aspect - r).abs()).sum();
    Ok(BendingFit {
        stiffness: BendingStiffness::from_array(least_squares.parameters),
        aspect_error: off / measured.len() as f64 / mean,
        points,
        least_squares,
    })
}
