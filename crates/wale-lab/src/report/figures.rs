//! Curves beside the data, as [Sperl2022, Figs. 11 and 16 to 18] show them.

use wale::picture::{Chart, ChartGrid, Series};

use super::Told;
use crate::fabric_file::direction_name;
use crate::shell::StretchPoint;
use crate::yarn_fit::Target;
use crate::yarn_fit::ablation::AblationKind;
use crate::yarn_fit::run::YarnFit;

const STRETCH: &str = "stretch [%]";
const FORCE: &str = "force [N]";
const STRESS: &str = "stress [N/m]";
const COMPRESSION: &str = "compression [%]";

fn series(name: &str, points: impl Iterator<Item = [f64; 2]>) -> Series {
    let (xs, ys) = points.map(|[x, y]| (100.0 * x, y)).unzip();
    Series { name: name.to_owned(), xs, ys }
}

/// A line from rest through points of a model.
fn line<'a>(name: &str, points: impl Iterator<Item = &'a StretchPoint>, of: impl Fn(&StretchPoint) -> f64) -> Series {
    series(name, std::iter::once([0.0, 0.0]).chain(points.map(|point| [point.stretch, of(point)])))
}

/// Shell and yarn beside what was measured: a row for each direction that was tested.
#[must_use]
pub fn curves_figure(told: &Told<'_>) -> ChartGrid {
    let mut charts = Vec::new();
    for (test, points) in told.fabric.stretch.iter().zip(&told.shell.membrane.points) {
        let of_yarn = told.yarn.and_then(|(_, fit)| {
            let index = fit.targets.iter().position(|target| (target.angle - test.direction).abs() < 1e-9)?;
            Some((fit, index))
        });
        if points.is_empty() || told.yarn.is_some() && of_yarn.is_none() {
            continue;
        }
        let curve = &test.curve;
        let measured = |values: &[f64], unit: f64| {
            series("measured", curve.stretch.iter().zip(values).map(|(&x, &y)| [x, unit * y]))
        };
        let fitted = |of: fn(&StretchPoint) -> f64| vec![line("fitted", points.iter().map(|[_, found]| found), of)];
        charts.push(Chart {
            title: format!("shell between clamps, {}", direction_name(test.direction)),
            x_label: STRETCH.to_owned(),
            y_label: FORCE.to_owned(),
            points: vec![measured(&curve.force, 1.0)],
            lines: fitted(|point| point.force),
            bar: None,
        });
        charts.push(Chart {
            y_label: COMPRESSION.to_owned(),
            points: curve.compression.iter().map(|values| measured(values, 100.0)).collect(),
            lines: fitted(|point| 100.0 * point.compression),
            ..charts[charts.len() - 1].clone()
        });
        if let Some((fit, index)) = of_yarn {
            let title = format!("yarn in a uniform strip, {}", direction_name(test.direction));
            charts.extend(pair(&title, &fit.targets[index], index, &[("fitted", fit)]));
        }
    }
    let columns = if told.yarn.is_some() { 4 } else { 2 };
    ChartGrid { title: told.fabric.title.clone(), columns, charts }
}

/// Stress and compression of a direction, as fits have them.
fn pair(title: &str, target: &Target, index: usize, fits: &[(&str, &YarnFit)]) -> [Chart; 2] {
    let lines = |of: fn(&StretchPoint) -> f64| {
        let one =
            |(name, fit): &(&str, &YarnFit)| line(name, fit.evaluation.stretch[index].iter().map(|a| &a.point), of);
        fits.iter().map(one).collect()
    };
    let measured = |k: usize, unit: f64| series("measured", target.points.iter().map(|p| [p[0], unit * p[k]]));
    let chart = |y_label: &str, points, lines| Chart {
        title: title.to_owned(),
        x_label: STRETCH.to_owned(),
        y_label: y_label.to_owned(),
        points,
        lines,
        bar: Some(100.0 * target.comfort),
    };
    let narrows = if target.compression { vec![measured(2, 100.0)] } else { Vec::new() };
    [
        chart(STRESS, vec![measured(1, 1.0)], lines(|point| point.force)),
        chart(COMPRESSION, narrows, lines(|point| 100.0 * point.compression)),
    ]
}

/// Every ablation beside the whole fit and the data, a row each; the bar is where comfort ends. None if there is none.
#[must_use]
pub fn ablation_figure(told: &Told<'_>) -> Option<ChartGrid> {
    let (_, whole) = told.yarn?;
    let swarm = told.ablated.iter().find(|one| one.kind == AblationKind::Swarm).and_then(|one| one.fit.as_ref());
    let mut charts = Vec::new();
    for one in told.ablated {
        let Some(fit) = &one.fit else { continue };
        let mut fits = vec![("the whole fit", whole), ("this one", fit)];
        if one.kind == AblationKind::LocalOnly {
            fits.extend(swarm.map(|swarm| ("swarm and COBYLA", swarm)));
        }
        for (index, target) in whole.targets.iter().enumerate() {
            // The first chart alone names its lines.
            let third = if fits.len() > 2 { " (yellow: with a swarm)" } else { "" };
            let title = format!("{}{third}, {}", one.kind.title(), direction_name(target.angle));
            charts.extend(pair(&title, target, index, &fits));
        }
    }
    let title = format!("{}: what each part of the fit is for", told.fabric.title);
    let title = title.trim_start_matches(": ").to_owned();
    (!charts.is_empty()).then(|| ChartGrid { title, columns: 2 * whole.targets.len(), charts })
}
