//! A tile brought to the size of a real fabric, as its yarns would let themselves be pushed together.

use super::coarse::CoarseDeformation;
use super::equilibrium::{EquilibriumSettings, TileError, TileSolver};
use super::material::RodMaterial;
use super::rest::RestShape;
use super::rest_shape::contact_radius;
use super::tile::YarnTile;

/// Largest change of a period in a step, as a logarithm.
const STEP: f64 = 0.03;
/// Bending stiffness of the yarn that is pushed, over that of a solid rod which is as stiff in stretch: fibres slide past each other.
const BENDING: f64 = 0.05;
/// Its contact stiffness, in `k_s/R`.
const CONTACT: f64 = 0.05;
/// Springs that end sliding, and the net force up to which a step is taken for an equilibrium, in the units of
/// [`EquilibriumSettings`].
const ANCHOR: f64 = 1e-4;
const ACCEPTED: f64 = 1e-3;

impl YarnTile {
    /// The tile with other periods \[m\]: it is stretched or pushed together evenly and step by step, and its yarns, straight if they
    /// were free, go where they resist least. What is too long for the new size folds out of the plane, as garter does along its wales;
    /// scaling the drawn yarns ([`Self::with_periods`]) would shorten them instead. They are at rest as they then lie.
    ///
    /// Only ratios of stiffnesses matter, and those of a soft yarn are taken.
    ///
    /// # Errors
    /// [`TileError`]; if there is no equilibrium on the way.
    ///
    /// # Panics
    /// If a period is not positive.
    pub fn pushed_to(&self, periods: [f64; 2]) -> Result<Self, TileError> {
        assert!(periods.iter().all(|&period| period > 0.0));
        let factors: [f64; 2] = std::array::from_fn(|axis| periods[axis] / self.periods()[axis]);
        let largest = factors.iter().fold(0.0f64, |most, factor| most.max(factor.ln().abs()));
        let steps = (largest / STEP).ceil() as u32;
        let radius = contact_radius(self);
        let stretch = std::f64::consts::PI * radius * radius;
        let rod = RodMaterial::solid_rod(radius, 1.0, CONTACT * stretch / radius);
        let mut material = RodMaterial { bending: BENDING * rod.bending, ..rod };
        // Yarns that touch hard keep their distance.
        material.contact[1].stiffness = stretch / radius;
        let straight = Self { rest: RestShape::straight(self.lengths()), ..self.clone() };
        let settings = EquilibriumSettings { anchor: ANCHOR, ..EquilibriumSettings::default() };
        let mut solver = TileSolver::new(&straight, &material, settings)?;
        let mut tile = straight.clone();
        for step in 1..=steps {
            let part = f64::from(step) / f64::from(steps);
            let plane = [[factors[0].powf(part), 0.0], [0.0, factors[1].powf(part)]];
            let found = solver.solve(&CoarseDeformation { plane, ..CoarseDeformation::REST })?;
            if found.residual > ACCEPTED {
                return Err(TileError::NoEquilibrium { residual: found.residual });
            }
            if step == steps {
                let places = straight.vertices().iter().zip(&found.displacement);
                tile.vertices =
                    places.map(|(x, u)| [factors[0] * x[0] + u[0], factors[1] * x[1] + u[1], x[2] + u[2]]).collect();
                tile.periods = periods;
            }
        }
        Ok(tile.at_rest_as_it_lies())
    }
}

#[cfg(test)]
mod tests {
    use super::super::tile_of_chart;
    use super::*;
    use wale::pattern::Chart;
    use wale::scene::schema::PresetName;
    use wale::scene::{Scene, text_of_preset};

    fn thickness(tile: &YarnTile) -> f64 {
        let heights = tile.vertices().iter().map(|x| x[2]);
        heights.clone().fold(f64::NEG_INFINITY, f64::max) - heights.fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn garter_that_is_pushed_together_along_its_wales_folds_and_keeps_its_yarn() {
        let scene = Scene::from_text(&text_of_preset(PresetName::WorstedWool), "preset.toml").unwrap();
        let tile = tile_of_chart(&Chart::garter(), &scene.yarns, scene.fabric.knit().unwrap()).unwrap();
        let [width, height] = tile.periods();
        let pushed = tile.pushed_to([width, 0.75 * height]).unwrap();
        assert_eq!(pushed.periods(), [width, 0.75 * height]);
        assert!(thickness(&pushed) > 1.1 * thickness(&tile), "{} {}", thickness(&pushed), thickness(&tile));
        let length = |tile: &YarnTile| tile.lengths().iter().sum::<f64>();
        let (kept, scaled) = (length(&pushed), length(&tile.with_periods([width, 0.75 * height])));
        assert!((kept / length(&tile) - 1.0).abs() < 0.02, "{kept} {}", length(&tile));
        assert!(scaled / length(&tile) < 0.93, "{scaled}");
        let same = tile.pushed_to(tile.periods()).unwrap();
        assert_eq!(same, tile.at_rest_as_it_lies());
    }
}
