//! `wale view`: a run as one HTML page to turn in the hand.

use std::io;
use std::path::PathBuf;

use wale::geometry::coloring::point_scalars;
use wale::record::atomic_file::write_atomically;
use wale::view::{ViewData, ViewError, ViewFrame, ViewSettings, write_html};

use crate::arguments::{FrameChoice, View};
use crate::exit::{Code, Failure};
use crate::opened::OpenedRun;
use crate::say;

/// Writes it.
pub fn view(arguments: &View) -> Result<(), Failure> {
    say!("{}", write_page(arguments)?.display())
}

/// Writes it, and says which file it is.
///
/// # Errors
/// When there is nothing to show, or a file cannot be read or written.
pub fn write_page(arguments: &View) -> Result<PathBuf, Failure> {
    let run = OpenedRun::open(&arguments.run, FrameChoice::All)?;
    let path = run.results(arguments.out.as_ref(), "view.html")?;
    let mut frames = Vec::new();
    for index in run.frames.clone() {
        let frame = run.frame(index)?;
        let curves = run.curves(&frame);
        let scalars = point_scalars(&run.network, &frame, &curves);
        frames.push(ViewFrame { time: frame.time, solids: run.solids(&frame), curves, scalars });
    }
    let data = ViewData {
        title: run.scene.title.clone(),
        frames,
        plies: run.scene.yarns.first().plies,
        twist: run.scene.yarns.first().twist,
    };
    let mut refused = None;
    let written = write_atomically(&path, |out| match write_html(&data, &ViewSettings::default(), out) {
        Ok(()) => Ok(()),
        Err(ViewError::Write(error)) => Err(error),
        Err(error) => {
            refused = Some(error);
            Err(io::Error::other("nothing to write"))
        }
    });
    if let Some(error) = refused {
        return Err(Failure::new(Code::BadInput, error));
    }
    written?;
    Ok(path)
}
