//! Files of a fit, and what it prints.

use std::path::Path;

use wale::scene::Scene;
use wale_lab::card_file::{CardFile, ContactNumber, ContactStiffness, ContactsCard};
use wale_lab::fabric_file::FabricFile;
use wale_lab::network_fit::NetworkFit;
use wale_lab::report::{Conclusion, Told, ablation_figure, ablations_csv, conclusion, curves_csv, curves_figure, page};
use wale_lab::shell::of_fabric::ShellFit;
use wale_lab::yarn_fit::YarnFitError;
use wale_lab::yarn_fit::ablation::{Ablated, AblationKind};
use wale_lab::yarn_fit::problem::YarnProblem;
use wale_lab::yarn_tile::write_pattern;

use super::yarn::FittedYarn;
use super::{tell, write};
use crate::exit::{Code, Failure};
use crate::say;

/// The file with the yarn's tile, which the card names.
pub const TILE: &str = "tile.pyp";
/// The scene with the contact model's numbers, which the card names too.
const SCENE: &str = "swatch.toml";
/// The table of ablations.
pub const ABLATIONS: &str = "ablations.csv";
/// Files of a finished fit; what they are is in `docs/topics/fabric-files.md`.
pub const RESULTS: [&str; 6] = ["card.toml", "curves.csv", "curves.svg", "report.html", TILE, SCENE];

/// What was fitted to a fabric.
pub struct Fitted {
    pub fabric: FabricFile,
    pub shell: ShellFit,
    pub yarn: Option<(YarnProblem, FittedYarn)>,
    /// A scene with the contact model's stiffnesses.
    pub network: Option<(Scene, NetworkFit)>,
    pub ablated: Vec<Ablated>,
    pub missing: Vec<String>,
}

impl Fitted {
    fn told(&self) -> Told<'_> {
        Told {
            fabric: &self.fabric,
            shell: &self.shell,
            yarn: self.yarn.as_ref().map(|(problem, yarn)| (problem, &yarn.fit)),
            ablated: &self.ablated,
            missing: &self.missing,
        }
    }

    fn conclusions(&self) -> Vec<(AblationKind, Option<YarnFitError>, Conclusion)> {
        let told = self.told();
        let one = |one: &Ablated| Some((one.kind, one.error(), conclusion(&told, one)?));
        self.ablated.iter().filter_map(one).collect()
    }

    fn lines(&self) -> Vec<String> {
        let fit = self.yarn.as_ref().map(|(_, yarn)| &yarn.fit);
        let mut lines = tell::lines(&self.shell, fit, self.network.as_ref().map(|(_, fit)| fit));
        for (kind, _, conclusion) in self.conclusions() {
            lines.push(format!("{}: {}", kind.title(), conclusion.sentence));
        }
        lines.extend(self.missing.iter().cloned());
        lines
    }

    /// Writes all files into a folder, the card last: a folder with a card has all the rest.
    pub fn write(&self, folder: &Path) -> Result<(), Failure> {
        std::fs::create_dir_all(folder).map_err(|error| Failure::io(folder, "create", error))?;
        let bad = |error| Failure::new(Code::BadInput, error);
        let told = self.told();
        write(&folder.join("curves.csv"), curves_csv(&told).as_bytes())?;
        write(&folder.join("curves.svg"), curves_figure(&told).to_svg().map_err(bad)?.as_bytes())?;
        write(&folder.join("report.html"), page(&told, &self.lines()).map_err(bad)?.as_bytes())?;
        if let Some((_, yarn)) = &self.yarn {
            write(&folder.join(TILE), write_pattern(&yarn.tile).as_bytes())?;
        }
        if let Some((scene, _)) = &self.network {
            let text = scene.resolved_toml().map_err(|error| Failure::new(Code::Bug, error))?;
            write(&folder.join(SCENE), text.as_bytes())?;
        }
        if let Some(figure) = ablation_figure(&told) {
            write(&folder.join("ablations.svg"), figure.to_svg().map_err(bad)?.as_bytes())?;
            write(&folder.join(ABLATIONS), ablations_csv(&told).as_bytes())?;
        }
        let contacts = self.network.as_ref().map(|(_, fit)| contacts_card(fit));
        let card = CardFile { contacts, open: self.shell.open.clone(), ..self.shell.card.clone() };
        write(&folder.join(RESULTS[0]), card.to_toml().as_bytes())
    }

    /// What was found, as JSON.
    pub fn json(&self, folder: &Path) -> serde_json::Value {
        let fit = self.yarn.as_ref().map(|(_, yarn)| &yarn.fit);
        let contacts = self.network.as_ref().map(|(_, fit)| fit);
        tell::found_json(folder, &self.shell, fit, contacts, &self.conclusions())
    }

    /// What was found, in words.
    pub fn say(&self, folder: &Path) -> Result<(), Failure> {
        tell::reading(&self.fabric)?;
        for line in self.lines() {
            say!("{line}")?;
        }
        say!("  {}", folder.join("report.html").display())
    }
}

/// A contact model's numbers as the card has them.
fn contacts_card(fit: &NetworkFit) -> ContactsCard {
    let number = |k: usize| {
        let (kind, value) = (fit.kinds[k], fit.stiffness[k]);
        let stiffness =
            if kind.is_bending() { ContactStiffness::Bending(value) } else { ContactStiffness::Force(value) };
        ContactNumber { name: kind.name().to_owned(), stiffness, within: fit.within[k] }
    };
    let numbers = (0..fit.kinds.len()).filter(|&k| fit.stiffness[k] > 0.0).map(number).collect();
    ContactsCard { scene: SCENE.to_owned(), numbers }
}
