//! What a run was made with: enough to make it again.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::atomic_file::write_bytes_atomically;
use super::error::RecordError;
use super::read_text;

/// Version of the run folder's layout.
pub const FORMAT: u32 = 1;

/// Content of `environment.json`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Environment {
    /// Version of the run folder's layout.
    pub format: u32,
    /// Version of the program.
    pub version: String,
    /// Features that it was built with.
    pub features: Vec<String>,
    /// Threads that it ran on when the run began (results do not depend on it).
    pub threads: usize,
    /// Operating system.
    pub os: String,
    /// Processor architecture.
    pub architecture: String,
    /// Name of the processor.
    pub cpu: String,
    /// Seeds of random numbers by what they are for; none where nothing is random.
    pub seeds: BTreeMap<String, u64>,
}

impl Environment {
    /// This program on this machine.
    #[must_use]
    pub fn here(threads: usize) -> Self {
        Self {
            format: FORMAT,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            features: features(),
            threads,
            os: std::env::consts::OS.to_owned(),
            architecture: std::env::consts::ARCH.to_owned(),
            cpu: cpu_name(),
            seeds: BTreeMap::new(),
        }
    }

    /// Writes `environment.json`.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), RecordError> {
        let mut text = serde_json::to_vec_pretty(self)
            .map_err(|error| RecordError::Damaged { path: path.to_path_buf(), reason: error.to_string() })?;
        text.push(b'\n');
        write_bytes_atomically(path, &text)
    }

    /// Reads `environment.json`; another layout version is told before anything else is asked of the file.
    ///
    /// # Errors
    /// [`RecordError::OtherVersion`], [`RecordError::Damaged`], [`RecordError::Missing`].
    pub fn read(path: &Path) -> Result<Self, RecordError> {
        #[derive(Deserialize)]
        struct Layout {
            format: u32,
            version: Option<String>,
        }
        let damaged =
            |error: serde_json::Error| RecordError::Damaged { path: path.to_path_buf(), reason: error.to_string() };
        let text = read_text(path)?;
        let layout: Layout = serde_json::from_str(&text).map_err(damaged)?;
        if layout.format != FORMAT {
            return Err(RecordError::OtherVersion {
                path: path.to_path_buf(),
                found: format!(
                    "wale {} with run folder format {}",
                    layout.version.as_deref().unwrap_or("?"),
                    layout.format
                ),
                expected: format!("wale {} with format {FORMAT}", env!("CARGO_PKG_VERSION")),
            });
        }
        serde_json::from_str(&text).map_err(damaged)
    }
}

fn features() -> Vec<String> {
    // Code paths that the compiler may choose decide the last bits.
    [
        ("avx2", cfg!(target_feature = "avx2")),
        ("avx512f", cfg!(target_feature = "avx512f")),
        ("fma", cfg!(target_feature = "fma")),
        ("neon", cfg!(target_feature = "neon")),
        ("debug-assertions", cfg!(debug_assertions)),
    ]
    .into_iter()
    .filter(|(_, on)| *on)
    .map(|(name, _)| name.to_owned())
    .collect()
}

fn cpu_name() -> String {
    fs::read_to_string("/proc/cpuinfo")
        .ok()
        .and_then(|text| {
            let line = text.lines().find(|line| line.starts_with("model name"))?;
            Some(line.split_once(':')?.1.trim().to_owned())
        })
        .unwrap_or_else(|| "unknown".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_read_back_and_another_format_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("environment.json");
        let here = Environment::here(2);
        here.write(&path).unwrap();
        assert_eq!(Environment::read(&path).unwrap(), here);

        fs::write(&path, r#"{"format": 9, "version": "7.0", "other": "layout"}"#).unwrap();
        let error = Environment::read(&path).unwrap_err().to_string();
        assert!(error.contains("wale 7.0") && error.contains("format 9"), "{error}");

        for bad in ["", "{", "[]", r#"{"format": -1}"#, &"[".repeat(100_000)] {
            fs::write(&path, bad).unwrap();
            assert!(matches!(Environment::read(&path), Err(RecordError::Damaged { .. })));
        }
    }
}
