//! `wale fit`: the thin shell and the yarn of a fabric file, by its stretch and bending tests; of several, one yarn for all.

mod ablations;
mod deliver;
mod places;
mod questions;
mod tell;
mod yarn;

use std::io;
use std::path::Path;

use wale::record::RecordError;
use wale::record::atomic_file::write_atomically;
use wale_lab::card_file::YarnCard;
use wale_lab::fabric_file::{FabricFile, FabricFileError};
use wale_lab::foretold::foretell;
use wale_lab::shell::membrane_fit::{MembraneFitSettings, MembraneLaw};
use wale_lab::shell::of_fabric::{ShellFit, ShellFitError, fit_shell};
use wale_lab::uniform_test::TestedTile;
use wale_lab::yarn_fit::PullSettings;
use wale_lab::yarn_fit::of_fabric::{bending_is_known, structure_tile, yarn_problems};
use wale_lab::yarn_fit::problem::YarnProblem;

use crate::arguments::fit::{Fit, Law};
use crate::exit::{Code, Failure};
use crate::opened::scene_failure;
use crate::signals::Signals;
use crate::{machine, output};
use deliver::Fitted;
use places::Places;

/// Reads, fits, tells and writes.
pub fn fit(arguments: &Fit) -> Result<(), Failure> {
    let places = Places::of(arguments)?;
    let folder = &places.folder;
    machine::use_threads(arguments.results.threads.map(usize::from))?;
    if arguments.elsewhere.answer {
        return questions::answer(folder);
    }
    if let Some(file) = &arguments.elsewhere.tell {
        return questions::tell(folder, file);
    }
    if arguments.elsewhere.ask && !arguments.results.force && folder.join(yarn::PROBLEM).exists() {
        return questions::print(&yarn::ask(arguments, folder, &yarn::problems(folder)?)?);
    }
    let fabrics: Vec<FabricFile> = arguments.fabrics.iter().map(|path| read(path)).collect::<Result<_, _>>()?;
    if arguments.read_only {
        return told_apart(arguments.results.json, &fabrics, tell::read_json, tell::reading);
    }
    if places.taken(arguments) && !arguments.results.force {
        let mend = "there is a fit in it: choose another with `--out`, or overwrite it with `--force`";
        return Err(RecordError::NotEmpty { path: folder.clone(), mend }.into());
    }
    let with_yarn = with_yarn(arguments, &fabrics)?;
    let named = |index: usize, error: &dyn std::fmt::Display| refused(&arguments.fabrics[index], error);
    // What is wrong with the yarns is said before a shell is fitted.
    for (index, fabric) in fabrics.iter().enumerate().filter(|_| with_yarn) {
        structure_tile(fabric).map_err(|error| named(index, &error))?;
    }
    let shells = arguments.fabrics.iter().zip(&fabrics).map(|(path, fabric)| shell(arguments, path, fabric));
    let mut shells: Vec<ShellFit> = shells.collect::<Result<_, _>>()?;
    if !with_yarn {
        if arguments.elsewhere.ask {
            return Err(named(0, &"only the fit of a yarn asks questions; add [structure] to the fabric file"));
        }
        let (fabric, shell) = (fabrics.into_iter().next(), shells.pop());
        let fitted = fabric.zip(shell).map(|(fabric, shell)| Fitted {
            fabric,
            shell,
            yarn: None,
            network: None,
            ablated: Vec::new(),
            missing: Vec::new(),
        });
        return deliver(arguments, &places, &fitted.into_iter().collect::<Vec<_>>());
    }
    let ablation = yarn::ablation(arguments);
    let pairs: Vec<(&FabricFile, &ShellFit)> = fabrics.iter().zip(&shells).collect();
    if let Some(index) =
        pairs.iter().position(|(fabric, shell)| ablation.with_bending && !bending_is_known(fabric, shell))
    {
        return Err(named(
            index,
            &"--with-bending asks for [[rigidity]] in the fabric file, or for loops as [[bending]] and areal_mass",
        ));
    }
    let problems = yarn_problems(&pairs, ablation).map_err(|error| named(0, &error))?;
    yarn::prepare(folder, &problems, arguments.results.force)?;
    if arguments.elsewhere.ask {
        return questions::print(&yarn::ask(arguments, folder, &problems)?);
    }
    let fitted = fit_yarn(arguments, &places, fabrics, shells, problems)?;
    deliver(arguments, &places, &fitted)
}

/// The yarn, its ablations if they are wanted, and the contact model of each fabric.
fn fit_yarn(
    arguments: &Fit,
    places: &Places,
    fabrics: Vec<FabricFile>,
    shells: Vec<ShellFit>,
    problems: Vec<YarnProblem>,
) -> Result<Vec<Fitted>, Failure> {
    let folder = &places.folder;
    let signals = Signals::listen().map_err(|error| Failure::new(Code::Io, error))?;
    let tells = !arguments.results.json;
    let task = yarn::Task { folder, problems: &problems, way: yarn::way(arguments), name: "yarn", tells };
    let Some(yarns) = task.fit(&signals)? else {
        let what = "the tile could be tested nowhere within the bounds: do its yarns pass through each other?";
        return Err(Failure::new(Code::NotConverged, format_args!("{}: {what}", arguments.fabrics[0].display())));
    };
    let mut ablated = ablations::Ablations { of_fabric: vec![Vec::new(); fabrics.len()], missing: Vec::new() };
    if arguments.ablations {
        ablated = ablations::ablations(arguments, folder, &fabrics, &shells, &yarns, &signals)?;
    }
    let mut fitted = Vec::with_capacity(fabrics.len());
    let yarns = problems.into_iter().zip(yarns);
    for (((fabric, mut shell), yarn), ablated_here) in fabrics.into_iter().zip(shells).zip(yarns).zip(ablated.of_fabric)
    {
        let fit = &yarn.1.fit;
        shell.card.yarn = Some(YarnCard { material: fit.material, within: fit.within, tile: deliver::TILE.to_owned() });
        let tested =
            TestedTile { tile: yarn.1.tile.clone(), material: fit.material, settings: PullSettings::default() };
        foretell(&fabric, &mut shell, &tested);
        let network = yarn::fit_contacts(&fabric, &mut shell);
        let missing = ablated.missing.clone();
        fitted.push(Fitted { fabric, shell, yarn: Some(yarn), network, ablated: ablated_here, missing });
    }
    Ok(fitted)
}

/// Whether a yarn is fitted: where the file says how it lies. Several fabrics have nothing in common but their yarn.
fn with_yarn(arguments: &Fit, fabrics: &[FabricFile]) -> Result<bool, Failure> {
    let lies = |fabric: &FabricFile| fabric.structure.is_some();
    if fabrics.len() > 1 {
        if arguments.shell_only {
            let what = "several fabrics are fitted together by their yarn; fit their shells one by one";
            return Err(Failure::new(Code::Usage, what));
        }
        if let Some(index) = fabrics.iter().position(|fabric| !lies(fabric)) {
            let what = "nothing says how the yarns lie; add [structure] with a scene or a tile";
            return Err(refused(&arguments.fabrics[index], &what));
        }
    } else if arguments.ablations && !fabrics.iter().all(lies) {
        let what = "only the fit of a yarn has ablations; add [structure] to the fabric file";
        return Err(refused(&arguments.fabrics[0], &what));
    }
    Ok(!arguments.shell_only && fabrics.iter().all(lies))
}

fn refused(path: &Path, error: &dyn std::fmt::Display) -> Failure {
    Failure::new(Code::BadInput, format_args!("{}: {error}", path.display()))
}

fn read(path: &Path) -> Result<FabricFile, Failure> {
    FabricFile::read(path).map_err(|error| match error {
        FabricFileError::Fabric(error) => scene_failure(error),
        FabricFileError::Curve(error) => Failure::new(Code::BadInput, error),
    })
}

fn shell(arguments: &Fit, path: &Path, fabric: &FabricFile) -> Result<ShellFit, Failure> {
    let law = match arguments.law {
        Law::Quadratic => MembraneLaw::Quadratic,
        Law::Stiffening => MembraneLaw::Stiffening,
    };
    let settings = MembraneFitSettings { law, targets: yarn::TARGETS, ..MembraneFitSettings::default() };
    fit_shell(fabric, &settings).map_err(|error| {
        let code = match error {
            ShellFitError::NoStretchTest => Code::BadInput,
            ShellFitError::Shell(_) => Code::NotConverged,
        };
        Failure::new(code, format_args!("{}: {error}", path.display()))
    })
}

/// Tells one after the other; as JSON, a list where there are several.
fn told_apart<T>(
    as_json: bool,
    all: &[T],
    json: impl Fn(&T) -> serde_json::Value,
    say: impl Fn(&T) -> Result<(), Failure>,
) -> Result<(), Failure> {
    match all {
        [one] if as_json => output::json(&json(one)),
        _ if as_json => output::json(&serde_json::Value::Array(all.iter().map(json).collect())),
        _ => all.iter().try_for_each(say),
    }
}

fn deliver(arguments: &Fit, places: &Places, fitted: &[Fitted]) -> Result<(), Failure> {
    let all: Vec<(&Fitted, &Path)> = fitted.iter().zip(places.of_fabric.iter().map(|path| path.as_path())).collect();
    for (one, folder) in &all {
        one.write(folder)?;
    }
    let json = arguments.results.json;
    told_apart(json, &all, |(one, folder)| one.json(folder), |(one, folder)| one.say(folder))
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    Ok(write_atomically(path, |out| io::Write::write_all(out, bytes))?)
}
