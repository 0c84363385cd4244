//! What a scene asks to be made of a run at its end: pictures and a plot, a page, exports.

use std::path::{Path, PathBuf};

use wale::model::{ExportFormat, Output, Pictures};

use crate::arguments::{Export, Format, FrameChoice, Plot, Render, Up, View};
use crate::commands::{export, plot, render, view};
use crate::exit::Failure;

/// Makes them, and says which files they are.
///
/// # Errors
/// When a file cannot be read or written.
pub fn make(run: &Path, output: &Output) -> Result<Vec<PathBuf>, Failure> {
    let mut made = Vec::new();
    let frames = match output.pictures {
        Pictures::None => None,
        Pictures::Last => Some(FrameChoice::Last),
        Pictures::All => Some(FrameChoice::All),
    };
    if let Some(frames) = frames {
        made.extend(render::draw_frames(&Render { frames, ..Render::of(run) })?);
        made.extend(plot::write_plot(&Plot { run: run.to_owned(), out: None })?);
    }
    if output.view {
        made.push(view::write_page(&View { run: run.to_owned(), out: None })?);
    }
    for format in &output.exports {
        let format = match format {
            ExportFormat::Usd => Format::Usd,
            ExportFormat::Vtk => Format::Vtk,
            ExportFormat::Bcc => Format::Bcc,
            ExportFormat::Obj => Format::Obj,
            ExportFormat::Ply => Format::Ply,
            ExportFormat::Csv => Format::Csv,
        };
        let arguments = Export { run: run.to_owned(), format, out: None, frames: FrameChoice::All, up: Up::Z };
        made.extend(export::write_files(&arguments)?);
    }
    Ok(made)
}
