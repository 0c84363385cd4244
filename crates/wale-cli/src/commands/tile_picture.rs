//! A periodic tile of yarns as a PNG picture.

use std::io;
use std::path::PathBuf;

use wale::picture::{Camera, PngError, Settings, Subject, render, write_png};
use wale::record::atomic_file::write_atomically;
use wale_lab::yarn_tile::{drawn_curves, read_pattern};

use super::render::MARGIN;
use crate::arguments::Render;
use crate::exit::{Code, Failure};

/// Fabric that is drawn, over the radius of its yarns \[–\]: a few loops across.
const ACROSS: f64 = 60.0;
/// Most repeats across, where a tile is smaller than its yarns are thick.
const MOST_REPEATS: usize = 12;

/// Draws as many repeats as make a picture, and says which file it is.
///
/// # Errors
/// When the file is no tile, or the picture cannot be written.
pub fn draw_tile(arguments: &Render) -> Result<PathBuf, Failure> {
    let text = std::fs::read_to_string(&arguments.run).map_err(|error| Failure::io(&arguments.run, "read", error))?;
    let tile = read_pattern(&arguments.run.display().to_string(), &text)
        .map_err(|error| Failure::new(Code::BadInput, error))?;
    let repeats = tile.periods().map(|period| {
        let wanted = (ACROSS * tile.radius() / period).ceil();
        if wanted.is_finite() { (wanted as usize).clamp(1, MOST_REPEATS) } else { 1 }
    });
    let curves = drawn_curves(&tile, repeats)
        .map_err(|error| Failure::new(Code::BadInput, format_args!("{}: {error}", arguments.run.display())))?;
    let [width, height] = arguments.size.unwrap_or([1600, 1200]).map(|side| side as usize);
    let subject = Subject { curves: &curves, scalars: None, solids: &[] };
    let (points, thick) = subject.extent_points();
    let view = arguments.view;
    let camera = Camera::framing(view, view.projection(), &points, thick, width as f64 / height as f64, MARGIN);
    let settings = Settings { width, height, ground: Some(view.ground_normal()), ..Settings::default() };
    let image = render(&subject, &camera, &settings);
    let path = arguments.out.clone().unwrap_or_else(|| arguments.run.with_extension("png"));
    write_atomically(&path, |out| {
        write_png(&image, out).map_err(|error| match error {
            PngError::Write(png_error) => io::Error::from(png_error),
            other => io::Error::other(other),
        })
    })?;
    Ok(path)
}
