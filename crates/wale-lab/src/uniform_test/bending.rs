//! Pure bending of a tile: it is rolled onto cylinders, both ways, and its moment is the slope of its energy.

use super::{TestedTile, UniformTestError, positive};
use crate::yarn_tile::{CoarseDeformation, TileError, TileSolver};

/// How a tile is bent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TileBendingTest {
    /// Direction that is curved, from the weft (0) towards the warp (π/2) \[rad\].
    pub angle: f64,
    /// Largest curvature, to either side \[1/m\]; left out, a tenth of one by the longer period [Sperl2022, section 9.1], at which a
    /// tile is still thin.
    pub largest: Option<f64>,
    /// Points to either side.
    pub points: usize,
}

impl Default for TileBendingTest {
    /// Along the weft, five points to either side.
    fn default() -> Self {
        Self { angle: 0.0, largest: None, points: 5 }
    }
}

/// What the test reports.
#[derive(Clone, Debug, PartialEq)]
pub struct TileBendingResult {
    /// `B`: slope of the moment by width over the curvature, by least squares \[N·m\].
    pub rigidity: f64,
    /// Moment by width that keeps the tile flat \[N\]; positive if it would else curl to its lower side, the back.
    pub flat_moment: f64,
    /// Curvature without moment, as the line of the moments has it \[1/m\]: positive if the tile curls to its upper side, the front.
    pub own_curvature: f64,
    /// Largest curvature \[1/m\].
    pub largest: f64,
    /// Curvature \[1/m\] and moment by width \[N\].
    pub points: Vec<[f64; 2]>,
}

/// Bends to a tenth of one by the longer period.
const THIN: f64 = 0.1;

impl TileBendingTest {
    /// Bends a tile, its plane held.
    ///
    /// # Errors
    /// [`UniformTestError`].
    pub fn run(&self, tested: &TestedTile) -> Result<TileBendingResult, UniformTestError> {
        let TestedTile { tile, material, settings } = tested;
        let largest = self.largest.unwrap_or(THIN / tile.periods()[0].max(tile.periods()[1]));
        positive("largest curvature", largest)?;
        let count = self.points.max(2);
        let step = largest / count as f64;
        let flat = CoarseDeformation::stretched(self.angle, 0.0, 0.0);
        let side = |sign: f64| -> Result<Vec<f64>, UniformTestError> {
            let mut solver =
                TileSolver::new(tile, material, settings.equilibrium).map_err(UniformTestError::at("rest"))?;
            (0..=count)
                .map(|k| {
                    let curvature = sign * step * k as f64;
                    let place = format!("a curvature of {curvature:.2} 1/m");
                    let found = solver.solve(&flat.bent(curvature)).map_err(UniformTestError::at(place.clone()))?;
                    if found.residual > settings.accepted {
                        let cause = TileError::NoEquilibrium { residual: found.residual };
                        return Err(UniformTestError::at(place)(cause));
                    }
                    Ok(found.energy_density)
                })
                .collect()
        };
        let (up, down) = (side(1.0)?, side(-1.0)?);
        let energies: Vec<f64> = down.iter().skip(1).rev().chain(&up).copied().collect();
        // Between two curvatures the moment is what the energy rises by.
        let points: Vec<[f64; 2]> = energies
            .windows(2)
            .enumerate()
            .map(|(k, pair)| [step * (k as f64 + 0.5 - count as f64), (pair[1] - pair[0]) / step])
            .collect();
        let (square, product) = points.iter().fold((0.0, 0.0), |(s, p), [k, m]| (s + k * k, p + k * m));
        // Curvatures stand evenly about zero, so that the line's height there is the mean.
        let rigidity = product / square;
        let flat_moment = points.iter().map(|p| p[1]).sum::<f64>() / points.len() as f64;
        Ok(TileBendingResult { rigidity, flat_moment, own_curvature: -flat_moment / rigidity, largest, points })
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    use crate::yarn_fit::PullSettings;
    use crate::yarn_tile::test_tiles::{basket, stockinette, straight};
    use crate::yarn_tile::{EquilibriumSettings, RestShape, RodMaterial, bending_stiffness};

    /// A plain weave, quickly at rest.
    pub fn woven() -> TestedTile {
        let tile = basket();
        let material = RodMaterial::solid_rod(tile.radius(), 1e6, 10.0);
        let equilibrium = EquilibriumSettings { tolerance: 1e-9, max_iterations: 300, anchor: 1e-3 };
        TestedTile { tile, material, settings: PullSettings { equilibrium, ..PullSettings::default() } }
    }

    #[test]
    fn straight_yarns_have_the_rigidity_of_their_rods() {
        let tile = straight(16);
        let material = RodMaterial::solid_rod(tile.radius(), 1e6, 10.0);
        let tested = TestedTile { tile: tile.clone(), material, settings: PullSettings::default() };
        let found = TileBendingTest::default().run(&tested).unwrap();
        // One yarn a period across.
        let rod = material.bending / tile.periods()[1];
        assert!((found.rigidity / rod - 1.0).abs() < 2e-3, "{} {rod}", found.rigidity);
        assert!(found.own_curvature.abs() < 1e-6 && found.points.len() == 10);
        let second = bending_stiffness(
            &tile,
            &material,
            PullSettings::default().equilibrium,
            &CoarseDeformation::stretched(0.0, 0.0, 0.0),
            found.largest,
        );
        assert!((found.rigidity / second.unwrap() - 1.0).abs() < 2e-3);
        assert!(TileBendingTest { largest: Some(-1.0), ..TileBendingTest::default() }.run(&tested).is_err());
    }

    #[test]
    fn a_weave_that_is_alike_on_both_sides_does_not_curl() {
        let found = TileBendingTest::default().run(&woven()).unwrap();
        assert!(found.own_curvature.abs() < 1e-2 * found.largest, "{found:?}");
    }

    #[test]
    fn stockinette_of_yarns_that_would_be_straight_rolls_its_sides_to_the_back_and_its_ends_to_the_front() {
        // The heads and sinkers of this tile lie above its legs: its upper side is the back.
        let tile = stockinette();
        let lengths = tile.lengths();
        let tile = tile.with_rest(RestShape::straight(lengths)).unwrap();
        // What sticks keeps them from sliding into another loop.
        let rod = RodMaterial::solid_rod(tile.radius(), 1e6, 10.0);
        let material = RodMaterial { holding: rod.bending / tile.radius().powi(4), ..rod };
        let tested = TestedTile { material, tile, ..woven() };
        let along =
            |angle: f64| TileBendingTest { angle, points: 2, ..TileBendingTest::default() }.run(&tested).unwrap();
        let (course, wale) = (along(0.0), along(FRAC_PI_2));
        assert!(course.own_curvature > 0.1 * course.largest && course.flat_moment < 0.0, "{course:?}");
        assert!(wale.own_curvature < -0.1 * wale.largest && wale.flat_moment > 0.0, "{wale:?}");
    }
}
