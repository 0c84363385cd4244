//! Strips that are drawn to a load: the curve, and LT, WT and EMT of it.

use super::strip::{StripPoint, UniformStrip};
use super::{UniformTestError, positive};
use crate::virtual_test::KesTensileResult;

/// Stretch beyond which a load is given up \[–\].
const LARGEST: f64 = 3.0;
/// First step on the way to a load, and the bounds of the others \[–\].
const FIRST: f64 = 0.01;
const STEPS: [f64; 2] = [0.002, 0.06];
/// Precision of a load \[–\].
const PRECISION: f64 = 1e-7;

/// Draws a strip until it bears a load by width \[N/m\]: the least stretch at which it does.
///
/// # Errors
/// [`UniformTestError`].
pub fn stretch_at_load(strip: &mut impl UniformStrip, load: f64) -> Result<StripPoint, UniformTestError> {
    positive("load", load)?;
    let mut low = strip.at(0.0)?;
    let mut step = FIRST;
    let mut high = loop {
        let next = strip.at(low.stretch + step)?;
        if next.force >= load {
            break next;
        }
        if next.stretch > LARGEST {
            return Err(UniformTestError::Load { load, stretch: next.stretch, force: next.force });
        }
        let slope = (next.force - low.force) / step;
        let wanted = if slope > 0.0 { 0.5 * (load - next.force) / slope } else { STEPS[1] };
        (low, step) = (next, wanted.clamp(STEPS[0], STEPS[1]));
    };
    // By secants between what is too little and what is enough, with the weight of an end that stays halved (Illinois).
    let (mut below, mut above) = (low.force - load, high.force - load);
    let mut last = 0.0;
    for _ in 0..60 {
        let part = -below / (above - below);
        let next = strip.at(low.stretch + part * (high.stretch - low.stretch))?;
        let off = next.force - load;
        if off.abs() <= PRECISION * load {
            return Ok(next);
        }
        if off < 0.0 {
            (low, below) = (next, off);
            above *= if last < 0.0 { 0.5 } else { 1.0 };
        } else {
            (high, above) = (next, off);
            below *= if last > 0.0 { 0.5 } else { 1.0 };
        }
        last = off;
    }
    Err(UniformTestError::Load { load, stretch: high.stretch, force: high.force })
}

/// A curve of so many points, evenly from rest to a stretch.
///
/// # Errors
/// [`UniformTestError`].
pub fn draw(strip: &mut impl UniformStrip, largest: f64, points: usize) -> Result<Vec<StripPoint>, UniformTestError> {
    positive("largest stretch", largest)?;
    (0..=points).map(|k| strip.at(largest * k as f64 / points as f64)).collect()
}

/// `LT`, `WT` and `EMT` at a load by width \[N/m\], and a curve of so many points. `new` makes a strip at rest: the curve is that of a
/// strip which was drawn once.
///
/// # Errors
/// [`UniformTestError`].
pub fn tensile<S: UniformStrip>(
    new: impl Fn() -> Result<S, UniformTestError>,
    load: f64,
    points: usize,
) -> Result<KesTensileResult, UniformTestError> {
    let extensibility = stretch_at_load(&mut new()?, load)?.stretch;
    let curve = draw(&mut new()?, extensibility, points)?;
    // A tile without friction stores all work.
    let work = curve[points].energy - curve[0].energy;
    Ok(KesTensileResult {
        linearity: work / (0.5 * load * extensibility),
        work,
        extensibility,
        points: curve.iter().map(|p| [p.stretch, p.force, p.compression]).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nothing contracts: Ψ = ½ k E², E = s + s²/2.
    struct Stiff(f64);

    impl UniformStrip for Stiff {
        fn at(&mut self, stretch: f64) -> Result<StripPoint, UniformTestError> {
            let e = stretch + 0.5 * stretch * stretch;
            let (force, energy) = (self.0 * e * (1.0 + stretch), 0.5 * self.0 * e * e);
            Ok(StripPoint { stretch, force, compression: 0.0, energy })
        }
    }

    #[test]
    fn a_known_law_has_the_numbers_that_are_worked_out_by_hand() {
        for k in [100.0, 800.0, 1e6] {
            let found = tensile(|| Ok(Stiff(k)), 490.0, 10).unwrap();
            let s = found.extensibility;
            let e = s + 0.5 * s * s;
            assert!((k * e * (1.0 + s) / 490.0 - 1.0).abs() < 1e-6, "{s}");
            assert!((found.work / (0.5 * k * e * e) - 1.0).abs() < 1e-12);
            assert!((found.linearity / ((1.0 + 0.5 * s) / (1.0 + s)) - 1.0).abs() < 1e-6);
            assert_eq!(found.points.len(), 11);
        }
        assert!(matches!(tensile(|| Ok(Stiff(1e-3)), 490.0, 10), Err(UniformTestError::Load { .. })));
        assert!(matches!(tensile(|| Ok(Stiff(1.0)), -1.0, 10), Err(UniformTestError::Number { .. })));
    }
}
