//! Folders of a fit: one for what goes on, and one for what comes out of each fabric.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use super::deliver::{ABLATIONS, RESULTS};
use super::yarn::ANSWERS;
use crate::arguments::fit::Fit;
use crate::exit::{Code, Failure};

/// Where a fit is kept.
pub struct Places {
    /// The problem and its answers.
    pub folder: PathBuf,
    /// Card and report of each fabric: the same folder for a single one, folders in it for several.
    pub of_fabric: Vec<PathBuf>,
}

impl Places {
    /// As the arguments say.
    pub fn of(arguments: &Fit) -> Result<Self, Failure> {
        let out = arguments.results.out.clone();
        let [one] = &arguments.fabrics[..] else {
            let folder = out.ok_or_else(|| {
                Failure::new(Code::Usage, "several fabrics: say with `--out FOLDER` where their fit goes")
            })?;
            let of_fabric = names(&arguments.fabrics).iter().map(|name| folder.join(name)).collect();
            return Ok(Self { folder, of_fabric });
        };
        let folder = out.unwrap_or_else(|| one.with_extension("fit"));
        Ok(Self { of_fabric: vec![folder.clone()], folder })
    }

    /// Whether there is a fit already. One whose answers are there is none to ablations that it has not: with the same answers it
    /// comes out the same.
    pub fn taken(&self, arguments: &Fit) -> bool {
        let there = |name: &str| self.of_fabric.iter().any(|folder| folder.join(name).exists());
        let goes_on = arguments.ablations && self.folder.join(ANSWERS).exists() && !there(ABLATIONS);
        !goes_on && (RESULTS.iter().any(|name| there(name)) || there(ABLATIONS))
    }
}

/// Names of fabrics: of their files, or of the folders of these where files are called the same, or numbers with them.
fn names(paths: &[PathBuf]) -> Vec<String> {
    let text = |name: Option<&OsStr>| name.map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let files: Vec<String> = paths.iter().map(|path| text(path.file_stem())).collect();
    let folders: Vec<String> = paths.iter().map(|path| text(path.parent().and_then(Path::file_name))).collect();
    let differ = |names: &[String]| (1..names.len()).all(|k| !names[..k].contains(&names[k]) && !names[k].is_empty());
    match () {
        () if differ(&files) => files,
        () if differ(&folders) && !folders[0].is_empty() => folders,
        () => files.iter().enumerate().map(|(k, name)| format!("{}-{name}", k + 1)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fabrics_have_names_of_their_own() {
        let of = |paths: &[&str]| names(&paths.iter().map(PathBuf::from).collect::<Vec<_>>());
        assert_eq!(of(&["jersey.toml", "rib.toml"]), ["jersey", "rib"]);
        assert_eq!(of(&["jersey/fabric.toml", "rib/fabric.toml"]), ["jersey", "rib"]);
        assert_eq!(of(&["fabric.toml", "x/fabric.toml"]), ["1-fabric", "2-fabric"]);
        assert_eq!(of(&["x/a.toml", "x/a.toml"]), ["1-a", "2-a"]);
    }
}
