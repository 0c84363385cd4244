//! `wale render`: frames of a run, or a periodic tile, as PNG pictures.

use std::io;
use std::path::PathBuf;

use wale::geometry::coloring::point_scalars;
use wale::picture::{
    Camera, ColorMode, PngError, Settings, Subject, color_range, render as draw, sequence_name, write_png,
};
use wale::record::atomic_file::write_atomically;

use super::tile_picture::draw_tile;
use crate::arguments::Render;
use crate::exit::{Code, Failure};
use crate::opened::OpenedRun;
use crate::say;

/// Free space around the fabric, as a share of the picture's height.
pub const MARGIN: f64 = 0.085;

/// Draws them.
pub fn render(arguments: &Render) -> Result<(), Failure> {
    if arguments.run.extension().is_some_and(|extension| extension == "pyp") {
        return say!("{}", draw_tile(arguments)?.display());
    }
    for path in draw_frames(arguments)? {
        say!("{}", path.display())?;
    }
    Ok(())
}

/// Draws them, and says which files they are.
///
/// # Errors
/// When there are no such frames, or a file cannot be read or written.
pub fn draw_frames(arguments: &Render) -> Result<Vec<PathBuf>, Failure> {
    let run = OpenedRun::open(&arguments.run, arguments.frames)?;
    let single = run.frames.end - run.frames.start == 1;
    let paths = paths(arguments, &run, single)?;
    let view = arguments.view;
    let [width, height] = arguments.size.unwrap_or([1600, 1200]).map(|side| side as usize);
    let camera = camera(arguments, &run, width as f64 / height as f64)?;
    let mut settings = Settings {
        width,
        height,
        color_mode: arguments.color,
        plies: run.scene.yarns.first().plies,
        twist: run.scene.yarns.first().twist,
        ground: Some(view.ground_normal()),
        ..Settings::default()
    };
    for (index, path) in run.frames.clone().zip(&paths) {
        let frame = run.frame(index)?;
        let curves = run.curves(&frame);
        let scalars = point_scalars(&run.network, &frame, &curves);
        if let (ColorMode::By(quantity), None) = (settings.color_mode, settings.color_range) {
            // The last frame sets the colours of the sequence.
            let last = run.frame(run.frames.end - 1)?;
            let of_last = point_scalars(&run.network, &last, &run.curves(&last));
            settings.color_range = Some(color_range(quantity, of_last.of(quantity)));
        }
        settings.caption = Some(format!("{} · {:.3} s", run.scene.title, frame.time));
        let solids = run.solids(&frame);
        let subject = Subject { curves: &curves, scalars: Some(&scalars), solids: &solids };
        let image = draw(&subject, &camera, &settings);
        write_atomically(path, |out| {
            write_png(&image, out).map_err(|error| match error {
                PngError::Write(png_error) => io::Error::from(png_error),
                other => io::Error::other(other),
            })
        })?;
    }
    Ok(paths)
}

/// One camera for all frames, that has the first and the last in view.
fn camera(arguments: &Render, run: &OpenedRun, aspect: f64) -> Result<Camera, Failure> {
    let (mut points, mut radius) = (Vec::new(), 0.0_f64);
    for index in [run.frames.start, run.frames.end - 1] {
        let frame = run.frame(index)?;
        let (curves, solids) = (run.curves(&frame), run.solids(&frame));
        let (more, thick) = Subject { curves: &curves, scalars: None, solids: &solids }.extent_points();
        points.extend(more);
        radius = radius.max(thick);
    }
    Ok(Camera::framing(arguments.view, arguments.view.projection(), &points, radius, aspect, MARGIN))
}

/// Files for the chosen frames: one name, or a folder of numbered ones.
fn paths(arguments: &Render, run: &OpenedRun, single: bool) -> Result<Vec<PathBuf>, Failure> {
    let out = arguments.out.as_ref();
    if single {
        return Ok(vec![run.results(out, "picture.png")?]);
    }
    let first = run.results(out.map(|folder| folder.join("x")).as_ref(), "pictures/x")?;
    run.frames
        .clone()
        .map(|index| {
            let index = usize::try_from(index).map_err(|error| Failure::new(Code::Usage, error))?;
            Ok(first.with_file_name(sequence_name(index)))
        })
        .collect()
}
