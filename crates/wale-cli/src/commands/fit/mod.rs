//! `wale fit`: the thin shell and the yarn of a fabric file, by its stretch and bending tests.

mod questions;
mod report;
mod tell;
mod yarn;

use std::io;
use std::path::{Path, PathBuf};

use wale::record::RecordError;
use wale::record::atomic_file::write_atomically;
use wale::scene::Scene;
use wale_lab::card_file::{CardFile, YarnCard};
use wale_lab::fabric_file::{FabricFile, FabricFileError};
use wale_lab::fabric_fit::{FabricFit, FabricFitError, fit_fabric};
use wale_lab::network_fit::NetworkFit;
use wale_lab::shell::membrane_fit::{MembraneFitSettings, MembraneLaw};
use wale_lab::yarn_fit::run::YarnFit;
use wale_lab::yarn_tile::{YarnTile, write_pattern};

use crate::arguments::fit::{Fit, Law};
use crate::exit::{Code, Failure};
use crate::opened::scene_failure;
use crate::{machine, output, say};

/// Files of a finished fit; what they are is in `docs/topics/fabric-files.md`.
const RESULTS: [&str; 6] = ["card.toml", "curves.csv", "curves.svg", "report.html", "tile.pyp", "swatch.toml"];

/// Reads, fits, tells and writes.
pub fn fit(arguments: &Fit) -> Result<(), Failure> {
    let folder = arguments.out.clone().unwrap_or_else(|| arguments.fabric.with_extension("fit"));
    machine::use_threads(arguments.threads.map(usize::from))?;
    if arguments.elsewhere.answer {
        return questions::answer(&folder);
    }
    if let Some(file) = &arguments.elsewhere.tell {
        return questions::tell(&folder, file);
    }
    if arguments.elsewhere.ask && !arguments.force && folder.join(yarn::PROBLEM).exists() {
        return questions::print(&yarn::ask(arguments, &folder, &yarn::problem(&folder)?)?);
    }
    let fabric = FabricFile::read(&arguments.fabric).map_err(|error| match error {
        FabricFileError::Fabric(error) => scene_failure(error),
        FabricFileError::Curve(error) => Failure::new(Code::BadInput, error),
    })?;
    if arguments.read_only {
        return if arguments.json { output::json(&tell::read_json(&fabric)) } else { tell::reading(&fabric) };
    }
    let taken = RESULTS.iter().any(|name| folder.join(name).exists());
    if taken && !arguments.force {
        let mend = "there is a fit in it: choose another with `--out`, or overwrite it with `--force`";
        return Err(RecordError::NotEmpty { path: folder, mend }.into());
    }
    // What is wrong with the yarns is said before the shell is fitted.
    let with_yarn = fabric.structure.is_some() && !arguments.shell_only;
    if with_yarn {
        yarn::check(arguments, &fabric)?;
    }
    let mut shell = fit_shell(arguments, &fabric)?;
    let problem = if with_yarn { Some(yarn::problem_of(arguments, &fabric, &shell, &folder)?) } else { None };
    let yarn = match (problem, arguments.elsewhere.ask) {
        (Some(problem), true) => return questions::print(&yarn::ask(arguments, &folder, &problem)?),
        (Some(problem), false) => Some(yarn::fit(arguments, &folder, &problem)?),
        (None, true) => {
            let what = "only the fit of a yarn asks questions; add [structure] to the fabric file";
            return Err(Failure::new(Code::BadInput, format_args!("{}: {what}", arguments.fabric.display())));
        }
        (None, false) => None,
    };
    if let Some(found) = &yarn {
        let tile = RESULTS[4].to_owned();
        shell.card.yarn = Some(YarnCard { material: found.fit.material, within: found.fit.within, tile });
    }
    let network = if with_yarn { yarn::fit_contacts(&fabric, &mut shell) } else { None };
    deliver(arguments, &folder, &fabric, &Fitted { shell, yarn, network })
}

fn fit_shell(arguments: &Fit, fabric: &FabricFile) -> Result<FabricFit, Failure> {
    let path = &arguments.fabric;
    let law = match arguments.law {
        Law::Quadratic => MembraneLaw::Quadratic,
        Law::Stiffening => MembraneLaw::Stiffening,
    };
    let settings = MembraneFitSettings { law, targets: yarn::TARGETS, ..MembraneFitSettings::default() };
    fit_fabric(fabric, &settings).map_err(|error| {
        let code = match error {
            FabricFitError::NoStretchTest => Code::BadInput,
            FabricFitError::Shell(_) => Code::NotConverged,
        };
        Failure::new(code, format_args!("{}: {error}", path.display()))
    })
}

/// A yarn that was fitted, and the tile with its rest shapes.
struct FittedYarn {
    fit: YarnFit,
    tile: YarnTile,
}

/// What was fitted.
struct Fitted {
    shell: FabricFit,
    yarn: Option<FittedYarn>,
    /// A scene with the contact model's stiffnesses.
    network: Option<(Scene, NetworkFit)>,
}

fn deliver(
    arguments: &Fit,
    folder: &PathBuf,
    fabric: &FabricFile,
    Fitted { shell, yarn, network }: &Fitted,
) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|error| Failure::io(folder, "create", error))?;
    let fit = yarn.as_ref().map(|yarn| &yarn.fit);
    let contacts = network.as_ref().map(|(_, fit)| fit);
    let svg = report::plot(fabric, shell, fit).to_svg().map_err(|error| Failure::new(Code::BadInput, error))?;
    write(&folder.join("curves.csv"), report::curves_csv(fabric, shell, fit).as_bytes())?;
    write(&folder.join("curves.svg"), svg.as_bytes())?;
    write(&folder.join("report.html"), report::page(fabric, &tell::lines(shell, fit, contacts), &svg).as_bytes())?;
    if let Some(yarn) = yarn {
        write(&folder.join("tile.pyp"), write_pattern(&yarn.tile).as_bytes())?;
    }
    if let Some((scene, _)) = network {
        let text = scene.resolved_toml().map_err(|error| Failure::new(Code::Bug, error))?;
        write(&folder.join("swatch.toml"), text.as_bytes())?;
    }
    // Last: a folder with a card has all the rest.
    let card = CardFile { open: shell.open.clone(), ..shell.card.clone() };
    write(&folder.join("card.toml"), card.to_toml().as_bytes())?;
    if arguments.json {
        return output::json(&tell::found_json(folder, shell, fit, contacts));
    }
    tell::reading(fabric)?;
    for line in tell::lines(shell, fit, contacts) {
        say!("{line}")?;
    }
    say!("  {}", folder.join("report.html").display())
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    Ok(write_atomically(path, |out| io::Write::write_all(out, bytes))?)
}
