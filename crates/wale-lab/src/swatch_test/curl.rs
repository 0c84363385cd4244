//! Curl: a free swatch comes to rest, and its edges roll up.

use wale::measure::Shape;
use wale::scene::Scene;

use super::{SwatchTestError, simulation, start, swatch};

/// How an edge rolls up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeCurl {
    /// Mean curvature over its outermost loops \[1/m\], positive where they roll to the front.
    pub curvature: f64,
    /// Angle by which these turn together \[rad\].
    pub turned: f64,
}

/// What the test reports.
#[derive(Clone, Debug, PartialEq)]
pub struct CurlResult {
    /// Columns and rows of the swatch.
    pub loops: [usize; 2],
    /// Left and right, along the courses; cast-on and bind-off, along the wales.
    pub edges: [EdgeCurl; 4],
    /// Mean curvature of the whole swatch along course and wale \[1/m\].
    pub whole: [f64; 2],
    /// Curvature along the courses by column, and along the wales by row: place from the middle \[m\] and curvature \[1/m\].
    pub along: [Vec<[f64; 2]>; 2],
    /// Size of the box around it \[m\].
    pub extent: [f64; 3],
}

/// Lets a flat swatch of so many columns and rows go until it rests, without weight, friction and table.
///
/// # Errors
/// [`SwatchTestError`].
pub fn curl(scene: &Scene, columns: usize, rows: usize) -> Result<CurlResult, SwatchTestError> {
    let scene = swatch(scene, columns, rows)?;
    let mut simulation = simulation(&scene, start(&scene, true));
    let report = simulation.relax();
    if !report.converged {
        let why = format!("after {} steps its fastest node still moves at {:.1e} m/s", report.steps, report.speed);
        return Err(SwatchTestError::NotAtRest { what: "swatch", why });
    }
    let shape = Shape::of(simulation.network(), &simulation.frame());
    let profile = Shape::profiles(simulation.network(), &simulation.frame());
    let (wale, course) = (shape.wale_spacing_m, shape.course_spacing_m);
    let at = |k: usize, count: usize, spacing: f64| spacing * (k as f64 - 0.5 * (count as f64 - 1.0));
    let placed = |values: &[f64], spacing: f64| -> Vec<[f64; 2]> {
        values.iter().enumerate().map(|(k, &curvature)| [at(k, values.len(), spacing), curvature]).collect()
    };
    let edge = |values: &[f64], spacing: f64, last: bool| {
        let count = Shape::edge_loops(values.len());
        let zone = if last { &values[values.len() - count..] } else { &values[..count] };
        let curvature = zone.iter().sum::<f64>() / count as f64;
        EdgeCurl { curvature, turned: curvature * count as f64 * spacing }
    };
    let both = |values: &[f64], spacing: f64| [false, true].map(|last| edge(values, spacing, last));
    let ([left, right], [bottom, top]) = (both(&profile[0], wale), both(&profile[1], course));
    Ok(CurlResult {
        loops: [columns, rows],
        edges: [left, right, bottom, top],
        whole: [shape.curvature.course_per_m, shape.curvature.wale_per_m],
        along: [placed(&profile[0], wale), placed(&profile[1], course)],
        extent: shape.extent_m,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stockinette_rolls_its_sides_back_and_its_ends_forward() {
        let text = "schema = 1\n[fabric.chart]\npattern = \"stockinette\"\ncolumns = 8\nrows = 8\n";
        let found = curl(&Scene::from_text(text, "stockinette.toml").unwrap(), 7, 7).unwrap();
        let [left, right, bottom, top] = found.edges.map(|edge| edge.curvature);
        assert!(left + right < -10.0 && bottom + top > 10.0, "{found:?}");
        assert!(found.edges.iter().all(|edge| edge.turned * edge.curvature >= 0.0));
        assert_eq!(found.along.each_ref().map(Vec::len), [7, 7]);
    }
}
