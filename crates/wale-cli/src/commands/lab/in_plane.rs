//! Tests that draw a fabric: swatch, strip, KES tensile, FAST.

use wale::picture::{Panel, Plot};
use wale_lab::shell::OutOfPlane;
use wale_lab::virtual_test::stretch::Until;
use wale_lab::virtual_test::units::{FAST_MM2, GF_CM_PER_CM2, GF_PER_CM, MM, PERCENT, UN_M};
use wale_lab::virtual_test::{FastTest, KesTensileResult, KesTensileTest, StretchResult, StretchTest};

use super::card::Card;
use super::failure::TestFailure;
use super::report::{Extra, Group, Number, Report, digits, direction_name, heads};
use super::swatch_picture::swatch_picture;
use super::{in_directions, line};
use crate::arguments::lab::{Directed, Stretch};

pub fn stretch(card: &Card, of: &Stretch, test: &'static str) -> Result<Report, TestFailure> {
    let mut one = if test == "strip" { StretchTest::strip() } else { StretchTest::swatch() };
    one.specimen.length = of.size.length.unwrap_or(one.specimen.length);
    one.specimen.width = of.size.width.unwrap_or(one.specimen.width);
    one.until = of.to.map_or(one.until, Until::Stretch);
    if of.wrinkle {
        one.out_of_plane = OutOfPlane::Free { disturbance: 1e-4 };
    }
    let found = in_directions(&of.directed.direction, |angle| StretchTest { angle, ..one }.run(&card.shell))?;
    let groups = found.iter().map(|(angle, found)| {
        let last = found.last();
        Group {
            name: direction_name(*angle),
            direction: Some(*angle),
            numbers: stretch_numbers(
                last.stretch,
                last.force,
                found.width,
                last.compression,
                found.initial_stiffness(),
            ),
        }
    });
    let rows = found.iter().flat_map(|(angle, found)| {
        found.points.iter().map(|p| vec![angle.to_degrees(), p.stretch, p.force, p.compression])
    });
    let curves: Vec<(f64, Vec<[f64; 3]>)> = found
        .iter()
        .map(|(a, f)| (*a, f.points.iter().map(|p| [p.stretch, p.force, p.compression]).collect()))
        .collect();
    let mut remarks = Vec::new();
    if test == "strip" {
        remarks.push("a shell does not break: there is no strength and no elongation at break".to_owned());
    }
    let size = one.specimen;
    let kind = if test == "strip" { "strip (ISO 13934-1)" } else { "swatch" };
    let manner = if of.wrinkle { "free to wrinkle" } else { "kept flat" };
    Ok(Report {
        what: format!("{kind}, {} × {} mm between clamps, {manner}", digits(size.length / MM), digits(size.width / MM)),
        groups: groups.collect(),
        heads: heads(["direction [deg]", "stretch [-]", "force [N]", "contraction [-]"]),
        rows: rows.collect(),
        plot: stretch_plot(&card.title, &curves),
        remarks,
        extras: found.iter().map(|(angle, found)| picture(*angle, found)).collect(),
    })
}

/// Pictures of swatches that are pulled along the yarns and the bias; one along another direction has its angle in its name.
pub const EXTRAS: [&str; 3] = ["-weft-sheet.svg", "-bias-sheet.svg", "-warp-sheet.svg"];

fn picture(angle: f64, found: &StretchResult) -> Extra {
    let name = direction_name(angle);
    let file = name.replace('°', " deg").replace(' ', "-");
    Extra { suffix: format!("-{file}-sheet.svg").into(), text: swatch_picture(&name, &found.sheet) }
}

/// Numbers of a specimen that was drawn to a force \[N\].
pub fn stretch_numbers(stretch: f64, force: f64, width: f64, contraction: f64, stiffness: f64) -> Vec<Number> {
    vec![
        Number::new("stretch", stretch, "stretch at the end", PERCENT, "%"),
        Number::new("force_N", force, "force at the end", 1.0, "N"),
        Number::new("line_force_N_per_m", force / width, "by width", GF_PER_CM, "gf/cm"),
        Number::new("compression", contraction, "contraction", PERCENT, "%"),
        Number::new("initial_stiffness_N_per_m", stiffness, "stiffness at first", 1.0, "N/m"),
    ]
}

/// Force and contraction by stretch, of curves by direction \[rad\].
pub fn stretch_plot(title: &str, curves: &[(f64, Vec<[f64; 3]>)]) -> Plot {
    let panel = |label: &str, of: fn(&[f64; 3]) -> f64| Panel {
        y_label: label.to_owned(),
        series: curves.iter().map(|(a, points)| line(*a, points.iter().map(|p| [p[0] / PERCENT, of(p)]))).collect(),
    };
    Plot {
        title: title.to_owned(),
        x_label: "stretch [%]".to_owned(),
        panels: vec![panel("force [N]", |p| p[1]), panel("contraction [%]", |p| p[2] / PERCENT)],
    }
}

pub fn kes_tensile(card: &Card, of: &Directed) -> Result<Report, TestFailure> {
    let found =
        in_directions(&of.direction, |angle| KesTensileTest { angle, ..KesTensileTest::default() }.run(&card.shell))?;
    Ok(kes_tensile_report(&found, &card.title))
}

/// What KES-FB1 prints of a model that gives all work back.
pub fn kes_tensile_report(found: &[(f64, KesTensileResult)], title: &str) -> Report {
    let groups = found.iter().map(|(angle, found)| Group {
        name: direction_name(*angle),
        direction: Some(*angle),
        numbers: vec![
            Number::new("LT", found.linearity, "LT, linearity", 1.0, ""),
            Number::new("WT_J_per_m2", found.work, "WT, work", GF_CM_PER_CM2, "gf·cm/cm²"),
            Number::trivial("RT", 1.0, "RT, resilience", "100 %"),
            Number::new("EMT", found.extensibility, "EMT, extensibility", PERCENT, "%"),
        ],
    });
    let rows = found
        .iter()
        .flat_map(|(angle, found)| found.points.iter().map(|[s, f, c]| vec![angle.to_degrees(), *s, *f, *c]));
    let series =
        found.iter().map(|(a, f)| line(*a, f.points.iter().map(|[s, load, _]| [s / PERCENT, load / GF_PER_CM])));
    Report {
        what: "KES-FB1 tensile, 5 cm long and 20 cm wide, to 500 gf/cm".to_owned(),
        groups: groups.collect(),
        heads: heads(["direction [deg]", "stretch [-]", "line force [N/m]", "contraction [-]"]),
        rows: rows.collect(),
        plot: Plot::lines(title, "stretch [%]", "load by width [gf/cm]", &series.collect::<Vec<_>>()),
        remarks: vec![
            "an elastic model gives all work back: RT is 100 % of any fabric and says nothing of the fabric".to_owned(),
        ],
        extras: Vec::new(),
    }
}

pub fn fast(card: &Card) -> Result<Report, TestFailure> {
    let found = FastTest::default().run(&card.shell)?;
    let mut groups = Vec::new();
    let angles = [0.0, 90f64.to_radians()];
    for (angle, one) in angles.into_iter().zip(&found.directions) {
        groups.push(Group {
            name: direction_name(angle),
            direction: Some(angle),
            numbers: vec![
                Number::new("E5", one.extension[0], "E5", PERCENT, "%"),
                Number::new("E20", one.extension[1], "E20", PERCENT, "%"),
                Number::new("E100", one.extension[2], "E100", PERCENT, "%"),
                Number::new("C_m", one.bending_length, "C, bending length", MM, "mm"),
                Number::new("B_N_m", one.bending_rigidity, "B, rigidity", UN_M, "µN·m"),
                Number::new("F_m2", one.formability, "F, formability", FAST_MM2, "mm² (E in %)"),
            ],
        });
    }
    let mut bias = fast_bias(found.bias_extension, found.shear_rigidity);
    let uniform = found.uniform_shear_rigidity;
    bias.numbers.push(Number::new("G_uniform_N_per_m", uniform, "G of a uniform strip", 1.0, "N/m"));
    groups.push(bias);
    let loads = wale_lab::virtual_test::fast::LOADS;
    let mut rows = Vec::new();
    let mut series = Vec::new();
    for (angle, one) in angles.into_iter().zip(&found.directions) {
        let points: Vec<[f64; 2]> =
            [[0.0; 2]].into_iter().chain(one.extension.into_iter().zip(loads).map(|(s, load)| [s, load])).collect();
        rows.extend(points.iter().map(|[s, load]| vec![angle.to_degrees(), *s, *load]));
        series.push(line(angle, points.iter().map(|[s, load]| [s / PERCENT, load / GF_PER_CM])));
    }
    rows.push(vec![45.0, found.bias_extension, loads[0]]);
    Ok(Report {
        what: "FAST-2 and FAST-3, 100 × 50 mm between clamps".to_owned(),
        groups,
        heads: heads(["direction [deg]", "stretch [-]", "line force [N/m]"]),
        rows,
        plot: Plot::lines(&card.title, "stretch [%]", "load by width [gf/cm]", &series),
        remarks: vec![
            "FAST-1 and FAST-4 are missing: a shell has neither thickness nor relaxation".to_owned(),
            "G = 123/EB5 supposes a uniform strip; clamps stiffen a short one".to_owned(),
        ],
        extras: Vec::new(),
    })
}

/// FAST-3 along the bias, of whatever model.
pub(super) fn fast_bias(extension: f64, shear_rigidity: f64) -> Group {
    let numbers = vec![
        Number::new("EB5", extension, "EB5", PERCENT, "%"),
        Number::new("G_N_per_m", shear_rigidity, "G = 123/EB5", 1.0, "N/m"),
    ];
    Group { name: "bias".to_owned(), direction: Some(45f64.to_radians()), numbers }
}
