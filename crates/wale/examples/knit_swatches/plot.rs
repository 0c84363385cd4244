//! Predicted against measured sizes as a picture: widths and heights of each group, a point a chart, on the line where both are the same.

use std::path::Path;

use wale::picture::{Chart, ChartGrid, Series};

use super::Predicted;

/// Writes widths beside heights as SVG, or as PNG where the name ends so.
pub fn write(path: &Path, groups: &[(&str, &[Predicted<'_>])]) -> Result<(), String> {
    let failed = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let groups: Vec<_> = groups.iter().filter(|(_, group)| !group.is_empty()).collect();
    let chart = |&(name, group): &(&str, &[Predicted<'_>]), k: usize| {
        let (xs, ys): (Vec<f64>, Vec<f64>) = group.iter().map(|one| (one.measured()[k], one.size[k])).unzip();
        let all = || xs.iter().chain(&ys).copied();
        let ends = vec![all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max)];
        Chart {
            title: format!("{name}: {}", ["width", "height"][k]),
            x_label: "measured".to_owned(),
            y_label: "predicted".to_owned(),
            points: vec![Series { name: "a chart".to_owned(), xs, ys }],
            lines: vec![Series { name: "the same".to_owned(), xs: ends.clone(), ys: ends }],
            bar: None,
        }
    };
    let charts = groups.iter().flat_map(|group| [0, 1].map(|k| chart(group, k))).collect();
    let title = "Relaxed sizes of real swatches, relative to stockinette, predicted with one card".to_owned();
    let grid = ChartGrid { title, columns: 2, charts };
    let bytes = if path.extension().is_some_and(|end| end == "png") {
        grid.to_png(1.5).map_err(|error| failed(&error))?
    } else {
        grid.to_svg().map_err(|error| failed(&error))?.into_bytes()
    };
    std::fs::write(path, bytes).map_err(|error| failed(&error))
}
