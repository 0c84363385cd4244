//! The cantilever of a fabric that is known by its tile: a heavy elastica of its bending rigidity and its weight.

use super::{UniformTestError, positive};
use crate::shell::cantilever::CantileverReport;
use crate::virtual_test::CantileverTest;
use crate::virtual_test::cantilever::CantileverResult;

/// An inextensible strip under its own weight, held level at its edge. Lengths are by `(B/W)^⅓`, with the bending rigidity `B` \[N·m\]
/// and the weight by area `W` \[N/m²\].
#[derive(Clone, Debug, PartialEq)]
pub struct HeavyElastica {
    /// From the edge to its end, along the strip \[–\].
    pub length: f64,
    /// How it hangs, along and up from the edge, to its end \[–\].
    pub points: Vec<[f64; 2]>,
}

/// Steps of an integration, at least.
const STEPS: f64 = 400.0;
/// Pieces of the line that is drawn.
const PIECES: usize = 40;
/// Halvings of the interval of the end's slope; at 1.5 rad the end lies within 1e-6 of upright.
const HALVINGS: usize = 60;

/// The strip whose end lies at a slope, seen from the edge \[rad\]: `B θ″ = −W t cos θ` with the arc length `t` from the free end and the
/// slope `θ` of the strip, `θ′ = 0` there and `θ = 0` at the edge.
///
/// # Errors
/// [`UniformTestError::Number`] if the slope is not between 0 and 1.5 rad, as of a shell.
pub fn heavy_elastica(slope: f64) -> Result<HeavyElastica, UniformTestError> {
    if !(slope > 0.0 && slope < 1.5) {
        return Err(UniformTestError::Number { what: "slope", value: slope, must: "between 0 and 1.5 rad" });
    }
    // The end is steeper than the line to it, and the steeper the longer the strip.
    let (mut low, mut high) = (slope, std::f64::consts::FRAC_PI_2);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let Hanging { along, down, .. } = Hanging::from_end(middle).to_edge();
        if down.atan2(along) > slope { high = middle } else { low = middle }
    }
    let length = Hanging::from_end(low).to_edge().arc;
    let fine = STEPS as usize / PIECES;
    let mut hanging = Hanging::from_end(low);
    let mut line = vec![hanging];
    for _ in 0..PIECES {
        for _ in 0..fine {
            hanging = hanging.step(length / STEPS);
        }
        line.push(hanging);
    }
    let points = line.iter().rev().map(|at| [hanging.along - at.along, at.down - hanging.down]).collect();
    Ok(HeavyElastica { length, points })
}

/// A place on the strip, counted from its end.
#[derive(Clone, Copy)]
struct Hanging {
    arc: f64,
    slope: f64,
    /// `θ′`.
    bend: f64,
    along: f64,
    down: f64,
}

impl Hanging {
    fn from_end(slope: f64) -> Self {
        Self { arc: 0.0, slope, bend: 0.0, along: 0.0, down: 0.0 }
    }

    /// On to where the strip is level.
    fn to_edge(self) -> Self {
        // θ = θ₀ − t³/6 of a strip that hangs little; gravity bends one that hangs more the less.
        let step = (6.0 * self.slope).cbrt() / STEPS;
        let mut at = self;
        while at.slope > 0.0 {
            at = at.step(step);
        }
        // Newton's method, from less than a step away.
        for _ in 0..3 {
            at = at.step(-at.slope / at.bend);
        }
        at
    }

    /// A step of Runge and Kutta.
    fn step(self, h: f64) -> Self {
        let rate = |at: Self| [at.bend, -at.arc * at.slope.cos(), at.slope.cos(), at.slope.sin()];
        let moved = |k: [f64; 4], h: f64| Self {
            arc: self.arc + h,
            slope: self.slope + h * k[0],
            bend: self.bend + h * k[1],
            along: self.along + h * k[2],
            down: self.down + h * k[3],
        };
        let a = rate(self);
        let b = rate(moved(a, 0.5 * h));
        let c = rate(moved(b, 0.5 * h));
        let d = rate(moved(c, h));
        moved(std::array::from_fn(|i| (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]) / 6.0), h)
    }
}

/// The test of a fabric with a bending rigidity \[N·m\] and a mass by area \[kg/m²\]; a tile has no end that could sink.
///
/// # Errors
/// [`UniformTestError::Number`]: a number that is not positive, or an impossible slope.
pub fn tile_cantilever(
    rigidity: f64,
    areal_mass: f64,
    test: &CantileverTest,
) -> Result<CantileverResult, UniformTestError> {
    positive("bending rigidity", rigidity)?;
    positive("areal mass", areal_mass)?;
    positive("gravity", test.gravity)?;
    let weight = areal_mass * test.gravity;
    let unit = (rigidity / weight).cbrt();
    let HeavyElastica { length, points } = heavy_elastica(test.slope)?;
    let (overhang, bending_length) = (unit * length, 0.5 * unit * length);
    let flexural_rigidity = weight * bending_length.powi(3);
    let report = CantileverReport { overhang, bending_length, flexural_rigidity };
    Ok(CantileverResult { report, profile: points.iter().map(|[x, z]| [unit * x, unit * z]).collect() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_strip_that_hangs_little_is_a_loaded_beam() {
        // Its end sinks by W L⁴/8B, and lies at W L³/8B.
        for slope in [1e-9, 1e-4, 1e-2] {
            let found = heavy_elastica(slope).unwrap();
            assert!((found.length.powi(3) / (8.0 * slope) - 1.0).abs() < 1e-8 + slope, "{slope}: {}", found.length);
        }
    }

    #[test]
    fn its_line_is_as_long_as_the_strip_and_ends_at_the_slope() {
        for slope in [0.1, 41.5f64.to_radians(), 1.2, 1.49] {
            let HeavyElastica { length, points } = heavy_elastica(slope).unwrap();
            let [x, z] = points[points.len() - 1];
            assert!(points.len() == 41 && points[0] == [0.0, 0.0]);
            assert!(((-z).atan2(x) - slope).abs() < 1e-6, "{slope}: {x} {z}");
            let along: f64 = points.windows(2).map(|p| (p[1][0] - p[0][0]).hypot(p[1][1] - p[0][1])).sum();
            assert!((along / length - 1.0).abs() < 5e-3, "{slope}: {along} {length}");
            // Level at the edge: the first piece sinks by half a curvature by its length squared, and no more.
            assert!(-points[1][1] < 0.5 * points[1][0], "{slope}");
        }
    }

    #[test]
    fn half_the_overhang_at_the_slope_of_the_standard_is_the_bending_length() {
        let (rigidity, mass) = (6e-6, 0.2);
        let found = tile_cantilever(rigidity, mass, &CantileverTest::default()).unwrap();
        // W L³/B is about 8 at 41.5°.
        assert!((found.report.flexural_rigidity / rigidity - 1.0).abs() < 0.08, "{:?}", found.report);
        assert_eq!(found.report.bending_length, 0.5 * found.report.overhang);
        let limp = tile_cantilever(rigidity / 8.0, mass, &CantileverTest::default()).unwrap();
        assert!((found.report.overhang / limp.report.overhang - 2.0).abs() < 1e-12);
    }

    #[test]
    fn impossible_strips_are_errors() {
        let test = CantileverTest::default();
        for slope in [0.0, -1.0, 1.5, f64::NAN] {
            assert!(tile_cantilever(1e-6, 0.1, &CantileverTest { slope, ..test }).is_err(), "{slope}");
        }
        assert!(tile_cantilever(0.0, 0.1, &test).is_err() && tile_cantilever(1e-6, f64::NAN, &test).is_err());
    }
}
