//! A file that only grows, row by row, and can be cut back to where a checkpoint found it.

use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use super::error::{RecordError, reading};

/// A growing text file of whole lines.
#[derive(Debug)]
pub struct AppendFile {
    path: PathBuf,
    file: File,
    length: u64,
}

impl AppendFile {
    /// An empty file, in the place of an old one if there is one.
    ///
    /// # Errors
    /// When it cannot be made.
    pub fn create(path: &Path) -> Result<Self, RecordError> {
        let file = File::create(path).map_err(|e| RecordError::from_io(path, "create", e))?;
        Ok(Self { path: path.to_path_buf(), file, length: 0 })
    }

    /// Opens a file and drops all behind `length`: whole lines of later steps and a line that a kill cut through.
    ///
    /// # Errors
    /// [`RecordError::Damaged`] when the file is shorter than that, or has no end of line there.
    pub fn resume(path: &Path, length: u64) -> Result<Self, RecordError> {
        check_length(path, length)?;
        let mut file = OpenOptions::new().write(true).open(path).map_err(|e| RecordError::from_io(path, "open", e))?;
        file.set_len(length)
            .and_then(|()| file.seek(SeekFrom::End(0)))
            .and_then(|_| file.sync_all())
            .map_err(|e| RecordError::from_io(path, "cut back", e))?;
        Ok(Self { path: path.to_path_buf(), file, length })
    }

    /// Appends a line; `line` ends in a line feed. A failed write leaves no half line if that can be helped.
    ///
    /// # Errors
    /// A full disk and other failures to write.
    pub fn append(&mut self, line: &[u8]) -> Result<(), RecordError> {
        if let Err(error) = self.file.write_all(line) {
            let _ = self.file.set_len(self.length);
            let _ = self.file.seek(SeekFrom::Start(self.length));
            return Err(RecordError::from_io(&self.path, "append", error));
        }
        self.length += line.len() as u64;
        Ok(())
    }

    /// Brings all lines to the disk, and says how long the file is \[bytes\].
    ///
    /// # Errors
    /// When the disk fails.
    pub fn sync(&self) -> Result<u64, RecordError> {
        self.file.sync_all().map_err(|error| RecordError::from_io(&self.path, "sync", error))?;
        Ok(self.length)
    }

    /// The file's path.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// Whether a file reaches to `length`, with a line ending there.
///
/// # Errors
/// [`RecordError::Damaged`] if not.
pub fn check_length(path: &Path, length: u64) -> Result<(), RecordError> {
    let damaged = |reason: String| RecordError::Damaged { path: path.to_path_buf(), reason };
    let mut file = File::open(path).map_err(|error| reading(path, error))?;
    let found = file.metadata().map_err(|error| reading(path, error))?.len();
    if found < length {
        return Err(damaged(format!("{found} bytes long, and the checkpoint was taken at {length}")));
    }
    if length > 0 {
        let mut last = [0];
        file.seek(SeekFrom::Start(length - 1))
            .and_then(|_| file.read_exact(&mut last))
            .map_err(|error| reading(path, error))?;
        if last != *b"\n" {
            return Err(damaged(format!("no line ends at byte {length}")));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn killed_in_a_line_and_resumed_gives_the_same_bytes() {
        let folder = tempfile::tempdir().unwrap();
        let lines: Vec<String> = (0..6).map(|i| format!("line {i}\n")).collect();
        let whole: String = lines.concat();
        let path = folder.path().join("rows");
        // The checkpoint was taken after three lines; the kill comes at any later byte.
        let mark = 21;
        for kill in mark..=whole.len() {
            std::fs::write(&path, &whole.as_bytes()[..kill]).unwrap();
            let mut file = AppendFile::resume(&path, mark as u64).unwrap();
            for line in &lines[3..] {
                file.append(line.as_bytes()).unwrap();
            }
            assert_eq!(file.sync().unwrap(), whole.len() as u64);
            assert_eq!(std::fs::read_to_string(&path).unwrap(), whole);
        }
    }

    #[test]
    fn a_file_shorter_than_its_mark_is_damaged() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rows");
        std::fs::write(&path, "one\ntwo\n").unwrap();
        for length in [5, 9, u64::MAX] {
            assert!(matches!(AppendFile::resume(&path, length), Err(RecordError::Damaged { .. })));
        }
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "one\ntwo\n");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_told() {
        let mut file = AppendFile::create(Path::new("/dev/full")).unwrap();
        assert!(matches!(file.append(b"x\n"), Err(RecordError::DiskFull { .. })));
    }
}
