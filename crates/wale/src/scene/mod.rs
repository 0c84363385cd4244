//! Scenes: what a person writes in TOML, read into plain, checked SI numbers, with errors that underline the value.
//!
//! ```
//! use wale::scene::Scene;
//!
//! let text = "
//!     schema = 1
//!     [fabric.chart]
//!     pattern = \"rib 2x2\"
//!     columns = 20
//!     rows = 20
//! ";
//! let scene = Scene::from_text(text, "rib.toml")?;
//! assert_eq!(scene.structure.size(), [20, 20]);
//!
//! let error = Scene::from_text("schema = 1\n[fabric]\nloop_length = \"-3 mm\"\n", "bad.toml").unwrap_err();
//! assert_eq!(error.to_string(), "bad.toml:3:15: a length must be positive here, not \"-3 mm\"");
//! # Ok::<(), wale::scene::SceneError>(())
//! ```

pub mod dimensions;
mod error;
mod locate;
mod presets;
mod resolve;
pub mod schema;
#[cfg(test)]
mod tests;
pub mod units;
mod write;

use std::fs::File;
use std::io::Read;
use std::ops::Range;
use std::path::{Path, PathBuf};

pub use error::{ErrorClass, SceneError};

use crate::model::{FabricCard, Network, Plan, YarnId, Yarns};
use crate::pattern::Structure;
use error::{Complaint, nearest};
use resolve::Failure;
use schema::{PresetName, SceneText};

/// Version of the scene format.
pub const SCHEMA: u32 = 1;

/// Most bytes of a scene file.
pub const LARGEST_FILE: usize = 16 << 20;

/// A scene: all that a run needs, in SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Title for reports, perhaps empty.
    pub title: String,
    /// The yarns.
    pub yarns: Yarns,
    /// Their colours as sRGB, at least one.
    pub yarn_colors: Vec<[u8; 3]>,
    /// The fabric.
    pub fabric: FabricCard,
    /// The stitches and how they are worked.
    pub structure: Structure,
    /// What happens, and what is written.
    pub plan: Plan,
}

/// A scene and the files it was read from.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneFile {
    /// The scene.
    pub scene: Scene,
    /// The scene file and the files that it names, as they were opened.
    pub inputs: Vec<PathBuf>,
}

impl Scene {
    /// Gives every yarn of the scene's fabric its colour.
    pub fn color_yarns(&self, network: &mut Network) {
        let first = self.yarn_colors.first().copied().unwrap_or([0x8a; 3]);
        for (color, kind) in network.yarn_color.iter_mut().zip(&network.yarn_kind) {
            *color = self.yarn_colors.get(usize::from(*kind)).copied().unwrap_or(first);
        }
        // Threads of a draft may have colours of their own.
        let Some(woven) = self.structure.woven() else { return };
        for yarn in (0..network.yarn_count()).map(YarnId::new) {
            if let Some(color) = woven.thread(network, yarn).and_then(|thread| thread.color) {
                network.yarn_color[yarn.index()] = color;
            }
        }
    }

    /// Reads a scene file.
    ///
    /// # Errors
    /// If the file or one that it names cannot be read, or something in them is wrong.
    pub fn read(path: &Path) -> Result<Self, SceneError> {
        Self::read_with_inputs(path).map(|file| file.scene)
    }

    /// Reads a scene file, and says which files were opened for it.
    ///
    /// # Errors
    /// As [`Scene::read`].
    pub fn read_with_inputs(path: &Path) -> Result<SceneFile, SceneError> {
        let name = path.display().to_string();
        let text = read_text(path).map_err(|complaint| SceneError::new(complaint, &name, "", None))?;
        let (scene, mut inputs) = interpret(&text, &name, path.parent())?;
        inputs.insert(0, path.to_owned());
        Ok(SceneFile { scene, inputs })
    }

    /// Reads a scene from its text; a chart file cannot be read so. `name` stands in errors.
    ///
    /// # Errors
    /// If something in the text is wrong.
    pub fn from_text(text: &str, name: &str) -> Result<Self, SceneError> {
        interpret(text, name, None).map(|(scene, _)| scene)
    }

    /// The scene written out in full, defaults and presets resolved, in SI units. Reading it gives the same scene.
    ///
    /// # Errors
    /// If a number of the scene, changed by a program, is out of the format's bounds.
    pub fn resolved_toml(&self) -> Result<String, SceneError> {
        let error = |what: String| SceneError::new(Complaint::new("", what), "resolved scene", "", None);
        let text = write::text_of(self).map_err(error)?;
        toml::to_string(&text).map_err(|failed| error(failed.to_string()))
    }
}

/// The JSON Schema of scene files.
#[must_use]
pub fn json_schema() -> serde_json::Value {
    schemars::schema_for!(SceneText).to_value()
}

/// A commented scene to start from, as `wale new` writes it.
#[must_use]
pub fn template() -> &'static str {
    include_str!("../../presets/new-scene.toml")
}

/// A scene file that shows a preset.
#[must_use]
pub fn text_of_preset(preset: PresetName) -> String {
    let name = serde_json::to_value(preset).ok().and_then(|name| name.as_str().map(str::to_owned)).unwrap_or_default();
    format!(
        "schema = {SCHEMA}\n\n[yarn]\npreset = \"{name}\"\n\n\
         [fabric.chart]\npattern = \"stockinette\"\ncolumns = 20\nrows = 20\n"
    )
}

fn read_text(path: &Path) -> Result<String, Complaint> {
    let failed = |error: std::io::Error| {
        let complaint = Complaint::new("", format!("the scene cannot be read: {error}"));
        match error.kind() {
            std::io::ErrorKind::NotFound => complaint.mend("check the name, or write a scene with `wale new`"),
            std::io::ErrorKind::IsADirectory => complaint.mend("name a .toml file"),
            _ => complaint.class(ErrorClass::InputOutput),
        }
    };
    let mut bytes = Vec::new();
    let limit = LARGEST_FILE as u64 + 1;
    File::open(path).and_then(|file| file.take(limit).read_to_end(&mut bytes)).map_err(failed)?;
    if bytes.len() > LARGEST_FILE {
        let what = format!("the scene is larger than {LARGEST_FILE} bytes");
        return Err(Complaint::new("", what).class(ErrorClass::ResourceLimit));
    }
    String::from_utf8(bytes).map_err(|_| Complaint::new("", "the scene is not text in UTF-8"))
}

fn interpret(text: &str, name: &str, directory: Option<&Path>) -> Result<(Scene, Vec<PathBuf>), SceneError> {
    // A byte order mark is no part of the scene.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let parsed: SceneText = toml::from_str(text).map_err(|error| {
        let (complaint, span) = explained(&error);
        SceneError::new(complaint, name, text, span)
    })?;
    resolve::scene(&parsed, directory).map_err(|failure| match failure {
        Failure::Elsewhere(error) => *error,
        Failure::Here(complaint) => {
            let span = locate::span_of(text, &complaint.path);
            SceneError::new(complaint, name, text, span)
        }
    })
}

/// The reader's message with a mend: after a line break where our own types gave one, the nearest word where it lists
/// the words that it knows.
fn explained(error: &toml::de::Error) -> (Complaint, Option<Range<usize>>) {
    let message = error.message();
    let (what, mend) = match message.split_once('\n') {
        Some((what, mend)) => (what, Some(mend.replace('\n', " "))),
        None => (message, None),
    };
    let mut quoted = what.split('`').skip(1).step_by(2);
    let mut complaint = Complaint::new("", what);
    let unknown_key = what.starts_with("unknown field");
    if unknown_key || what.starts_with("unknown variant") {
        let word = quoted.next().unwrap_or_default();
        let known: Vec<&str> = quoted.collect();
        let kind = if unknown_key { "key" } else { "value" };
        complaint = Complaint::new("", format!("unknown {kind} `{}`", error::shortened(word)));
        complaint = complaint.why(if unknown_key { "no such key here" } else { "no such value here" });
        let list = known.join(", ");
        complaint = complaint.mend(match nearest(word, known.iter().copied()) {
            Some(near) => format!("did you mean `{near}`? known here: {list}"),
            None => format!("known here: {list}"),
        });
    } else if let Some(key) = what.strip_prefix("missing field").and(quoted.next()) {
        complaint = Complaint::new("", format!("`{key}` is missing")).mend(match key {
            "schema" => format!("write schema = {SCHEMA} in the first line"),
            "fabric" => "add [fabric.chart] with pattern = \"garter\", columns = 20 and rows = 20".to_owned(),
            key => format!("add {key} = …"),
        });
        // The reader points at everything that lacks the key; where that is the whole file, at nothing.
        let whole = key == "schema" || key == "fabric";
        return (complaint, error.span().filter(|_| !whole));
    } else if let Some(mend) = mend {
        complaint = complaint.mend(mend);
    }
    (complaint, error.span())
}
