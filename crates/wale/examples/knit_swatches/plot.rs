//! Predicted against measured sizes as a picture: a point a chart, on the line where both are the same.

use std::path::Path;

use wale::picture::{Chart, ChartGrid, Series};

use super::Predicted;

/// Writes widths beside heights as SVG, or as PNG where the name ends so.
pub fn write(path: &Path, groups: &[(&str, &[Predicted<'_>])]) -> Result<(), String> {
    let failed = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let chart = |(k, what): (usize, &str)| {
        let series = |(name, group): &(&str, &[Predicted<'_>])| Series {
            name: (*name).to_owned(),
            xs: group.iter().map(|one| one.measured()[k]).collect(),
            ys: group.iter().map(|one| one.size[k]).collect(),
        };
        let points: Vec<Series> = groups.iter().filter(|(_, group)| !group.is_empty()).map(series).collect();
        let all = || points.iter().flat_map(|series| series.xs.iter().chain(&series.ys)).copied();
        let ends = vec![all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max)];
        Chart {
            title: format!("{what}, relative to stockinette"),
            x_label: "measured".to_owned(),
            y_label: "predicted".to_owned(),
            points,
            lines: vec![Series { name: "the same".to_owned(), xs: ends.clone(), ys: ends }],
            bar: None,
        }
    };
    let charts = ["width", "height"].into_iter().enumerate().map(chart).collect();
    let title = "Relaxed sizes of real swatches, predicted with one card".to_owned();
    let grid = ChartGrid { title, columns: 2, charts };
    let bytes = if path.extension().is_some_and(|end| end == "png") {
        grid.to_png(1.5).map_err(|error| failed(&error))?
    } else {
        grid.to_svg().map_err(|error| failed(&error))?.into_bytes()
    };
    std::fs::write(path, bytes).map_err(|error| failed(&error))
}
