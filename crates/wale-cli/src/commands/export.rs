//! `wale export`: a run in a format that other programs read.

use std::path::PathBuf;

use wale::export::{self, FrameSnapshots, UpAxis};

use crate::arguments::{Export, Format, Up};
use crate::exit::{Code, Failure};
use crate::opened::OpenedRun;
use crate::say;

/// Exports it.
pub fn export(arguments: &Export) -> Result<(), Failure> {
    for path in write_files(arguments)? {
        say!("{}", path.display())?;
    }
    Ok(())
}

/// Exports it, and says which files were written.
///
/// # Errors
/// When there are no such frames, or a file cannot be read or written.
pub fn write_files(arguments: &Export) -> Result<Vec<PathBuf>, Failure> {
    let run = OpenedRun::open(&arguments.run, arguments.frames)?;
    let format = match arguments.format {
        Format::Usd => export::Format::Usda,
        Format::Vtk => export::Format::Pvd,
        Format::Bcc => export::Format::Bcc,
        Format::Obj => export::Format::Obj,
        Format::Ply => export::Format::Ply,
        Format::Csv => return copy_metrics(arguments, &run),
    };
    let path = run.results(arguments.out.as_ref(), &format!("yarns.{}", format.extension()))?;
    let settings = export::Settings {
        title: run.scene.title.clone(),
        frames_per_second: run.scene.plan.simulation.frame_rate,
        up: match arguments.up {
            Up::Y => UpAxis::Y,
            Up::Z => UpAxis::Z,
        },
        ..export::Settings::default()
    };
    let first = run.frames.start;
    let mut snapshots = FrameSnapshots {
        network: &run.network,
        settings: run.curve_settings(),
        count: usize::try_from(run.frames.end - first).unwrap_or(usize::MAX),
        read: |index: usize| Ok(run.frame(first + index as u64)?),
    };
    export::write(&path, format, &mut snapshots, &settings).map_err(export_failure)
}

fn export_failure(error: export::ExportError) -> Failure {
    match error {
        export::ExportError::File { path, source } => Failure::io(&path, "write", source),
        export::ExportError::Stream(_) => Failure::new(Code::Io, error),
        export::ExportError::Frame { .. } | export::ExportError::TooMany { .. } => Failure::new(Code::BadInput, error),
        _ => Failure::new(Code::Bug, error),
    }
}

fn copy_metrics(arguments: &Export, run: &OpenedRun) -> Result<Vec<PathBuf>, Failure> {
    let from = run.reader.metrics_path();
    let path = run.results(arguments.out.as_ref(), "metrics.csv")?;
    let text = std::fs::read(&from).map_err(|error| Failure::io(&from, "read", error))?;
    wale::record::atomic_file::write_bytes_atomically(&path, &text)?;
    Ok(vec![path])
}
