//! Files that appear whole or not at all.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use super::ExportError;

/// Writes a file beside its final place, then gives it its final name.
///
/// The content goes to a hidden file in the same folder, is flushed to the disk, and replaces `path` by a rename; the
/// folder is flushed too. If anything fails, the hidden file is removed and `path` is as it was.
///
/// # Errors
/// [`ExportError::File`] with the path, or what `content` returns.
pub fn export_file(
    path: &Path,
    content: impl FnOnce(&mut BufWriter<File>) -> Result<(), ExportError>,
) -> Result<(), ExportError> {
    let here = |source| ExportError::File { path: path.to_owned(), source };
    let (part, file) = create_beside(path).map_err(here)?;
    let mut out = BufWriter::with_capacity(1 << 16, file);
    let written = content(&mut out).map_err(|error| match error {
        ExportError::Stream(source) => here(source),
        other => other,
    });
    let finished = written.and_then(|()| {
        let file = out.into_inner().map_err(|e| here(e.into_error()))?;
        file.sync_all().map_err(here)?;
        fs::rename(&part, path).map_err(here)?;
        // Folders cannot be opened everywhere; the rename itself has been done.
        if let Ok(folder) = File::open(folder_of(path)) {
            let _ = folder.sync_all();
        }
        Ok(())
    });
    if finished.is_err() {
        // The first error is the one to tell.
        let _ = fs::remove_file(&part);
    }
    finished
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// A new file in the folder of `path`, under a name nobody else has.
fn create_beside(path: &Path) -> io::Result<(PathBuf, File)> {
    let name = path.file_name().ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, "it names no file"))?;
    // A rename would put a file in the place of a device.
    if fs::metadata(path).is_ok_and(|found| !found.is_file()) {
        let reason = "it is there already and is not a plain file";
        return Err(io::Error::new(io::ErrorKind::InvalidInput, reason));
    }
    let mut taken = io::Error::from(io::ErrorKind::AlreadyExists);
    for attempt in 0..1000 {
        let mut hidden = std::ffi::OsString::from(".");
        hidden.push(name);
        hidden.push(format!(".{attempt}.part"));
        let part = folder_of(path).join(hidden);
        match OpenOptions::new().write(true).create_new(true).open(&part) {
            Ok(file) => return Ok((part, file)),
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists => taken = e,
            Err(e) => return Err(e),
        }
    }
    Err(taken)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    #[test]
    fn a_failed_export_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.obj");
        export_file(&path, |out| Ok(out.write_all(b"first")?)).unwrap();
        let failed = export_file(&path, |out| {
            out.write_all(b"second")?;
            Err(ExportError::NoFrames)
        });
        assert!(matches!(failed, Err(ExportError::NoFrames)));
        assert_eq!(fs::read(&path).unwrap(), b"first");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        export_file(&path, |out| Ok(out.write_all(b"third")?)).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"third");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn impossible_places_are_told_with_their_path() {
        let folder = tempfile::tempdir().unwrap();
        for path in [folder.path().join("none/a.obj"), folder.path().to_owned()] {
            let error = export_file(&path, |_| Ok(())).unwrap_err();
            assert!(matches!(&error, ExportError::File { path: p, .. } if *p == path));
        }
        assert!(export_file(Path::new("/"), |_| Ok(())).is_err());
    }
}
