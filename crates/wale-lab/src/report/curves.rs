//! Curves as tables.

use std::fmt::Write;

use super::Told;

/// Measured and fitted, point by point.
#[must_use]
pub fn curves_csv(told: &Told<'_>) -> String {
    let mut text = String::from(
        "model,direction [deg],stretch [-],measured force [N or N/m],fitted force [N or N/m],measured compression [-],fitted compression [-]\n",
    );
    for (test, points) in told.fabric.stretch.iter().zip(&told.shell.membrane.points) {
        for [target, point] in points {
            let measured = measured(test.curve.compression.is_some(), target.compression);
            let _ = writeln!(
                text,
                "shell between clamps [N],{},{},{},{},{measured},{}",
                test.direction.to_degrees(),
                target.stretch,
                target.force,
                point.force,
                point.compression
            );
        }
    }
    for (target, answers) in told.yarn.iter().flat_map(|(_, yarn)| yarn.targets.iter().zip(&yarn.evaluation.stretch)) {
        for ([stretch, force, compression], answer) in target.points.iter().zip(answers) {
            let measured = measured(target.compression, *compression);
            let _ = writeln!(
                text,
                "yarn in a uniform strip [N/m],{},{stretch},{force},{},{measured},{}",
                target.angle.to_degrees(),
                answer.point.force,
                answer.point.compression
            );
        }
    }
    text
}

/// What every fit of the yarn does beside what was measured, point by point.
#[must_use]
pub fn ablations_csv(told: &Told<'_>) -> String {
    let mut text = String::from(
        "fit,direction [deg],stretch [-],measured stress [N/m],stress [N/m],measured compression [-],compression [-]\n",
    );
    let whole = told.yarn.iter().map(|(_, fit)| ("whole", *fit));
    let others = told.ablated.iter().filter_map(|one| Some((one.kind.name(), one.fit.as_ref()?)));
    for (name, fit) in whole.chain(others) {
        for (target, answers) in fit.targets.iter().zip(&fit.evaluation.stretch) {
            for ([stretch, force, compression], answer) in target.points.iter().zip(answers) {
                let measured = measured(target.compression, *compression);
                let (degrees, found) = (target.angle.to_degrees(), answer.point);
                let _ = writeln!(
                    text,
                    "{name},{degrees},{stretch},{force},{},{measured},{}",
                    found.force, found.compression
                );
            }
        }
    }
    text
}

fn measured(was: bool, value: f64) -> String {
    if was { format!("{value}") } else { String::new() }
}
