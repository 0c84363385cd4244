//! From one coarse deformation to the next: yarns follow, and the next equilibrium is guessed.

use wale_numerics::block_matrix::SLOTS;

use super::coarse::{CoarseDeformation, times};
use super::equilibrium::{LONGEST_MOVE, TileError, TileSolver};

/// Parts that a change of deformation is cut into at most, as powers of two.
const MOST_HALVINGS: u32 = 12;

impl TileSolver {
    /// Changes the deformation in parts that take no two centrelines nearer than half their distance: the whole tile follows evenly,
    /// and what the constraints then ask for is small.
    pub(super) fn move_to(&mut self, to: &CoarseDeformation) -> Result<(), TileError> {
        check(to)?;
        let from = self.system.deformation;
        let (mut done, mut part) = (0.0, 1.0f64);
        while done < 1.0 {
            let next = (done + part).min(1.0);
            let target = between(&from, to, next);
            check(&target)?;
            let mut moved = self.displacement.clone();
            carry(&self.system.deformation, &target, &mut moved);
            let before = (self.system.deformation, self.displacement.clone());
            (self.system.deformation, self.displacement) = (target, moved);
            self.system.refresh_contacts(&self.displacement)?;
            let mut held = self.displacement.clone();
            self.system.constraints.project(&mut held);
            let direction: Vec<f64> = held.iter().zip(&self.displacement).map(|(a, b)| a - b).collect();
            let free = self.system.longest_step(&self.displacement, &direction, 0.0, f64::INFINITY) >= 1.0;
            if free || part < 0.5f64.powi(MOST_HALVINGS as i32) {
                self.displacement = held;
                done = next;
            } else {
                (self.system.deformation, self.displacement) = before;
                part *= 0.5;
            }
        }
        Ok(())
    }

    /// Where two equilibria lie on a line of deformations, guesses that the next goes on as they do, in its compression too where
    /// that is free.
    pub(super) fn extrapolate(&mut self) {
        let (Some((first, u)), Some((second, v))) = (&self.before, &self.last) else { return };
        let Some(factor) = along(first, second, &self.system.deformation, self.free_compression) else { return };
        let direction: Vec<f64> = (0..u.len()).map(|k| v[k] + factor * (v[k] - u[k]) - self.displacement[k]).collect();
        let mut compression = 0.0;
        if self.free_compression {
            let [a, b, c] = [first, second, &self.system.deformation].map(CoarseDeformation::compression);
            compression = b + factor * (b - a) - c;
        }
        let most = LONGEST_MOVE * 2.0 * self.length;
        if self.system.longest_step(&self.displacement, &direction, compression, most) >= 1.0 {
            self.displacement.iter_mut().zip(&direction).for_each(|(u, d)| *u += d);
            let rate = self.system.deformation.compression_rate();
            self.system.deformation.add(&rate, compression);
        }
    }
}

/// Whether a deformation can be applied.
pub(super) fn check(deformation: &CoarseDeformation) -> Result<(), TileError> {
    let (determinant, curvature) = (deformation.determinant(), deformation.curvature);
    let finite = deformation.plane.iter().flatten().all(|f| f.is_finite());
    if finite && determinant > 1e-6 && curvature.is_finite() {
        Ok(())
    } else {
        Err(TileError::Deformation { determinant, curvature })
    }
}

/// A part of the way from one deformation to another; the direction is that of the other.
fn between(from: &CoarseDeformation, to: &CoarseDeformation, part: f64) -> CoarseDeformation {
    let mix = |a: f64, b: f64| if part < 1.0 { a + part * (b - a) } else { b };
    CoarseDeformation {
        plane: std::array::from_fn(|i| std::array::from_fn(|j| mix(from.plane[i][j], to.plane[i][j]))),
        curvature: mix(from.curvature, to.curvature),
        direction: to.direction,
    }
}

/// Displacements that go with the plane when it is stretched further.
fn carry(from: &CoarseDeformation, to: &CoarseDeformation, displacement: &mut [f64]) {
    let ([[a, b], [c, d]], determinant) = (from.plane, from.determinant());
    let inverse = [[d / determinant, -b / determinant], [-c / determinant, a / determinant]];
    for u in displacement.as_chunks_mut::<SLOTS>().0 {
        let [x, y] = times(&to.plane, times(&inverse, [u[0], u[1]]));
        (u[0], u[1]) = (x, y);
    }
}

/// The factor `t` with `third − second = t (second − first)`, if there is one; compression is not looked at where it is free.
fn along(
    first: &CoarseDeformation,
    second: &CoarseDeformation,
    third: &CoarseDeformation,
    free_compression: bool,
) -> Option<f64> {
    let numbers = |d: &CoarseDeformation| {
        let mut d = *d;
        if free_compression {
            let (rate, compression) = (d.compression_rate(), d.compression());
            d.add(&rate, -compression);
        }
        let [[a, b], [c, e]] = d.plane;
        [a, b, c, e, d.curvature * 1e-3, d.direction[0], d.direction[1]]
    };
    let (a, b, c) = (numbers(first), numbers(second), numbers(third));
    let (mut square, mut product, mut size) = (0.0, 0.0, 0.0);
    for k in 0..a.len() {
        let (old, new) = (b[k] - a[k], c[k] - b[k]);
        square += old * old;
        product += old * new;
        size += new * new;
    }
    if square < 1e-20 || size < 1e-20 {
        return None;
    }
    let factor = product / square;
    (factor > 0.0 && factor < 4.0 && (size - factor * product).abs() < 1e-6 * size).then_some(factor)
}
