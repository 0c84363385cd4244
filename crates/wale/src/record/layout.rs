//! Names of a run folder's files, and who may fill or empty it.

use std::fs;
use std::path::Path;

use super::atomic_file::{remove_leftovers, sync_folder, write_bytes_atomically};
use super::error::RecordError;
use super::read_text;
use super::status::Status;

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

/// Reads the status of a run folder.
///
/// # Errors
/// [`RecordError::NotARun`] without a `STATUS`; [`RecordError::Damaged`].
pub fn read_status(folder: &Path) -> Result<Status, RecordError> {
    let path = folder.join(STATUS);
    let text = read_text(&path).map_err(|error| match error {
        RecordError::Missing { .. } if folder.exists() => {
            let reason = if folder.join(SCENE).exists() {
                "killed while it was being made; make it anew with `--force`".to_owned()
            } else {
                format!("it has no file {STATUS}")
            };
            RecordError::NotARun { path: folder.to_path_buf(), reason }
        }
        RecordError::Missing { .. } => RecordError::Missing { path: folder.to_path_buf() },
        other => other,
    })?;
    text.parse().map_err(|()| RecordError::Damaged {
        path,
        reason: format!("`{}` is no status", text.trim_end().escape_debug()),
    })
}

pub(super) fn write_status(folder: &Path, status: Status) -> Result<(), RecordError> {
    write_bytes_atomically(&folder.join(STATUS), format!("{status}\n").as_bytes())
}

/// Refuses a folder with content, except a run's under `force`.
pub(super) fn check_empty(folder: &Path, force: bool) -> Result<(), RecordError> {
    if folder.exists() && !folder.is_dir() {
        return Err(RecordError::NotEmpty { path: folder.to_path_buf(), mend: "it is a file: choose another name" });
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
pub(super) fn clear(folder: &Path) -> Result<(), RecordError> {
    // The status goes first: from then on the rest is no run.
    for name in [STATUS, SUMMARY, METRICS, LOG, ENVIRONMENT, INPUTS] {
        remove_if_there(&folder.join(name))?;
    }
    for sub in [FRAMES, CHECKPOINTS] {
        let sub = folder.join(sub);
        if sub.exists() {
            fs::remove_dir_all(&sub).map_err(|error| RecordError::from_io(&sub, "remove", error))?;
        }
    }
    // The scene goes last: while it is there, an interrupted `--force` can be repeated.
    remove_if_there(&folder.join(SCENE))?;
    remove_leftovers(folder)?;
    sync_folder(folder).map_err(|error| RecordError::from_io(folder, "sync", error))
}

pub(super) fn remove_if_there(path: &Path) -> Result<(), RecordError> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(RecordError::from_io(path, "remove", error)),
        _ => Ok(()),
    }
}

/// There must be room for two checkpoints and a frame beside what is kept.
pub(super) fn check_space(folder: &Path, frame_bytes: u64, checkpoint_bytes: u64) -> Result<(), RecordError> {
    let needed = frame_bytes.saturating_add(checkpoint_bytes.saturating_mul(2));
    let available = fs4::available_space(folder)
        .map_err(|error| RecordError::from_io(folder, "measure the free space of", error))?;
    if available < needed {
        return Err(RecordError::TooLittleSpace { path: folder.to_path_buf(), needed, available });
    }
    Ok(())
}
