//! The same yarn fitted again, without each part of its model and by other ways.

use std::path::Path;

use wale_lab::fabric_file::FabricFile;
use wale_lab::report::bending_error;
use wale_lab::shell::of_fabric::ShellFit;
use wale_lab::yarn_fit::ablation::{Ablated, AblationKind};
use wale_lab::yarn_fit::of_fabric::{bending_is_known, yarn_problems};
use wale_lab::yarn_fit::problem::Question;

use super::yarn::{FittedYarn, Task, prepare, swarm, way};
use crate::arguments::fit::Fit;
use crate::exit::{Code, Failure};
use crate::signals::Signals;

/// Folder with the journals, in that of the fit.
const FOLDER: &str = "ablations";

/// What was found, fabric by fabric, and why some were not made.
pub struct Ablations {
    pub of_fabric: Vec<Vec<Ablated>>,
    pub missing: Vec<String>,
}

/// Makes them all, each from the answers of its own journal.
pub fn ablations(
    arguments: &Fit,
    folder: &Path,
    fabrics: &[FabricFile],
    shells: &[ShellFit],
    whole: &[FittedYarn],
    signals: &Signals,
) -> Result<Ablations, Failure> {
    let mut found = Ablations { of_fabric: vec![Vec::new(); fabrics.len()], missing: Vec::new() };
    let pairs: Vec<(&FabricFile, &ShellFit)> = fabrics.iter().zip(shells).collect();
    for kind in AblationKind::ALL {
        let Some(way) = kind.way(&way(arguments), swarm(arguments)) else { continue };
        if kind == AblationKind::WithBending && pairs.iter().any(|(fabric, shell)| !bending_is_known(fabric, shell)) {
            found.missing.push(format!(
                "{} ({}): not made, because no bending of this fabric was measured. It needs [[rigidity]] in the fabric file, or loops \
                 as [[bending]] and areal_mass.",
                kind.title(),
                kind.figure().unwrap_or_default()
            ));
            continue;
        }
        let problems = yarn_problems(&pairs, kind.ablation()).map_err(|error| Failure::new(Code::BadInput, error))?;
        let folder = folder.join(FOLDER).join(kind.name());
        prepare(&folder, &problems, arguments.results.force)?;
        let task =
            Task { folder: &folder, problems: &problems, way, name: kind.name(), tells: !arguments.results.json };
        let fits = task.fit(signals)?;
        for (fabric, of_fabric) in found.of_fabric.iter_mut().enumerate() {
            let fit = fits.as_ref().map(|fits| fits[fabric].fit.clone());
            let bending = match (&fit, kind) {
                (Some(fit), AblationKind::WithBending) => {
                    let at = whole[fabric].fit.material.parameters();
                    let samples = fit.targets.first().map_or(1, |target| target.points.len());
                    let question = Question { fabric, ..Question::of(at, samples, false) };
                    let of_whole = task.answer(&question)?;
                    of_whole.and_then(|of_whole| {
                        Some([bending_error(&fit.bending, &of_whole)?, bending_error(&fit.bending, &fit.evaluation)?])
                    })
                }
                _ => None,
            };
            of_fabric.push(Ablated { kind, fit, bending });
        }
    }
    Ok(found)
}
