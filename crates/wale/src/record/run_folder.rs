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

use super::atomic_file::{remove_leftovers, sync_folder, write_bytes_atomically};
use super::checkpoint::{Checkpoint, Checkpoints, Marks, SceneHash};
use super::environment::Environment;
use super::error::RecordError;
use super::frames::Frames;
use super::inputs::{compare_hashes, sha256, write_hashes};
use super::lock::FolderLock;
use super::log::StepLog;
use super::metrics::{Column, Metrics};
use super::status::Status;
use super::{append_file, read_file, read_text};
use crate::dynamics::State;
use crate::model::Frame;

pub(super) const SCENE: &str = "scene.resolved.toml";
pub(super) const INPUTS: &str = "inputs.sha256";
pub(super) const ENVIRONMENT: &str = "environment.json";
pub(super) const METRICS: &str = "metrics.csv";
pub(super) const LOG: &str = "log.jsonl";
pub(super) const FRAMES: &str = "frames";
pub(super) const CHECKPOINTS: &str = "checkpoints";
pub(super) const SUMMARY: &str = "summary.json";
pub(super) const STATUS: &str = "STATUS";
const LOCK: &str = "lock";

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
    folder: PathBuf,
    scene: SceneHash,
    frames: Frames,
    frame_count: u64,
    metrics: Metrics,
    log: StepLog,
    checkpoints: Checkpoints,
    // Last, so that the folder is given back when all else is closed.
    _lock: FolderLock,
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
        fs::create_dir_all(folder)
            .map_err(|error| RecordError::from_io(folder, "create", error))?;
        let lock = FolderLock::take(folder)?;
        check_empty(folder, force)?;
        check_space(folder, start.frame_bytes, start.checkpoint_bytes)?;
        clear(folder)?;
        for sub in [FRAMES, CHECKPOINTS] {
            let sub = folder.join(sub);
            fs::create_dir_all(&sub)
                .map_err(|error| RecordError::from_io(&sub, "create", error))?;
        }
        write_bytes_atomically(&folder.join(SCENE), start.scene.as_bytes())?;
        let mut hashed = vec![PathBuf::from(SCENE)];
        for input in start.inputs {
            hashed.push(
                std::path::absolute(input)
                    .map_err(|error| RecordError::from_io(input, "find", error))?,
            );
        }
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
        let marks = Marks {
            frames: self.frame_count,
            metrics: self.metrics.sync()?,
            log: self.log.sync()?,
        };
        self.checkpoints.save(state, &self.scene, marks)?;
        Ok(())
    }

    /// Writes `summary.json`.
    ///
    /// # Errors
    /// A full disk and other failures to write.
    pub fn write_summary(&self, summary: &impl Serialize) -> Result<(), RecordError> {
        let path = self.folder.join(SUMMARY);
        let mut text =
            serde_json::to_vec_pretty(summary).map_err(|error| RecordError::Damaged {
                path: path.clone(),
                reason: error.to_string(),
            })?;
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

/// A run that was found fit to go on with; nothing in its folder has been changed yet.
#[derive(Debug)]
pub struct Interrupted {
    /// The checkpoint to go on from.
    pub checkpoint: Checkpoint,
    /// The resolved scene's text.
    pub scene: String,
    /// The status that was found; [`Status::Running`] means killed.
    pub status: Status,
    /// What should be told: damaged checkpoints passed over, inputs that are gone or changed.
    pub notes: Vec<String>,
    folder: PathBuf,
    lock: FolderLock,
}

impl Interrupted {
    /// Claims a run folder and checks that it can be gone on with: version, inputs, checkpoints.
    ///
    /// `allow_changed` takes another program version of the same format, changed inputs (the recorded scene is used
    /// all the same) and an edited `scene.resolved.toml`.
    ///
    /// # Errors
    /// [`RecordError::NotARun`], [`RecordError::InUse`], [`RecordError::OtherVersion`],
    /// [`RecordError::InputChanged`], [`RecordError::OtherScene`], [`RecordError::Damaged`] and others of the file
    /// system.
    pub fn open(
        folder: &Path,
        here: &Environment,
        allow_changed: bool,
    ) -> Result<Self, RecordError> {
        let status = read_status(folder)?;
        let lock = FolderLock::take(folder)?;
        let mut notes = Vec::new();
        let began = Environment::read(&folder.join(ENVIRONMENT))?;
        if began.version != here.version {
            let other = RecordError::OtherVersion {
                path: folder.to_path_buf(),
                found: format!("wale {}", began.version),
                expected: format!("wale {}", here.version),
            };
            if !allow_changed {
                return Err(other);
            }
            notes.push(format!(
                "begun by wale {}: the bits may differ",
                began.version
            ));
        } else if (&began.features, &began.architecture) != (&here.features, &here.architecture) {
            notes.push("begun by another build of wale: the last bits may differ".to_owned());
        }
        let comparison = compare_hashes(&folder.join(INPUTS))?;
        for path in comparison.changed {
            if !allow_changed {
                return Err(RecordError::InputChanged {
                    path: folder.join(path),
                });
            }
            notes.push(format!("{}: changed since the run began", path.display()));
        }
        for path in comparison.gone {
            notes.push(format!(
                "{}: gone; the recorded scene is used",
                path.display()
            ));
        }
        let scene = read_text(&folder.join(SCENE))?;
        let hash = sha256(scene.as_bytes());
        let frame_count = Frames::new(folder.join(FRAMES)).count()?;
        let found = Checkpoints::new(folder.join(CHECKPOINTS)).load(
            (!allow_changed).then_some(&hash),
            |checkpoint| {
                let marks = checkpoint.marks;
                if frame_count < marks.frames {
                    return Err(format!(
                        "taken at frame {}, and there are {frame_count}",
                        marks.frames
                    ));
                }
                append_file::check_length(&folder.join(METRICS), marks.metrics)
                    .and_then(|()| append_file::check_length(&folder.join(LOG), marks.log))
                    .map_err(|error| error.to_string())
            },
        )?;
        notes.extend(found.passed_over);
        Ok(Self {
            checkpoint: found.checkpoint,
            scene,
            status,
            notes,
            folder: folder.to_path_buf(),
            lock,
        })
    }

    /// The resolved scene's file.
    #[must_use]
    pub fn scene_path(&self) -> PathBuf {
        self.folder.join(SCENE)
    }

    /// Cuts everything back to the checkpoint and goes on writing.
    ///
    /// # Errors
    /// [`RecordError::Damaged`] when the metrics table has other columns; [`RecordError::TooLittleSpace`]; others
    /// of the file system.
    pub fn resume(self, columns: &[Column]) -> Result<RunFolder, RecordError> {
        let folder = self.folder;
        let Checkpoint { state, marks, .. } = self.checkpoint;
        let frames = Frames::new(folder.join(FRAMES));
        let checkpoints = Checkpoints::new(folder.join(CHECKPOINTS));
        let frame_bytes = match marks.frames {
            0 => 0,
            _ => read_file(&frames.path(0))?.len() as u64,
        };
        check_space(&folder, frame_bytes, Checkpoints::byte_count(&state))?;
        let metrics = Metrics::resume(&folder.join(METRICS), columns, marks.metrics)?;
        let log = StepLog::resume(&folder.join(LOG), marks.log)?;
        frames.remove_from(marks.frames)?;
        checkpoints.remove_after(state.step)?;
        for swept in [&folder, &folder.join(FRAMES), &folder.join(CHECKPOINTS)] {
            remove_leftovers(swept)?;
        }
        remove_if_there(&folder.join(SUMMARY))?;
        write_status(&folder, Status::Running)?;
        Ok(RunFolder {
            scene: sha256(self.scene.as_bytes()),
            frames,
            frame_count: marks.frames,
            metrics,
            log,
            checkpoints,
            _lock: self.lock,
            folder,
        })
    }
}

/// Reads the status of a run folder.
///
/// # Errors
/// [`RecordError::NotARun`] without a `STATUS`; [`RecordError::Damaged`].
pub fn read_status(folder: &Path) -> Result<Status, RecordError> {
    let path = folder.join(STATUS);
    let text = read_text(&path).map_err(|error| match error {
        RecordError::Missing { .. } if folder.exists() => RecordError::NotARun {
            path: folder.to_path_buf(),
            reason: format!("it has no file {STATUS}"),
        },
        RecordError::Missing { .. } => RecordError::Missing {
            path: folder.to_path_buf(),
        },
        other => other,
    })?;
    text.parse().map_err(|()| RecordError::Damaged {
        path,
        reason: format!("`{}` is no status", text.trim_end().escape_debug()),
    })
}

fn write_status(folder: &Path, status: Status) -> Result<(), RecordError> {
    write_bytes_atomically(&folder.join(STATUS), format!("{status}\n").as_bytes())
}

/// Refuses a folder with content, except a run's under `force`.
fn check_empty(folder: &Path, force: bool) -> Result<(), RecordError> {
    if folder.exists() && !folder.is_dir() {
        return Err(RecordError::NotEmpty {
            path: folder.to_path_buf(),
            mend: "it is a file: choose another name",
        });
    }
    let mut found = Vec::new();
    match fs::read_dir(folder) {
        Ok(entries) => {
            for entry in entries {
                let entry = entry.map_err(|error| super::error::reading(folder, error))?;
                found.push(entry.file_name());
            }
        }
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(super::error::reading(folder, error)),
    }
    found.retain(|name| name != LOCK);
    let is_run = found.iter().any(|name| name == STATUS || name == SCENE);
    match (found.is_empty(), is_run, force) {
        (true, ..) | (false, true, true) => Ok(()),
        (false, true, false) => Err(RecordError::NotEmpty {
            path: folder.to_path_buf(),
            mend: "it holds a run: choose another folder, `wale resume` it, or delete the run with `--force`",
        }),
        (false, false, _) => Err(RecordError::NotEmpty {
            path: folder.to_path_buf(),
            mend: "it holds other files, which `--force` does not delete: choose another folder",
        }),
    }
}

/// Deletes what belongs to a run, and nothing else.
fn clear(folder: &Path) -> Result<(), RecordError> {
    // The status goes first: from then on the rest is no run.
    for name in [STATUS, SUMMARY, METRICS, LOG, ENVIRONMENT, INPUTS] {
        remove_if_there(&folder.join(name))?;
    }
    for sub in [FRAMES, CHECKPOINTS] {
        let sub = folder.join(sub);
        if sub.exists() {
            fs::remove_dir_all(&sub)
                .map_err(|error| RecordError::from_io(&sub, "remove", error))?;
        }
    }
    // The scene goes last: while it is there, an interrupted `--force` can be repeated.
    remove_if_there(&folder.join(SCENE))?;
    remove_leftovers(folder)?;
    sync_folder(folder).map_err(|error| RecordError::from_io(folder, "sync", error))
}

fn remove_if_there(path: &Path) -> Result<(), RecordError> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(RecordError::from_io(path, "remove", error))
        }
        _ => Ok(()),
    }
}

/// There must be room for two checkpoints and a frame beside what is kept.
fn check_space(folder: &Path, frame_bytes: u64, checkpoint_bytes: u64) -> Result<(), RecordError> {
    let needed = frame_bytes.saturating_add(checkpoint_bytes.saturating_mul(2));
    let available = fs4::available_space(folder)
        .map_err(|error| RecordError::from_io(folder, "measure the free space of", error))?;
    if available < needed {
        return Err(RecordError::TooLittleSpace {
            path: folder.to_path_buf(),
            needed,
            available,
        });
    }
    Ok(())
}
