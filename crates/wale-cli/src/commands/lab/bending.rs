//! Tests that bend a fabric: KES bending, cantilever, pear loops.

use wale::picture::Plot;
use wale_lab::virtual_test::cantilever::{self as hang, CantileverResult};
use wale_lab::virtual_test::pear_loop::{Clamps as LoopClamps, Hanging};
use wale_lab::virtual_test::units::{DEG, GF_CM_PER_CM, GF_CM2_PER_CM, MM, PER_CM, UN_M};
use wale_lab::virtual_test::{CantileverTest, KesBendingTest, PearLoopTest};

use super::card::Card;
use super::failure::TestFailure;
use super::report::{Group, Number, Report, digits, direction_name, heads};
use super::{in_directions, line};
use crate::arguments::lab::{Cantilever, Clamps, Directed, Gravity, PearLoop};

pub fn kes_bending(card: &Card, of: &Directed) -> Result<Report, TestFailure> {
    let found =
        in_directions(&of.direction, |angle| KesBendingTest { angle, ..KesBendingTest::default() }.run(&card.shell))?;
    let groups = found.iter().map(|(angle, found)| Group {
        name: direction_name(*angle),
        direction: Some(*angle),
        numbers: vec![
            Number::new("B_N_m", found.rigidity, "B, rigidity", GF_CM2_PER_CM, "gf·cm²/cm"),
            Number::trivial("2HB_N", 0.0, "2HB, hysteresis", "0 gf·cm/cm"),
        ],
    });
    let rows =
        found.iter().flat_map(|(angle, found)| found.points.iter().map(|[k, m]| vec![angle.to_degrees(), *k, *m]));
    let series = found.iter().map(|(a, f)| line(*a, f.points.iter().map(|[k, m]| [k / PER_CM, m / GF_CM_PER_CM])));
    Ok(Report {
        what: "KES-FB2 pure bending, 1 cm long and 20 cm wide, to ±2.5 cm⁻¹".to_owned(),
        groups: groups.collect(),
        heads: heads(["direction [deg]", "curvature [1/m]", "moment by width [N]"]),
        rows: rows.collect(),
        plot: Plot::lines(&card.title, "curvature [1/cm]", "moment by width [gf·cm/cm]", &series.collect::<Vec<_>>()),
        remarks: vec![
            "an elastic shell has no hysteresis: 2HB is zero of any card and says nothing of the fabric".to_owned(),
        ],
        extras: Vec::new(),
    })
}

pub fn cantilever(card: &Card, of: &Cantilever) -> Result<Report, TestFailure> {
    let test = cantilever_test(of);
    let found =
        in_directions(&of.directed.direction, |angle| hang::run(&CantileverTest { angle, ..test }, &card.shell))?;
    let mut report = cantilever_report(&found, of.slope, &card.title);
    report.what = format!("{}, {} mm wide", report.what, digits(test.width / MM));
    Ok(report)
}

/// The test that is asked for.
pub fn cantilever_test(of: &Cantilever) -> CantileverTest {
    let default = CantileverTest::default();
    CantileverTest { width: of.width.unwrap_or(default.width), slope: of.slope, ..default }
}

/// What the test prints of a model.
pub fn cantilever_report(found: &[(f64, CantileverResult)], slope: f64, title: &str) -> Report {
    let groups = found.iter().map(|(angle, found)| Group {
        name: direction_name(*angle),
        direction: Some(*angle),
        numbers: vec![
            Number::new("overhang_m", found.report.overhang, "overhang", MM, "mm"),
            Number::new("c_m", found.report.bending_length, "c, bending length", MM, "mm"),
            Number::new("G_N_m", found.report.flexural_rigidity, "G = W c³", UN_M, "µN·m"),
            Number::new("G_N_m", found.report.flexural_rigidity, "", GF_CM2_PER_CM, "gf·cm²/cm"),
        ],
    });
    let rows =
        found.iter().flat_map(|(angle, found)| found.profile.iter().map(|[x, z]| vec![angle.to_degrees(), *x, *z]));
    let series = found.iter().map(|(a, f)| line(*a, f.profile.iter().map(|[x, z]| [x / MM, z / MM])));
    let mut remarks = Vec::new();
    if (slope - 41.5 * DEG).abs() > 1e-6 {
        remarks.push("G = W c³ holds for a slope of 41.5° alone".to_owned());
    }
    Report {
        what: format!("cantilever (ASTM D1388), to a slope of {}°", digits(slope / DEG)),
        groups: groups.collect(),
        heads: heads(["direction [deg]", "along [m]", "up [m]"]),
        rows: rows.collect(),
        plot: Plot::lines(title, "from the edge [mm]", "height [mm]", &series.collect::<Vec<_>>()),
        remarks,
        extras: Vec::new(),
    }
}

pub fn pear_loop(card: &Card, of: &PearLoop) -> Result<Report, TestFailure> {
    let default = PearLoopTest::default();
    let base = PearLoopTest {
        length: of.size.length.unwrap_or(default.length),
        width: of.size.width.unwrap_or(default.width),
        hanging: match of.gravity {
            Gravity::Down => Hanging::Down,
            Gravity::Up => Hanging::Up,
            Gravity::None => Hanging::Weightless,
        },
        clamps: match of.clamps {
            Clamps::Facing => LoopClamps::Facing,
            Clamps::SideBySide => LoopClamps::SideBySide,
        },
        distances: if of.distance.is_empty() { default.distances.clone() } else { of.distance.clone() },
        ..default
    };
    let found = in_directions(&of.directed.direction, |angle| PearLoopTest { angle, ..base.clone() }.run(&card.shell))?;
    let groups = found.iter().map(|(angle, found)| {
        let (first, last) = (found.points[0], found.points[found.points.len() - 1]);
        Group {
            name: direction_name(*angle),
            direction: Some(*angle),
            numbers: vec![
                Number::new("first_distance_m", first.distance, "first distance", MM, "mm"),
                Number::new("first_aspect", first.aspect, "h/p there", 1.0, ""),
                Number::new("last_distance_m", last.distance, "last distance", MM, "mm"),
                Number::new("last_aspect", last.aspect, "h/p there", 1.0, ""),
            ],
        }
    });
    let rows = found.iter().flat_map(|(angle, found)| {
        found.points.iter().map(|p| vec![angle.to_degrees(), p.distance, p.height, p.width, p.aspect])
    });
    let series = found.iter().map(|(a, f)| line(*a, f.points.iter().map(|p| [p.distance / MM, p.aspect])));
    let clamps = match base.clamps {
        LoopClamps::Facing => "facing each other",
        LoopClamps::SideBySide => "side by side",
    };
    let hanging = match base.hanging {
        Hanging::Down => "hanging",
        Hanging::Up => "standing",
        Hanging::Weightless => "without weight",
    };
    Ok(Report {
        what: format!(
            "pear loops of {} × {} mm, {hanging}, clamps {clamps}",
            digits(base.length / MM),
            digits(base.width / MM)
        ),
        groups: groups.collect(),
        heads: heads(["direction [deg]", "distance of clamps [m]", "height [m]", "width [m]", "h/p [-]"]),
        rows: rows.collect(),
        plot: Plot::lines(&card.title, "distance of the clamps [mm]", "h/p", &series.collect::<Vec<_>>()),
        remarks: Vec::new(),
        extras: Vec::new(),
    })
}
