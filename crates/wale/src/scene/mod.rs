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

mod bare;
pub mod dimensions;
mod error;
mod locate;
mod presets;
mod resolve;
pub mod schema;
#[cfg(test)]
mod tests;
mod text_file;
pub mod units;
mod write;

use std::path::{Path, PathBuf};

pub use bare::{is_bare, read_bare};
pub use error::{ErrorClass, SceneError};
pub use text_file::TextFile;

use crate::model::{FabricCard, Network, Plan, YarnId, Yarns};
use crate::pattern::Structure;
use error::Complaint;
use resolve::Failure;
use schema::{PresetName, SceneText};

/// Version of the scene format.
pub const SCHEMA: u32 = 1;

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
        let (scene, mut inputs) = interpret(&TextFile::read(path, "scene")?)?;
        inputs.insert(0, path.to_owned());
        Ok(SceneFile { scene, inputs })
    }

    /// Reads a scene from its text; a chart file cannot be read so. `name` stands in errors.
    ///
    /// # Errors
    /// If something in the text is wrong.
    pub fn from_text(text: &str, name: &str) -> Result<Self, SceneError> {
        interpret(&TextFile::new(text, name)).map(|(scene, _)| scene)
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
    format!(
        "schema = {SCHEMA}\n\n[yarn]\npreset = \"{}\"\n\n\
         [fabric.chart]\npattern = \"stockinette\"\ncolumns = 20\nrows = 20\n",
        preset.name()
    )
}

fn interpret(file: &TextFile) -> Result<(Scene, Vec<PathBuf>), SceneError> {
    let parsed: SceneText = file.parse()?;
    resolve::scene(&parsed, file.directory()).map_err(|failure| match failure {
        Failure::Elsewhere(error) => *error,
        Failure::Here(complaint) => file.complain(complaint),
    })
}
