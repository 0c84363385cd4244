//! What can go wrong with files, told as where, what and the mend.

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// A failure to write or to read the record of a run.
#[derive(Debug, Error)]
pub enum RecordError {
    /// The disk, or the user's quota on it, is full.
    #[error(
        "{}: no space left on the disk: free some and go on from the last checkpoint with `wale resume`",
        path.display()
    )]
    DiskFull {
        /// File that was being written.
        path: PathBuf,
    },
    /// There is room for neither the checkpoints nor the next frame.
    #[error(
        "{}: {available} bytes are free, and at least {needed} are needed for two checkpoints and a frame: free some \
         space or choose another folder",
        path.display()
    )]
    TooLittleSpace {
        /// The run folder.
        path: PathBuf,
        /// Smallest free space to start with \[bytes\].
        needed: u64,
        /// Free space now \[bytes\].
        available: u64,
    },
    /// The folder or the file system does not allow writing.
    #[error("{}: writing is not allowed here ({reason}): choose another folder or change its permissions", path.display())]
    NotWritable {
        /// File or folder that was being written.
        path: PathBuf,
        /// Words of the operating system.
        reason: String,
    },
    /// A file that is needed does not exist.
    #[error("{}: no such file or folder", path.display())]
    Missing {
        /// The path that was looked for.
        path: PathBuf,
    },
    /// Any other failure of the operating system.
    #[error("{}: cannot {doing}: {source}", path.display())]
    Io {
        /// File that was worked on.
        path: PathBuf,
        /// What was being done, as a verb.
        doing: &'static str,
        /// The operating system's error.
        source: io::Error,
    },
    /// A file does not hold what its format promises.
    #[error("{}: damaged: {reason}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it, and the mend where there is one.
        reason: String,
    },
    /// A file or a folder was written by another version of the program.
    #[error(
        "{}: written by {found}, this is {expected}: finish the run with the version that began it, or begin a new \
         run (`--allow-changed` goes on regardless where the file format is the same)",
        path.display()
    )]
    OtherVersion {
        /// The file.
        path: PathBuf,
        /// What wrote it.
        found: String,
        /// What is reading it.
        expected: String,
    },
    /// A checkpoint belongs to another scene.
    #[error(
        "{}: this checkpoint belongs to another scene: resume it in its own run folder, or begin a new run",
        path.display()
    )]
    OtherScene {
        /// The checkpoint.
        path: PathBuf,
    },
    /// A new run was asked for in a folder that holds something.
    #[error("{}: not empty: {mend}", path.display())]
    NotEmpty {
        /// The folder.
        path: PathBuf,
        /// What to do about it.
        mend: &'static str,
    },
    /// The folder is no run folder.
    #[error("{}: not a run folder ({reason}): `wale run SCENE --out FOLDER` makes one", path.display())]
    NotARun {
        /// The folder.
        path: PathBuf,
        /// What is missing.
        reason: String,
    },
    /// Another process works in the folder.
    #[error("{}: in use by process {pid} on {host}: {mend}", path.display())]
    InUse {
        /// The folder.
        path: PathBuf,
        /// Process id of the owner, or `?`.
        pid: String,
        /// Host of the owner, or `?`.
        host: String,
        /// What to do about it.
        mend: String,
    },
    /// An input differs from the one that the run began with.
    #[error(
        "{}: changed since the run began: restore it, begin a new run, or pass `--allow-changed` to go on with the \
         scene as it was recorded",
        path.display()
    )]
    InputChanged {
        /// The input file.
        path: PathBuf,
    },
}

impl RecordError {
    /// Sorts an error of the operating system into the cases that people can mend.
    #[must_use]
    pub fn from_io(path: &Path, doing: &'static str, source: io::Error) -> Self {
        let path = path.to_path_buf();
        match source.kind() {
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded | io::ErrorKind::FileTooLarge => {
                Self::DiskFull { path }
            }
            io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
                Self::NotWritable { path, reason: source.to_string() }
            }
            io::ErrorKind::NotFound => Self::Missing { path },
            _ => Self::Io { path, doing, source },
        }
    }

    /// Whether the content of a file is at fault, rather than the disk or the permissions.
    #[must_use]
    pub fn is_bad_content(&self) -> bool {
        matches!(
            self,
            Self::Damaged { .. }
                | Self::OtherVersion { .. }
                | Self::OtherScene { .. }
                | Self::NotARun { .. }
                | Self::InputChanged { .. }
        )
    }
}

/// A reader denied is told apart from a writer denied.
pub(crate) fn reading(path: &Path, source: io::Error) -> RecordError {
    match source.kind() {
        io::ErrorKind::NotFound => RecordError::Missing { path: path.to_path_buf() },
        _ => RecordError::Io { path: path.to_path_buf(), doing: "read", source },
    }
}
