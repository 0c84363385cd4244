//! What a fit says.

use std::path::Path;

use serde_json::json;
use wale::energy::{BendingStiffness, MembraneStiffness};
use wale_lab::fabric_file::{FabricFile, direction_name};
use wale_lab::network_fit::NetworkFit;
use wale_lab::report::Conclusion;
use wale_lab::shell::of_fabric::ShellFit;
use wale_lab::yarn_fit::YarnFitError;
use wale_lab::yarn_fit::ablation::AblationKind;
use wale_lab::yarn_fit::run::YarnFit;
use wale_lab::yarn_tile::RodParameter;

use crate::exit::Failure;
use crate::say;

/// How the tables were understood.
pub fn reading(fabric: &FabricFile) -> Result<(), Failure> {
    say!("{}", if fabric.title.is_empty() { "a fabric" } else { &fabric.title })?;
    for test in &fabric.stretch {
        let (stretch, force) = (test.curve.stretch.last().copied(), test.curve.force.last().copied());
        let (stretch, force) = (stretch.unwrap_or_default(), force.unwrap_or_default());
        say!(
            "  stretch along the {}: {} samples to {:.1} %, {force:.3} N",
            direction_name(test.direction),
            test.curve.stretch.len(),
            100.0 * stretch
        )?;
        for line in [&test.curve.table_read_as].into_iter().chain(&test.curve.read_as) {
            say!("    {line}")?;
        }
    }
    for test in &fabric.bending {
        say!("  loops along the {}: {}", direction_name(test.direction), test.curve.distance.len())?;
        for line in [&test.curve.table_read_as].into_iter().chain(&test.curve.read_as) {
            say!("    {line}")?;
        }
    }
    for test in &fabric.rigidity {
        say!("  bending rigidity along the {}: {:.3} µN·m", direction_name(test.direction), 1e6 * test.value)?;
    }
    for gap in fabric.gaps() {
        say!("  {gap}")?;
    }
    Ok(())
}

/// The same as JSON.
pub fn read_json(fabric: &FabricFile) -> serde_json::Value {
    json!({
        "title": fabric.title,
        "stretch": fabric.stretch.iter().map(|test| json!({
            "direction_rad": test.direction,
            "stretch": test.curve.stretch,
            "force_N": test.curve.force,
            "compression": test.curve.compression,
            "read_as": test.curve.read_as,
            "table_read_as": test.curve.table_read_as,
        })).collect::<Vec<_>>(),
        "bending": fabric.bending.iter().map(|test| json!({
            "direction_rad": test.direction,
            "clamp_distance_m": test.curve.distance,
            "aspect_ratio": test.curve.aspect_ratio,
            "read_as": test.curve.read_as,
            "table_read_as": test.curve.table_read_as,
        })).collect::<Vec<_>>(),
        "rigidity": fabric.rigidity.iter().map(|test| json!({
            "direction_rad": test.direction,
            "value_N_m": test.value,
        })).collect::<Vec<_>>(),
        "gaps": fabric.gaps(),
    })
}

/// What was found, as JSON.
pub fn found_json(
    folder: &Path,
    found: &ShellFit,
    yarn: Option<&YarnFit>,
    contacts: Option<&NetworkFit>,
    ablations: &[(AblationKind, Option<YarnFitError>, Conclusion)],
) -> serde_json::Value {
    // Infinite factors are no numbers in JSON.
    let factors = |within: &[f64]| within.iter().map(|w| w.is_finite().then_some(*w)).collect::<Vec<Option<f64>>>();
    let used = found.membrane.stiffness.used();
    json!({
        "folder": folder,
        "membrane_N_per_m": found.membrane.stiffness.to_array()[..used],
        "membrane_within": factors(&found.card.membrane_within[..used]),
        "force_error": found.membrane.force_error,
        "compression_error": found.membrane.compression_error,
        "bending_within": found.bending.as_ref().map(|fit| factors(&fit.least_squares.uncertainty)),
        "bending_N_m": found.bending.as_ref().map(|fit| fit.stiffness.to_array()),
        "aspect_error": found.bending.as_ref().map(|fit| fit.aspect_error),
        "yarn": yarn.map(|yarn| json!({
            "names": RodParameter::NAMES,
            "parameters_SI": yarn.material.parameters(),
            "within": factors(&yarn.within),
            "error": yarn.error,
            "cost": yarn.cost,
            "evaluations": yarn.evaluations,
            "open": yarn.open,
        })),
        "contacts": contacts.map(|contacts| json!({
            "names": contacts.kinds.map(|kind| kind.name()),
            "stiffness_SI": contacts.stiffness,
            "within": factors(&contacts.within),
            "error": contacts.error,
            "undetermined": contacts.undetermined,
            "at_bound": contacts.at_bound,
        })),
        "ablations": ablations.iter().map(|(kind, error, conclusion)| json!({
            "name": kind.name(),
            "error": error,
            "conclusion": conclusion.sentence,
            "as_the_paper": conclusion.as_the_paper,
        })).collect::<Vec<_>>(),
        "open": found.open,
    })
}

/// What was found, in lines.
pub fn lines(found: &ShellFit, yarn: Option<&YarnFit>, contacts: Option<&NetworkFit>) -> Vec<String> {
    let mut lines = vec![format!(
        "thin shell: mean error {:.1} % of force, {:.1} % of compression",
        100.0 * found.membrane.force_error,
        100.0 * found.membrane.compression_error
    )];
    let (values, used) = (found.membrane.stiffness.to_array(), found.membrane.stiffness.used());
    for ((name, value), within) in
        MembraneStiffness::NAMES.into_iter().zip(values).zip(found.card.membrane_within).take(used)
    {
        let known = known_within(within);
        let unit = if name == "m_xy" { "   " } else { "N/m" };
        lines.push(format!("  {name} {value:10.3} {unit}   {known}"));
    }
    if let Some(bending) = &found.bending {
        lines.push(format!("bending: mean error {:.1} % of the loops' aspect", 100.0 * bending.aspect_error));
        let within = bending.least_squares.uncertainty;
        for ((name, value), within) in BendingStiffness::NAMES.into_iter().zip(bending.stiffness.to_array()).zip(within)
        {
            lines.push(format!("  {name} {:10.3} µN·m   {}", 1e6 * value, known_within(within)));
        }
    }
    if let Some(yarn) = yarn {
        lines.push(format!("yarn in full contact: {}", errors(&yarn.error)));
        let values = yarn.material.parameters();
        for (k, (name, within)) in RodParameter::NAMES.into_iter().zip(yarn.within).enumerate() {
            let (factor, unit) = UNITS[k];
            let known = match within {
                1.0 => "held".to_owned(),
                within if within > 3.0 => "not determined".to_owned(),
                within if k == RodParameter::Onset as usize => format!("± {:.1} %", 5.0 * within.ln()),
                within => format!("× or ÷ {within:.2}"),
            };
            lines.push(format!("  {name:<5} {:12.5} {unit:<7} {known}", factor * values[k]));
        }
        lines.extend(yarn.open.iter().map(|open| format!("  {open}")));
    }
    if let Some(contacts) = contacts {
        lines.push(format!("contact model of scenes: {}", errors(&contacts.error)));
        for (k, kind) in contacts.kinds.into_iter().enumerate().filter(|(k, _)| contacts.stiffness[*k] > 0.0) {
            let name = kind.name();
            let known = match contacts.within[k] {
                _ if contacts.at_bound.contains(&name) => "at its bound".to_owned(),
                within if within > 3.0 => "not determined".to_owned(),
                within => format!("× or ÷ {within:.2}"),
            };
            let (factor, unit) = if kind.is_bending() { (1e9, "mN mm^2") } else { (1.0, "N") };
            lines.push(format!("  {name:<12} {:12.5} {unit:<7} {known}", factor * contacts.stiffness[k]));
        }
    }
    lines.extend(found.open.iter().map(|open| format!("  {open}")));
    lines
}

/// The factor within which a number is known, in words.
fn known_within(factor: f64) -> String {
    if factor <= 3.0 { format!("× or ÷ {factor:.2}") } else { "not determined".to_owned() }
}

fn errors(error: &YarnFitError) -> String {
    let [comfort, full, compression] = [error.comfort, error.full, error.compression].map(|part| 100.0 * part);
    format!(
        "mean error {comfort:.1} % of the stress in comfort, {full:.1} % over the whole range, {compression:.1} % of compression"
    )
}

/// How the numbers of a yarn are shown.
const UNITS: [(f64, &str); RodParameter::COUNT] =
    [(1.0, "N"), (1.0, "N"), (100.0, "%"), (1e9, "mN mm^2"), (1e3, "mm"), (1e-3, "kJ/m^2"), (1e-3, "kPa")];
