//! A run folder as pictures, exports and inspection see it: read only, also while it is being written.

use std::path::{Path, PathBuf};

use super::checkpoint::{Checkpoint, Checkpoints};
use super::environment::Environment;
use super::error::RecordError;
use super::frames::Frames;
use super::layout::{CHECKPOINTS, ENVIRONMENT, FRAMES, METRICS, SCENE, SUMMARY, read_status};
use super::lock::FolderLock;
use super::read_text;
use super::status::Status;

/// A run folder, opened to read.
#[derive(Clone, Debug)]
pub struct RunReader {
    folder: PathBuf,
    frames: Frames,
}

impl RunReader {
    /// Opens a run folder of this format.
    ///
    /// # Errors
    /// [`RecordError::NotARun`], [`RecordError::Missing`], [`RecordError::OtherVersion`].
    pub fn open(folder: &Path) -> Result<Self, RecordError> {
        read_status(folder)?;
        Environment::read(&folder.join(ENVIRONMENT))?;
        Ok(Self { folder: folder.to_path_buf(), frames: Frames::new(folder.join(FRAMES)) })
    }

    /// Whether a folder looks like a run folder, whole or not.
    #[must_use]
    pub fn is_run(folder: &Path) -> bool {
        read_status(folder).is_ok()
    }

    /// The folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.folder
    }

    /// The resolved scene's file.
    #[must_use]
    pub fn scene_path(&self) -> PathBuf {
        self.folder.join(SCENE)
    }

    /// The metrics table's file.
    #[must_use]
    pub fn metrics_path(&self) -> PathBuf {
        self.folder.join(METRICS)
    }

    /// The frames.
    #[must_use]
    pub fn frames(&self) -> &Frames {
        &self.frames
    }

    /// What the run was made with.
    ///
    /// # Errors
    /// [`RecordError::Damaged`] and those of the file system.
    pub fn environment(&self) -> Result<Environment, RecordError> {
        Environment::read(&self.folder.join(ENVIRONMENT))
    }

    /// Where the run stands.
    ///
    /// # Errors
    /// [`RecordError::Damaged`] and those of the file system.
    pub fn status(&self) -> Result<Status, RecordError> {
        read_status(&self.folder)
    }

    /// Whether a process is writing now; a run whose status is `running` without one was killed.
    #[must_use]
    pub fn is_held(&self) -> bool {
        FolderLock::is_held(&self.folder)
    }

    /// The summary, once there is one.
    ///
    /// # Errors
    /// [`RecordError::Damaged`] and those of the file system.
    pub fn summary(&self) -> Result<Option<serde_json::Value>, RecordError> {
        let path = self.folder.join(SUMMARY);
        match read_text(&path) {
            Ok(text) => serde_json::from_str(&text)
                .map(Some)
                .map_err(|error| RecordError::Damaged { path, reason: error.to_string() }),
            Err(RecordError::Missing { .. }) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// The newest checkpoint that can be read.
    ///
    /// # Errors
    /// As [`Checkpoints::load`].
    pub fn checkpoint(&self) -> Result<Checkpoint, RecordError> {
        Checkpoints::new(self.folder.join(CHECKPOINTS)).load(None, |_| Ok(())).map(|found| found.checkpoint)
    }
}
