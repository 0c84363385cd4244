//! Tests that shear a fabric: KES shear, picture frame, bias extension.

use wale::picture::{Panel, Plot, Series};
use wale_lab::virtual_test::units::{DEG, GF_PER_CM, GF_PER_CM_DEG, MM, PERCENT};
use wale_lab::virtual_test::{BiasExtensionTest, KesShearResult, KesShearTest, PictureFrameResult, PictureFrameTest};

use super::card::Card;
use super::failure::TestFailure;
use super::report::{Group, Number, Report, digits, direction_name, heads};
use super::{in_directions, line};
use crate::arguments::lab::{BiasExtension, Directed, PictureFrame};

pub fn kes_shear(card: &Card, of: &Directed) -> Result<Report, TestFailure> {
    let found =
        in_directions(&of.direction, |angle| KesShearTest { angle, ..KesShearTest::default() }.run(&card.shell))?;
    Ok(kes_shear_report(&found, &card.title))
}

/// What the test prints of a model.
pub fn kes_shear_report(found: &[(f64, KesShearResult)], title: &str) -> Report {
    let groups = found.iter().map(|(angle, found)| Group {
        name: format!("pulled along the {}", direction_name(*angle)),
        direction: Some(*angle),
        numbers: vec![
            Number::new("G_N_per_m_rad", found.rigidity, "G, rigidity", GF_PER_CM_DEG, "gf/(cm·deg)"),
            Number::trivial("2HG_N_per_m", 0.0, "2HG, hysteresis", "0 gf/cm"),
            Number::trivial("2HG5_N_per_m", 0.0, "2HG5, hysteresis", "0 gf/cm"),
        ],
    });
    let rows = found
        .iter()
        .flat_map(|(angle, found)| found.points.iter().map(|[a, f, s]| vec![angle.to_degrees(), *a, *f, *s]));
    let series = found.iter().map(|(a, f)| line(*a, f.points.iter().map(|[x, y, _]| [x / DEG, y / GF_PER_CM])));
    Report {
        what: "KES-FB1 shear, 5 cm long and 20 cm wide, pulled by 10 gf/cm, to ±8°".to_owned(),
        groups: groups.collect(),
        heads: heads(["direction [deg]", "angle [rad]", "line force across [N/m]", "stretch along [-]"]),
        rows: rows.collect(),
        plot: Plot::lines(title, "angle of shear [deg]", "force by width [gf/cm]", &series.collect::<Vec<_>>()),
        remarks: vec![
            "an elastic model has no hysteresis: 2HG and 2HG5 are zero of any fabric and say nothing of the fabric"
                .to_owned(),
            "the pull of 10 gf/cm is part of G, about 0.17 gf/(cm·deg)".to_owned(),
        ],
        extras: Vec::new(),
    }
}

pub fn picture_frame(card: &Card, of: &PictureFrame) -> Result<Report, TestFailure> {
    let found = in_directions(&of.directed.direction, |angle| {
        PictureFrameTest { side: of.side, angle, largest: of.to, ..PictureFrameTest::default() }.run(&card.shell)
    })?;
    Ok(picture_frame_report(&found, of.side, &card.title))
}

/// What the test prints of a model.
pub fn picture_frame_report(found: &[(f64, PictureFrameResult)], side: f64, title: &str) -> Report {
    let groups = found.iter().map(|(angle, found)| {
        let last = found.points[found.points.len() - 1];
        Group {
            name: format!("first bar along the {}", direction_name(*angle)),
            direction: Some(*angle),
            numbers: vec![
                Number::new("rigidity_N_per_m_rad", found.rigidity, "rigidity at first", GF_PER_CM_DEG, "gf/(cm·deg)"),
                Number::new("angle_rad", last.angle, "angle at the end", DEG, "°"),
                Number::new("shear_force_N_per_m", last.shear_force, "F_s/L at the end", 1.0, "N/m"),
                Number::new("force_N", last.force, "corner force", 1.0, "N"),
                Number::new("energy_J", last.energy, "work", 1e-3, "mJ"),
            ],
        }
    });
    let rows = found.iter().flat_map(|(angle, found)| {
        found.points.iter().map(|p| vec![angle.to_degrees(), p.angle, p.travel, p.force, p.shear_force, p.energy])
    });
    let series = found.iter().map(|(a, f)| line(*a, f.points.iter().map(|p| [p.angle / DEG, p.shear_force])));
    Report {
        what: format!("picture frame, sides of {} mm", digits(side / MM)),
        groups: groups.collect(),
        heads: heads([
            "direction [deg]",
            "angle [rad]",
            "travel [m]",
            "force [N]",
            "shear force by length [N/m]",
            "energy [J]",
        ]),
        rows: rows.collect(),
        plot: Plot::lines(title, "angle of shear [deg]", "F_s/L [N/m]", &series.collect::<Vec<_>>()),
        remarks: vec!["kept flat: there is no angle at which it locks and wrinkles".to_owned()],
        extras: Vec::new(),
    }
}

pub fn bias_extension(card: &Card, of: &BiasExtension) -> Result<Report, TestFailure> {
    let mut test = BiasExtensionTest { largest: of.to, ..BiasExtensionTest::default() };
    test.specimen.length = of.size.length.unwrap_or(test.specimen.length);
    test.specimen.width = of.size.width.unwrap_or(test.specimen.width);
    let found = test.run(&card.shell)?;
    let last = found.points[found.points.len() - 1];
    let series = |name: &str, of: fn(&wale_lab::virtual_test::bias_extension::BiasPoint) -> [f64; 2]| {
        let (xs, ys) = found.points.iter().map(of).map(|[x, y]| (x, y)).unzip();
        Series { name: name.to_owned(), xs, ys }
    };
    let plot = Plot {
        title: card.title.clone(),
        x_label: "angle of shear by travel [deg]".to_owned(),
        panels: vec![
            Panel { y_label: "F_s/L [N/m]".to_owned(), series: vec![series("", |p| [p.angle / DEG, p.shear_force])] },
            Panel {
                y_label: "angle seen in the middle [deg]".to_owned(),
                series: vec![series("", |p| [p.angle / DEG, p.seen_angle / DEG])],
            },
        ],
    };
    Ok(Report {
        what: format!(
            "bias extension, {} × {} mm between clamps",
            digits(test.specimen.length / MM),
            digits(test.specimen.width / MM)
        ),
        groups: vec![Group {
            name: "bias".to_owned(),
            direction: Some(45f64.to_radians()),
            numbers: vec![
                Number::new("rigidity_N_per_m_rad", found.rigidity, "rigidity at first", GF_PER_CM_DEG, "gf/(cm·deg)"),
                Number::new("angle_rad", last.angle, "angle by travel", DEG, "°"),
                Number::new("seen_angle_rad", last.seen_angle, "angle as seen", DEG, "°"),
                Number::new("stretch", last.stretch, "stretch", PERCENT, "%"),
                Number::new("force_N", last.force, "force", 1.0, "N"),
                Number::new("shear_force_N_per_m", last.shear_force, "F_s/L at the end", 1.0, "N/m"),
            ],
        }],
        heads: heads([
            "angle by travel [rad]",
            "angle as seen [rad]",
            "stretch [-]",
            "force [N]",
            "shear force by length [N/m]",
        ]),
        rows: found.points.iter().map(|p| vec![p.angle, p.seen_angle, p.stretch, p.force, p.shear_force]).collect(),
        plot,
        remarks: vec![
            "kept flat: there is no angle at which it locks and wrinkles".to_owned(),
            "angle by travel and F_s suppose yarns that neither stretch nor slip: where the angle as seen differs, they do not hold"
                .to_owned(),
        ],
        extras: Vec::new(),
    })
}
