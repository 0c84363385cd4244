//! The formats that yarns are written in, and the one door to them.

use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use super::snapshot::checked;
use super::{
    ExportError, Settings, Snapshot, Snapshots, export_file, write_bcc, write_obj, write_ply, write_pvd, write_usda,
    write_vtp,
};

/// A file format for yarns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// USD text, all frames in one file.
    Usda,
    /// VTK PolyData, a file per frame; several frames also get a collection.
    Vtp,
    /// ParaView collection with a VTP file per frame.
    Pvd,
    /// Binary curves, a file per frame.
    Bcc,
    /// Wavefront tubes, a file per frame.
    Obj,
    /// Stanford tubes, a file per frame.
    Ply,
}

/// A word that names no format.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{word}` is no export format; there are {}", Format::list())]
pub struct UnknownFormat {
    /// What was asked for.
    pub word: String,
}

impl Format {
    /// All formats.
    pub const ALL: [Self; 6] = [Self::Usda, Self::Vtp, Self::Pvd, Self::Bcc, Self::Obj, Self::Ply];

    /// The file name extension, without a dot.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            Self::Usda => "usda",
            Self::Vtp => "vtp",
            Self::Pvd => "pvd",
            Self::Bcc => "bcc",
            Self::Obj => "obj",
            Self::Ply => "ply",
        }
    }

    /// The format that a path's extension names.
    ///
    /// # Errors
    /// [`UnknownFormat`], also for a path without extension.
    pub fn of_path(path: &Path) -> Result<Self, UnknownFormat> {
        path.extension().map(|e| e.to_string_lossy()).unwrap_or_default().parse()
    }

    fn list() -> String {
        Self::ALL.map(Self::extension).join(", ")
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.extension())
    }
}

impl FromStr for Format {
    type Err = UnknownFormat;

    fn from_str(word: &str) -> Result<Self, UnknownFormat> {
        let plain = word.trim_start_matches('.');
        Self::ALL
            .into_iter()
            .find(|format| format.extension().eq_ignore_ascii_case(plain))
            .ok_or_else(|| UnknownFormat { word: word.to_owned() })
    }
}

/// Writes snapshots to files and tells which, the main one last.
///
/// Formats of one frame a file put the frame's number before the extension (`curl.0007.obj`) unless there is only one
/// frame. Each file appears whole or not at all; if a later one fails, earlier ones stay.
///
/// # Errors
/// [`ExportError`], with the path where there is one.
pub fn write(
    path: &Path,
    format: Format,
    snapshots: &mut dyn Snapshots,
    settings: &Settings,
) -> Result<Vec<PathBuf>, ExportError> {
    let count = snapshots.count();
    if count == 0 {
        return Err(ExportError::NoFrames);
    }
    let numbered = |i: usize, extension: &str| {
        let digits = (count - 1).to_string().len().max(4);
        path.with_extension(format!("{i:0digits$}.{extension}"))
    };
    let mut written = Vec::new();
    match format {
        Format::Usda => {
            export_file(path, |out| write_usda(out, snapshots, settings))?;
            written.push(path.to_owned());
        }
        Format::Vtp if count == 1 => {
            let snapshot = checked(snapshots, 0)?;
            export_file(path, |out| write_vtp(out, &snapshot, settings))?;
            written.push(path.to_owned());
        }
        Format::Vtp | Format::Pvd => {
            let mut collection = Vec::with_capacity(count);
            for i in 0..count {
                let snapshot = checked(snapshots, i)?;
                let file = numbered(i, "vtp");
                export_file(&file, |out| write_vtp(out, &snapshot, settings))?;
                let name = file.file_name().unwrap_or_default().to_string_lossy();
                collection.push((snapshot.time, name.into_owned()));
                written.push(file);
            }
            let path = path.with_extension("pvd");
            export_file(&path, |out| write_pvd(out, &collection))?;
            written.push(path);
        }
        Format::Bcc | Format::Obj | Format::Ply => {
            for i in 0..count {
                let snapshot: Snapshot = checked(snapshots, i)?;
                let file = if count == 1 { path.to_owned() } else { numbered(i, format.extension()) };
                export_file(&file, |out| match format {
                    Format::Bcc => write_bcc(out, &snapshot, settings),
                    Format::Ply => write_ply(out, &snapshot, settings),
                    _ => write_obj(out, &snapshot, settings),
                })?;
                written.push(file);
            }
        }
    }
    Ok(written)
}
