//! A run folder while it is being written: made, checked before going on, filled in one order, ended by a status.
//!
//! ```text
//! scene.resolved.toml   the scene with every default written out
//! inputs.sha256         hashes of the files that the scene was made from, and of the line above
//! environment.json      program, processor, threads, seeds
//! metrics.csv           a row a frame            log.jsonl   a line a step
//! frames/               frame_00000.wale …       checkpoints/   two generations and LATEST
//! summary.json          measured at the end      STATUS   running | done | stopped | failed:<code>
//! lock                  who is writing
//! ```
//! `STATUS` is written last when a run is made: a folder without it is no run. In the loop the order is frame →
//! metrics → checkpoint, so that a checkpoint never speaks of something that is not on the disk.

use std::fs;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::atomic_file::write_bytes_atomically;
use super::checkpoint::{Checkpoints, Marks, SceneHash};
use super::environment::Environment;
use super::error::RecordError;
use super::frames::Frames;
use super::inputs::{sha256, write_hashes};
use super::layout::{
    CHECKPOINTS, ENVIRONMENT, FRAMES, INPUTS, LOG, METRICS, SCENE, SUMMARY, check_empty, check_space, clear,
    write_status,
};
use super::lock::FolderLock;
use super::log::StepLog;
use super::metrics::{Column, Metrics};
use super::status::Status;
use crate::dynamics::State;
use crate::model::Frame;

/// What a run begins with.
#[derive(Clone, Debug)]
pub struct RunStart<'a> {
    /// The scene with every default written out, as TOML.
    pub scene: &'a str,
    /// Files that the scene was read from.
    pub inputs: &'a [PathBuf],
    /// Program and machine.
    pub environment: &'a Environment,
    /// Columns of the metrics table, after the step.
    pub columns: &'a [Column],
    /// Length of a frame's file \[bytes\], see [`Frames::byte_count`].
    pub frame_bytes: u64,
    /// Length of a checkpoint \[bytes\], see [`Checkpoints::byte_count`].
    pub checkpoint_bytes: u64,
}

/// A run folder that this process is writing.
#[derive(Debug)]
pub struct RunFolder {
    pub(super) folder: PathBuf,
    pub(super) scene: SceneHash,
    pub(super) frames: Frames,
    pub(super) frame_count: u64,
    pub(super) metrics: Metrics,
    pub(super) log: StepLog,
    pub(super) checkpoints: Checkpoints,
    // Last, so that the folder is given back when all else is closed.
    pub(super) _lock: FolderLock,
}

impl RunFolder {
    /// Makes a run folder.
    ///
    /// An existing empty folder is taken; `force` also takes one that holds a run, and deletes that run. A folder
    /// that holds anything else is never touched.
    ///
    /// # Errors
    /// [`RecordError::NotEmpty`], [`RecordError::InUse`], [`RecordError::TooLittleSpace`],
    /// [`RecordError::NotWritable`] and others of the file system.
    pub fn create(folder: &Path, start: &RunStart<'_>, force: bool) -> Result<Self, RecordError> {
        // Asked before the first file, so that a foreign folder does not even get a lock file.
        check_empty(folder, force)?;
        fs::create_dir_all(folder).map_err(|error| RecordError::from_io(folder, "create", error))?;
        let lock = FolderLock::take(folder)?;
        check_empty(folder, force)?;
        check_space(folder, start.frame_bytes, start.checkpoint_bytes)?;
        clear(folder)?;
        for sub in [FRAMES, CHECKPOINTS] {
            let sub = folder.join(sub);
            fs::create_dir_all(&sub).map_err(|error| RecordError::from_io(&sub, "create", error))?;
        }
        write_bytes_atomically(&folder.join(SCENE), start.scene.as_bytes())?;
        let mut hashed = Vec::new();
        for input in start.inputs {
            hashed.push(std::path::absolute(input).map_err(|error| RecordError::from_io(input, "find", error))?);
        }
        // Last, so that a list that was cut short lacks it.
        hashed.push(PathBuf::from(SCENE));
        write_hashes(&folder.join(INPUTS), &hashed)?;
        start.environment.write(&folder.join(ENVIRONMENT))?;
        let metrics = Metrics::create(&folder.join(METRICS), start.columns)?;
        let log = StepLog::create(&folder.join(LOG))?;
        metrics.sync()?;
        log.sync()?;
        write_status(folder, Status::Running)?;
        Ok(Self {
            folder: folder.to_path_buf(),
            scene: sha256(start.scene.as_bytes()),
            frames: Frames::new(folder.join(FRAMES)),
            frame_count: 0,
            metrics,
            log,
            checkpoints: Checkpoints::new(folder.join(CHECKPOINTS)),
            _lock: lock,
        })
    }

    /// The folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.folder
    }

    /// Frames written so far; the index of the next one.
    #[must_use]
    pub fn frame_count(&self) -> u64 {
        self.frame_count
    }

    /// Writes the next frame.
    ///
    /// # Errors
    /// A full disk and other failures to write.
    pub fn write_frame(&mut self, frame: &Frame) -> Result<(), RecordError> {
        self.frames.write(self.frame_count, frame)?;
        self.frame_count += 1;
        Ok(())
    }

    /// Appends a row to the metrics table, one value a column.
    ///
    /// # Errors
    /// A full disk and other failures to write.
    ///
    /// # Panics
    /// If there are not as many values as columns.
    pub fn write_metrics(&mut self, step: u64, values: &[f64]) -> Result<(), RecordError> {
        self.metrics.append(step, values)
    }

    /// Appends an entry to the step log.
    ///
    /// # Errors
    /// A full disk and other failures to write.
    pub fn log(&mut self, entry: &impl Serialize) -> Result<(), RecordError> {
        self.log.append(entry)
    }

    /// Takes a checkpoint; what was written before is brought to the disk first.
    ///
    /// # Errors
    /// A full disk and other failures to write; the checkpoints before are then still there.
    pub fn checkpoint(&mut self, state: &State) -> Result<(), RecordError> {
        let marks = Marks { frames: self.frame_count, metrics: self.metrics.sync()?, log: self.log.sync()? };
        self.checkpoints.save(state, &self.scene, marks)?;
        Ok(())
    }

    /// Writes `summary.json`.
    ///
    /// # Errors
    /// A full disk and other failures to write.
    pub fn write_summary(&self, summary: &impl Serialize) -> Result<(), RecordError> {
        let path = self.folder.join(SUMMARY);
        let mut text = serde_json::to_vec_pretty(summary)
            .map_err(|error| RecordError::Damaged { path: path.clone(), reason: error.to_string() })?;
        text.push(b'\n');
        write_bytes_atomically(&path, &text)
    }

    /// Says where the run stands.
    ///
    /// # Errors
    /// A full disk and other failures to write.
    pub fn set_status(&self, status: Status) -> Result<(), RecordError> {
        write_status(&self.folder, status)
    }
}
