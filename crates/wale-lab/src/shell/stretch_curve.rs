//! What a stretch test measures.

use serde::{Deserialize, Serialize};

use super::error::{ShellError, positive};

/// One point of a stretch test.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StretchPoint {
    /// Stretch `l/l̄ − 1` \[–\].
    pub stretch: f64,
    /// Force of a swatch \[N\]; of a uniform strip, force a width at rest \[N/m\].
    pub force: f64,
    /// Orthogonal compression `1 − w/w̄` at mid-length \[–\].
    pub compression: f64,
}

/// A stretch test along one direction.
#[derive(Clone, Debug, PartialEq)]
pub struct StretchCurve {
    /// Direction of the pull from the weft (0) towards the warp (π/2) \[rad\].
    pub angle: f64,
    /// Points by rising stretch; the unstretched one need not be among them.
    pub points: Vec<StretchPoint>,
}

impl StretchCurve {
    /// `count` points evenly along the stretch range up to its end, by linear interpolation from the unstretched state.
    ///
    /// # Errors
    /// [`ShellError::Number`] if a stretch is not larger than the one before.
    pub fn targets(&self, count: usize) -> Result<Vec<StretchPoint>, ShellError> {
        let mut knots = vec![StretchPoint { stretch: 0.0, force: 0.0, compression: 0.0 }];
        for point in self.points.iter().filter(|point| point.stretch != 0.0) {
            positive("rise of the stretch from point to point", point.stretch - knots[knots.len() - 1].stretch)?;
            knots.push(*point);
        }
        let Some(last) = self.points.last() else { return Ok(Vec::new()) };
        let at = |stretch: f64| {
            let upper = knots.partition_point(|knot| knot.stretch < stretch).clamp(1, knots.len() - 1);
            let (a, b) = (&knots[upper - 1], &knots[upper]);
            let part = (stretch - a.stretch) / (b.stretch - a.stretch);
            let mix = |a: f64, b: f64| a + part * (b - a);
            StretchPoint { stretch, force: mix(a.force, b.force), compression: mix(a.compression, b.compression) }
        };
        Ok((1..=count).map(|k| at(last.stretch * k as f64 / count as f64)).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn targets_lie_evenly_on_the_measured_line() {
        let point = |stretch, force, compression| StretchPoint { stretch, force, compression };
        let curve = StretchCurve { angle: 0.0, points: vec![point(0.1, 1.0, 0.02), point(0.3, 5.0, 0.1)] };
        let targets = curve.targets(6).unwrap();
        for (k, target) in targets.iter().enumerate() {
            let s = 0.05 * (k + 1) as f64;
            let force = if s <= 0.1 { 10.0 * s } else { 1.0 + 20.0 * (s - 0.1) };
            assert!((target.stretch - s).abs() < 1e-15 && (target.force - force).abs() < 1e-12);
        }
        let folded = StretchCurve { angle: 0.0, points: vec![point(0.3, 1.0, 0.0), point(0.1, 5.0, 0.0)] };
        assert!(folded.targets(6).is_err());
        assert_eq!(StretchCurve { angle: 0.0, points: Vec::new() }.targets(6), Ok(Vec::new()));
    }
}
