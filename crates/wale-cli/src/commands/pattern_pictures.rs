//! `wale patterns --pictures`: a piece of each pattern as its relaxed repeat lays it out.

use std::fs;
use std::io;
use std::path::Path;

use wale::geometry::{CurveSettings, curves};
use wale::model::Frame;
use wale::pattern::named::named_pattern;
use wale::picture::{Camera, PngError, Settings, Subject, View, render, write_png};
use wale::record::atomic_file::write_atomically;
use wale::scene::Scene;
use wale::simulation::Start;

use crate::estimate::Estimate;
use crate::exit::{Code, Failure};
use crate::{machine, say};

/// Stitches and rows of a piece, at least.
const PIECE: [usize; 2] = [16, 20];
/// Pixels of a picture.
const SIZE: [usize; 2] = [360, 270];

/// Draws the named patterns into a folder.
///
/// # Errors
/// When a name is unknown or a file cannot be written.
pub fn draw(names: &[String], folder: &Path) -> Result<(), Failure> {
    fs::create_dir_all(folder).map_err(|error| Failure::io(folder, "create", error))?;
    for name in names {
        let chart = named_pattern(name).map_err(|error| Failure::new(Code::Usage, error))?;
        let [columns, rows] = [chart.cast_on(), chart.row_count()];
        let scene = format!(
            "schema = 1\n[yarn]\ncolor = \"#7a2e3a\"\n{}[fabric.chart]\npattern = \"{name}\"\ncolumns = {}\nrows = {}\n",
            if chart.yarn_count() > 1 { "[yarns.B]\ncolor = \"#e8dcc8\"\n" } else { "" },
            PIECE[0].next_multiple_of(columns),
            PIECE[1].next_multiple_of(rows),
        );
        let scene = Scene::from_text(&scene, name).map_err(|error| Failure::new(Code::Bug, error))?;
        Estimate::of(&scene).check(machine::available_memory())?;
        let mut start = Start::new(&scene.structure, &scene.yarns, &scene.fabric, true);
        scene.color_yarns(&mut start.network);
        let network = start.network;
        let frame = Frame { time: 0.0, positions: network.position.clone(), sliding: network.arc_length.clone() };
        let curves = curves(&network, &frame, &CurveSettings::of(&scene.yarns, &scene.fabric));
        let subject = Subject { curves: &curves, scalars: None, solids: &[] };
        let (points, radius) = subject.extent_points();
        let [width, height] = SIZE;
        let camera =
            Camera::framing(View::Front, View::Front.projection(), &points, radius, width as f64 / height as f64, 0.04);
        let settings = Settings {
            width,
            height,
            plies: scene.yarns.first().plies,
            twist: scene.yarns.first().twist,
            scale_bar: false,
            ..Settings::default()
        };
        let image = render(&subject, &camera, &settings);
        let path = folder.join(format!("{}.png", name.replace([' ', '\''], "-")));
        write_atomically(&path, |out| {
            write_png(&image, out).map_err(|error| match error {
                PngError::Write(png_error) => io::Error::from(png_error),
                other => io::Error::other(other),
            })
        })?;
        let rest = match start.compensation {
            Some(report) if report.converged => "relaxed",
            Some(_) => "not at rest",
            None => "laid out plainly",
        };
        say!("{}: {rest}", path.display())?;
    }
    Ok(())
}
