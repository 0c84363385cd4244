//! Strips in uniform uniaxial stretch without stress across them [Sperl2022, Eq. 3].

use wale::energy::MembraneStiffness;
use wale_numerics::jet::{Jet, Real};

use super::error::{ShellError, positive};
use super::stretch_curve::{StretchCurve, StretchPoint};

/// A point of a uniform stretch with its derivatives by the stiffnesses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UniformPoint {
    /// Stretch, stress (force a width at rest \[N/m\]) and compression.
    pub point: StretchPoint,
    /// Derivatives of the stress by each stiffness \[–\].
    pub force_slope: [f64; MembraneStiffness::COUNT],
    /// Derivatives of the compression by each stiffness \[m/N\].
    pub compression_slope: [f64; MembraneStiffness::COUNT],
}

/// Energy density \[J/m²\] of `F = U diag(1 + s, w) Uᵀ`: `along = 1 + s` in the direction `angle` \[rad\] from the weft, and the
/// width `w = 1 − c` across it.
pub fn density<T: Real>(stiffness: &MembraneStiffness, angle: f64, along: T, width: T) -> T {
    let (metric, area_ratio) = metric(angle, along, width);
    stiffness.density(metric, area_ratio)
}

/// Its metric `[f₁·f₁, f₂·f₂, f₁·f₂]` and area ratio.
fn metric<T: Real>(angle: f64, along: T, width: T) -> ([T; 3], T) {
    let (sin, cos) = angle.sin_cos();
    let f11 = along.scale(cos * cos) + width.scale(sin * sin);
    let f22 = along.scale(sin * sin) + width.scale(cos * cos);
    let f12 = (along - width).scale(sin * cos);
    ([f11.square() + f12.square(), f22.square() + f12.square(), f12 * (f11 + f22)], along * width)
}

/// Widths among which the one of least energy is looked for first.
const NARROWEST: f64 = 1e-4;
const WIDEST: f64 = 4.0;
const SAMPLES: usize = 200;

/// The width `w = 1 − c` of least energy density at a stretch: the lowest of a scan, then Newton's method kept inside its
/// bracket by halving.
///
/// # Errors
/// [`ShellError::Collapsed`] where the energy falls all the way to no width, [`ShellError::Number`] if the stretch is not above −1.
pub fn width_without_stress(stiffness: &MembraneStiffness, angle: f64, stretch: f64) -> Result<f64, ShellError> {
    positive("1 + stretch", 1.0 + stretch)?;
    let sample = |k: usize| NARROWEST * (WIDEST / NARROWEST).powf(k as f64 / (SAMPLES - 1) as f64);
    let energy = |k: usize| density(stiffness, angle, 1.0 + stretch, sample(k));
    let best = (0..SAMPLES).min_by(|&a, &b| energy(a).total_cmp(&energy(b))).unwrap_or(0);
    if best == 0 || best == SAMPLES - 1 {
        return Err(ShellError::Collapsed { stretch });
    }
    let (mut low, mut high) = (sample(best - 1), sample(best + 1));
    let mut width = sample(best);
    for _ in 0..100 {
        let jet = density(stiffness, angle, Jet::<1>::constant(1.0 + stretch), Jet::<1>::variable(width, 0));
        let (slope, curvature) = (jet.gradient[0], jet.hessian()[0][0]);
        if slope > 0.0 {
            high = width
        } else {
            low = width
        }
        let newton = width - slope / curvature;
        let next = if curvature > 0.0 && newton > low && newton < high { newton } else { 0.5 * (low + high) };
        let done = (next - width).abs() <= 1e-15 * width;
        width = next;
        if done {
            break;
        }
    }
    Ok(width)
}

/// Stress and compression of a strip stretched by `stretch` \[–\] along `angle` \[rad\] from the weft, with their derivatives
/// by the stiffnesses, through the condition of no stress across.
///
/// # Errors
/// As [`width_without_stress`].
pub fn uniform_stretch(stiffness: &MembraneStiffness, angle: f64, stretch: f64) -> Result<UniformPoint, ShellError> {
    let width = width_without_stress(stiffness, angle, stretch)?;
    let [along, across] = Jet::<2>::variables(&[1.0 + stretch, width]);
    let whole = density(stiffness, angle, along, across);
    let [_, [mixed, second]] = whole.hessian();
    let (mut force_slope, mut compression_slope) = ([0.0; MembraneStiffness::COUNT], [0.0; MembraneStiffness::COUNT]);
    let (metric, area_ratio) = metric(angle, along, across);
    for k in 0..stiffness.used() {
        let part = stiffness.density_slope(k, metric, area_ratio).gradient;
        let width_slope = -part[1] / second;
        force_slope[k] = part[0] + mixed * width_slope;
        compression_slope[k] = -width_slope;
    }
    let point = StretchPoint { stretch, force: whole.gradient[0], compression: 1.0 - width };
    Ok(UniformPoint { point, force_slope, compression_slope })
}

/// A curve of `count` points evenly up to `largest` stretch: the data for a yarn model.
///
/// # Errors
/// As [`width_without_stress`].
pub fn uniform_curve(
    stiffness: &MembraneStiffness,
    angle: f64,
    largest: f64,
    count: usize,
) -> Result<StretchCurve, ShellError> {
    let at = |k: usize| Ok(uniform_stretch(stiffness, angle, largest * k as f64 / count as f64)?.point);
    Ok(StretchCurve { angle, points: (1..=count).map(at).collect::<Result<_, ShellError>>()? })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

    const STIFFNESS: MembraneStiffness =
        MembraneStiffness { xx: 40.0, xy: 9.0, yy: 110.0, ss: 6.0, n1: 3.0, n2: 5.0, ..MembraneStiffness::NONE };

    #[test]
    fn small_stretches_have_the_modulus_and_poisson_ratio() {
        let area = 16.0;
        let (cxx, cxy, cyy) = (40.0 + area, 9.0 + area, 110.0 + area);
        let weft = uniform_stretch(&STIFFNESS, 0.0, 1e-6).unwrap().point;
        assert!((weft.force / 1e-6 / (cxx - cxy * cxy / cyy) - 1.0).abs() < 1e-5);
        assert!((weft.compression / 1e-6 / (cxy / cyy) - 1.0).abs() < 1e-5);
        let warp = uniform_stretch(&STIFFNESS, FRAC_PI_2, 1e-6).unwrap().point;
        assert!((warp.force / 1e-6 / (cyy - cxy * cxy / cxx) - 1.0).abs() < 1e-5);
    }

    #[test]
    fn nothing_is_across_and_slopes_are_those_of_differences() {
        const STIFFENS: MembraneStiffness = MembraneStiffness {
            stiffening_xx: 60.0,
            stiffening_yy: 90.0,
            stiffening_ss: 8.0,
            stiffening_xy: 0.5,
            ..STIFFNESS
        };
        for (angle, law) in [0.0, 0.3, FRAC_PI_4, FRAC_PI_2].into_iter().flat_map(|a| [(a, STIFFNESS), (a, STIFFENS)]) {
            for stretch in [-0.2, 0.05, 0.5, 1.6] {
                let found = uniform_stretch(&law, angle, stretch).unwrap();
                let width = 1.0 - found.point.compression;
                let jet = density(&law, angle, Jet::<1>::constant(1.0 + stretch), Jet::<1>::variable(width, 0));
                let largest = 1e-11_f64.max(1e-14 * found.point.force.abs());
                assert!(jet.gradient[0].abs() < largest, "stress across: {}", jet.gradient[0]);
                for k in 0..law.used() {
                    let moved = |by: f64| {
                        let mut array = law.to_array();
                        array[k] += by;
                        uniform_stretch(&MembraneStiffness::from_array(array), angle, stretch).unwrap().point
                    };
                    // The last is a ratio and no stiffness: the same step would be a far larger part of it.
                    let step = if k + 1 == MembraneStiffness::COUNT { 1e-5 } else { 1e-4 };
                    let (up, down) = (moved(step), moved(-step));
                    let off = |up: f64, down: f64, slope: f64| {
                        ((up - down) / (2.0 * step) - slope).abs() / slope.abs().max(1.0)
                    };
                    assert!(off(up.force, down.force, found.force_slope[k]) < 1e-7, "{angle} {stretch} {k}");
                    assert!(
                        off(up.compression, down.compression, found.compression_slope[k]) < 1e-7,
                        "{angle} {stretch} {k}"
                    );
                }
            }
        }
    }

    #[test]
    fn without_the_area_terms_a_strip_collapses_and_says_so() {
        // A directional Poisson ratio of 2: at a stretch of 0.9 St. Venant–Kirchhoff alone has no width left.
        let bare =
            MembraneStiffness { xx: 400.0, xy: 60.0, yy: 30.0, ss: 5.0, n1: 0.0, n2: 0.0, ..MembraneStiffness::NONE };
        assert_eq!(uniform_stretch(&bare, 0.0, 0.9), Err(ShellError::Collapsed { stretch: 0.9 }));
        assert!(uniform_stretch(&MembraneStiffness { n2: 1.0, ..bare }, 0.0, 0.9).unwrap().point.compression < 1.0);
        assert!(uniform_stretch(&STIFFNESS, 0.0, -1.0).is_err());
    }
}
