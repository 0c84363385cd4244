//! What a yarn model is fitted to: uniform stretches of the fabric without stress across.

use serde::{Deserialize, Serialize};

use crate::shell::{StretchCurve, StretchPoint};

/// A uniform stretch along one direction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Target {
    /// Direction of the pull from the weft \[rad\].
    pub angle: f64,
    /// Stretch \[–\], first Piola-Kirchhoff stress \[N/m\] and compression \[–\], by rising stretch.
    pub points: Vec<[f64; 3]>,
    /// Whether the compression was measured.
    pub compression: bool,
    /// Stretch up to which the fabric is worn in comfort; beyond, fits weigh less [Sperl2022, section 7.3.1].
    pub comfort: f64,
}

/// Compression that counts as none when errors are measured against it \[–\].
const LEAST_COMPRESSION: f64 = 0.02;

impl Target {
    /// A curve of which the part below a stress \[N/m\] is comfort.
    ///
    /// # Panics
    /// If it has no point.
    #[must_use]
    pub fn new(curve: &StretchCurve, compression: bool, comfort_stress: f64) -> Self {
        let points: Vec<[f64; 3]> = curve.points.iter().map(|p| [p.stretch, p.force, p.compression]).collect();
        assert!(!points.is_empty());
        let mut comfort = points[points.len() - 1][0];
        let mut before = [0.0; 2];
        for point in &points {
            if point[1] >= comfort_stress {
                let part = ((comfort_stress - before[1]) / (point[1] - before[1])).clamp(0.0, 1.0);
                comfort = before[0] + part * (point[0] - before[0]);
                break;
            }
            before = [point[0], point[1]];
        }
        Self { angle: curve.angle, points, compression, comfort }
    }

    /// The stretches \[–\].
    #[must_use]
    pub fn stretches(&self) -> Vec<f64> {
        self.points.iter().map(|point| point[0]).collect()
    }

    /// `count` points evenly along the curve.
    #[must_use]
    pub fn resampled(&self, count: usize) -> Self {
        let last = self.points[self.points.len() - 1][0];
        let points = (1..=count).map(|k| self.at(last * k as f64 / count as f64)).collect();
        Self { points, ..self.clone() }
    }

    /// The curve at a stretch, by straight lines from the origin.
    #[must_use]
    pub fn at(&self, stretch: f64) -> [f64; 3] {
        let upper = self.points.partition_point(|p| p[0] < stretch).min(self.points.len() - 1);
        let before = if upper == 0 { [0.0; 3] } else { self.points[upper - 1] };
        let part = (stretch - before[0]) / (self.points[upper][0] - before[0]);
        let mut at: [f64; 3] = std::array::from_fn(|i| before[i] + part * (self.points[upper][i] - before[i]));
        at[0] = stretch;
        at
    }

    /// Second Piola-Kirchhoff stress \[N/m\] and compression at the end of comfort, by which errors are measured.
    #[must_use]
    pub fn comfort_values(&self) -> [f64; 2] {
        let [stretch, stress, compression] = self.at(self.comfort);
        [stress / (1.0 + stretch), compression.abs().max(LEAST_COMPRESSION)]
    }
}

impl From<[f64; 3]> for StretchPoint {
    fn from([stretch, force, compression]: [f64; 3]) -> Self {
        Self { stretch, force, compression }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn target() -> Target {
        let points = [[0.1, 1.0, 0.02], [0.2, 3.0, 0.05], [0.3, 9.0, 0.1]].map(StretchPoint::from).to_vec();
        Target::new(&StretchCurve { angle: 0.0, points }, true, 2.0)
    }

    #[test]
    fn comfort_ends_where_the_stress_says() {
        let target = target();
        assert!((target.comfort - 0.15).abs() < 1e-15);
        let [stress, compression] = target.comfort_values();
        assert!((stress - 2.0 / 1.15).abs() < 1e-14 && (compression - 0.035).abs() < 1e-15);
    }

    #[test]
    fn a_curve_is_divided_along_its_lines() {
        let fine = target().resampled(6);
        assert_eq!(fine.points.len(), 6);
        assert!((fine.points[0][1] - 0.5).abs() < 1e-12 && (fine.points[4][1] - 6.0).abs() < 1e-12);
        assert_eq!(fine.at(0.3), target().at(0.3));
    }
}
