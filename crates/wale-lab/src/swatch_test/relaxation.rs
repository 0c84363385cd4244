//! Relaxation shrinkage: how much smaller a fabric is at rest than as it was knitted, that is as its card lays it out.

use wale::measure::Shape;
use wale::scene::Scene;

use super::{SwatchTestError, card, relaxed_spacing, simulation, start, swatch};

/// What the test reports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shrinkage {
    /// Distance of wales, and of courses, as knitted \[m\].
    pub knitted: [f64; 2],
    /// The same at rest \[m\].
    pub relaxed: [f64; 2],
}

impl Shrinkage {
    /// What it loses of its width (weft), and of its length (warp) \[–\]; negative where it grows.
    #[must_use]
    pub fn shrinkage(&self) -> [f64; 2] {
        std::array::from_fn(|axis| 1.0 - self.relaxed[axis] / self.knitted[axis])
    }

    /// What it loses of its area \[–\].
    #[must_use]
    pub fn of_area(&self) -> f64 {
        1.0 - (self.relaxed[0] * self.relaxed[1]) / (self.knitted[0] * self.knitted[1])
    }
}

/// Of the repeat of a scene's chart, without end and held flat by a light bed.
///
/// # Errors
/// [`SwatchTestError`].
pub fn shrinkage_of_tile(scene: &Scene) -> Result<Shrinkage, SwatchTestError> {
    if scene.fabric.woven().is_some() {
        return Err(SwatchTestError::Sett);
    }
    let known = card(scene)?;
    Ok(Shrinkage { knitted: [known.wale_spacing, known.course_spacing], relaxed: relaxed_spacing(scene)? })
}

/// Of a free swatch of so many columns and rows, which may curl: distances are those of neighbouring loops.
///
/// # Errors
/// [`SwatchTestError`].
pub fn shrinkage_of_swatch(scene: &Scene, columns: usize, rows: usize) -> Result<Shrinkage, SwatchTestError> {
    let scene = swatch(scene, columns, rows)?;
    let mut simulation = simulation(&scene, start(&scene, false));
    let spacing = |simulation: &wale::simulation::Simulation| {
        let shape = Shape::of(simulation.network(), &simulation.frame());
        [shape.wale_spacing_m, shape.course_spacing_m]
    };
    let knitted = spacing(&simulation);
    let report = simulation.relax();
    if !report.converged {
        let why = format!("after {} steps its fastest node still moves at {:.1e} m/s", report.steps, report.speed);
        return Err(SwatchTestError::NotAtRest { what: "swatch", why });
    }
    Ok(Shrinkage { knitted, relaxed: spacing(&simulation) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shrinkage_is_by_side_and_area() {
        let found = Shrinkage { knitted: [2.0, 1.0], relaxed: [1.0, 1.1] };
        let [width, length] = found.shrinkage();
        assert!((width - 0.5).abs() < 1e-15 && (length + 0.1).abs() < 1e-15);
        assert!((found.of_area() - 0.45).abs() < 1e-15);
    }

    #[test]
    fn a_repeat_that_is_laid_out_too_wide_shrinks_to_the_same_size() {
        let scene = |spacing: &str| {
            let text = format!(
                "schema = 1\n[fabric]\nloop_length = \"15 mm\"\n{spacing}[fabric.chart]\npattern = \"stockinette\"\ncolumns = 4\nrows = 4\n"
            );
            Scene::from_text(&text, "stockinette.toml").unwrap()
        };
        let [plain, wide] =
            ["", "wale_spacing = \"5 mm\"\n"].map(|spacing| shrinkage_of_tile(&scene(spacing)).unwrap());
        assert!((wide.knitted[0] - 5e-3).abs() < 1e-12 && wide.knitted[1] == plain.knitted[1]);
        for axis in 0..2 {
            // Stiffnesses that the card derives from its layout differ a little.
            assert!((wide.relaxed[axis] / plain.relaxed[axis] - 1.0).abs() < 1e-2, "{plain:?} {wide:?}");
        }
        assert!(wide.shrinkage()[0] > 0.3 && plain.shrinkage()[0].abs() < 0.01, "{plain:?} {wide:?}");
    }
}
