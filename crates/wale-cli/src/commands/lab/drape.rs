//! The drape test, from several small pushes.

use std::f64::consts::TAU;
use std::fmt::Write;

use rayon::prelude::*;
use wale::picture::{Plot, Series};
use wale_lab::virtual_test::units::{CM2, MM, PERCENT};
use wale_lab::virtual_test::{DrapeResult, DrapeTest};

use super::card::Card;
use super::failure::TestFailure;
use super::report::{Extra, Group, Number, Report, digits, heads};
use super::sheet_picture::sheet_picture;
use crate::arguments::lab::Drape;

/// Files beside table, plot and numbers.
pub const EXTRAS: [&str; 2] = ["-sheet.svg", "-sheet.obj"];

pub fn drape(card: &Card, of: &Drape) -> Result<Report, TestFailure> {
    // The command line sees to it, a question from elsewhere may not.
    if !(1..=1000).contains(&of.starts) {
        return Err(TestFailure::bad_input(format_args!("starts is {}, and must be 1 to 1000", of.starts)));
    }
    let test = DrapeTest { specimen: of.specimen, support: of.support, edge: of.edge, ..DrapeTest::default() };
    let found: Vec<DrapeResult> = (1..=of.starts)
        .into_par_iter()
        .map(|start| DrapeTest { start, ..test }.run(&card.shell))
        .collect::<Vec<_>>()
        .into_iter()
        .collect::<Result<_, _>>()?;
    let group = |(index, one): (usize, &DrapeResult)| Group {
        name: format!("start {}", index + 1),
        direction: None,
        numbers: vec![
            Number::new("drape_coefficient", one.coefficient, "drape coefficient", PERCENT, "%"),
            Number::count("nodes", one.nodes, "nodes"),
            Number::new("shadow_m2", one.shadow, "shadow", CM2, "cm²"),
            Number::new("specimen_m2", one.specimen, "specimen", CM2, "cm²"),
            Number::new("support_m2", one.support, "support", CM2, "cm²"),
            Number::new("depth_m", one.depth, "hangs down by", MM, "mm"),
        ],
    };
    let mut groups: Vec<Group> = found.iter().enumerate().map(group).collect();
    if found.len() > 1 {
        let count = found.len() as f64;
        let mean = found.iter().map(|one| one.coefficient).sum::<f64>() / count;
        let spread = (found.iter().map(|one| (one.coefficient - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt();
        groups.push(Group {
            name: "all".to_owned(),
            direction: None,
            numbers: vec![
                Number::new("mean_drape_coefficient", mean, "mean coefficient", PERCENT, "%"),
                Number::new("deviation_of_drape_coefficient", spread, "standard deviation", PERCENT, "%"),
            ],
        });
    }
    let angle = |k: usize, count: usize| TAU * k as f64 / count as f64;
    let rows = found.iter().enumerate().flat_map(|(start, one)| {
        let count = one.outline.len();
        one.outline.iter().enumerate().map(move |(k, r)| vec![(start + 1) as f64, angle(k, count), *r])
    });
    let closed = |name: String, radius: &dyn Fn(usize) -> f64| {
        let at = |k: usize| {
            let (sin, cos) = angle(k, 720).sin_cos();
            (radius(k % 720) * cos / MM, radius(k % 720) * sin / MM)
        };
        let (xs, ys) = (0..=720).map(at).unzip();
        Series { name, xs, ys }
    };
    let mut series = vec![
        closed("support".to_owned(), &|_| 0.5 * test.support),
        closed("specimen".to_owned(), &|_| 0.5 * test.specimen),
    ];
    series.extend(found.iter().enumerate().map(|(k, one)| closed(format!("shadow {}", k + 1), &|i| one.outline[i])));
    let first = &found[0];
    let mut remarks = vec![
        "folds do not touch each other: a limp sheet passes through itself, and its coefficient is too small"
            .to_owned(),
    ];
    remarks.extend(too_coarse(card, of.edge));
    Ok(Report {
        what: format!(
            "drape test (Cusick), {} cm on {} cm, {} triangles",
            digits(100.0 * test.specimen),
            digits(100.0 * test.support),
            first.triangles.len()
        ),
        groups,
        heads: heads(["start", "angle [rad]", "radius of the shadow [m]"]),
        rows: rows.collect(),
        plot: Plot::lines(&card.title, "along the weft [mm]", "along the warp [mm]", &series),
        remarks,
        extras: vec![
            Extra { suffix: EXTRAS[0].into(), text: sheet_picture(&first.places, &first.triangles) },
            Extra { suffix: EXTRAS[1].into(), text: obj(first) },
        ],
    })
}

/// A warning of a mesh that is too coarse for a limp sheet.
fn too_coarse(card: &Card, edge: f64) -> Option<String> {
    // B = 2k_θ of the direction that bends most easily.
    let rigidity = card.shell.bending.to_array().into_iter().fold(f64::INFINITY, |least, k| least.min(2.0 * k));
    let length = (rigidity / (card.shell.areal_mass * DrapeTest::default().gravity)).cbrt();
    (edge > length).then(|| {
        format!(
            "WARNING: edges of the mesh, {} mm, are longer than the bending length, {} mm: the sheet folds too little, and its coefficient is too large; make them shorter with --edge",
            digits(edge / MM),
            digits(length / MM)
        )
    })
}

fn obj(sheet: &DrapeResult) -> String {
    let mut text = String::from("# A draped specimen, metres, z up\n");
    for [x, y, z] in &sheet.places {
        let _ = writeln!(text, "v {x:.6} {y:.6} {z:.6}");
    }
    for [a, b, c] in &sheet.triangles {
        let _ = writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1);
    }
    text
}
