//! What a run leaves on the disk: a folder that explains itself, can be resumed exactly, and is never half-written.

use std::fs;
use std::io;
use std::path::Path;

pub mod append_file;
pub mod atomic_file;
pub mod binary;
pub mod checkpoint;
pub mod environment;
pub mod error;
pub mod frames;
pub mod inputs;
pub mod interrupted;
mod layout;
pub mod lock;
pub mod log;
pub mod metrics;
pub mod run_folder;
pub mod run_reader;
pub mod status;
#[cfg(test)]
mod tests;

pub use checkpoint::{Checkpoint, Checkpoints, Marks, SceneHash};
pub use environment::Environment;
pub use error::RecordError;
pub use frames::Frames;
pub use interrupted::Interrupted;
pub use metrics::Column;
pub use run_folder::{RunFolder, RunStart};
pub use run_reader::RunReader;
pub use status::Status;

/// Reads a whole regular file: a device or a pipe under the name of one could be endless.
pub(crate) fn read_file(path: &Path) -> Result<Vec<u8>, RecordError> {
    let metadata = fs::metadata(path).map_err(|error| error::reading(path, error))?;
    if !metadata.is_file() {
        return Err(error::reading(path, io::Error::other("not a regular file")));
    }
    fs::read(path).map_err(|error| error::reading(path, error))
}

/// Reads a text file of a run, which is never large.
pub(crate) fn read_text(path: &Path) -> Result<String, RecordError> {
    String::from_utf8(read_file(path)?)
        .map_err(|_| RecordError::Damaged { path: path.to_path_buf(), reason: "not UTF-8 text".to_owned() })
}
