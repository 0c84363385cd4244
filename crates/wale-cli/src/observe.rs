//! What is written of a step: the row of the metrics table and the line of the log.

use serde_json::{Map, Value, json};
use wale::model::Frame;
use wale::record::Column;
use wale::simulation::StepReport;

/// Columns of the metrics table for the reports of one simulation.
#[must_use]
pub fn columns(report: &StepReport) -> Vec<Column> {
    let mut columns = vec![Column::new("time", "s"), Column::new("step size", "s")];
    columns.extend(energies(report).map(|(name, _)| Column::new(format!("{name} energy"), "J")));
    columns.extend([
        Column::new("largest stretch", "-"),
        Column::new("smallest spacing", "m"),
        Column::new("obstacle contacts", "-"),
    ]);
    columns.extend(["x", "y", "z"].map(|axis| Column::new(format!("extent {axis}"), "m")));
    for grip in &report.grips {
        for (what, unit) in [("force", "N"), ("displacement", "m")] {
            columns.extend(["x", "y", "z"].map(|axis| Column::new(format!("{} {what} {axis}", grip.name), unit)));
        }
        columns.push(Column::new(format!("{} work", grip.name), "J"));
    }
    columns
}

/// Values of the columns for a report and the frame at its end.
#[must_use]
pub fn values(report: &StepReport, frame: &Frame) -> Vec<f64> {
    let mut values = vec![report.time, report.step_size];
    values.extend(energies(report).map(|(_, energy)| energy));
    values.extend([report.largest_stretch, report.smallest_spacing, report.contacts as f64]);
    values.extend(extent(frame));
    for grip in &report.grips {
        values.extend(grip.force.to_array());
        values.extend(grip.displacement.to_array());
        values.push(grip.work);
    }
    values
}

/// The line of the log; nothing in it comes from a clock.
#[must_use]
pub fn entry(report: &StepReport) -> Value {
    let energies: Map<String, Value> =
        energies(report).map(|(name, energy)| (name.to_owned(), json!(energy))).collect();
    json!({
        "step": report.step,
        "time": report.time,
        "step_size": report.step_size,
        "rejected": report.rejected,
        "newton_iterations": report.newton_iterations,
        "linear_iterations": report.linear_iterations,
        "converged": report.converged,
        "energies": energies,
        "largest_stretch": report.largest_stretch,
        "smallest_spacing": report.smallest_spacing,
        "contacts": report.contacts,
    })
}

/// Energies of the fabric; the terms that only belong to the stepping are left out.
fn energies(report: &StepReport) -> impl Iterator<Item = (&'static str, f64)> {
    report
        .energies
        .iter()
        .filter(|(name, _)| *name != "inertia" && !name.ends_with("damping"))
        // A sum of nothing is minus zero.
        .map(|(name, energy)| (*name, energy + 0.0))
}

fn extent(frame: &Frame) -> [f64; 3] {
    std::array::from_fn(|axis| {
        let (low, high) = frame
            .positions
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x[axis]), high.max(x[axis])));
        if low <= high { high - low } else { 0.0 }
    })
}
