//! What stands behind the numbers of a scene: the paper's table, a preset, or the card of a fabric that was fitted.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::beside::path_beside;
use super::{Failure, fabric};
use crate::scene::error::Complaint;
use crate::scene::schema::{FabricText, PresetName, SceneText, YarnText};
use crate::scene::text_file::TextFile;

/// Numbers that a scene does not have to give.
pub(super) struct Base {
    pub yarn: YarnText,
    /// Of other yarns, by their names.
    pub yarns: BTreeMap<String, YarnText>,
    pub fabric: FabricText,
    /// Files that were opened for them.
    pub inputs: Vec<PathBuf>,
}

impl Base {
    fn new(yarn: YarnText, fabric: FabricText) -> Self {
        Self { yarn, yarns: BTreeMap::new(), fabric, inputs: Vec::new() }
    }
}

/// The part of a card that scenes read: it names the scene that has its contact model's numbers.
#[derive(Deserialize)]
struct CardText {
    contacts: Option<ContactsText>,
}

#[derive(Deserialize)]
struct ContactsText {
    scene: String,
}

/// What stands behind a scene's numbers.
pub(super) fn base(text: &SceneText, directory: Option<&Path>) -> Result<Base, Failure> {
    let yarn = text.yarn.as_ref();
    let (preset, card) = (yarn.and_then(|yarn| yarn.preset), yarn.and_then(|yarn| yarn.card.as_deref()));
    let complain = |key: &str, what: &str| {
        Err(Complaint::new(key, what).why("both say everything about the yarn").mend("keep one of them").into())
    };
    match (&text.fabric.paper_table_1, preset, card) {
        (Some(_), Some(_), _) => complain("yarn.preset", "the yarn has a preset and the fabric a paper_table_1"),
        (Some(_), _, Some(_)) => complain("yarn.card", "the yarn has a card and the fabric a paper_table_1"),
        (_, Some(_), Some(_)) => complain("yarn.card", "the yarn has a preset and a card"),
        (Some(table), None, None) => {
            let (yarn, fabric) = fabric::from_paper_table_1(table);
            Ok(Base::new(yarn, fabric))
        }
        (None, None, Some(card)) => of_card(&text.fabric, card, directory),
        (None, preset, None) => {
            let preset = preset.unwrap_or(PresetName::WorstedWool).read();
            Ok(Base::new(preset.yarn, preset.fabric))
        }
    }
}

/// The numbers of a fabric that was fitted.
fn of_card(said: &FabricText, card: &str, directory: Option<&Path>) -> Result<Base, Failure> {
    const KEY: &str = "yarn.card";
    if said.loop_length.is_some() || said.model_loop_length.is_some() {
        let key = if said.loop_length.is_some() { "loop_length" } else { "model_loop_length" };
        return Err(Complaint::new(format!("fabric.{key}"), format!("{key} beside a card"))
            .why("the card was fitted to loops of its own length, and its other lengths go with them")
            .mend(format!("leave {key} out"))
            .into());
    }
    let elsewhere = |error| Failure::Elsewhere(Box::new(error));
    let path = path_beside(KEY, card, directory)?;
    let file = TextFile::read(&path, "card").map_err(elsewhere)?;
    let text: CardText = file.parse().map_err(elsewhere)?;
    let Some(contacts) = text.contacts else {
        return Err(Complaint::new(KEY, "the card has no [contacts]")
            .why("scenes are of the contact model, which is fitted where the fabric file has a chart or a draft")
            .mend("fit the fabric again with `wale fit`, with a scene under [structure]")
            .into());
    };
    let beside = match path_beside("contacts.scene", &contacts.scene, file.directory()) {
        Ok(beside) => beside,
        Err(complaint) => return Err(elsewhere(file.complain(complaint))),
    };
    let scene: SceneText =
        TextFile::read(&beside, "scene of the card").and_then(|file| file.parse()).map_err(elsewhere)?;
    if scene.fabric.weave.is_some() != said.weave.is_some() {
        let kind = |woven: bool| if woven { "a weave" } else { "a knit" };
        let what =
            format!("the card is of {}, the fabric {}", kind(scene.fabric.weave.is_some()), kind(said.weave.is_some()));
        return Err(Complaint::new(KEY, what).mend("take the card of another fabric").into());
    }
    let inputs = vec![path, beside];
    Ok(Base { yarn: scene.yarn.unwrap_or_default(), yarns: scene.yarns, fabric: scene.fabric, inputs })
}
