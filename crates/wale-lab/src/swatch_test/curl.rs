//! Curl: a free swatch comes to rest, and its edges roll up.

use wale::measure::Shape;
use wale::scene::Scene;

use super::{SwatchTestError, simulation, start, swatch};

/// What the test reports.
#[derive(Clone, Debug, PartialEq)]
pub struct CurlResult {
    /// Columns and rows of the swatch.
    pub loops: [usize; 2],
    /// Mean curvature along the courses over the outermost loops of both sides \[1/m\], positive where they roll to the front.
    pub sides: f64,
    /// Mean curvature along the wales over the outermost loops of cast-on and bind-off \[1/m\].
    pub ends: f64,
    /// Mean curvature of the whole swatch along course and wale \[1/m\].
    pub whole: [f64; 2],
    /// Angle by which a side, and an end, turns within its outermost loops \[rad\].
    pub turned: [f64; 2],
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
    let zone = |count: usize, spacing: f64| Shape::edge_loops(count) as f64 * spacing;
    Ok(CurlResult {
        loops: [columns, rows],
        sides: shape.side_edges.course_per_m,
        ends: shape.end_edges.wale_per_m,
        whole: [shape.curvature.course_per_m, shape.curvature.wale_per_m],
        turned: [shape.side_edges.course_per_m * zone(columns, wale), shape.end_edges.wale_per_m * zone(rows, course)],
        along: [placed(&profile[0], wale), placed(&profile[1], course)],
        extent: shape.extent_m,
    })
}
