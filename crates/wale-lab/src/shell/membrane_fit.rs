//! The in-plane stiffnesses whose stretch tests come out as measured [Sperl2022, Eq. 2].

use std::convert::Infallible;

use rayon::prelude::*;
use wale::energy::{BendingStiffness, MembraneStiffness};

use super::card::ShellCard;
use super::clamped_stretch::ClampedStretch;
use super::error::ShellError;

pub use super::membrane_law::MembraneLaw;
use super::stretch_curve::{StretchCurve, StretchPoint};
use super::uniform::uniform_stretch;
use crate::least_squares::{LeastSquaresFit, LeastSquaresSettings, Residuals, fit};

/// How a curve was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StretchTest {
    /// In uniform stretch without stress across; forces are a width \[N/m\].
    Uniform,
    /// Between clamps; forces are of the swatch \[N\]. The direction is that of each curve.
    Clamped(ClampedStretch),
}

/// A measured curve.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredStretch {
    /// The curve.
    pub curve: StretchCurve,
    /// How it was measured; of a clamped test, its angle is the curve's.
    pub test: StretchTest,
    /// Whether compression was measured too.
    pub compression: bool,
}

impl MeasuredStretch {
    /// A curve with its compression.
    #[must_use]
    pub fn new(curve: StretchCurve, test: StretchTest) -> Self {
        Self { curve, test, compression: true }
    }
}

/// How a fit is done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MembraneFitSettings {
    /// The law that is fitted.
    pub law: MembraneLaw,
    /// Targets along each measured curve.
    pub targets: usize,
    /// Starts, at most [`MembraneFitSettings::MOST_STARTS`].
    pub starts: usize,
    /// One start that is known to be near, in place of those \[N/m\].
    pub begin: Option<MembraneStiffness>,
    /// Most evaluations a start.
    pub max_evaluations: usize,
    /// Noise of the data that intervals reckon with even where the fit is closer, over the mean measured value \[–\].
    pub least_noise: f64,
}

impl MembraneFitSettings {
    /// Most starts.
    pub const MOST_STARTS: usize = STARTS.len();
}

impl Default for MembraneFitSettings {
    fn default() -> Self {
        let law = MembraneLaw::Quadratic;
        Self { law, targets: 6, starts: STARTS.len(), begin: None, max_evaluations: 120, least_noise: 0.01 }
    }
}

/// A fabric that was fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct MembraneFit {
    /// The stiffnesses \[N/m\].
    pub stiffness: MembraneStiffness,
    /// Mean error of the force at the targets over their mean measured force \[–\].
    pub force_error: f64,
    /// Mean error of the compression at the targets over their mean measured compression \[–\]; zero where none was measured.
    pub compression_error: f64,
    /// The targets, curve by curve, and what the fitted fabric does there.
    pub points: Vec<Vec<[StretchPoint; 2]>>,
    /// Its numbers, and how well each is known, in the order of [`MembraneStiffness::NAMES`].
    pub least_squares: LeastSquaresFit<{ MembraneStiffness::COUNT }>,
}

impl MembraneFit {
    /// Names of the stiffnesses that the data do not determine within a factor of three.
    #[must_use]
    pub fn undetermined(&self) -> Vec<&'static str> {
        self.least_squares.undetermined().into_iter().map(|k| MembraneStiffness::NAMES[k]).collect()
    }
}

/// Starts, as parts of the moduli along weft and warp (`xx`, `yy`), of their geometric mean (`xy`, `n1`, `n2`) and of the
/// modulus along the bias (`ss`).
const STARTS: [[f64; MembraneStiffness::QUADRATIC]; 6] = [
    [0.8, 0.10, 0.8, 0.30, 0.03, 0.03],
    [0.8, 0.30, 0.8, 0.30, 0.001, 0.10],
    [0.5, 0.01, 0.5, 0.10, 0.10, 0.001],
    [1.0, 0.01, 1.0, 0.50, 0.001, 0.01],
    [0.5, 0.20, 0.5, 0.05, 0.01, 0.30],
    [0.3, 0.05, 0.3, 0.30, 0.30, 0.10],
];
/// Starts of the stiffening, as parts of the moduli of each direction, and its coupling.
const STIFFENING: [[f64; MembraneStiffness::COUNT - MembraneStiffness::QUADRATIC]; STARTS.len()] = [
    [3.0, 3.0, 3.0, 0.3],
    [10.0, 10.0, 10.0, 0.6],
    [1.0, 1.0, 1.0, 0.1],
    [2.0, 2.0, 2.0, 0.8],
    [10.0, 10.0, 3.0, 0.1],
    [3.0, 10.0, 1.0, 0.5],
];
/// How much a stiffness would rather stay where it is guessed, over what a target weighs: too little to move what the tests tell, and
/// enough that what they do not tell ends as a fabric and not at a bound.
const GUESS: f64 = 1e-3;
/// Mean compression below which a width was not measured, or did not change.
const LEAST_COMPRESSION: f64 = 1e-6;

/// What is measured at a target, and its derivatives by the stiffnesses.
struct Answer {
    point: StretchPoint,
    force_slope: [f64; MembraneStiffness::COUNT],
    compression_slope: [f64; MembraneStiffness::COUNT],
}

/// Fits the stiffnesses to measured curves, of whichever directions there are.
///
/// Minimises `Σ ((f − f_i)/f̄)² + ((c − c_i)/c̄)²` over targets that lie evenly along each curve, with the mean measured force
/// `f̄` and compression `c̄` as weights [Sperl2022, Eq. 2], by Levenberg–Marquardt in the logarithms of the stiffnesses with exact derivatives
/// through equilibrium. Coordinates that only a missing direction would tell are reported, not guessed: see
/// [`MembraneFit::undetermined`].
///
/// # Errors
/// [`ShellError::Fit`] if there is nothing measured, or no start can be tested; [`ShellError::Number`] if a curve folds back.
pub fn fit_membrane(measured: &[MeasuredStretch], settings: &MembraneFitSettings) -> Result<MembraneFit, ShellError> {
    let targets: Vec<Vec<StretchPoint>> =
        measured.iter().map(|one| one.curve.targets(settings.targets)).collect::<Result<_, _>>()?;
    // Each target with whether its compression was measured.
    let all = || targets.iter().zip(measured).flat_map(|(targets, one)| targets.iter().map(|t| (t, one.compression)));
    let count = all().count();
    let wide = all().filter(|(_, measured)| *measured).count();
    let mean_force = all().map(|(t, _)| t.force.abs()).sum::<f64>() / count as f64;
    let mean_compression =
        all().filter(|(_, measured)| *measured).map(|(t, _)| t.compression.abs()).sum::<f64>() / wide.max(1) as f64;
    // Written so that a NaN fails.
    if !(mean_force > 0.0 && mean_force < f64::INFINITY && mean_compression.is_finite()) {
        return Err(ShellError::Fit("no force was measured".into()));
    }
    let weigh_compression = if mean_compression > LEAST_COMPRESSION { 1.0 / mean_compression } else { 0.0 };

    let answers = |parameters: &[f64; MembraneStiffness::COUNT]| -> Option<Vec<Vec<Answer>>> {
        let stiffness = settings.law.stiffness(parameters);
        let one = |k: usize| answer(&measured[k].test, &stiffness, measured[k].curve.angle, &targets[k]);
        (0..measured.len()).into_par_iter().map(one).collect()
    };
    let law = settings.law;
    let (starts, unit) = starts(measured, &targets, settings.starts);
    let guess = law.coordinates(&starts[0]);
    let mut places: Vec<_> = starts.iter().map(|start| law.coordinates(start)).collect();
    if let Some(begin) = settings.begin {
        // What the paper's law does not use stays where it is held.
        let begin = begin.to_array();
        places = vec![law.coordinates(&std::array::from_fn(|k| if begin[k] == 0.0 { starts[0][k] } else { begin[k] }))];
    }
    let evaluate = |place: &[f64; MembraneStiffness::COUNT]| {
        let mut out = Residuals::default();
        for k in 0..MembraneStiffness::COUNT {
            let slopes = std::array::from_fn(|j| if j == k { GUESS } else { 0.0 });
            out.push(GUESS * (place[k] - guess[k]), slopes);
        }
        let numbers = law.numbers(place);
        for ((target, compression), answer) in all().zip(answers(&numbers)?.iter().flatten()) {
            let slopes = |slope: &[f64; MembraneStiffness::COUNT], weight: f64| {
                law.by_coordinates(&numbers, slope).map(|slope| weight * slope)
            };
            let force = (answer.point.force - target.force) / mean_force;
            out.push(force, slopes(&answer.force_slope, 1.0 / mean_force));
            if compression && weigh_compression > 0.0 {
                let compression = (answer.point.compression - target.compression) * weigh_compression;
                out.push(compression, slopes(&answer.compression_slope, weigh_compression));
            }
        }
        Some(out)
    };

    let bounds = law.bounds(unit, &guess);
    let search = LeastSquaresSettings::to_the_end(settings.max_evaluations, bounds, settings.least_noise);
    let failed = || ShellError::Fit("no start led to a fabric whose tests could be done".into());
    let least_squares = match fit(|place: &_, _| Ok::<_, Infallible>(evaluate(place)), &places, &search) {
        Ok(found) => found.ok_or_else(failed)?,
        Err(never) => match never {},
    };
    let parameters = law.numbers(&least_squares.parameters);
    let uncertainty = law.factors(&least_squares.parameters, &least_squares.uncertainty);
    let least_squares = LeastSquaresFit { parameters, uncertainty, ..least_squares };
    let found = answers(&least_squares.parameters).ok_or_else(failed)?;
    let points: Vec<Vec<[StretchPoint; 2]>> = targets
        .iter()
        .zip(&found)
        .map(|(targets, answers)| targets.iter().zip(answers).map(|(target, answer)| [*target, answer.point]).collect())
        .collect();
    let pairs = || points.iter().flatten().zip(all()).map(|([target, found], (_, measured))| (target, found, measured));
    let force_off: f64 = pairs().map(|(target, found, _)| (found.force - target.force).abs()).sum();
    let compression_off: f64 = pairs()
        .filter(|(.., measured)| *measured)
        .map(|(target, found, _)| (found.compression - target.compression).abs())
        .sum();
    Ok(MembraneFit {
        stiffness: law.stiffness(&least_squares.parameters),
        force_error: force_off / count as f64 / mean_force,
        compression_error: compression_off / wide.max(1) as f64 * weigh_compression,
        points,
        least_squares,
    })
}

/// The targets of one direction; `None` where the fabric cannot be tested.
fn answer(
    test: &StretchTest,
    stiffness: &MembraneStiffness,
    angle: f64,
    targets: &[StretchPoint],
) -> Option<Vec<Answer>> {
    let card = ShellCard { membrane: *stiffness, bending: BendingStiffness::isotropic(0.0), areal_mass: 0.0 };
    card.check().ok()?;
    match test {
        StretchTest::Uniform => targets
            .iter()
            .map(|target| {
                let found = uniform_stretch(stiffness, angle, target.stretch).ok()?;
                let super::uniform::UniformPoint { point, force_slope, compression_slope } = found;
                Some(Answer { point, force_slope, compression_slope })
            })
            .collect(),
        StretchTest::Clamped(test) => {
            let stretches: Vec<f64> = targets.iter().map(|target| target.stretch).collect();
            let found = ClampedStretch { angle, ..*test }.run_with_slopes(&card, &stretches).ok()?;
            let answer = |found: super::clamped_stretch::SensitivePoint| Answer {
                point: found.point,
                force_slope: found.force_slope,
                compression_slope: found.compression_slope,
            };
            Some(found.into_iter().map(answer).collect())
        }
    }
}

/// Where to begin, from the moduli of the measured curves; and the geometric mean of the moduli \[N/m\].
fn starts(
    measured: &[MeasuredStretch],
    targets: &[Vec<StretchPoint>],
    count: usize,
) -> (Vec<[f64; MembraneStiffness::COUNT]>, f64) {
    // The curve nearest to a direction stands in for one that is missing.
    let modulus = |angle: f64| {
        let away = |k: &usize| (measured[*k].curve.angle - angle).abs();
        let nearest =
            (0..measured.len()).filter(|&k| !targets[k].is_empty()).min_by(|a, b| away(a).total_cmp(&away(b)));
        let points = nearest.map_or(&[][..], |k| &targets[k][..]);
        let width =
            nearest.map_or(1.0, |k| if let StretchTest::Clamped(test) = &measured[k].test { test.width } else { 1.0 });
        let sum = |of: fn(&StretchPoint) -> f64| points.iter().map(of).sum::<f64>();
        (sum(|p| p.force) / (width * sum(|p| p.stretch))).abs().clamp(1e-6, 1e9)
    };
    let right = std::f64::consts::FRAC_PI_2;
    let (weft, bias, warp) = (modulus(0.0), modulus(0.5 * right), modulus(right));
    let mean = (weft * warp).sqrt();
    let units = [weft, mean, warp, bias, mean, mean, weft, warp, bias, 1.0];
    let start = |(quadratic, stiffening): (&[f64; 6], &[f64; 4])| {
        let mut parts = quadratic.iter().chain(stiffening);
        units.map(|unit| unit * parts.next().copied().unwrap_or(1.0))
    };
    let starts = STARTS.iter().zip(&STIFFENING).take(count.max(1)).map(start).collect();
    (starts, mean)
}

#[cfg(test)]
mod tests {
    use super::super::uniform::uniform_curve;
    use super::*;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

    const TRUTH: MembraneStiffness =
        MembraneStiffness { xx: 25.0, xy: 4.0, yy: 80.0, ss: 7.0, n1: 1.5, n2: 3.0, ..MembraneStiffness::NONE };

    fn uniform(angle: f64, largest: f64) -> MeasuredStretch {
        MeasuredStretch::new(uniform_curve(&TRUTH, angle, largest, 60).unwrap(), StretchTest::Uniform)
    }

    #[test]
    fn a_curve_without_compression_says_nothing_about_it() {
        let mut curves: Vec<_> = [(0.0, 1.2), (FRAC_PI_4, 0.8), (FRAC_PI_2, 0.5)].map(|(a, s)| uniform(a, s)).into();
        let whole = fit_membrane(&curves, &MembraneFitSettings::default()).unwrap();
        for point in &mut curves[2].curve.points {
            point.compression = 0.7;
        }
        curves[2].compression = false;
        let fit = fit_membrane(&curves, &MembraneFitSettings::default()).unwrap();
        assert!(fit.force_error < 1e-3 && fit.compression_error < 1e-3, "{fit:?}");
        assert!((fit.stiffness.xx / whole.stiffness.xx - 1.0).abs() < 0.05, "{:?}", fit.stiffness);
    }

    #[test]
    fn uniform_curves_of_a_known_fabric_are_recovered() {
        let curves: Vec<_> =
            [(0.0, 1.2), (FRAC_PI_4, 0.8), (FRAC_PI_2, 0.5)].map(|(angle, largest)| uniform(angle, largest)).into();
        let fit = fit_membrane(&curves, &MembraneFitSettings::default()).unwrap();
        assert!(fit.force_error < 1e-3 && fit.compression_error < 1e-3, "{fit:?}");
        assert!((fit.stiffness.yy / TRUTH.yy - 1.0).abs() < 0.05, "{:?}", fit.stiffness);
    }

    #[test]
    fn a_fabric_that_stiffens_is_recovered() {
        let truth = MembraneStiffness {
            xy: -4.0,
            stiffening_xx: 60.0,
            stiffening_yy: 400.0,
            stiffening_ss: 9.0,
            stiffening_xy: 0.5,
            ..TRUTH
        };
        let curves: Vec<_> = [(0.0, 0.5), (FRAC_PI_4, 0.4), (FRAC_PI_2, 0.3)]
            .map(|(a, s)| MeasuredStretch::new(uniform_curve(&truth, a, s, 60).unwrap(), StretchTest::Uniform))
            .into();
        let fitted =
            |law| fit_membrane(&curves, &MembraneFitSettings { law, ..MembraneFitSettings::default() }).unwrap();
        let (stiffening, quadratic) = (fitted(MembraneLaw::Stiffening), fitted(MembraneLaw::Quadratic));
        assert!(stiffening.force_error < 2e-3 && stiffening.compression_error < 1e-2, "{stiffening:?}");
        assert!((stiffening.stiffness.stiffening_yy / 400.0 - 1.0).abs() < 0.2, "{:?}", stiffening.stiffness);
        assert!(quadratic.force_error > 0.02 && !quadratic.stiffness.stiffens(), "{quadratic:?}");
    }

    #[test]
    fn what_a_missing_direction_would_tell_is_reported() {
        let fit = fit_membrane(&[uniform(0.0, 0.8)], &MembraneFitSettings::default()).unwrap();
        assert!(fit.force_error < 0.01);
        let missing = fit.undetermined();
        assert!(missing.contains(&"k_ss") && !missing.contains(&"k_xx"), "{missing:?}");
        // What nothing tells stays a fabric.
        let found = fit.stiffness;
        assert!(
            (0.02..2.0).contains(&(found.ss / found.xx)) && (0.1..10.0).contains(&(found.yy / found.xx)),
            "{found:?}"
        );
    }

    #[test]
    fn nothing_measured_is_an_error() {
        let empty = MeasuredStretch::new(StretchCurve { angle: 0.0, points: Vec::new() }, StretchTest::Uniform);
        for curves in [&[][..], &[empty][..]] {
            let error = fit_membrane(curves, &MembraneFitSettings::default()).unwrap_err();
            assert!(error.to_string().contains("no force"), "{error}");
        }
    }
}
