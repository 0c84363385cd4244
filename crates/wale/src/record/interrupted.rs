//! A run that ended before its end, and whether it can be gone on with.

use std::path::{Path, PathBuf};

use super::atomic_file::remove_leftovers;
use super::checkpoint::{Checkpoint, Checkpoints};
use super::environment::Environment;
use super::error::RecordError;
use super::frames::Frames;
use super::inputs::{compare_hashes, sha256};
use super::layout::{
    CHECKPOINTS, ENVIRONMENT, FRAMES, INPUTS, LOG, METRICS, SCENE, SUMMARY, check_space, read_status, remove_if_there,
    write_status,
};
use super::lock::FolderLock;
use super::log::StepLog;
use super::metrics::{Column, Metrics};
use super::run_folder::RunFolder;
use super::status::Status;
use super::{append_file, read_file, read_text};

/// A run that was found fit to go on with; nothing in its folder has been changed yet.
#[derive(Debug)]
pub struct Interrupted {
    /// The checkpoint to go on from; `None` if the run was killed before its first, and begins at the beginning.
    pub checkpoint: Option<Checkpoint>,
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
    pub fn open(folder: &Path, here: &Environment, allow_changed: bool) -> Result<Self, RecordError> {
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
            notes.push(format!("begun by wale {}: the bits may differ", began.version));
        } else if (&began.features, &began.architecture) != (&here.features, &here.architecture) {
            notes.push("begun by another build of wale: the last bits may differ".to_owned());
        }
        let comparison = compare_hashes(&folder.join(INPUTS), SCENE)?;
        for path in comparison.changed {
            if !allow_changed {
                return Err(RecordError::InputChanged { path: folder.join(path) });
            }
            notes.push(format!("{}: changed since the run began", path.display()));
        }
        for path in comparison.gone {
            notes.push(format!("{}: gone; the recorded scene is used", path.display()));
        }
        let scene = read_text(&folder.join(SCENE))?;
        let hash = sha256(scene.as_bytes());
        let frame_count = Frames::new(folder.join(FRAMES)).count()?;
        let checkpoints = Checkpoints::new(folder.join(CHECKPOINTS));
        let mut checkpoint = None;
        if checkpoints.is_untouched()? {
            notes.push("killed before its first checkpoint: begins at the beginning".to_owned());
        } else {
            let found = checkpoints.load((!allow_changed).then_some(&hash), |checkpoint| {
                let marks = checkpoint.marks;
                if frame_count < marks.frames {
                    return Err(format!("taken at frame {}, and there are {frame_count}", marks.frames));
                }
                append_file::check_length(&folder.join(METRICS), marks.metrics)
                    .and_then(|()| append_file::check_length(&folder.join(LOG), marks.log))
                    .map_err(|error| error.to_string())
            })?;
            notes.extend(found.passed_over);
            checkpoint = Some(found.checkpoint);
        }
        Ok(Self { checkpoint, scene, status, notes, folder: folder.to_path_buf(), lock })
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
        let frames = Frames::new(folder.join(FRAMES));
        let checkpoints = Checkpoints::new(folder.join(CHECKPOINTS));
        let (metrics_path, log_path) = (folder.join(METRICS), folder.join(LOG));
        let (metrics, log, frame_count);
        if let Some(Checkpoint { state, marks, .. }) = self.checkpoint {
            let frame_bytes = match marks.frames {
                0 => 0,
                _ => read_file(&frames.path(0))?.len() as u64,
            };
            check_space(&folder, frame_bytes, Checkpoints::byte_count(&state))?;
            metrics = Metrics::resume(&metrics_path, columns, marks.metrics)?;
            log = StepLog::resume(&log_path, marks.log)?;
            checkpoints.remove_after(state.step)?;
            frame_count = marks.frames;
        } else {
            metrics = Metrics::create(&metrics_path, columns)?;
            log = StepLog::create(&log_path)?;
            frame_count = 0;
        }
        frames.remove_from(frame_count)?;
        for swept in [&folder, &folder.join(FRAMES), &folder.join(CHECKPOINTS)] {
            remove_leftovers(swept)?;
        }
        remove_if_there(&folder.join(SUMMARY))?;
        write_status(&folder, Status::Running)?;
        Ok(RunFolder {
            scene: sha256(self.scene.as_bytes()),
            frames,
            frame_count,
            metrics,
            log,
            checkpoints,
            _lock: self.lock,
            folder,
        })
    }
}
