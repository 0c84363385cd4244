//! The curves of a fit: a table, a plot, a page.

use std::fmt::Write;
use std::path::PathBuf;

use wale::picture::{Panel, Plot, Series};
use wale_lab::fabric_file::FabricFile;
use wale_lab::fabric_fit::FabricFit;
use wale_lab::yarn_fit::run::YarnFit;

use super::tell::degrees;

/// Measured and fitted, point by point.
pub fn curves_csv(fabric: &FabricFile, found: &FabricFit, yarn: Option<&YarnFit>) -> String {
    let mut text = String::from(
        "model,direction [deg],stretch [-],measured force [N or N/m],fitted force [N or N/m],measured compression [-],fitted compression [-]\n",
    );
    for (test, points) in fabric.stretch.iter().zip(&found.membrane.points) {
        for [target, point] in points {
            let measured =
                if test.curve.compression.is_some() { format!("{}", target.compression) } else { String::new() };
            let _ = writeln!(
                text,
                "shell between clamps [N],{},{},{},{},{measured},{}",
                test.direction.to_degrees(),
                target.stretch,
                target.force,
                point.force,
                point.compression
            );
        }
    }
    for (target, answers) in yarn.iter().flat_map(|yarn| yarn.targets.iter().zip(&yarn.evaluation.stretch)) {
        for ([stretch, force, compression], answer) in target.points.iter().zip(answers) {
            let measured = if target.compression { format!("{compression}") } else { String::new() };
            let _ = writeln!(
                text,
                "yarn in a uniform strip [N/m],{},{stretch},{force},{},{measured},{}",
                target.angle.to_degrees(),
                answer.point.force,
                answer.point.compression
            );
        }
    }
    text
}

/// Curves of the shell between clamps, and of the yarn in a uniform strip.
pub fn plot(fabric: &FabricFile, found: &FabricFit, yarn: Option<&YarnFit>) -> Plot {
    let percent = |values: &[f64]| values.iter().map(|value| 100.0 * value).collect::<Vec<_>>();
    let (mut force, mut compression) = (Vec::new(), Vec::new());
    for (test, points) in fabric.stretch.iter().zip(&found.membrane.points) {
        let name = degrees(test.direction);
        let xs = percent(&test.curve.stretch);
        force.push(Series { name: format!("{name}, measured"), xs: xs.clone(), ys: test.curve.force.clone() });
        if let Some(values) = &test.curve.compression {
            compression.push(Series { name: format!("{name}, measured"), xs, ys: percent(values) });
        }
        let with_rest = |of: fn(&wale_lab::shell::StretchPoint) -> f64| {
            std::iter::once(0.0).chain(points.iter().map(|[_, point]| of(point))).collect::<Vec<_>>()
        };
        let xs = percent(&with_rest(|point| point.stretch));
        force.push(Series { name: format!("{name}, fitted"), xs: xs.clone(), ys: with_rest(|point| point.force) });
        let ys = percent(&with_rest(|point| point.compression));
        compression.push(Series { name: format!("{name}, fitted"), xs, ys });
    }
    let mut panels = vec![
        Panel { y_label: "force [N]".to_owned(), series: force },
        Panel { y_label: "compression [%]".to_owned(), series: compression },
    ];
    if let Some(yarn) = yarn {
        let (mut stress, mut compression) = (Vec::new(), Vec::new());
        for (target, answers) in yarn.targets.iter().zip(&yarn.evaluation.stretch) {
            let name = degrees(target.angle);
            let xs = percent(&std::iter::once(0.0).chain(target.stretches()).collect::<Vec<_>>());
            let add = |to: &mut Vec<Series>, what: &str, values: Vec<f64>| {
                let ys = std::iter::once(0.0).chain(values).collect();
                to.push(Series { name: format!("{name}, {what}"), xs: xs.clone(), ys });
            };
            add(&mut stress, "uniform", target.points.iter().map(|p| p[1]).collect());
            add(&mut stress, "yarn", answers.iter().map(|a| a.point.force).collect());
            if target.compression {
                add(&mut compression, "uniform", percent(&target.points.iter().map(|p| p[2]).collect::<Vec<_>>()));
            }
            add(&mut compression, "yarn", percent(&answers.iter().map(|a| a.point.compression).collect::<Vec<_>>()));
        }
        panels.push(Panel { y_label: "stress [N/m]".to_owned(), series: stress });
        panels.push(Panel { y_label: "compression [%]".to_owned(), series: compression });
    }
    Plot { title: fabric.title.clone(), x_label: "stretch [%]".to_owned(), panels }
}

/// One page that needs no other file.
pub fn page(fabric: &FabricFile, lines: &[String], svg: &str) -> String {
    let escaped = |text: &str| text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    let title = if fabric.title.is_empty() { "A fabric" } else { &fabric.title };
    let files: Vec<String> = fabric.inputs.iter().map(|path: &PathBuf| escaped(&path.display().to_string())).collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{title}</title>\n\
         <style>body{{font:16px/1.5 sans-serif;max-width:60em;margin:2em auto;padding:0 1em}}pre{{white-space:pre-wrap}}svg{{max-width:100%;height:auto}}</style>\n\
         </head><body>\n<h1>{title}</h1>\n<pre>{}</pre>\n{svg}\n<p>Read from {}. The card is in card.toml, the curves are in curves.csv.</p>\n\
         </body></html>\n",
        escaped(&lines.join("\n")),
        files.join(", "),
        title = escaped(title),
    )
}
