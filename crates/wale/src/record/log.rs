//! The log of every step: one JSON object a line.

use std::io;
use std::path::Path;

use serde::Serialize;

use super::append_file::AppendFile;
use super::error::RecordError;

/// `log.jsonl` while it is being written. It holds nothing that a clock has measured, so that it too is the same to
/// the byte for a run that was interrupted.
#[derive(Debug)]
pub struct StepLog {
    file: AppendFile,
}

impl StepLog {
    /// An empty log.
    ///
    /// # Errors
    /// When it cannot be made.
    pub fn create(path: &Path) -> Result<Self, RecordError> {
        Ok(Self { file: AppendFile::create(path)? })
    }

    /// Goes on with a log that had `length` bytes when the checkpoint was taken.
    ///
    /// # Errors
    /// [`RecordError::Damaged`] when the log is shorter.
    pub fn resume(path: &Path, length: u64) -> Result<Self, RecordError> {
        Ok(Self { file: AppendFile::resume(path, length)? })
    }

    /// Appends an entry.
    ///
    /// # Errors
    /// A full disk and other failures to write.
    pub fn append(&mut self, entry: &impl Serialize) -> Result<(), RecordError> {
        let mut line = serde_json::to_vec(entry)
            .map_err(|error| RecordError::from_io(self.file.path(), "append", io::Error::other(error)))?;
        line.push(b'\n');
        self.file.append(&line)
    }

    /// Brings the log to the disk, and says how long it is \[bytes\].
    ///
    /// # Errors
    /// When the disk fails.
    pub fn sync(&self) -> Result<u64, RecordError> {
        self.file.sync()
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_resumed_log_is_the_same_to_the_byte() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.jsonl");
        let mut log = StepLog::create(&path).unwrap();
        log.append(&json!({"step": 1, "text": "line\nfeed"})).unwrap();
        let mark = log.sync().unwrap();
        log.append(&json!({"step": 2})).unwrap();
        let whole = std::fs::read(&path).unwrap();
        assert_eq!(whole.iter().filter(|&&b| b == b'\n').count(), 2);
        std::fs::write(&path, &whole[..whole.len() - 4]).unwrap();
        let mut log = StepLog::resume(&path, mark).unwrap();
        log.append(&json!({"step": 2})).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), whole);
    }
}
