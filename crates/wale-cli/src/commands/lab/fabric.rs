//! What a test knows of a fabric, as texts that travel: the card, the tile, the scene.

use std::path::{Path, PathBuf};

use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};
use wale::scene::{Scene, TextFile};
use wale_lab::card_file::CardFile;
use wale_lab::fabric_file::{FabricFile, FabricFileError};
use wale_lab::swatch_test::SwatchTestError;
use wale_lab::uniform_test::TestedTile;
use wale_lab::yarn_fit::PullSettings;
use wale_lab::yarn_tile::read_pattern;

use super::card::{Card, Needs, card};
use crate::arguments::lab::{By, Common, Test};
use crate::exit::{Code, Failure};
use crate::opened::scene_failure;

/// What a test knows of a fabric, no more than it needs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fabric {
    /// What it is called.
    title: String,
    /// Its card, by shell and by tile.
    card: Option<String>,
    /// Its tile with rest shapes, by tile.
    tile: Option<String>,
    /// Its scene with the contact model, by contacts and by yarns.
    scene: Option<String>,
}

/// A fabric ready to be tested by a model.
pub enum Specimen {
    /// A thin shell.
    Shell(Card),
    /// A tile of yarns in full contact, and the fabric's mass by area if it is known \[kg/m²\].
    Tile(Box<TestedTile>, Option<f64>),
    /// A tile of the contact model.
    Contacts(Box<Scene>),
    /// All yarns.
    Yarns(Box<Scene>),
}

/// Only these tell a card from a scene, and both from a fabric file.
#[derive(Deserialize)]
struct Peek {
    title: Option<String>,
    shell: Option<IgnoredAny>,
    fabric: Option<IgnoredAny>,
}

impl Fabric {
    /// Reads what a test by a model needs.
    ///
    /// # Errors
    /// If it is not there.
    pub fn read(path: &Path, by: By) -> Result<Self, Failure> {
        let file = TextFile::read(path, "fabric file, card or scene").map_err(scene_failure)?;
        let peek: Peek = file.parse().map_err(scene_failure)?;
        let mut fabric = Self { title: peek.title.clone().unwrap_or_default(), card: None, tile: None, scene: None };
        let by_scene = matches!(by, By::Contacts | By::Yarns);
        if peek.fabric.is_some() && by_scene {
            fabric.scene = Some(resolved(path)?);
            return Ok(fabric);
        }
        let place = if peek.shell.is_some() { path.to_owned() } else { fitted(path)? };
        if by_scene {
            let scene = beside(&place, "swatch.toml");
            if !scene.is_file() {
                let why = "the contact model of it was not fitted; that takes a chart or a draft in [structure] of the fabric file";
                return Err(missing(&place, &scene, why));
            }
            fabric.scene = Some(resolved(&scene)?);
            return Ok(fabric);
        }
        let text = read(&place)?;
        if by == By::Tile {
            let known = CardFile::of(&TextFile::new(&text, &place.display().to_string())).map_err(scene_failure)?;
            let Some(yarn) = known.yarn else {
                let why = "its card has no [yarn]; fit it with [structure] in the fabric file";
                return Err(Failure::new(Code::BadInput, format_args!("{}: {why}", place.display())));
            };
            let tile = beside(&place, &yarn.tile);
            if !tile.is_file() {
                return Err(missing(&place, &tile, "the card names it as its tile"));
            }
            fabric.tile = Some(read(&tile)?);
        }
        fabric.card = Some(text);
        Ok(fabric)
    }

    /// What it is called.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// Makes it ready for a test.
    ///
    /// # Errors
    /// If something in it is wrong or missing. `place` is what errors call it.
    pub fn specimen(&self, test: &Test, by: By, place: &Path) -> Result<Specimen, Failure> {
        let name = place.display().to_string();
        let lacks = |what: &str| Failure::new(Code::BadInput, format_args!("{name}: there is no {what} in it"));
        if matches!(by, By::Contacts | By::Yarns) {
            let text = self.scene.as_ref().ok_or_else(|| lacks("scene"))?;
            let scene = Box::new(Scene::from_text(text, &name).map_err(scene_failure)?);
            let unfit = match (by, test) {
                (By::Yarns, _) if scene.structure.chart().is_none() => Some(SwatchTestError::NoChart),
                (_, Test::Relaxation(_)) if scene.fabric.woven().is_some() => Some(SwatchTestError::Sett),
                _ => None,
            };
            if let Some(why) = unfit {
                return Err(Failure::new(Code::BadInput, format_args!("{name}: {why}")));
            }
            return Ok(if by == By::Yarns { Specimen::Yarns(scene) } else { Specimen::Contacts(scene) });
        }
        let text = self.card.as_ref().ok_or_else(|| lacks("card"))?;
        let known = CardFile::of(&TextFile::new(text, &name)).map_err(scene_failure)?;
        let common = test.common();
        if by == By::Shell {
            return Ok(Specimen::Shell(card(known, place, common, needs(test))?));
        }
        let mass = mass(common, &known);
        let yarn = known.yarn.ok_or_else(|| lacks("yarn"))?;
        let text = self.tile.as_ref().ok_or_else(|| lacks("tile"))?;
        let tile = read_pattern(&format!("{name}, its tile"), text)
            .map_err(|error| Failure::new(Code::BadInput, format_args!("{name}: {error}")))?;
        let settings = PullSettings::default();
        Ok(Specimen::Tile(Box::new(TestedTile { tile, material: yarn.material, settings }), mass))
    }
}

fn mass(common: &Common, card: &CardFile) -> Option<f64> {
    common.areal_mass.or(card.areal_mass)
}

/// What a test on a shell needs beside in-plane stiffnesses.
fn needs(test: &Test) -> Needs {
    let (bending, mass) = match test {
        Test::Stretch(of) | Test::Strip(of) => (of.wrinkle, false),
        Test::KesBending(_) => (true, false),
        Test::Cantilever(_) | Test::PearLoop(_) | Test::Drape(_) | Test::Fast(_) => (true, true),
        _ => (false, false),
    };
    Needs { bending, mass }
}

/// The card of a fabric file: where `wale fit` puts it, or the one kept beside the file.
fn fitted(fabric: &Path) -> Result<PathBuf, Failure> {
    // That it is a fabric file at all is said before what is missing beside it.
    FabricFile::read(fabric).map_err(|error| match error {
        FabricFileError::Fabric(error) => scene_failure(error),
        FabricFileError::Curve(error) => Failure::new(Code::BadInput, error),
    })?;
    let card = fabric.with_extension("fit").join("card.toml");
    let kept = fabric.with_file_name("card.toml");
    for card in [&card, &kept] {
        if card.is_file() {
            return Ok(card.clone());
        }
    }
    let message = format!(
        "{} has no card yet, neither {} nor card.toml beside it: run `wale fit {}` first",
        fabric.display(),
        card.display(),
        fabric.display()
    );
    Err(Failure::new(Code::BadInput, message))
}

fn beside(card: &Path, name: &str) -> PathBuf {
    card.parent().unwrap_or(Path::new("")).join(name)
}

fn missing(card: &Path, file: &Path, why: &str) -> Failure {
    Failure::new(Code::BadInput, format_args!("{}: {} is not there: {why}", card.display(), file.display()))
}

fn read(path: &Path) -> Result<String, Failure> {
    std::fs::read_to_string(path).map_err(|error| Failure::io(path, "read", error))
}

/// A scene with all that it names written out.
fn resolved(path: &Path) -> Result<String, Failure> {
    Scene::read(path).and_then(|scene| scene.resolved_toml()).map_err(scene_failure)
}
