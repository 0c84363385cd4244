//! A rectangle of cloth between two clamps, flat, one of which is moved along and across the pull.

use std::f64::consts::FRAC_PI_4;

use wale::fabric::coordinates::BLOCK;

use super::bias_mesh::bias_rectangle;
use crate::shell::error::{ShellError, positive};
use crate::shell::mesh::Rectangle;
use crate::shell::rest::{RestSettings, advance_load};
use crate::shell::{ShellCard, ShellSystem};

/// What is clamped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Specimen {
    /// Length between the clamps at rest \[m\].
    pub length: f64,
    /// Width, the length of each clamp \[m\].
    pub width: f64,
}

impl Specimen {
    /// An edge length of the mesh that suits it \[m\]: a fifteenth of its smaller side. Finer ones change forces by less than 0.6 %
    /// (`docs/topics/thin-shell.md`).
    #[must_use]
    pub fn edge(&self) -> f64 {
        self.length.min(self.width) / 15.0
    }
}

/// Largest load step: move of the clamp over the length of the specimen \[–\].
const LARGEST_STEP: f64 = 0.2;
/// How near a force is brought to the one asked for \[–\].
const PRECISION: f64 = 3e-9;

/// A specimen in its clamps. The first clamp stands still.
#[derive(Debug)]
pub struct Rig {
    rectangle: Rectangle,
    system: ShellSystem,
    q: Vec<f64>,
    moved: [f64; 2],
    rest: RestSettings,
    energy: f64,
}

impl Rig {
    /// Clamps a specimen that was cut with its length at `angle` \[rad\] from the weft towards the warp. It stays flat. On the
    /// bias its mesh has edges along both yarns.
    ///
    /// # Errors
    /// [`ShellError`]: a card or a size that is of no use.
    pub fn new(card: &ShellCard, specimen: Specimen, angle: f64, edge: f64) -> Result<Self, ShellError> {
        let Specimen { length, width } = specimen;
        let on_bias = (angle - FRAC_PI_4).abs() < 1e-6;
        let rectangle =
            if on_bias { bias_rectangle(length, width, edge)? } else { Rectangle::new(length, width, edge)? };
        let mut held = vec![[false, false, true]; rectangle.mesh.points.len()];
        for end in rectangle.ends() {
            held[end].fill([true; 3]);
        }
        let mut system = ShellSystem::new(&rectangle.mesh, card, angle, [0.0; 3], &held)?;
        let q = rectangle.mesh.laid_flat();
        let energy = system.linearise(&q, 0.0);
        // Places are rounded to 10⁻¹⁶; where yarns are much stiffer than shear, that alone leaves forces.
        let rounding = 1e-11 * system.stiffness() / card.membrane.ss;
        let rest = RestSettings::default();
        let rest = RestSettings { tolerance: rest.tolerance.max(rounding), ..rest };
        Ok(Self { rectangle, system, q, moved: [0.0; 2], rest, energy })
    }

    /// Moves the second clamp to a place along the pull and across it \[m\], from where it was clamped.
    ///
    /// # Errors
    /// [`ShellError`] if the specimen does not come to rest, or the clamps would meet.
    pub fn move_to(&mut self, to: [f64; 2]) -> Result<(), ShellError> {
        positive("length between the clamps", self.rectangle.length + to[0])?;
        let (from, length) = (self.moved, self.rectangle.length);
        let way = [to[0] - from[0], to[1] - from[1]];
        let far = way[0].hypot(way[1]) / length;
        if far > 0.0 {
            let points = &self.rectangle.mesh.points;
            // All of the specimen follows as it would if it were strained uniformly.
            let place = |done: f64, next: f64, q: &mut [f64]| {
                for (slots, point) in q.chunks_exact_mut(BLOCK).zip(points) {
                    slots[0] += (next - done) / far * way[0] * point[0] / length;
                    slots[1] += (next - done) / far * way[1] * point[0] / length;
                }
            };
            let what = "a move of the clamp, over the specimen's length, of";
            advance_load(&mut self.system, &mut self.q, &self.rest, [0.0, far], LARGEST_STEP, what, place)?;
            self.moved = to;
            self.energy = self.system.linearise(&self.q, 0.0);
        }
        Ok(())
    }

    /// Moves the second clamp along the pull until that needs this force \[N\]; across, it is at `across` \[m\].
    ///
    /// # Errors
    /// [`ShellError`] if the specimen does not come to rest, or does not bear the force.
    pub fn pull_to(&mut self, force: f64, across: f64) -> Result<(), ShellError> {
        let length = self.rectangle.length;
        let stiffness = self.system.stiffness() * self.rectangle.width / length;
        let within = PRECISION.max(3.0 * self.rest.tolerance) * force.abs().max(1e-6 * stiffness * length);
        let (mut before, mut slope) = (None::<[f64; 2]>, stiffness);
        for _ in 0..80 {
            let along = self.moved[0];
            self.move_to([along, across])?;
            let off = self.force()[0] - force;
            if off.abs() <= within {
                return Ok(());
            }
            if let Some([place, other]) = before {
                let secant = (off - other) / (along - place);
                slope = if secant > 0.0 { secant } else { 0.5 * slope };
            }
            before = Some([along, off]);
            let step = (-off / slope).clamp(-0.1 * length, 0.3 * length);
            self.move_to([along + step, across])?;
        }
        let load = format!("a pull of {force:.4} N");
        Err(ShellError::NotAtRest { load, iterations: 80, residual: (self.force()[0] / force - 1.0).abs() })
    }

    /// Where the second clamp is, along and across \[m\].
    #[must_use]
    pub fn moved(&self) -> [f64; 2] {
        self.moved
    }
    /// Force with which the second clamp is pulled, along and across \[N\].
    #[must_use]
    pub fn force(&self) -> [f64; 2] {
        let [_, end] = self.rectangle.ends();
        let sum = |axis: usize| end.clone().map(|v| self.system.gradient()[BLOCK * v + axis]).sum();
        [sum(0), sum(1)]
    }
    /// What the specimen stores \[J\].
    #[must_use]
    pub fn energy(&self) -> f64 {
        self.energy
    }
    /// Width at mid-length between the sides \[m\].
    #[must_use]
    pub fn width(&self) -> f64 {
        let row = self.rectangle.middle();
        self.q[BLOCK * (row.end - 1) + 1] - self.q[BLOCK * row.start + 1]
    }
    /// Directions of the specimen's length and width at its middle, as a camera sees them: the columns of the deformation
    /// gradient over a patch of half a width \[–\].
    #[must_use]
    pub fn middle(&self) -> [[f64; 2]; 2] {
        let (length, width) = (self.rectangle.length, self.rectangle.width);
        let radius = 0.25 * width.min(length);
        // Least squares of places by places at rest, over a disc.
        let (mut normal, mut right) = ([0.0; 3], [[0.0; 2]; 2]);
        let near: Vec<usize> = (0..self.rectangle.mesh.points.len())
            .filter(|&v| {
                let [x, y] = self.rectangle.mesh.points[v];
                (x - 0.5 * length).hypot(y - 0.5 * width) <= radius
            })
            .collect();
        let count = near.len().max(1) as f64;
        let mean = |of: &dyn Fn(usize, usize) -> f64| {
            [0, 1].map(|axis| near.iter().map(|&v| of(v, axis)).sum::<f64>() / count)
        };
        let at_rest = |v: usize, axis: usize| self.rectangle.mesh.points[v][axis];
        let now = |v: usize, axis: usize| self.q[BLOCK * v + axis];
        let (rest, place) = (mean(&at_rest), mean(&now));
        for &v in &near {
            let d = [0, 1].map(|axis| at_rest(v, axis) - rest[axis]);
            for axis in 0..2 {
                let e = now(v, axis) - place[axis];
                right[0][axis] += d[0] * e;
                right[1][axis] += d[1] * e;
            }
            normal = [normal[0] + d[0] * d[0], normal[1] + d[0] * d[1], normal[2] + d[1] * d[1]];
        }
        let [a, b, c] = normal;
        let determinant = a * c - b * b;
        let column =
            |one: f64, two: f64| [0, 1].map(|axis: usize| (one * right[0][axis] + two * right[1][axis]) / determinant);
        [column(c, -b), column(-b, a)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wale::energy::{BendingStiffness, MembraneStiffness};

    fn card() -> ShellCard {
        let membrane =
            MembraneStiffness { xx: 30.0, xy: 5.0, yy: 90.0, ss: 8.0, n1: 2.0, n2: 4.0, ..MembraneStiffness::NONE };
        ShellCard { membrane, bending: BendingStiffness::isotropic(0.0), areal_mass: 0.0 }
    }

    #[test]
    fn work_of_the_clamp_is_what_the_specimen_stores() {
        let specimen = Specimen { length: 0.1, width: 0.06 };
        let mut rig = Rig::new(&card(), specimen, 0.4, 0.01).unwrap();
        // Simpson's rule along a straight way, and back by another.
        let (mut work, parts) = (0.0, 20);
        let way = [0.03, 0.02];
        for k in 0..=parts {
            let part = k as f64 / parts as f64;
            rig.move_to(way.map(|w| part * w)).unwrap();
            let force = rig.force();
            let weight = if k == 0 || k == parts { 1.0 } else { 2.0 + 2.0 * (k % 2) as f64 };
            work += weight * (force[0] * way[0] + force[1] * way[1]) / (3.0 * parts as f64);
        }
        assert!((work / rig.energy() - 1.0).abs() < 1e-6, "{work} {}", rig.energy());
        // However it got there.
        let mut straight = Rig::new(&card(), specimen, 0.4, 0.01).unwrap();
        straight.move_to([0.01, 0.005]).unwrap();
        rig.move_to([0.02, -0.01]).unwrap();
        rig.move_to([0.01, 0.005]).unwrap();
        assert!((rig.energy() / straight.energy() - 1.0).abs() < 1e-9, "{}", rig.energy());
    }

    #[test]
    fn a_force_is_reached_from_either_side() {
        let specimen = Specimen { length: 0.1, width: 0.06 };
        let mut rig = Rig::new(&card(), specimen, 0.0, 0.01).unwrap();
        rig.pull_to(1.0, 0.0).unwrap();
        let first = rig.moved()[0];
        assert!((rig.force()[0] - 1.0).abs() < 2e-9);
        rig.pull_to(3.0, 0.0).unwrap();
        rig.pull_to(1.0, 0.0).unwrap();
        assert!((rig.moved()[0] / first - 1.0).abs() < 1e-7);
        // The specimen contracts, and its middle is seen to be stretched and narrowed.
        let [along, across] = rig.middle();
        assert!(along[0] > 1.0 && across[1] < 1.0 && rig.width() < 0.06);
        assert!(along[1].abs() < 1e-9 && across[0].abs() < 1e-9);
        assert!(rig.move_to([-0.1, 0.0]).is_err());
    }
}
