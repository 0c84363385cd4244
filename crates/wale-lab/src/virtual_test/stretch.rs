//! Specimens between clamps that are drawn apart: a swatch [Sperl2022, section 4.3], and the strip of ISO 13934-1.

use super::rig::{Rig, Specimen};
use super::units::GF_PER_CM;
use crate::shell::clamped_stretch::{ClampedStretch, OutOfPlane, Sheet};
use crate::shell::error::{ShellError, positive};
use crate::shell::{ShellCard, StretchPoint};

/// How far a specimen is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Until {
    /// To this stretch \[–\].
    Stretch(f64),
    /// To this force by width at rest \[N/m\].
    LineLoad(f64),
}

/// A specimen, and how it is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StretchTest {
    /// What is clamped.
    pub specimen: Specimen,
    /// Direction of the pull from the weft (0) towards the warp (π/2) \[rad\].
    pub angle: f64,
    /// How far.
    pub until: Until,
    /// Points of the curve.
    pub points: usize,
    /// Whether it may leave its plane.
    pub out_of_plane: OutOfPlane,
}

impl StretchTest {
    /// The swatch of [Sperl2022, section 4.3], 10 × 6 cm, to 5 N.
    #[must_use]
    pub fn swatch() -> Self {
        let specimen = Specimen { length: 0.1, width: 0.06 };
        let until = Until::LineLoad(5.0 / 0.06);
        Self { specimen, angle: 0.0, until, points: 20, out_of_plane: OutOfPlane::Flat }
    }

    /// The strip of ISO 13934-1, 200 × 50 mm. The standard draws it until it breaks; a shell does not break, so it ends at
    /// 500 gf/cm.
    #[must_use]
    pub fn strip() -> Self {
        let specimen = Specimen { length: 0.2, width: 0.05 };
        Self { specimen, until: Until::LineLoad(500.0 * GF_PER_CM), ..Self::swatch() }
    }

    /// Draws a fabric.
    ///
    /// # Errors
    /// [`ShellError`]: an impossible number, or a specimen that does not come to rest.
    pub fn run(&self, card: &ShellCard) -> Result<StretchResult, ShellError> {
        let edge = self.specimen.edge();
        let largest = match self.until {
            Until::Stretch(stretch) => stretch,
            Until::LineLoad(load) => {
                positive("load", load)?;
                let mut rig = Rig::new(card, self.specimen, self.angle, edge)?;
                rig.pull_to(load * self.specimen.width, 0.0)?;
                rig.moved()[0] / self.specimen.length
            }
        };
        positive("largest stretch", largest)?;
        let count = self.points.max(2);
        let stretches: Vec<f64> = (1..=count).map(|k| largest * k as f64 / count as f64).collect();
        let test = ClampedStretch {
            length: self.specimen.length,
            width: self.specimen.width,
            angle: self.angle,
            edge,
            out_of_plane: self.out_of_plane,
            ..ClampedStretch::default()
        };
        let mut points = vec![StretchPoint { stretch: 0.0, force: 0.0, compression: 0.0 }];
        let (pulled, sheet) = test.run_with_sheet(card, &stretches)?;
        points.extend(pulled);
        Ok(StretchResult { width: self.specimen.width, points, sheet })
    }
}

/// What the test reports.
#[derive(Clone, Debug, PartialEq)]
pub struct StretchResult {
    /// Width at rest \[m\].
    pub width: f64,
    /// Stretch, force \[N\] and compression at mid-length, from rest on.
    pub points: Vec<StretchPoint>,
    /// How it lies at the end.
    pub sheet: Sheet,
}

impl StretchResult {
    /// The last point.
    #[must_use]
    pub fn last(&self) -> StretchPoint {
        self.points[self.points.len() - 1]
    }
    /// Force by width and stretch up to the first point \[N/m\].
    #[must_use]
    pub fn initial_stiffness(&self) -> f64 {
        self.points[1].force / self.width / self.points[1].stretch
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wale::energy::{BendingStiffness, MembraneStiffness};

    #[test]
    fn a_cloth_without_contraction_is_drawn_by_the_closed_form() {
        // With neither k_xy nor an area term nothing contracts: F/w = k E (1 + s), E = s + s²/2.
        let membrane =
            MembraneStiffness { xx: 200.0, xy: 0.0, yy: 300.0, ss: 10.0, n1: 0.0, n2: 0.0, ..MembraneStiffness::NONE };
        let card = ShellCard { membrane, bending: BendingStiffness::isotropic(0.0), areal_mass: 0.0 };
        let force = |s: f64| 200.0 * (s + 0.5 * s * s) * (1.0 + s);
        let swatch = StretchTest::swatch().run(&card).unwrap();
        assert!((swatch.last().force - 5.0).abs() < 1e-6);
        for point in &swatch.points {
            assert!((point.force / 0.06 - force(point.stretch)).abs() < 1e-6, "{point:?}");
            assert!(point.compression.abs() < 1e-9);
        }
        let strip = StretchTest { until: Until::Stretch(0.3), ..StretchTest::strip() }.run(&card).unwrap();
        assert!((strip.last().force / 0.05 - force(0.3)).abs() < 1e-6);
        assert!(StretchTest { until: Until::Stretch(-0.1), ..StretchTest::strip() }.run(&card).is_err());
        assert!(StretchTest { until: Until::LineLoad(f64::NAN), ..StretchTest::strip() }.run(&card).is_err());
    }
}
