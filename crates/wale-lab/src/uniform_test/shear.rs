//! KES shear of a tile: pulled along one direction by a constant force, sheared across it, its width held as by clamps far wider than
//! the specimen is long.

use super::{TestedTile, UniformTestError, positive};
use crate::virtual_test::KesShearResult;
use crate::virtual_test::kes_shear::{KesShearTest, SLOPE};
use crate::virtual_test::units::DEG;
use crate::yarn_tile::{CoarseDeformation, TileSolver};

/// Tries to reach the pull, and its precision \[–\].
const MOST_TRIES: usize = 40;
const PRECISION: f64 = 1e-6;
/// Stretch of the first try to learn how stiff the tile is, and the longest step of another \[–\].
const FIRST: f64 = 1e-3;
const LONGEST: f64 = 0.05;

/// Shears a tile as `test` says; its specimen is as long and wide as one likes.
///
/// A place `(x, y)` along and across goes to `((1 + s) x, y + x tan φ)`; `s` is such that the pull by width `P₁₁` is constant, and the
/// force across by width is `P₂₁`, `P = ∂Ψ/∂F`.
///
/// # Errors
/// [`UniformTestError`].
pub fn tile_shear(tested: &TestedTile, test: &KesShearTest) -> Result<KesShearResult, UniformTestError> {
    positive("tension", test.tension)?;
    if !(test.largest >= SLOPE[1] && test.largest < 80.0 * DEG) {
        let must = "between 5° and 80°, in radians";
        return Err(UniformTestError::Number { what: "largest angle of shear", value: test.largest, must });
    }
    let side = |sign: f64| -> Result<Vec<[f64; 3]>, UniformTestError> {
        let mut sheared = Sheared::new(tested, test.angle)?;
        let count = test.points.max(4);
        (0..=count)
            .map(|k| {
                let angle = test.largest * k as f64 / count as f64;
                let across = sheared.pull_to(test.tension, sign * angle.tan())?;
                Ok([angle, sign * across, sheared.stretch])
            })
            .collect()
    };
    Ok(KesShearResult::of_sides(&side(1.0)?, &side(-1.0)?))
}

/// A tile on its way.
struct Sheared {
    solver: TileSolver,
    angle: f64,
    stretch: f64,
    /// Pull by stretch, as last seen \[N/m\].
    stiffness: Option<f64>,
    accepted: f64,
}

impl Sheared {
    fn new(tested: &TestedTile, angle: f64) -> Result<Self, UniformTestError> {
        let TestedTile { tile, material, settings } = tested;
        let solver = TileSolver::new(tile, material, settings.equilibrium).map_err(UniformTestError::at("rest"))?;
        Ok(Self { solver, angle, stretch: 0.0, stiffness: None, accepted: settings.accepted })
    }

    /// Pull and force across, by width \[N/m\].
    fn forces(&mut self, stretch: f64, shear: f64) -> Result<[f64; 2], UniformTestError> {
        let place = format!("{:.2} % of stretch and {:.1}° of shear", 100.0 * stretch, shear.atan() / DEG);
        let (a, b) = (self.angle.cos(), self.angle.sin());
        // F = D f Dᵀ with the directions along and across as columns of D.
        let turned = |f: [[f64; 2]; 2], d: [[f64; 2]; 2]| -> [[f64; 2]; 2] {
            let product = |l: [[f64; 2]; 2], r: [[f64; 2]; 2]| -> [[f64; 2]; 2] {
                std::array::from_fn(|i| std::array::from_fn(|j| l[i][0] * r[0][j] + l[i][1] * r[1][j]))
            };
            product(product(d, f), [[d[0][0], d[1][0]], [d[0][1], d[1][1]]])
        };
        let gradient = turned([[1.0 + stretch, 0.0], [shear, 1.0]], [[a, -b], [b, a]]);
        let (deformation, rotation) = CoarseDeformation::of_gradient(gradient, self.angle);
        let found = self.solver.solve(&deformation).map_err(UniformTestError::at(place.clone()))?;
        if found.residual > self.accepted {
            let cause = crate::yarn_tile::TileError::NoEquilibrium { residual: found.residual };
            return Err(UniformTestError::at(place)(cause));
        }
        // The energy does not feel a rotation: P(R U) = R P(U).
        let stress: [[f64; 2]; 2] = std::array::from_fn(|i| {
            std::array::from_fn(|j| (0..2).map(|k| rotation[i][k] * found.stress.plane[k][j]).sum())
        });
        let local = turned(stress, [[a, b], [-b, a]]);
        Ok([local[0][0], local[1][0]])
    }

    /// Force across \[N/m\] at a shear under a pull, by secants from the last stretch.
    fn pull_to(&mut self, tension: f64, shear: f64) -> Result<f64, UniformTestError> {
        let mut at = self.stretch;
        let mut force = self.forces(at, shear)?;
        let mut before: Option<[f64; 2]> = None;
        for _ in 0..MOST_TRIES {
            let off = force[0] - tension;
            if off.abs() <= PRECISION * tension {
                self.stretch = at;
                return Ok(force[1]);
            }
            if let Some([place, other]) = before {
                let secant = (off - other) / (at - place);
                self.stiffness = if secant > 0.0 { Some(secant) } else { self.stiffness.map(|k| 2.0 * k) };
            }
            before = Some([at, off]);
            let step = self.stiffness.map_or(FIRST.copysign(-off), |k| (-off / k).clamp(-LONGEST, LONGEST));
            at += step;
            force = self.forces(at, shear)?;
        }
        Err(UniformTestError::Load { load: tension, stretch: at, force: force[0] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::uniform_test::bending::tests::woven;

    #[test]
    fn the_force_across_is_the_slope_of_the_energy() {
        let tested = woven();
        for angle in [0.0, 0.5] {
            let mut sheared = Sheared::new(&tested, angle).unwrap();
            let h = 1e-4;
            let energy = |sheared: &mut Sheared, stretch: f64, shear: f64| {
                sheared.forces(stretch, shear).unwrap();
                // At rest under what was asked for last.
                sheared.solver.solve(&sheared.solver.deformation()).unwrap().energy_density
            };
            let force = sheared.forces(0.02, 0.06).unwrap();
            let along = (energy(&mut sheared, 0.02 + h, 0.06) - energy(&mut sheared, 0.02 - h, 0.06)) / (2.0 * h);
            let across = (energy(&mut sheared, 0.02, 0.06 + h) - energy(&mut sheared, 0.02, 0.06 - h)) / (2.0 * h);
            let size = force[0].hypot(force[1]);
            assert!((along - force[0]).abs() < 2e-4 * size, "{along} {force:?}");
            assert!((across - force[1]).abs() < 2e-4 * size, "{across} {force:?}");
        }
    }

    #[test]
    fn a_weave_shears_the_same_to_both_sides_and_bears_its_pull() {
        let found = tile_shear(&woven(), &KesShearTest { points: 4, ..KesShearTest::default() }).unwrap();
        assert_eq!(found.points.len(), 9);
        // Its yarns turn freely at their crossings: all but a little of the force is that of the pull, T/λ tan φ.
        let of_pull = KesShearTest::default().tension / (1.0 + found.points[4][2]);
        assert!((1.0..1.05).contains(&(found.rigidity / of_pull)), "{of_pull} {found:?}");
        for (one, other) in found.points.iter().zip(found.points.iter().rev()) {
            assert!((one[1] + other[1]).abs() < 1e-2 * found.points[8][1].abs(), "{one:?} {other:?}");
        }
        let bad = KesShearTest { largest: 0.01, ..KesShearTest::default() };
        assert!(matches!(tile_shear(&woven(), &bad), Err(UniformTestError::Number { .. })));
    }
}
