//! Collections of other people's files, which are no part of this repository.

use std::path::{Path, PathBuf};

/// A file or folder of the collections: in the folder that `WALE_DATA` names, or else in `shared/data` beside the repository.
/// Where it is not there, the test says that it is skipped.
pub fn shared(name: &str) -> Option<PathBuf> {
    let data = std::env::var_os("WALE_DATA").map(PathBuf::from);
    let data = data.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"));
    let path = data.join(name);
    if path.exists() {
        return Some(path);
    }
    eprintln!("SKIPPED: {} is not there (set WALE_DATA to where it is)", path.display());
    None
}
