//! Yarns that wale knows, each with a fabric of it; TOML files of our own, read with the scene's own structs.

use super::schema::{PresetName, PresetText};

impl PresetName {
    /// All presets.
    pub const ALL: [Self; 3] = [Self::FineCottonJersey, Self::WorstedWool, Self::ThickAcrylic];

    /// Its name, as scenes have it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::FineCottonJersey => "fine-cotton-jersey",
            Self::WorstedWool => "worsted-wool",
            Self::ThickAcrylic => "thick-acrylic",
        }
    }

    /// The preset's file.
    #[must_use]
    pub fn toml(self) -> &'static str {
        match self {
            Self::FineCottonJersey => include_str!("../../presets/fine-cotton-jersey.toml"),
            Self::WorstedWool => include_str!("../../presets/worsted-wool.toml"),
            Self::ThickAcrylic => include_str!("../../presets/thick-acrylic.toml"),
        }
    }

    /// One line about the preset.
    #[must_use]
    pub fn title(self) -> String {
        self.read().title
    }

    /// # Panics
    /// Never: the files are part of the program, and a test reads them all.
    pub(super) fn read(self) -> PresetText {
        toml::from_str(self.toml()).expect("presets are part of the program and tested")
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Scene, text_of_preset};
    use super::*;

    #[test]
    fn every_preset_reads_and_gives_a_sensible_fabric() {
        for preset in PresetName::ALL {
            let text = text_of_preset(preset);
            let scene = Scene::from_text(&text, "preset.toml").unwrap_or_else(|error| panic!("{error}"));
            let (yarn, card) = (scene.yarns.first(), scene.fabric.knit().unwrap());
            assert!(!preset.title().is_empty());
            // Areal mass of relaxed stockinette [kg/m²]: from a thin T-shirt to a thick hand-knit.
            let loop_mass = yarn.linear_density / card.path_ratio * card.loop_length;
            let mass = loop_mass / (card.wale_spacing * card.course_spacing);
            assert!((0.12..1.2).contains(&mass), "{preset:?}: {mass} kg/m²");
            // Bending stiffness of spun yarns: 0.1 to 100 mN mm².
            assert!((1e-10..1e-7).contains(&yarn.bending_stiffness), "{preset:?}");
            assert!(2.0 * yarn.radius < 0.25 * card.loop_length, "{preset:?}");
        }
    }
}
