//! Hashes of what a run was made from, in the format of `sha256sum`.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::atomic_file::write_bytes_atomically;
use super::checkpoint::SceneHash;
use super::error::RecordError;
use super::{read_file, read_text};

/// SHA-256 of bytes.
#[must_use]
pub fn sha256(bytes: &[u8]) -> SceneHash {
    Sha256::digest(bytes).into()
}

/// Writes the hashes of files; relative names stay relative, to the folder of the list.
///
/// # Errors
/// When a file cannot be read or the list cannot be written.
pub fn write_hashes(list: &Path, files: &[PathBuf]) -> Result<(), RecordError> {
    let mut text = String::new();
    for file in files {
        let hash = sha256(&read_file(&beside(list, file))?);
        for byte in hash {
            let _ = write!(text, "{byte:02x}");
        }
        let _ = writeln!(text, "  {}", file.display());
    }
    write_bytes_atomically(list, text.as_bytes())
}

/// What comparing the files with their hashes has shown.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Comparison {
    /// Files with other content.
    pub changed: Vec<PathBuf>,
    /// Files that are no longer there.
    pub gone: Vec<PathBuf>,
}

/// Compares the files named in a list with their hashes; `last` is the name that ends a list that is whole.
///
/// # Errors
/// When the list is damaged or a file cannot be read.
pub fn compare_hashes(list: &Path, last: &str) -> Result<Comparison, RecordError> {
    let mut comparison = Comparison::default();
    let text = read_text(list)?;
    if !text.ends_with(&format!("  {last}\n")) {
        return Err(RecordError::Damaged { path: list.to_path_buf(), reason: format!("it does not end with {last}") });
    }
    for line in text.lines() {
        let (hash, name) =
            line.split_once("  ").and_then(|(hash, name)| Some((parse_hash(hash)?, name))).ok_or_else(|| {
                RecordError::Damaged { path: list.to_path_buf(), reason: format!("`{line}` is not a hash and a name") }
            })?;
        match read_file(&beside(list, Path::new(name))) {
            Ok(bytes) if sha256(&bytes) == hash => {}
            Ok(_) => comparison.changed.push(PathBuf::from(name)),
            Err(RecordError::Missing { .. }) => comparison.gone.push(PathBuf::from(name)),
            Err(error) => return Err(error),
        }
    }
    Ok(comparison)
}

fn beside(list: &Path, file: &Path) -> PathBuf {
    list.parent().unwrap_or(Path::new(".")).join(file)
}

fn parse_hash(text: &str) -> Option<SceneHash> {
    let text = text.as_bytes();
    if text.len() != 64 {
        return None;
    }
    let mut hash = [0; 32];
    for (byte, pair) in hash.iter_mut().zip(text.chunks_exact(2)) {
        let digit = |c: u8| char::from(c).to_digit(16);
        *byte = u8::try_from(digit(pair[0])? * 16 + digit(pair[1])?).ok()?;
    }
    Some(hash)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_and_losses_are_found() {
        let folder = tempfile::tempdir().unwrap();
        let list = folder.path().join("inputs.sha256");
        let scene = folder.path().join("scene with  spaces.toml");
        std::fs::write(&scene, "a").unwrap();
        std::fs::write(folder.path().join("chart.txt"), "k, p").unwrap();
        write_hashes(&list, &[scene.clone(), PathBuf::from("chart.txt")]).unwrap();
        assert_eq!(compare_hashes(&list, "chart.txt").unwrap(), Comparison::default());
        assert!(
            std::fs::read_to_string(&list)
                .unwrap()
                .starts_with("ca978112ca1bbdcafac231b39a23dc4da786eff8147c4e72b9807785afee48bb  ")
        );

        std::fs::write(&scene, "b").unwrap();
        std::fs::remove_file(folder.path().join("chart.txt")).unwrap();
        let comparison = compare_hashes(&list, "chart.txt").unwrap();
        assert_eq!(comparison.changed, [scene]);
        assert_eq!(comparison.gone, [PathBuf::from("chart.txt")]);
    }

    #[test]
    fn a_damaged_list_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let list = folder.path().join("inputs.sha256");
        let hash = "a".repeat(64);
        for bad in [
            "",
            "x  chart.txt\n",
            "é  chart.txt\n",
            &format!("{}  chart.txt\n", "g".repeat(64)),
            &format!("{hash}  chart.txt"),
            &format!("{hash}  other\n"),
        ] {
            std::fs::write(&list, bad).unwrap();
            assert!(matches!(compare_hashes(&list, "chart.txt"), Err(RecordError::Damaged { .. })));
        }
    }
}
