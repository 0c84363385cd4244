//! `wale new`: a scene file to begin from.

use wale::record::RecordError;
use wale::record::atomic_file::write_bytes_atomically;
use wale::scene::template;

use crate::arguments::{New, Preset};
use crate::exit::Failure;
use crate::say;

/// The yarn of the template.
const TEMPLATE_PRESET: &str = "\"worsted-wool\"";

/// Writes it.
pub fn new(arguments: &New) -> Result<(), Failure> {
    let path = &arguments.file;
    if path.exists() && !arguments.force {
        return Err(RecordError::NotEmpty {
            path: path.clone(),
            mend: "there is something of that name: choose another, or overwrite a file with `--force`",
        }
        .into());
    }
    write_bytes_atomically(path, text(arguments.preset).as_bytes())?;
    say!("{} written; next: `wale check {0}`, then `wale run {0}`", path.display())
}

/// The template with another yarn.
fn text(preset: Preset) -> String {
    template().replacen(TEMPLATE_PRESET, &format!("\"{}\"", preset.name()), 1)
}

#[cfg(test)]
mod tests {
    use wale::scene::Scene;

    use super::*;

    #[test]
    fn every_yarn_gives_another_scene_that_reads() {
        let [cotton, wool, acrylic] = [Preset::FineCottonJersey, Preset::WorstedWool, Preset::ThickAcrylic]
            .map(|preset| Scene::from_text(&text(preset), "new.toml").unwrap().yarns.first().radius);
        assert!(cotton < wool && wool < acrylic);
    }
}
