//! Files that appear whole or not at all.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use super::error::RecordError;

/// Ending of the temporary files; they also begin with a dot.
const PARTIAL: &str = ".partial";

/// Writes a file under its final name only when all of it is on the disk.
///
/// The bytes go to a temporary file in the same folder, are synced, renamed, and the folder is synced: after a kill
/// or a power cut the old file or the new one is there, never a mixture. A failed write removes the temporary file
/// and leaves an old file of that name untouched.
///
/// # Errors
/// [`RecordError::DiskFull`], [`RecordError::NotWritable`] and other failures of the file system, or of `write`.
pub fn write_atomically(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), RecordError> {
    let temporary = temporary_path(path)?;
    let written = write_and_sync(&temporary, write).and_then(|()| fs::rename(&temporary, path));
    if let Err(error) = written {
        // The first error is the one to tell; a leftover is swept when the folder is next opened.
        let _ = fs::remove_file(&temporary);
        return Err(RecordError::from_io(path, "write", error));
    }
    sync_folder(&parent(path)).map_err(|error| RecordError::from_io(path, "sync", error))
}

/// [`write_atomically`] for bytes that are already in memory.
///
/// # Errors
/// As [`write_atomically`].
pub fn write_bytes_atomically(path: &Path, bytes: &[u8]) -> Result<(), RecordError> {
    write_atomically(path, |file| file.write_all(bytes))
}

/// Removes what interrupted writes left in a folder (not in its subfolders).
///
/// # Errors
/// When the folder cannot be read or a leftover cannot be removed.
pub fn remove_leftovers(folder: &Path) -> Result<(), RecordError> {
    let entries = fs::read_dir(folder).map_err(|error| super::error::reading(folder, error))?;
    for entry in entries {
        let entry = entry.map_err(|error| super::error::reading(folder, error))?;
        let name = entry.file_name();
        let name = name.to_string_lossy();
        if name.starts_with('.') && name.ends_with(PARTIAL) {
            fs::remove_file(entry.path()).map_err(|error| RecordError::from_io(&entry.path(), "remove", error))?;
        }
    }
    Ok(())
}

/// Makes a rename or a removal in a folder durable.
pub(crate) fn sync_folder(folder: &Path) -> io::Result<()> {
    // Only Unix lets a folder be opened and synced; elsewhere the rename itself is the best there is.
    if cfg!(unix) {
        File::open(folder)?.sync_all()?;
    }
    Ok(())
}

fn write_and_sync(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut file = BufWriter::with_capacity(1 << 18, File::create(path)?);
    write(&mut file)?;
    let file = file.into_inner().map_err(io::IntoInnerError::into_error)?;
    file.sync_all()
}

fn temporary_path(path: &Path) -> Result<PathBuf, RecordError> {
    let name = path.file_name().ok_or_else(|| RecordError::Io {
        path: path.to_path_buf(),
        doing: "write",
        source: io::Error::new(io::ErrorKind::InvalidInput, "the path names no file"),
    })?;
    let mut temporary = OsString::from(".");
    temporary.push(name);
    temporary.push(format!(".{}{PARTIAL}", std::process::id()));
    Ok(parent(path).join(temporary))
}

fn parent(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_path_buf(),
        _ => PathBuf::from("."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn replaces_whole_files() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_bytes_atomically(&path, b"first").unwrap();
        write_bytes_atomically(&path, b"second, longer").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"second, longer");
        assert_eq!(names(folder.path()), ["a.txt"]);
    }

    #[test]
    fn a_failed_write_keeps_the_old_file_and_no_leftover() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_bytes_atomically(&path, b"old").unwrap();
        let full = write_atomically(&path, |file| {
            file.write_all(&vec![1; 1 << 20])?;
            Err(io::Error::from(io::ErrorKind::StorageFull))
        });
        assert!(matches!(full, Err(RecordError::DiskFull { .. })));
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["a.txt"]);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_device_is_a_full_disk() {
        let path = Path::new("/dev/full");
        let error = write_and_sync(path, |file| file.write_all(b"x")).unwrap_err();
        let error = RecordError::from_io(path, "write", error);
        assert!(matches!(error, RecordError::DiskFull { .. }), "{error}");
        assert!(error.to_string().contains("no space left"));
    }

    #[test]
    fn a_missing_folder_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("nowhere").join("a.txt");
        assert!(matches!(write_bytes_atomically(&path, b"x"), Err(RecordError::Missing { .. })));
    }

    #[test]
    fn leftovers_are_swept_and_other_files_kept() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(".a.ckpt.123.partial"), b"half").unwrap();
        fs::write(folder.path().join("a.partial"), b"the user's own").unwrap();
        remove_leftovers(folder.path()).unwrap();
        assert_eq!(names(folder.path()), ["a.partial"]);
    }

    #[test]
    fn a_path_without_a_name_is_an_error() {
        assert!(write_bytes_atomically(Path::new("/"), b"x").is_err());
    }
}
