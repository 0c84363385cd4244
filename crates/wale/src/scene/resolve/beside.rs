//! Files that a scene names: they lie in its folder, or below it.

use std::fs::File;
use std::io::Read;
use std::path::{Component, Path, PathBuf};

use crate::scene::error::{Complaint, ErrorClass, shortened};

/// A file that lies in the scene's folder or below it, links followed.
pub(super) fn path_beside(key: &str, name: &str, directory: Option<&Path>) -> Result<PathBuf, Complaint> {
    let complain = |what: String| {
        Complaint::new(key, what)
            .why("a file that a scene names lies in the scene's folder, or below it")
            .mend("write for instance \"rib.knit\"")
    };
    let shown = shortened(name);
    let inside = !name.is_empty()
        && !name.contains(['\\', ':', '\0'])
        && Path::new(name).components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if !inside {
        return Err(complain(format!("\"{}\" is not a path inside the scene's folder", shown.escape_debug())));
    }
    let Some(directory) = directory else {
        return Err(complain("this scene has no folder to read files from".to_owned()));
    };
    // A scene that is given by its bare name lies in the working directory.
    let directory = if directory.as_os_str().is_empty() { Path::new(".") } else { directory };
    let path = directory.join(name);
    let unreadable = |error: &std::io::Error| unreadable(key, &shown, error);
    let real = path.canonicalize().map_err(|error| unreadable(&error))?;
    let folder = directory.canonicalize().map_err(|error| unreadable(&error))?;
    if !real.starts_with(&folder) {
        return Err(complain(format!("\"{shown}\" leads out of the scene's folder")));
    }
    if !real.is_file() {
        return Err(complain(format!("\"{shown}\" is no file")));
    }
    Ok(path)
}

fn unreadable(key: &str, name: &str, error: &std::io::Error) -> Complaint {
    let complaint = Complaint::new(key, format!("\"{name}\" cannot be read: {error}"));
    match error.kind() {
        std::io::ErrorKind::NotFound => complaint.mend("check the name; it is relative to the scene's folder"),
        _ => complaint.class(ErrorClass::InputOutput),
    }
}

/// The text of a file, no more than is allowed of it.
pub(super) fn read_text(path: &Path, key: &str, name: &str, limit: usize) -> Result<String, Complaint> {
    String::from_utf8(read_bytes(path, key, name, limit)?).map_err(|_| {
        let what = format!("\"{}\" is not text in UTF-8", shortened(name));
        Complaint::new(key, what)
    })
}

/// The bytes of a file, one more than `limit` at most.
pub(super) fn read_bytes(path: &Path, key: &str, name: &str, limit: usize) -> Result<Vec<u8>, Complaint> {
    let mut bytes = Vec::new();
    let limit = limit as u64 + 1;
    File::open(path)
        .and_then(|file| file.take(limit).read_to_end(&mut bytes))
        .map_err(|error| unreadable(key, &shortened(name), &error))?;
    Ok(bytes)
}
