//! Tests on tiles: of yarns in full contact, and of the contact model.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use wale::picture::{Panel, Plot};
use wale::scene::Scene;
use wale_lab::network_fit::{NetworkPull, NetworkPullSettings, relaxed_reference};
use wale_lab::swatch_test::shrinkage_of_tile;
use wale_lab::uniform_test::{
    TestedTile, TileBendingTest, UniformStrip, UniformTestError, draw, stretch_at_load, tensile, tile_cantilever,
    tile_picture_frame, tile_shear, uniform_fast,
};
use wale_lab::virtual_test::stretch::Until;
use wale_lab::virtual_test::units::{FAST_MM2, GF_CM_PER_CM, GF_CM2_PER_CM, GF_PER_CM, MM, PER_CM, PERCENT, UN_M};
use wale_lab::virtual_test::{KesShearTest, KesTensileTest, PictureFrameTest, StretchTest};

use super::bending::{cantilever_report, cantilever_test};
use super::failure::TestFailure;
use super::report::{Group, Number, Report, digits, direction_name, heads};
use super::{in_plane, line, shear, yarns};
use crate::arguments::lab::{Stretch, Test};

/// Standard gravity \[m/s²\].
const GRAVITY: f64 = 9.81;

/// A test on a tile of yarns in full contact.
///
/// # Errors
/// [`TestFailure`].
pub fn run(test: &Test, tested: &TestedTile, mass: Option<f64>, title: &str) -> Result<Report, TestFailure> {
    let what = "tile of yarns in full contact";
    let strip = |angle: f64| tested.strip(angle);
    let bend = |angle: f64| TileBendingTest { angle, ..TileBendingTest::default() }.run(tested);
    match test {
        Test::Stretch(of) | Test::Strip(of) => stretch(strip, of, matches!(test, Test::Strip(_)), title, what),
        Test::KesTensile(of) => kes_tensile(strip, &of.direction, title, what),
        Test::KesShear(of) => {
            let mut all = Vec::new();
            for &angle in &of.direction {
                all.push((angle, tile_shear(tested, &KesShearTest { angle, ..KesShearTest::default() })?));
            }
            let kept = "a uniform shear of the tile, its width held as by clamps far wider than the specimen is long";
            Ok(of_tile(shear::kes_shear_report(&all, title), what, kept))
        }
        Test::PictureFrame(of) => {
            let mut all = Vec::new();
            for &angle in &of.directed.direction {
                let test = PictureFrameTest { side: of.side, angle, largest: of.to, points: 30 };
                all.push((angle, tile_picture_frame(tested, &test)?));
            }
            let kept = "deformation is uniform, as it is in the frame";
            Ok(of_tile(shear::picture_frame_report(&all, of.side, title), what, kept))
        }
        Test::KesBending(of) => {
            let mut all = Vec::new();
            for &angle in &of.direction {
                all.push((angle, bend(angle)?));
            }
            bending(&all, title, what)
        }
        Test::Curl(_) => {
            let mut all = Vec::new();
            for angle in [0.0, FRAC_PI_2] {
                all.push((angle, bend(angle)?));
            }
            let mut report = bending(&all, title, what)?;
            report.what = format!("curl of a {what}: the curvature at which it has no moment");
            report.remarks.push(
                "without end it has no edges: this is how far they would turn it, if nothing else bent".to_owned(),
            );
            Ok(report)
        }
        Test::Cantilever(of) => {
            let mass = mass.ok_or_else(|| lacks_mass("cantilever"))?;
            let mut all = Vec::new();
            for &angle in &of.directed.direction {
                let rigidity = bend(angle)?.rigidity;
                if rigidity.is_nan() || rigidity <= 0.0 {
                    return Err(TestFailure::not_converged(format_args!(
                        "its bending rigidity came out as {rigidity:e} N·m"
                    )));
                }
                all.push((angle, tile_cantilever(rigidity, mass, &cantilever_test(of))?));
            }
            let kept = "a tile has no end that sinks: the strip is a heavy elastica of the tile's B, whatever its width, and holds for small curvatures of a fabric that is flat at rest";
            Ok(of_tile(cantilever_report(&all, of.slope, title), what, kept))
        }
        Test::Fast(_) => {
            let rigidity = [bend(0.0)?.rigidity, bend(FRAC_PI_2)?.rigidity];
            fast(strip, Some(rigidity), mass, title, what)
        }
        _ => Err(TestFailure::bad_input("a tile is not tested so")),
    }
}

/// A test on a tile of the contact model.
///
/// # Errors
/// [`TestFailure`].
pub fn run_contacts(test: &Test, scene: &Scene, title: &str) -> Result<Report, TestFailure> {
    let what = "tile of the contact model";
    if let Test::Relaxation(_) = test {
        return Ok(yarns::relaxation(&shrinkage_of_tile(scene)?, what.to_owned(), title));
    }
    let reference = relaxed_reference(scene)?;
    let settings = NetworkPullSettings::default();
    let strip = |angle: f64| NetworkPull::new(&reference, angle, &settings).map_err(UniformTestError::from);
    let mut report = match test {
        Test::Stretch(of) | Test::Strip(of) => stretch(strip, of, matches!(test, Test::Strip(_)), title, what),
        Test::KesTensile(of) => kes_tensile(strip, &of.direction, title, what),
        Test::Fast(_) => fast(strip, None, None, title, what),
        _ => Err(TestFailure::bad_input("a tile of the contact model is not tested so")),
    }?;
    let aside = |angle: f64| (angle / FRAC_PI_4 - (angle / FRAC_PI_4).round()).abs() > 1e-6;
    if scene.fabric.woven().is_some() && report.groups.iter().any(|group| group.direction.is_some_and(aside)) {
        report.remarks.push(
            "off weft, warp and bias a strip that may not shear pushes threads together: they stay straight, or snap aside"
                .to_owned(),
        );
    }
    Ok(report)
}

fn lacks_mass(test: &str) -> TestFailure {
    TestFailure::bad_input(format_args!("{test} needs a mass by area: give it with --areal-mass \"170 g/m^2\""))
}

/// A report that was worded for a shell.
fn of_tile(mut report: Report, what: &str, kept: &str) -> Report {
    report.what = format!("{}, by a {what}", report.what);
    report.remarks.push(kept.to_owned());
    report
}

fn stretch<S: UniformStrip>(
    strip: impl Fn(f64) -> Result<S, UniformTestError>,
    of: &Stretch,
    is_strip: bool,
    title: &str,
    what: &str,
) -> Result<Report, TestFailure> {
    let mut test = if is_strip { StretchTest::strip() } else { StretchTest::swatch() };
    test.specimen.length = of.size.length.unwrap_or(test.specimen.length);
    test.specimen.width = of.size.width.unwrap_or(test.specimen.width);
    let until = of.to.map_or(test.until, Until::Stretch);
    let width = test.specimen.width;
    let (mut groups, mut rows, mut curves) = (Vec::new(), Vec::new(), Vec::new());
    for &angle in &of.directed.direction {
        let largest = match until {
            Until::Stretch(stretch) => stretch,
            Until::LineLoad(load) => stretch_at_load(&mut strip(angle)?, load)?.stretch,
        };
        let points = draw(&mut strip(angle)?, largest, test.points)?;
        let last = points[points.len() - 1];
        let initial = (points[1].force - points[0].force) / points[1].stretch;
        groups.push(Group {
            name: direction_name(angle),
            direction: Some(angle),
            numbers: in_plane::stretch_numbers(last.stretch, last.force * width, width, last.compression, initial),
        });
        rows.extend(points.iter().map(|p| vec![angle.to_degrees(), p.stretch, p.force * width, p.compression]));
        curves.push((angle, points.iter().map(|p| [p.stretch, p.force * width, p.compression]).collect()));
    }
    let mut remarks =
        vec!["a uniform strip: no clamp keeps it from narrowing, so that only the width matters".to_owned()];
    if is_strip {
        remarks.push("a tile does not break: there is no strength and no elongation at break".to_owned());
    }
    Ok(Report {
        what: format!(
            "{} {} mm wide, by a {what}",
            if is_strip { "strip (ISO 13934-1)" } else { "swatch" },
            digits(width / MM)
        ),
        groups,
        heads: heads(["direction [deg]", "stretch [-]", "force [N]", "contraction [-]"]),
        rows,
        plot: in_plane::stretch_plot(title, &curves),
        remarks,
        extras: Vec::new(),
    })
}

fn kes_tensile<S: UniformStrip>(
    strip: impl Fn(f64) -> Result<S, UniformTestError>,
    directions: &[f64],
    title: &str,
    what: &str,
) -> Result<Report, TestFailure> {
    let test = KesTensileTest::default();
    let mut all = Vec::new();
    for &angle in directions {
        all.push((angle, tensile(|| strip(angle), test.load, test.points)?));
    }
    let kept =
        "a uniform strip: the clamps of the instrument keep so wide a specimen from narrowing, and make it stiffer";
    Ok(of_tile(in_plane::kes_tensile_report(&all, title), what, kept))
}

fn fast<S: UniformStrip>(
    strip: impl Fn(f64) -> Result<S, UniformTestError>,
    rigidity: Option<[f64; 2]>,
    mass: Option<f64>,
    title: &str,
    what: &str,
) -> Result<Report, TestFailure> {
    let found = uniform_fast(strip, rigidity)?;
    let (mut groups, mut rows, mut series) = (Vec::new(), Vec::new(), Vec::new());
    let loads = wale_lab::virtual_test::fast::LOADS;
    for (angle, one) in [0.0, FRAC_PI_2].into_iter().zip(&found.directions) {
        let mut numbers = vec![
            Number::new("E5", one.extension[0], "E5", PERCENT, "%"),
            Number::new("E20", one.extension[1], "E20", PERCENT, "%"),
            Number::new("E100", one.extension[2], "E100", PERCENT, "%"),
        ];
        if let Some([rigidity, formability]) = one.bending {
            if let Some(mass) = mass.filter(|_| rigidity > 0.0) {
                let length = (rigidity / (mass * GRAVITY)).cbrt();
                numbers.push(Number::new("C_m", length, "C, bending length", MM, "mm"));
            }
            numbers.push(Number::new("B_N_m", rigidity, "B, rigidity", UN_M, "µN·m"));
            numbers.push(Number::new("F_m2", formability, "F, formability", FAST_MM2, "mm² (E in %)"));
        }
        groups.push(Group { name: direction_name(angle), direction: Some(angle), numbers });
        let points: Vec<[f64; 2]> =
            [[0.0; 2]].into_iter().chain(one.extension.into_iter().zip(loads).map(|(s, load)| [s, load])).collect();
        rows.extend(points.iter().map(|[s, load]| vec![angle.to_degrees(), *s, *load]));
        series.push(line(angle, points.iter().map(|[s, load]| [s / PERCENT, load / GF_PER_CM])));
    }
    groups.push(in_plane::fast_bias(found.bias_extension, found.shear_rigidity));
    rows.push(vec![45.0, found.bias_extension, loads[0]]);
    let mut remarks = vec!["uniform strips, as the formula of G supposes; FAST-1 and FAST-4 are missing".to_owned()];
    if rigidity.is_none() {
        remarks.push("no C, B and F: this tile is not bent".to_owned());
    } else if mass.is_none() {
        remarks.push("no C: give the mass by area with --areal-mass".to_owned());
    }
    Ok(Report {
        what: format!("FAST-2 and FAST-3, by a {what}"),
        groups,
        heads: heads(["direction [deg]", "stretch [-]", "line force [N/m]"]),
        rows,
        plot: Plot::lines(title, "stretch [%]", "load by width [gf/cm]", &series),
        remarks,
        extras: Vec::new(),
    })
}

fn bending(
    all: &[(f64, wale_lab::uniform_test::TileBendingResult)],
    title: &str,
    what: &str,
) -> Result<Report, TestFailure> {
    let groups = all.iter().map(|(angle, found)| Group {
        name: direction_name(*angle),
        direction: Some(*angle),
        numbers: vec![
            Number::new("B_N_m", found.rigidity, "B, rigidity", GF_CM2_PER_CM, "gf·cm²/cm"),
            Number::trivial("2HB_N", 0.0, "2HB, hysteresis", "0 gf·cm/cm"),
            Number::new("flat_moment_N", found.flat_moment, "moment when flat", GF_CM_PER_CM, "gf·cm/cm"),
            Number::new("own_curvature_per_m", found.own_curvature, "own curvature", 1.0, "1/m (+ to the front)"),
            Number::new("largest_curvature_per_m", found.largest, "bent to ±", PER_CM, "1/cm"),
        ],
    });
    let rows = all.iter().flat_map(|(a, f)| f.points.iter().map(|[k, m]| vec![a.to_degrees(), *k, *m]));
    let series: Vec<_> =
        all.iter().map(|(a, f)| line(*a, f.points.iter().map(|[k, m]| [k / PER_CM, m / GF_CM_PER_CM]))).collect();
    Ok(Report {
        what: format!("pure bending of a {what}"),
        groups: groups.collect(),
        heads: heads(["direction [deg]", "curvature [1/m]", "moment by width [N]"]),
        rows: rows.collect(),
        plot: Plot {
            title: title.to_owned(),
            x_label: "curvature [1/cm]".to_owned(),
            panels: vec![Panel { y_label: "moment by width [gf·cm/cm]".to_owned(), series }],
        },
        remarks: vec![
            "bent to a tenth of one by its longer period, at which it is still thin; KES goes to 2.5 1/cm".to_owned(),
            "nothing rubs in a tile: 2HB is zero of any yarn and says nothing of the fabric".to_owned(),
        ],
        extras: Vec::new(),
    })
}
