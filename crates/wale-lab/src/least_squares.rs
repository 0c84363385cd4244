//! Nonlinear least squares from several starts, in coordinates of which one unit is a large change: logarithms, as a rule.

use std::convert::Infallible;

use rayon::prelude::*;
use wale_numerics::dense::SmallSystem;
use wale_numerics::eigen::symmetric_eigen;

/// Residuals and, for each, its derivatives by the `P` coordinates.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Residuals<const P: usize> {
    /// Residuals, scaled so that one is as bad as any other \[–\].
    pub values: Vec<f64>,
    /// Their derivatives, a row each; none where they were not asked for.
    pub slopes: Vec<[f64; P]>,
}

impl<const P: usize> Residuals<P> {
    /// Adds a residual with its derivatives.
    pub fn push(&mut self, value: f64, slopes: [f64; P]) {
        self.values.push(value);
        self.slopes.push(slopes);
    }
    /// Sum of squares.
    #[must_use]
    pub fn cost(&self) -> f64 {
        self.values.iter().map(|r| r * r).sum()
    }
    /// `JᵀJ`.
    fn normal(&self) -> [[f64; P]; P] {
        let mut normal = [[0.0; P]; P];
        for row in &self.slopes {
            for i in 0..P {
                for j in 0..P {
                    normal[i][j] += row[i] * row[j];
                }
            }
        }
        normal
    }
}

/// How parameters are looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeastSquaresSettings<const P: usize> {
    /// Most evaluations a start.
    pub max_evaluations: usize,
    /// Least and largest value of each parameter; one whose bounds meet is held.
    pub bounds: [[f64; 2]; P],
    /// Noise of the data that a parameter's interval reckons with even where the fit is closer \[–\].
    pub least_noise: f64,
    /// Relative gain of a step below which the fit is at its end.
    pub least_gain: f64,
    /// Sum of squares below which nothing is left to be gained.
    pub enough: f64,
}

/// Parameters that were found.
#[derive(Clone, Debug, PartialEq)]
pub struct LeastSquaresFit<const P: usize> {
    /// The parameters.
    pub parameters: [f64; P],
    /// Sum of squares.
    pub cost: f64,
    /// That where the best start began.
    pub start_cost: f64,
    /// Singular values of the Jacobian, ascending: how much the residuals change for a change by one unit, a factor e of a logarithm.
    pub singular_values: [f64; P],
    /// The combinations of coordinates that belong to them.
    pub combinations: [[f64; P]; P],
    /// Factor within which each parameter is known with 95 % confidence, `e` to the power of the interval of its coordinate: it may be
    /// that much smaller or larger; infinite where the data do not say, one where it is held.
    pub uncertainty: [f64; P],
    /// Starts that led to parameters at all.
    pub starts_that_ended: usize,
    /// Evaluations of the best start.
    pub evaluations: usize,
}

impl<const P: usize> LeastSquaresFit<P> {
    /// Parameters that the data do not determine within a factor of three, by their index.
    #[must_use]
    pub fn undetermined(&self) -> Vec<usize> {
        (0..P).filter(|&k| self.uncertainty[k] > 3.0).collect()
    }
}

/// Largest change of a coordinate in a step.
const LONGEST_STEP: f64 = 1.5;
/// Damping at first, and that at which nothing is gained by more.
const FIRST_DAMPING: f64 = 1e-2;
const LARGEST_DAMPING: f64 = 1e10;

/// Positive parameters of least squares: their coordinates are logarithms, and `evaluate` gets the parameters and gives derivatives by
/// the logarithms. Otherwise as [`fit`].
pub fn fit_positive<const P: usize>(
    evaluate: impl Fn(&[f64; P]) -> Option<Residuals<P>> + Sync,
    starts: &[[f64; P]],
    settings: &LeastSquaresSettings<P>,
) -> Option<LeastSquaresFit<P>> {
    let logs = LeastSquaresSettings { bounds: settings.bounds.map(|pair| pair.map(f64::ln)), ..*settings };
    let starts: Vec<[f64; P]> = starts.iter().map(|start| start.map(f64::ln)).collect();
    let found = fit(|at: &[f64; P], _| Ok::<_, Infallible>(evaluate(&at.map(f64::exp))), &starts, &logs);
    let found = match found {
        Ok(found) => found?,
        Err(never) => match never {},
    };
    Some(LeastSquaresFit { parameters: found.parameters.map(f64::exp), ..found })
}

/// The coordinates of least squares by Levenberg–Marquardt from each start; the best of all, the earlier where two are equal.
///
/// `evaluate` gets coordinates and whether derivatives are wanted, which it may give unasked; it answers `None` where a test of them
/// fails: that start then goes another way, or is left out.
/// Starts run in parallel; the result does not depend on the number of threads. `None` if none led anywhere.
///
/// # Errors
/// The first that `evaluate` ends with, in the order of the starts; all starts are followed as far as they go.
pub fn fit<const P: usize, E: Send>(
    evaluate: impl Fn(&[f64; P], bool) -> Result<Option<Residuals<P>>, E> + Sync,
    starts: &[[f64; P]],
    settings: &LeastSquaresSettings<P>,
) -> Result<Option<LeastSquaresFit<P>>, E> {
    let ends: Vec<Result<Option<Descent<P>>, E>> =
        starts.par_iter().map(|start| descend(&evaluate, start, settings)).collect();
    let found: Vec<Descent<P>> = ends.into_iter().collect::<Result<Vec<_>, E>>()?.into_iter().flatten().collect();
    let starts_that_ended = found.len();
    let Some(best) = found.into_iter().reduce(|best, next| if next.cost < best.cost { next } else { best }) else {
        return Ok(None);
    };
    let (squares, combinations) = symmetric_eigen(&best.here.normal());
    let fitted = (0..P).filter(|&k| settings.is_free(k)).count();
    let freedom = best.here.values.len().saturating_sub(fitted).max(1);
    let noise = (best.cost / freedom as f64).max(settings.least_noise * settings.least_noise);
    let mut uncertainty = [1.0; P];
    for (k, factor) in uncertainty.iter_mut().enumerate().filter(|(k, _)| settings.is_free(*k)) {
        let variance: f64 = (0..P)
            .filter(|&m| combinations[m][k].abs() > 1e-9)
            .map(|m| noise * combinations[m][k] * combinations[m][k] / squares[m].max(0.0))
            .sum();
        *factor = (1.96 * variance.sqrt()).exp();
    }
    Ok(Some(LeastSquaresFit {
        parameters: best.place,
        cost: best.cost,
        start_cost: best.start_cost,
        singular_values: squares.map(|square| square.max(0.0).sqrt()),
        combinations,
        uncertainty,
        starts_that_ended,
        evaluations: best.evaluations,
    }))
}

impl<const P: usize> LeastSquaresSettings<P> {
    /// A fit that goes on until a step gains nothing that numbers can tell.
    #[must_use]
    pub fn to_the_end(max_evaluations: usize, bounds: [[f64; 2]; P], least_noise: f64) -> Self {
        Self { max_evaluations, bounds, least_noise, least_gain: 1e-9, enough: 0.0 }
    }

    fn is_free(&self, k: usize) -> bool {
        self.bounds[k][0] < self.bounds[k][1]
    }
}

struct Descent<const P: usize> {
    place: [f64; P],
    here: Residuals<P>,
    cost: f64,
    start_cost: f64,
    evaluations: usize,
}

fn descend<const P: usize, E>(
    evaluate: &impl Fn(&[f64; P], bool) -> Result<Option<Residuals<P>>, E>,
    start: &[f64; P],
    settings: &LeastSquaresSettings<P>,
) -> Result<Option<Descent<P>>, E> {
    let within = |k: usize, value: f64| value.clamp(settings.bounds[k][0], settings.bounds[k][1]);
    let mut place: [f64; P] = std::array::from_fn(|k| within(k, start[k]));
    let finite = |r: &Residuals<P>| r.cost().is_finite() && r.slopes.iter().flatten().all(|s| s.is_finite());
    let at = |place: &[f64; P], slopes: bool| -> Result<Option<Residuals<P>>, E> {
        let mut found = evaluate(place, slopes)?.filter(finite);
        for row in found.iter_mut().flat_map(|found| &mut found.slopes) {
            (0..P).filter(|&k| !settings.is_free(k)).for_each(|k| row[k] = 0.0);
        }
        Ok(found)
    };
    let Some(mut here) = at(&place, true)? else { return Ok(None) };
    let start_cost = here.cost();
    let mut cost = start_cost;
    let mut damping = FIRST_DAMPING;
    let mut evaluations = 1;
    let mut system = SmallSystem::default();
    while evaluations < settings.max_evaluations && damping < LARGEST_DAMPING && cost > settings.enough {
        let normal = here.normal();
        let slope: [f64; P] =
            std::array::from_fn(|i| here.values.iter().zip(&here.slopes).map(|(r, row)| r * row[i]).sum());
        let largest = (0..P).fold(0.0f64, |m, i| m.max(normal[i][i]));
        system.clear(P);
        for i in 0..P {
            // A parameter at a bound that would go on past it is held.
            let [low, high] = settings.bounds[i];
            let held = (place[i] <= low && slope[i] > 0.0) || (place[i] >= high && slope[i] < 0.0);
            for j in 0..P {
                system.matrix[P * i + j] = normal[i][j];
            }
            system.matrix[P * i + i] +=
                damping * (normal[i][i] + 1e-6 * largest) + if held { 1e12 * largest } else { 0.0 };
            system.right_side[i] = -slope[i];
        }
        if !system.solve() {
            damping = (4.0 * damping).max(1e-12);
            continue;
        }
        let longest = system.right_side.iter().fold(0.0f64, |m, d| m.max(d.abs()));
        let part = (LONGEST_STEP / longest.max(f64::MIN_POSITIVE)).min(1.0);
        let trial: [f64; P] = std::array::from_fn(|i| within(i, place[i] + part * system.right_side[i]));
        evaluations += 1;
        let found = match at(&trial, false)? {
            // Derivatives are asked for where the step is taken.
            Some(found) if found.cost() < cost && found.slopes.len() < found.values.len() => at(&trial, true)?,
            found => found,
        };
        match found.map(|found| (found.cost(), found)) {
            Some((lower, found)) if lower < cost => {
                let gain = (cost - lower) / cost;
                (place, here, cost) = (trial, found, lower);
                damping = (0.2 * damping).max(1e-14);
                if gain < settings.least_gain {
                    break;
                }
            }
            _ if part * longest < 1e-10 => break,
            _ => damping *= 5.0,
        }
    }
    Ok(Some(Descent { place, here, cost, start_cost, evaluations }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings<const P: usize>() -> LeastSquaresSettings<P> {
        LeastSquaresSettings::to_the_end(200, [[1e-6, 1e6]; P], 0.01)
    }

    /// `y = a e^{−bt}` with a third parameter that plays no role.
    fn decay(truth: [f64; 2]) -> impl Fn(&[f64; 3]) -> Option<Residuals<3>> {
        move |&[a, b, _]| {
            let mut out = Residuals::default();
            for k in 0..10 {
                let t = 0.3 * f64::from(k);
                let (y, measured) = (a * (-b * t).exp(), truth[0] * (-truth[1] * t).exp());
                out.push(y - measured, [y, -b * t * y, 0.0]);
            }
            Some(out)
        }
    }

    #[test]
    fn parameters_are_found_and_the_idle_one_is_told() {
        let fit = fit_positive(decay([3.0, 0.7]), &[[1.0, 1.0, 1.0], [0.01, 5.0, 2.0]], &settings()).unwrap();
        assert!((fit.parameters[0] - 3.0).abs() < 1e-6 && (fit.parameters[1] - 0.7).abs() < 1e-6, "{fit:?}");
        assert_eq!(fit.undetermined(), [2]);
        assert!(fit.singular_values[0] < 1e-9 && fit.combinations[0][2].abs() > 0.999);
        assert!(fit.uncertainty[0] < 1.1 && fit.uncertainty[2].is_infinite());
    }

    /// How often, of so many fits to noisy data, the truth of `a` and of `b` lies within their intervals; `held` keeps `b` where it is.
    fn covered(held: bool) -> [f64; 2] {
        const FITS: usize = 400;
        const NOISE: f64 = 0.05;
        let truth = [3.0, 0.7];
        let bounds = [[1e-6, 1e6], if held { [truth[1]; 2] } else { [1e-6, 1e6] }];
        let settings = LeastSquaresSettings::<2> { bounds, least_noise: 1e-6, ..settings() };
        let mut state = 7_u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut counts = [0usize; 2];
        for _ in 0..FITS {
            // Sums of twelve are normal enough.
            let noise: Vec<f64> = (0..20).map(|_| NOISE * ((0..12).map(|_| uniform()).sum::<f64>() - 6.0)).collect();
            let evaluate = |&[a, b]: &[f64; 2]| {
                let mut out = Residuals::default();
                for (k, noise) in noise.iter().enumerate() {
                    let t = 0.15 * k as f64;
                    let y = a * (-b * t).exp();
                    out.push(y - truth[0] * (-truth[1] * t).exp() - noise, [y, -b * t * y]);
                }
                Some(out)
            };
            let fit = fit_positive(evaluate, &[[2.0, truth[1]]], &settings).unwrap();
            for (k, count) in counts.iter_mut().enumerate() {
                *count += usize::from((fit.parameters[k] / truth[k]).ln().abs() <= fit.uncertainty[k].ln());
            }
        }
        counts.map(|count| count as f64 / FITS as f64)
    }

    #[test]
    fn what_is_held_leaves_an_interval_as_if_it_were_no_number() {
        let measured = [3.1, 2.0, 1.9, 1.2, 0.9];
        let residuals = |a: f64, b: f64, count: usize| {
            let rows = measured.iter().enumerate().map(move |(k, y)| (0.5 * k as f64, y));
            rows.map(|(t, y)| (a * (-b * t).exp() - y, a * (-b * t).exp(), t)).take(count).collect::<Vec<_>>()
        };
        let alone = |&[a]: &[f64; 1]| {
            let mut out = Residuals::default();
            residuals(a, 0.7, 5).into_iter().for_each(|(r, by_a, _)| out.push(r, [by_a]));
            Some(out)
        };
        let beside = |&[a, b, _]: &[f64; 3]| {
            let mut out = Residuals::default();
            residuals(a, b, 5).into_iter().for_each(|(r, by_a, t)| out.push(r, [by_a, -b * t * by_a, 0.3 * t]));
            Some(out)
        };
        let one = fit_positive(alone, &[[2.0]], &settings()).unwrap();
        let held = LeastSquaresSettings { bounds: [[1e-6, 1e6], [0.7; 2], [1.0; 2]], ..settings() };
        let three = fit_positive(beside, &[[2.0, 0.7, 1.0]], &held).unwrap();
        assert!((three.parameters[0] / one.parameters[0] - 1.0).abs() < 1e-9);
        assert!(
            (three.uncertainty[0] / one.uncertainty[0] - 1.0).abs() < 1e-9,
            "{:?} {:?}",
            three.uncertainty,
            one.uncertainty
        );
        assert_eq!(three.uncertainty[1..], [1.0, 1.0]);
    }

    #[test]
    fn nineteen_of_twenty_intervals_hold_the_truth() {
        for (held, fitted) in [(false, 2), (true, 1)] {
            for part in &covered(held)[..fitted] {
                assert!((0.91..=0.98).contains(part), "{part} of {fitted}");
            }
        }
    }

    #[test]
    fn failures_cost_a_start_or_a_step_and_no_more() {
        let known = decay([3.0, 0.7]);
        let patchy = |p: &[f64; 3]| if p[0] > 3.2 || p[1] > 2.0 { None } else { known(p) };
        let fit = fit_positive(patchy, &[[1.0, 5.0, 1.0], [0.5, 0.3, 1.0]], &settings()).unwrap();
        assert_eq!(fit.starts_that_ended, 1);
        assert!((fit.parameters[0] - 3.0).abs() < 1e-6, "{fit:?}");
        assert!(fit_positive(|_: &[f64; 3]| None, &[[1.0; 3]], &settings()).is_none());
    }

    #[test]
    fn a_parameter_that_wants_to_be_zero_stops_at_its_bound() {
        // y = a + b with b = −1 in truth: b goes to its bound, a to what is left.
        let sum = |&[a, b]: &[f64; 2]| {
            let mut out = Residuals::default();
            for t in [1.0, 2.0, 3.0] {
                out.push(a * t + b - (2.0 * t - 1.0), [a * t, b]);
            }
            Some(out)
        };
        let fit = fit_positive(sum, &[[1.0, 1.0]], &settings()).unwrap();
        assert!(fit.parameters[1] < 1e-5);
        // Least squares of a t alone: a = Σ t(2t − 1)/Σ t² = 22/14.
        assert!((fit.parameters[0] - 22.0 / 14.0).abs() < 1e-5, "{fit:?}");
    }

    #[test]
    fn a_parameter_whose_bounds_meet_is_held_and_the_rest_fitted() {
        let mut held = settings();
        held.bounds[1] = [0.5, 0.5];
        let fit = fit_positive(decay([3.0, 0.5]), &[[1.0, 2.0, 1.0]], &held).unwrap();
        assert!((fit.parameters[0] - 3.0).abs() < 1e-6 && fit.parameters[1] == 0.5, "{fit:?}");
        assert_eq!(fit.uncertainty[1], 1.0);
    }

    #[test]
    fn an_evaluation_that_ends_ends_the_fit_and_every_start_goes_as_far_as_it_can() {
        let asked = std::sync::Mutex::new(Vec::new());
        let evaluate = |at: &[f64; 1], _| {
            if at[0].fract() == 0.0 {
                let mut out = Residuals::default();
                out.push(at[0] - 7.5, [1.0]);
                return Ok(Some(out));
            }
            asked.lock().unwrap().push(at[0]);
            Err(at[0])
        };
        let whole = LeastSquaresSettings::to_the_end(9, [[-10.0, 10.0]], 0.01);
        let end = fit(evaluate, &[[1.0], [2.0]], &whole).unwrap_err();
        let mut asked = asked.into_inner().unwrap();
        asked.sort_by(f64::total_cmp);
        assert!(asked.len() == 2 && end == asked[0], "{asked:?} {end}");
    }
}
