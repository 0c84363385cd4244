//! The geometry of a weave: Peirce's round, bent, inextensible yarns [Peirce 1937].
//!
//! Between two interlacings a yarn goes straight for a while and bends over the other system's yarns in arcs about their
//! axes. With `D` the sum of both diameters, `p` the distance of the interlacings, `θ` the steepest angle and `l` the length
//! of yarn,
//!
//! ```text
//! p = (l − Dθ) cos θ + D sin θ
//! h = (l − Dθ) sin θ + D (1 − cos θ)      crimp c = l/p − 1
//! ```
//!
//! and both systems together are as thick as their yarns: `h₁ + h₂ = D`. A fabric is jammed when nothing of its yarns is
//! straight. How the systems share `D` is not geometry; here both press equally hard, as elastic beams of span `p` do that
//! are pushed aside by `h`: `k_b₁ h₁/p₁³ = k_b₂ h₂/p₂³`.

use thiserror::Error;

use super::draft::Draft;
use crate::model::{WovenGeometry, YarnCard};

/// The yarns of a weave and how far they are apart. Of two numbers the first is of the warp, the second of the weft.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sett {
    /// Diameters of the yarns \[m\].
    pub diameter: [f64; 2],
    /// Bending stiffnesses, or anything in proportion to them.
    pub bending_stiffness: [f64; 2],
    /// Distance of neighbouring ends, and of neighbouring picks \[m\].
    pub spacing: [f64; 2],
    /// Part of the segments between crossings that goes to the other side \[–\].
    pub interlacing: [f64; 2],
}

/// A sett that cannot be woven.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error(
    "ends {:.4} mm and picks {:.4} mm apart are closer than this weave of yarns {:.4} mm and {:.4} mm thick can lie; \
     it jams at {:.4} mm and {:.4} mm",
    1e3 * .asked[0], 1e3 * .asked[1], 1e3 * .diameter[0], 1e3 * .diameter[1], 1e3 * .jammed[0], 1e3 * .jammed[1]
)]
pub struct Jammed {
    /// The spacing of ends and picks that was asked for \[m\].
    pub asked: [f64; 2],
    /// Diameters \[m\].
    pub diameter: [f64; 2],
    /// The closest spacing in the same proportion \[m\].
    pub jammed: [f64; 2],
}

/// The geometry of a draft woven of two yarns at a spacing of ends and picks \[m\].
///
/// Under a float the yarns that it passes may lie closer than its interlacings; they do as far as these need the room.
///
/// # Errors
/// If the end or pick with the most interlacings is jammed.
pub fn geometry(draft: &Draft, yarns: [&YarnCard; 2], spacing: [f64; 2]) -> Result<WovenGeometry, Jammed> {
    let interlacing = draft.interlacing();
    let sett = Sett {
        diameter: yarns.map(|yarn| 2.0 * yarn.radius),
        bending_stiffness: yarns.map(|yarn| yarn.bending_stiffness),
        spacing,
        interlacing: interlacing.most,
    };
    sett.geometry()?;
    Sett { interlacing: interlacing.mean, ..sett }.geometry()
}

impl Sett {
    /// The geometry of the weave.
    ///
    /// # Errors
    /// If it is jammed.
    pub fn geometry(&self) -> Result<WovenGeometry, Jammed> {
        let thickness = self.diameter[0] + self.diameter[1];
        let Some(span) = self.spans() else {
            // The smallest common factor at which there is room.
            let fits = |factor: f64| Self { spacing: self.spacing.map(|p| p * factor), ..*self }.spans().is_some();
            let (mut low, mut high) = (1.0, 2.0);
            while !fits(high) && high < 1e9 {
                high *= 2.0;
            }
            for _ in 0..80 {
                let middle = 0.5 * (low + high);
                if fits(middle) { high = middle } else { low = middle }
            }
            let jammed = self.spacing.map(|p| p * high);
            return Err(Jammed { asked: self.spacing, diameter: self.diameter, jammed });
        };
        let most = span.map(|p| highest(p, thickness));
        let press = [0, 1].map(|k| self.bending_stiffness[k] / span[k].powi(3));
        let shared = thickness * press[1] / (press[0] + press[1]);
        // Where floats close up the two limits are one, but for rounding.
        let first = shared.max((thickness - most[1]).max(0.0)).min(most[0].min(thickness));
        let height = [first, thickness - first];
        let crimp = [0, 1].map(|k| {
            let along = self.spacing[1 - k];
            self.interlacing[k] * (yarn_length(span[k], height[k], thickness) - span[k]) / along
        });
        // Where an interlacing jams as the spans of the other system stay what they are.
        let closest = [0, 1].map(|k| {
            let height = (thickness - most[1 - k].min(thickness)).max(0.0);
            let jams = (thickness * thickness - (thickness - height).powi(2)).sqrt();
            jams.max(0.5 * self.diameter[1 - k]).min(0.95 * self.spacing[1 - k])
        });
        Ok(WovenGeometry { spacing: self.spacing, crimp, crimp_height: height, interlacing_spacing: closest })
    }

    /// Distance of the crossings at both ends of an interlacing of the warp, and of the weft: the spacing, or as much more as
    /// the fabric needs to have room; `None` if it has not enough \[m\].
    fn spans(&self) -> Option<[f64; 2]> {
        let thickness = self.diameter[0] + self.diameter[1];
        let at = |closed: f64| {
            [0, 1].map(|k| {
                let (along, part) = (self.spacing[1 - k], self.interlacing[k]);
                // All floats closed until the yarns that they pass touch.
                let most = if part > 0.0 { (along - (1.0 - part) * self.diameter[1 - k]) / part } else { along };
                along + closed * (most.max(along) - along)
            })
        };
        let fits = |span: [f64; 2]| span.map(|p| highest(p, thickness)).iter().sum::<f64>() >= thickness;
        if fits(at(0.0)) {
            return Some(at(0.0));
        }
        if !fits(at(1.0)) {
            return None;
        }
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            if fits(at(middle)) { high = middle } else { low = middle }
        }
        Some(at(high))
    }
}

/// The crimp height at which a span jams \[m\].
fn highest(span: f64, thickness: f64) -> f64 {
    if span >= thickness { f64::INFINITY } else { thickness - (thickness * thickness - span * span).sqrt() }
}

/// Length of yarn of a span that goes aside by a height \[m\].
fn yarn_length(span: f64, height: f64, thickness: f64) -> f64 {
    // h(θ) = p tan θ + D − D/cos θ grows with θ as long as anything is straight.
    let steepest = (span / thickness).min(1.0).asin();
    let height_at = |theta: f64| span * theta.tan() + thickness - thickness / theta.cos();
    let (mut low, mut high) = (0.0, steepest);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if height_at(middle) < height { low = middle } else { high = middle }
    }
    let theta = 0.5 * (low + high);
    (span - thickness * theta.sin()) / theta.cos() + thickness * theta
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(pitch: f64) -> Sett {
        Sett { diameter: [0.5; 2], bending_stiffness: [1.0; 2], spacing: [pitch; 2], interlacing: [1.0; 2] }
    }

    #[test]
    fn crimp_of_square_plain_weaves() {
        for (pitch, crimp) in [(2.0, 3.212_081), (1.5, 5.847_568), (1.2, 9.458_974), (1.0, 14.350_111)] {
            let geometry = square(pitch).geometry().unwrap();
            for found in geometry.crimp {
                assert!((100.0 * found - crimp).abs() < 1e-6, "{pitch}: {found}");
            }
            assert!((geometry.crimp_height[0] - 0.5).abs() < 1e-12);
        }
    }

    #[test]
    fn jams_at_half_the_root_of_three() {
        let limit = 0.75f64.sqrt();
        let geometry = square(limit * (1.0 + 1e-12)).geometry().unwrap();
        assert!((100.0 * geometry.crimp[0] - 20.92).abs() < 1e-3, "{geometry:?}");
        let jammed = square(0.8).geometry().unwrap_err();
        assert!((jammed.jammed[0] - limit).abs() < 1e-9, "{jammed}");
        assert!(jammed.to_string().contains("jams at 866.0254 mm and 866.0254 mm"), "{jammed}");
    }

    #[test]
    fn every_sett_with_room_has_a_geometry_to_the_last_digit() {
        // Where floats close up what one system leaves is what the other takes, to rounding.
        let mut woven = 0;
        for (first, second) in (20..60).flat_map(|a| (20..60).map(move |b| (a, b))) {
            let spacing = [first, second].map(|hundredths| f64::from(hundredths) * 1e-5);
            let sett = Sett { diameter: [2.5e-4; 2], bending_stiffness: [1.0; 2], spacing, interlacing: [0.5; 2] };
            if let Ok(geometry) = sett.geometry() {
                let [warp, weft] = geometry.crimp_height;
                assert!(warp >= 0.0 && weft >= 0.0 && (warp + weft - 5e-4).abs() < 1e-12, "{geometry:?}");
                woven += 1;
            }
        }
        assert!(woven > 1000, "{woven}");
    }

    #[test]
    fn a_stiff_yarn_stays_straight() {
        let sett = Sett { bending_stiffness: [1e6, 1.0], ..square(1.5) };
        let geometry = sett.geometry().unwrap();
        assert!(geometry.crimp[0] < 1e-6 && geometry.crimp[1] > 0.15, "{geometry:?}");
        // Jamming of the other limits it.
        let tight = Sett { bending_stiffness: [1e6, 1.0], ..square(0.95) }.geometry().unwrap();
        assert!(tight.crimp[0] > 0.02, "{tight:?}");
        assert!((tight.crimp_height[0] + tight.crimp_height[1] - 1.0).abs() < 1e-12);
    }

    #[test]
    fn floats_have_less_crimp_and_may_lie_closer() {
        let plain = square(1.2).geometry().unwrap();
        let twill = Sett { interlacing: [0.5; 2], ..square(1.2) }.geometry().unwrap();
        assert!((twill.crimp[0] / plain.crimp[0] - 0.5).abs() < 1e-9);
        assert!(square(0.75).geometry().is_err());
        let close = Sett { interlacing: [0.5; 2], ..square(0.75) }.geometry().unwrap();
        assert!(close.crimp[0] > 0.0 && close.crimp[0] < 0.3);
        // 2/2 twill: two interlacings at the jammed distance, two threads side by side.
        let limit = 0.5 * (0.75f64.sqrt() + 0.5);
        let jammed = Sett { interlacing: [0.5; 2], ..square(0.5) }.geometry().unwrap_err();
        assert!((jammed.jammed[0] - limit).abs() < 1e-9, "{jammed}");
    }
}
