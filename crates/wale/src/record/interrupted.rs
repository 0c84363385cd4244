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
        let found =
            Checkpoints::new(folder.join(CHECKPOINTS)).load((!allow_changed).then_some(&hash), |checkpoint| {
                let marks = checkpoint.marks;
                if frame_count < marks.frames {
                    return Err(format!("taken at frame {}, and there are {frame_count}", marks.frames));
                }
                append_file::check_length(&folder.join(METRICS), marks.metrics)
                    .and_then(|()| append_file::check_length(&folder.join(LOG), marks.log))
                    .map_err(|error| error.to_string())
            })?;
        notes.extend(found.passed_over);
        Ok(Self { checkpoint: found.checkpoint, scene, status, notes, folder: folder.to_path_buf(), lock })
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
