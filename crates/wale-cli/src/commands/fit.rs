//! `wale fit`: the thin shell of a fabric file, by its stretch and bending tests.

use std::fmt::Write;
use std::io;
use std::path::{Path, PathBuf};

use serde_json::json;
use wale::energy::{BendingStiffness, MembraneStiffness};
use wale::picture::{Panel, Plot, Series};
use wale::record::RecordError;
use wale::record::atomic_file::write_atomically;
use wale_lab::fabric_file::{FabricFile, FabricFileError};
use wale_lab::fabric_fit::{FabricFit, FabricFitError, fit_fabric};
use wale_lab::shell::membrane_fit::MembraneFitSettings;

use crate::arguments::Fit;
use crate::exit::{Code, Failure};
use crate::opened::scene_failure;
use crate::{machine, output, say};

/// Reads, fits, tells and writes.
pub fn fit(arguments: &Fit) -> Result<(), Failure> {
    let fabric = FabricFile::read(&arguments.fabric).map_err(|error| match error {
        FabricFileError::Fabric(error) => scene_failure(error),
        FabricFileError::Curve(error) => Failure::new(Code::BadInput, error),
    })?;
    if arguments.read_only {
        return if arguments.json { output::json(&read_json(&fabric)) } else { tell_reading(&fabric) };
    }
    let folder = arguments.out.clone().unwrap_or_else(|| arguments.fabric.with_extension("fit"));
    let taken = ["card.toml", "curves.csv", "curves.svg", "report.html"].iter().any(|name| folder.join(name).exists());
    if taken && !arguments.force {
        let mend = "there is a fit in it: choose another with `--out`, or overwrite it with `--force`";
        return Err(RecordError::NotEmpty { path: folder, mend }.into());
    }
    machine::use_threads(arguments.threads.map(usize::from))?;
    let found = fit_fabric(&fabric, &MembraneFitSettings::default()).map_err(|error| {
        let code = match error {
            FabricFitError::NoStretchTest => Code::BadInput,
            FabricFitError::Shell(_) => Code::NotConverged,
        };
        Failure::new(code, format_args!("{}: {error}", arguments.fabric.display()))
    })?;
    std::fs::create_dir_all(&folder).map_err(|error| Failure::io(&folder, "create", error))?;
    write(&folder.join("card.toml"), found.card.to_toml().as_bytes())?;
    write(&folder.join("curves.csv"), curves_csv(&fabric, &found).as_bytes())?;
    let svg = plot(&fabric, &found).to_svg().map_err(|error| Failure::new(Code::BadInput, error))?;
    write(&folder.join("curves.svg"), svg.as_bytes())?;
    write(&folder.join("report.html"), report(&fabric, &found, &svg).as_bytes())?;
    if arguments.json {
        return output::json(&found_json(&folder, &found));
    }
    tell_reading(&fabric)?;
    for line in lines(&found) {
        say!("{line}")?;
    }
    say!("  {}", folder.join("report.html").display())
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    Ok(write_atomically(path, |out| io::Write::write_all(out, bytes))?)
}

fn degrees(radians: f64) -> String {
    match radians.to_degrees().round() as i64 {
        0 => "weft".to_owned(),
        45 => "bias".to_owned(),
        90 => "warp".to_owned(),
        other => format!("{other}°"),
    }
}

/// How the tables were understood.
fn tell_reading(fabric: &FabricFile) -> Result<(), Failure> {
    say!("{}", if fabric.title.is_empty() { "a fabric" } else { &fabric.title })?;
    for test in &fabric.stretch {
        let (stretch, force) = (test.curve.stretch.last().copied(), test.curve.force.last().copied());
        let (stretch, force) = (stretch.unwrap_or_default(), force.unwrap_or_default());
        say!(
            "  stretch along the {}: {} samples to {:.1} %, {force:.3} N",
            degrees(test.direction),
            test.curve.stretch.len(),
            100.0 * stretch
        )?;
        for line in &test.curve.read_as {
            say!("    {line}")?;
        }
    }
    for test in &fabric.bending {
        say!("  loops along the {}: {}", degrees(test.direction), test.curve.distance.len())?;
        for line in &test.curve.read_as {
            say!("    {line}")?;
        }
    }
    for gap in fabric.gaps() {
        say!("  {gap}")?;
    }
    Ok(())
}

fn read_json(fabric: &FabricFile) -> serde_json::Value {
    json!({
        "title": fabric.title,
        "stretch": fabric.stretch.iter().map(|test| json!({
            "direction_rad": test.direction,
            "stretch": test.curve.stretch,
            "force_N": test.curve.force,
            "compression": test.curve.compression,
            "read_as": test.curve.read_as,
        })).collect::<Vec<_>>(),
        "bending": fabric.bending.iter().map(|test| json!({
            "direction_rad": test.direction,
            "clamp_distance_m": test.curve.distance,
            "aspect_ratio": test.curve.aspect_ratio,
            "read_as": test.curve.read_as,
        })).collect::<Vec<_>>(),
        "gaps": fabric.gaps(),
    })
}

fn found_json(folder: &Path, found: &FabricFit) -> serde_json::Value {
    // Infinite factors are no numbers in JSON.
    let within: Vec<Option<f64>> = found.card.membrane_within.iter().map(|w| w.is_finite().then_some(*w)).collect();
    json!({
        "folder": folder,
        "membrane_N_per_m": found.membrane.stiffness.to_array(),
        "membrane_within": within,
        "force_error": found.membrane.force_error,
        "compression_error": found.membrane.compression_error,
        "bending_N_m": found.bending.as_ref().map(|fit| fit.stiffness.to_array()),
        "aspect_error": found.bending.as_ref().map(|fit| fit.aspect_error),
        "open": found.open,
    })
}

/// What was found, in lines.
fn lines(found: &FabricFit) -> Vec<String> {
    let mut lines = vec![format!(
        "thin shell: mean error {:.1} % of force, {:.1} % of compression",
        100.0 * found.membrane.force_error,
        100.0 * found.membrane.compression_error
    )];
    let values = found.membrane.stiffness.to_array();
    for ((name, value), within) in MembraneStiffness::NAMES.into_iter().zip(values).zip(found.card.membrane_within) {
        let known = if within <= 3.0 { format!("× or ÷ {within:.2}") } else { "not determined".to_owned() };
        lines.push(format!("  {name} {value:10.3} N/m   {known}"));
    }
    if let Some(bending) = &found.bending {
        lines.push(format!("bending: mean error {:.1} % of the loops' aspect", 100.0 * bending.aspect_error));
        for (name, value) in BendingStiffness::NAMES.into_iter().zip(bending.stiffness.to_array()) {
            lines.push(format!("  {name} {:10.3} µN·m", 1e6 * value));
        }
    }
    lines.extend(found.open.iter().map(|open| format!("  {open}")));
    lines
}

fn curves_csv(fabric: &FabricFile, found: &FabricFit) -> String {
    let mut text = String::from(
        "direction [deg],stretch [-],measured force [N],fitted force [N],measured compression [-],fitted compression [-]\n",
    );
    for (test, points) in fabric.stretch.iter().zip(&found.membrane.points) {
        for [target, point] in points {
            let measured =
                if test.curve.compression.is_some() { format!("{}", target.compression) } else { String::new() };
            let _ = writeln!(
                text,
                "{},{},{},{},{measured},{}",
                test.direction.to_degrees(),
                target.stretch,
                target.force,
                point.force,
                point.compression
            );
        }
    }
    text
}

fn plot(fabric: &FabricFile, found: &FabricFit) -> Plot {
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
    let panels = vec![
        Panel { y_label: "force [N]".to_owned(), series: force },
        Panel { y_label: "compression [%]".to_owned(), series: compression },
    ];
    Plot { title: fabric.title.clone(), x_label: "stretch [%]".to_owned(), panels }
}

/// One page that needs no other file.
fn report(fabric: &FabricFile, found: &FabricFit, svg: &str) -> String {
    let escaped = |text: &str| text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    let title = if fabric.title.is_empty() { "A fabric" } else { &fabric.title };
    let files: Vec<String> = fabric.inputs.iter().map(|path: &PathBuf| escaped(&path.display().to_string())).collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{title}</title>\n\
         <style>body{{font:16px/1.5 sans-serif;max-width:60em;margin:2em auto;padding:0 1em}}svg{{max-width:100%;height:auto}}</style>\n\
         </head><body>\n<h1>{title}</h1>\n<pre>{}</pre>\n{svg}\n<p>Read from {}. The card is in card.toml, the curves are in curves.csv.</p>\n\
         </body></html>\n",
        escaped(&lines(found).join("\n")),
        files.join(", "),
        title = escaped(title),
    )
}
