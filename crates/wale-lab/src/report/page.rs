//! The report of a fit: one page that needs no other file.

use std::fmt::Write;

use wale::picture::PlotError;

use super::Told;
use super::conclusion::{conclusion, sum_of_squares};
use super::document::{document, escaped, inlined};
use super::errors::{DirectionErrors, shell_errors, yarn_errors};
use super::figures::{ablation_figure, curves_figure};
use crate::fabric_file::direction_name;
use crate::yarn_fit::problem::YarnProblem;
use crate::yarn_fit::run::YarnFit;
use crate::yarn_fit::{RodSpace, YarnFitError};
use crate::yarn_tile::RodParameter;

/// Of bars and of numbers within their bounds.
const STYLE: &str = "\
.bar{display:inline-block;height:.7em;background:#2f7fb8;margin-right:.5em}.bar.off{background:#8a3f9c}\
.line{position:relative;width:16em;height:1em;border-bottom:1px solid #888}\
.known{position:absolute;bottom:-.2em;height:.4em;background:#9cc4e0}\
.at{position:absolute;bottom:-.35em;width:.7em;height:.7em;margin-left:-.35em;border-radius:50%;background:#2f7fb8}";
/// Longest bar \[em\], which is an error of a half and more.
const LONGEST: f64 = 8.0;

/// The page. `lines` are what the program prints of the fit.
///
/// # Errors
/// If there is nothing to draw.
pub fn page(told: &Told<'_>, lines: &[String]) -> Result<String, PlotError> {
    let title = if told.fabric.title.is_empty() { "A fabric" } else { &told.fabric.title };
    let mut body = format!(
        "<h1>{}</h1>\n<h2>Curves</h2>\n{}\n",
        escaped(title),
        inlined(&curves_figure(told).to_svg()?, "curves")
    );
    if told.yarn.is_some() {
        body.push_str("<p>The bar is where the range of comfort ends.</p>\n");
    }
    errors_section(told, &mut body);
    if let Some((problem, fit)) = told.yarn {
        numbers_section(problem, fit, &mut body);
        ablations_section(told, &mut body)?;
    }
    let _ = writeln!(body, "<h2>In words</h2>\n<pre>{}</pre>", escaped(&lines.join("\n")));
    let files: Vec<String> = told.fabric.inputs.iter().map(|path| escaped(&path.display().to_string())).collect();
    let _ = writeln!(
        body,
        "<p>Read from {}. The card is in card.toml, the curves are in curves.csv.</p>",
        files.join(", ")
    );
    Ok(document(title, "wale fit", STYLE, &body))
}

/// An error as a bar and a number.
fn bar(error: Option<f64>) -> String {
    let Some(error) = error else { return "<td>not measured</td>".to_owned() };
    let length = LONGEST * (2.0 * error).clamp(0.0, 1.0);
    let off = if error > 0.5 { " off" } else { "" };
    format!("<td><span class=\"bar{off}\" style=\"width:{length:.2}em\"></span>{:.1} %</td>", 100.0 * error)
}

fn errors_table(errors: &[DirectionErrors], of_force: &str, body: &mut String) {
    let _ = writeln!(
        body,
        "<table><tr><th>direction</th><th>{of_force}, comfort</th><th>{of_force}, whole range</th>\
         <th>compression, comfort</th><th>compression, whole range</th></tr>"
    );
    for one in errors {
        let cells: String = one.force.into_iter().chain(one.compression).map(bar).collect();
        let _ = writeln!(body, "<tr><td>{}</td>{cells}</tr>", direction_name(one.direction));
    }
    body.push_str("</table>\n");
}

/// Errors as [Sperl2022, Figs. 13 and 15] show them.
fn errors_section(told: &Told<'_>, body: &mut String) {
    let shell = shell_errors(told);
    body.push_str("<h2>Errors</h2>\n<h3>Thin shell, over the mean of what was measured [Sperl2022, Fig. 13]</h3>\n");
    errors_table(&shell.stretch, "force", body);
    if !shell.loops.is_empty() {
        body.push_str("<table><tr><th>direction</th><th>aspect of loops</th></tr>\n");
        for [direction, error] in shell.loops {
            let _ = writeln!(body, "<tr><td>{}</td>{}</tr>", direction_name(direction), bar(Some(error)));
        }
        body.push_str("</table>\n");
    }
    if let Some((_, fit)) = told.yarn {
        body.push_str("<h3>Yarn, over the values at the end of comfort [Sperl2022, Fig. 15]</h3>\n");
        errors_table(&yarn_errors(fit), "stress", body);
    }
}

/// Where each number lies within its bounds, and how well it is known [Sperl2022, Fig. 14].
fn numbers_section(problem: &YarnProblem, fit: &YarnFit, body: &mut String) {
    body.push_str(
        "<h2>Numbers</h2>\n<p>Each within its bounds, linear for the onset and logarithmic for the others [Sperl2022, Fig. 14]; the \
         band is where it may be with 95 % confidence.</p>\n<table><tr><th></th><th>least</th><th></th><th>largest</th>\
         <th>found</th></tr>\n",
    );
    let values = fit.material.parameters();
    let (at, bounds) = (RodSpace::coordinates(values), problem.space.coordinate_bounds());
    for (k, name) in RodParameter::NAMES.into_iter().enumerate() {
        let ([low, high], [least, largest]) = (bounds[k], problem.space.bounds[k]);
        if low >= high {
            let _ = writeln!(body, "<tr><td>{name}</td><td></td><td>held</td><td></td><td>{:.4e}</td></tr>", values[k]);
            continue;
        }
        let part = |coordinate: f64| 100.0 * ((coordinate - low) / (high - low)).clamp(0.0, 1.0);
        let within = fit.within[k].ln();
        let (from, to) = (part(at[k] - within), part(at[k] + within));
        let _ = writeln!(
            body,
            "<tr><td>{name}</td><td>{least:.3e}</td><td><div class=\"line\"><div class=\"known\" style=\"left:{from:.1}%;\
             width:{:.1}%\"></div><div class=\"at\" style=\"left:{:.1}%\"></div></div></td><td>{largest:.3e}</td>\
             <td>{:.4e}</td></tr>",
            to - from,
            part(at[k]),
            values[k]
        );
    }
    body.push_str("</table>\n<p>In SI units: N for k_s, N·m² for k_b, m for R, J/m² for k_c, Pa for k_h.</p>\n");
}

/// The ablations of [Sperl2022, Figs. 11 and 16 to 18].
fn ablations_section(told: &Told<'_>, body: &mut String) -> Result<(), PlotError> {
    let Some((problem, whole)) = told.yarn else { return Ok(()) };
    if told.ablated.is_empty() && told.missing.is_empty() {
        return Ok(());
    }
    body.push_str(
        "<h2>Ablations</h2>\n<p>The same fit without one of its parts [Sperl2022, Figs. 11 and 16 to 18]. The sum of squares is of \
         stretch alone, at all points, for every fit.</p>\n<table><tr><th>fit</th><th>stress, comfort</th>\
         <th>stress, whole range</th><th>compression</th><th>bending</th><th>sum of squares</th></tr>\n",
    );
    let bending = told.ablated.iter().find_map(|one| one.bending);
    row("The whole fit", Some((&whole.error, sum_of_squares(problem, whole))), bending.map(|both| both[0]), body);
    for one in told.ablated {
        let found = one.fit.as_ref().map(|fit| (&fit.error, sum_of_squares(problem, fit)));
        row(one.kind.title(), found, one.bending.map(|both| both[1]), body);
    }
    body.push_str("</table>\n<dl>\n");
    for one in told.ablated {
        let Some(found) = conclusion(told, one) else { continue };
        let _ = writeln!(body, "<dt><b>{}</b></dt><dd>{}</dd>", one.kind.title(), escaped(&found.sentence));
    }
    body.push_str("</dl>\n");
    for missing in told.missing {
        let _ = writeln!(body, "<p>{}</p>", escaped(missing));
    }
    if let Some(figure) = ablation_figure(told) {
        let _ = writeln!(
            body,
            "{}\n<p>The curves are in ablations.csv. The bar is where the range of comfort ends.</p>",
            inlined(&figure.to_svg()?, "ablations")
        );
    }
    Ok(())
}

fn row(title: &str, found: Option<(&YarnFitError, f64)>, bending: Option<f64>, body: &mut String) {
    let (cells, sum) = match found {
        Some((error, sum)) => {
            ([error.comfort, error.full, error.compression].map(|error| bar(Some(error))).concat(), format!("{sum:.4}"))
        }
        None => ("<td></td><td></td><td></td>".to_owned(), "no fit".to_owned()),
    };
    let bending = if bending.is_some() { bar(bending) } else { "<td></td>".to_owned() };
    let _ = writeln!(body, "<tr><td>{title}</td>{cells}{bending}<td>{sum}</td></tr>");
}
