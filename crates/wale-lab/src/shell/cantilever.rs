//! The cantilever test: how far a strip reaches over an edge until its end has sunk to a slope of 41.5° (ASTM D1388, option A).

use wale::fabric::coordinates::BLOCK;

use super::card::ShellCard;
use super::error::{ShellError, positive};
use super::mesh::Rectangle;
use super::rest::{RestSettings, come_to_rest};
use super::system::ShellSystem;

/// A strip that is pushed over an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cantilever {
    /// Width \[m\].
    pub width: f64,
    /// Direction of the strip from the weft (0) towards the warp (π/2) \[rad\].
    pub angle: f64,
    /// Slope of the line from the edge to the strip's end \[rad\].
    pub slope: f64,
    /// Gravity, downward \[m/s²\].
    pub gravity: f64,
    /// Rows of triangles along the overhang.
    pub rows: usize,
    /// When it is at rest.
    pub rest: RestSettings,
}

impl Default for Cantilever {
    /// 25 mm wide, along the weft, 41.5°.
    fn default() -> Self {
        Self {
            width: 0.025,
            angle: 0.0,
            slope: 41.5f64.to_radians(),
            gravity: 9.81,
            rows: 40,
            rest: RestSettings::default(),
        }
    }
}

/// What the test reports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CantileverReport {
    /// Length over the edge \[m\].
    pub overhang: f64,
    /// Bending length `c`, half of the overhang \[m\].
    pub bending_length: f64,
    /// Flexural rigidity `G = W c³` with the weight an area `W` \[N·m\].
    pub flexural_rigidity: f64,
}

/// Relative precision of the overhang.
const PRECISION: f64 = 1e-5;

impl Cantilever {
    /// Pushes a strip over the edge until its end is low enough.
    ///
    /// # Errors
    /// [`ShellError`]: an impossible number, a fabric without weight or bending stiffness, or a strip that does not come to rest.
    pub fn run(&self, card: &ShellCard) -> Result<CantileverReport, ShellError> {
        positive("gravity", self.gravity)?;
        positive("areal mass", card.areal_mass)?;
        let (sin, cos) = self.angle.sin_cos();
        let stiffness = card.bending.along([cos, sin]);
        positive("bending stiffness along the strip", stiffness)?;
        if !(self.slope > 0.0 && self.slope < 1.5) {
            return Err(ShellError::Number { what: "slope", value: self.slope, must: "between 0 and 1.5 rad" });
        }
        let weight = card.areal_mass * self.gravity;
        // B = 2k_θ = W c³ is nearly right at 41.5°.
        let guess = 2.0 * (2.0 * stiffness / weight).cbrt();
        let off = |overhang: f64| Ok::<f64, ShellError>(self.slope_of(card, overhang)? - self.slope);
        let (mut short, mut long) = (guess, guess);
        let (mut below, mut above) = (off(short)?, 0.0);
        if below < 0.0 {
            while above <= 0.0 {
                (short, below) = (long, if above < 0.0 { above } else { below });
                long *= 1.25;
                above = off(long)?;
            }
        } else {
            above = below;
            while below >= 0.0 {
                (long, above) = (short, below);
                short *= 0.8;
                below = off(short)?;
            }
        }
        // Secants between both sides; the side that stays counts half the next time (Illinois).
        let mut last = 0.0;
        while long - short > PRECISION * short {
            let next = (short * above - long * below) / (above - below);
            let found = off(next)?;
            if found.abs() < 0.1 * PRECISION {
                (short, long) = (next, next);
            } else if found < 0.0 {
                (short, below) = (next, found);
                above *= if last < 0.0 { 0.5 } else { 1.0 };
            } else {
                (long, above) = (next, found);
                below *= if last > 0.0 { 0.5 } else { 1.0 };
            }
            last = found;
        }
        let (overhang, bending_length) = (short, 0.5 * short);
        Ok(CantileverReport { overhang, bending_length, flexural_rigidity: weight * bending_length.powi(3) })
    }

    /// Slope of the line from the edge to the end of a strip \[rad\].
    fn slope_of(&self, card: &ShellCard, overhang: f64) -> Result<f64, ShellError> {
        let profile = self.profile(card, overhang)?;
        let [x, z] = profile[profile.len() - 1];
        Ok((-z).atan2(x))
    }

    /// How a strip hangs that reaches so far over the edge \[m\]: from behind the edge to its end, along and up from the edge \[m\].
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn profile(&self, card: &ShellCard, overhang: f64) -> Result<Vec<[f64; 2]>, ShellError> {
        let strips = 2 * (self.rows.max(4) / 2);
        // The edge lies in the middle of the first row of triangles, as the clamps of a pear loop do.
        let step = overhang / (strips as f64 - 0.5);
        let rectangle = Rectangle::new(step * strips as f64, self.width, step / 0.75f64.sqrt())?;
        let mut held = vec![[false; 3]; rectangle.mesh.points.len()];
        for row in 0..2 {
            held[rectangle.rows[row].clone()].fill([true; 3]);
        }
        let mut system = ShellSystem::new(&rectangle.mesh, card, self.angle, [0.0, 0.0, -self.gravity], &held)?;
        let mut q = vec![0.0; BLOCK * rectangle.mesh.points.len()];
        // An arc that ends at about the slope asked for; held rows lie flat.
        let mut place = [-0.5 * step, 0.0];
        for (row, vertices) in rectangle.rows.iter().enumerate() {
            for v in vertices.clone() {
                q[BLOCK * v..BLOCK * v + 3].copy_from_slice(&[place[0], rectangle.mesh.points[v][1], place[1]]);
            }
            let (sin, cos) = (-1.6 * self.slope * row as f64 / strips as f64).sin_cos();
            place = [place[0] + step * cos, place[1] + step * sin];
        }
        come_to_rest(&mut system, &mut q, &self.rest).map_err(|error| match error {
            ShellError::NotAtRest { iterations, residual, .. } => {
                ShellError::NotAtRest { load: format!("an overhang of {overhang:.4} m"), iterations, residual }
            }
            other => other,
        })?;
        let mean = |row: &std::ops::Range<usize>, axis: usize| {
            row.clone().map(|v| q[BLOCK * v + axis]).sum::<f64>() / row.len() as f64
        };
        Ok(rectangle.rows.iter().map(|row| [mean(row, 0), mean(row, 2)]).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::uniform_test::heavy_elastica;
    use wale::energy::{BendingStiffness, MembraneStiffness};

    #[test]
    fn a_strip_reaches_as_far_as_a_heavy_elastica() {
        let membrane =
            MembraneStiffness { xx: 400.0, xy: 20.0, yy: 400.0, ss: 80.0, n1: 2.0, n2: 4.0, ..MembraneStiffness::NONE };
        let stiffness = 3e-6;
        let card = ShellCard { membrane, bending: BendingStiffness::isotropic(stiffness), areal_mass: 0.2 };
        let report = Cantilever::default().run(&card).unwrap();
        // `W L³/B`.
        let load = heavy_elastica(41.5f64.to_radians()).unwrap().length.powi(3);
        let expected = (load * 2.0 * stiffness / (0.2 * 9.81)).cbrt();
        // Edges of equilateral triangles couple both curvatures as a Poisson's ratio of −⅓ does: a strip too narrow to hold
        // itself straight across is softer by up to a ninth, and hangs down by a 27th sooner.
        let ratio = report.overhang / expected;
        assert!(ratio < 1.003 && ratio > (8.0f64 / 9.0).cbrt() - 0.003, "{ratio}");
        // W L³/B is about 8 there: which is why half the overhang is the bending length.
        assert!((load / 8.0 - 1.0).abs() < 0.08, "{load}");
        assert!((report.flexural_rigidity / (2.0 * stiffness) - 1.0).abs() < 0.15, "{report:?}");
    }

    #[test]
    fn impossible_strips_are_errors() {
        let membrane =
            MembraneStiffness { xx: 400.0, xy: 20.0, yy: 400.0, ss: 80.0, n1: 2.0, n2: 4.0, ..MembraneStiffness::NONE };
        let card = ShellCard { membrane, bending: BendingStiffness::isotropic(3e-6), areal_mass: 0.2 };
        assert!(Cantilever::default().run(&ShellCard { areal_mass: 0.0, ..card }).is_err());
        assert!(Cantilever::default().run(&ShellCard { bending: BendingStiffness::isotropic(0.0), ..card }).is_err());
        assert!(Cantilever { slope: 2.0, ..Cantilever::default() }.run(&card).is_err());
    }
}
