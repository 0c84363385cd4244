//! Tests on swatches of all their yarns.

use std::f64::consts::FRAC_PI_2;

use wale::picture::{Panel, Plot, Series};
use wale::scene::Scene;
use wale_lab::swatch_test::{ClampedResult, ClampedSwatch, CurlResult, Shrinkage, curl, shrinkage_of_swatch};
use wale_lab::virtual_test::rig::Specimen;
use wale_lab::virtual_test::stretch::Until;
use wale_lab::virtual_test::units::{DEG, GF_CM_PER_CM2, MM, PERCENT};
use wale_lab::virtual_test::{KesTensileTest, StretchTest};

use super::failure::TestFailure;
use super::in_plane::{stretch_numbers, stretch_plot};
use super::line;
use super::report::{Group, Number, Report, digits, direction_name, heads};
use crate::arguments::lab::Test;

/// What the tensile test of KES is called.
const KES: &str = "KES-FB1 tensile";

/// A test on a swatch of a scene's yarns.
///
/// # Errors
/// [`TestFailure`].
pub fn run(test: &Test, scene: &Scene, title: &str) -> Result<Report, TestFailure> {
    match test {
        Test::Stretch(of) | Test::Strip(of) => {
            let is_strip = matches!(test, Test::Strip(_));
            let base = if is_strip { StretchTest::strip() } else { StretchTest::swatch() };
            let length = of.size.length.unwrap_or(base.specimen.length);
            let width = of.size.width.unwrap_or(base.specimen.width);
            let until = of.to.map_or(base.until, Until::Stretch);
            let kind = if is_strip { "strip (ISO 13934-1)" } else { "swatch" };
            clamped(scene, &of.directed.direction, Specimen { length, width }, until, kind, title)
        }
        Test::KesTensile(of) => {
            let base = KesTensileTest::default();
            clamped(scene, &of.direction, base.specimen, Until::LineLoad(base.load), KES, title)
        }
        Test::Curl(of) => Ok(curled(&curl(scene, of.columns as usize, of.rows as usize)?, title)),
        Test::Relaxation(of) => {
            let (columns, rows) = (of.columns as usize, of.rows as usize);
            let found = shrinkage_of_swatch(scene, columns, rows)?;
            Ok(relaxation(&found, format!("free swatch of {columns} × {rows} loops"), title))
        }
        _ => Err(TestFailure::bad_input("a swatch of yarns is not tested so")),
    }
}

fn clamped(
    scene: &Scene,
    directions: &[f64],
    specimen: Specimen,
    until: Until,
    kind: &str,
    title: &str,
) -> Result<Report, TestFailure> {
    let (mut groups, mut rows, mut curves, mut remarks) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for &angle in directions {
        let along_wales = (angle - FRAC_PI_2).abs() < 1e-6;
        if !along_wales && angle.abs() > 1e-6 {
            let what = "a swatch of yarns is clamped along its courses or its wales: --direction weft or warp";
            return Err(TestFailure::bad_input(what));
        }
        let found = ClampedSwatch::new(specimen, along_wales, until).run(scene)?;
        groups.push(group(angle, &found, kind == KES));
        for (way, points) in [(1.0, &found.loading), (-1.0, &found.unloading)] {
            rows.extend(points.iter().map(|[s, f, c]| vec![angle.to_degrees(), way, *s, f * found.specimen.width, *c]));
        }
        let whole = found.loading.iter().chain(&found.unloading).map(|[s, f, c]| [*s, f * found.specimen.width, *c]);
        curves.push((angle, whole.collect()));
        if found.made_smaller {
            remarks.push(format!(
                "{} by {} mm would be too many loops: a smaller specimen of the same shape was drawn",
                digits(specimen.length / MM),
                digits(specimen.width / MM)
            ));
        }
    }
    remarks.dedup();
    remarks.push("drawn at 5 % a second and brought back: what does not return was rubbed away, but for a hundredth or two that went into the yarns' damping".to_owned());
    remarks.push("free to curl: contraction is between the selvedges as a camera sees them".to_owned());
    Ok(Report {
        what: format!("{kind}, by all yarns of a swatch between clamps, with friction"),
        groups,
        heads: heads(["direction [deg]", "there (1) or back (-1)", "stretch [-]", "force [N]", "contraction [-]"]),
        rows,
        plot: stretch_plot(title, &curves),
        remarks,
        extras: Vec::new(),
    })
}

fn group(angle: f64, found: &ClampedResult, is_kes: bool) -> Group {
    let last = found.loading[found.loading.len() - 1];
    let Specimen { length, width } = found.specimen;
    let initial = (found.loading[1][1] - found.loading[0][1]) / found.loading[1][0];
    let mut numbers = stretch_numbers(last[0], last[1] * width, width, last[2], initial);
    if is_kes {
        // It ends at the load of the instrument: what it is stretched by there has a name.
        numbers[0] = Number::new("EMT", last[0], "EMT, extensibility", PERCENT, "%");
    }
    numbers.extend([
        Number::new("LT", found.work / (0.5 * last[1] * last[0]), "LT, linearity", 1.0, ""),
        Number::new("WT_J_per_m2", found.work, "WT, work", GF_CM_PER_CM2, "gf·cm/cm²"),
        Number::new("RT", found.returned, "RT, resilience", PERCENT, "%"),
        Number::new("residual_stretch", found.residual, "stretch that is left", PERCENT, "%"),
        Number::count("columns", found.loops[0], "columns"),
        Number::count("rows", found.loops[1], "rows"),
        Number::new("length_m", length, "between the clamps", MM, "mm"),
        Number::new("width_m", width, "width", MM, "mm"),
    ]);
    Group { name: direction_name(angle), direction: Some(angle), numbers }
}

fn curled(found: &CurlResult, title: &str) -> Report {
    let side = |curvature: f64| if curvature > 0.0 { "1/m to the front" } else { "1/m to the back" };
    let edge = |name: &str, angle: f64, curvature: f64, turned: f64| Group {
        name: name.to_owned(),
        direction: Some(angle),
        numbers: vec![
            Number::new("curvature_per_m", curvature, "curvature", curvature.signum(), side(curvature)),
            Number::new("turned_rad", turned, "turned by", DEG * curvature.signum(), "°"),
        ],
    };
    let names = ["left side (along the courses)", "right side", "cast-on (along the wales)", "bind-off"];
    let mut groups: Vec<Group> = names
        .into_iter()
        .zip([0.0, 0.0, FRAC_PI_2, FRAC_PI_2])
        .zip(&found.edges)
        .map(|((name, angle), found)| edge(name, angle, found.curvature, found.turned))
        .collect();
    groups.push(Group {
        name: "the whole swatch".to_owned(),
        direction: None,
        numbers: vec![
            Number::new("course_curvature_per_m", found.whole[0], "along the courses", 1.0, "1/m"),
            Number::new("wale_curvature_per_m", found.whole[1], "along the wales", 1.0, "1/m"),
            Number::new("extent_x_m", found.extent[0], "box along the courses", MM, "mm"),
            Number::new("extent_y_m", found.extent[1], "box along the wales", MM, "mm"),
            Number::new("extent_z_m", found.extent[2], "box across", MM, "mm"),
        ],
    });
    let angles = [0.0, FRAC_PI_2];
    let rows = angles
        .iter()
        .zip(&found.along)
        .flat_map(|(a, points)| points.iter().map(|[x, k]| vec![a.to_degrees(), *x, *k]));
    let series: Vec<Series> =
        angles.iter().zip(&found.along).map(|(a, points)| line(*a, points.iter().map(|[x, k]| [x / MM, *k]))).collect();
    let y_label = "curvature [1/m], + to the front".to_owned();
    Report {
        what: format!(
            "curl of a free swatch of {} × {} loops, without weight and friction",
            found.loops[0], found.loops[1]
        ),
        groups,
        heads: heads(["direction [deg]", "from the middle [m]", "curvature [1/m]"]),
        rows: rows.collect(),
        plot: Plot {
            title: title.to_owned(),
            x_label: "from the middle [mm]".to_owned(),
            panels: vec![Panel { y_label, series }],
        },
        remarks: vec![
            "weight and friction would hold it flatter: this is how far the yarns alone turn it".to_owned(),
            "an edge is the outermost 15 % of the loops; curvature is taken over two loops to either side".to_owned(),
        ],
        extras: Vec::new(),
    }
}

/// A report of shrinkage, however it was found.
pub fn relaxation(found: &Shrinkage, what: String, title: &str) -> Report {
    let shrinkage = found.shrinkage();
    let names = ["width (along the courses)", "length (along the wales)"];
    let mut groups: Vec<Group> = (0..2)
        .map(|axis| Group {
            name: names[axis].to_owned(),
            direction: Some(axis as f64 * FRAC_PI_2),
            numbers: vec![
                Number::new("shrinkage", shrinkage[axis], "shrinkage", PERCENT, "%"),
                Number::new("knitted_m", found.knitted[axis], "a loop as knitted", MM, "mm"),
                Number::new("relaxed_m", found.relaxed[axis], "a loop at rest", MM, "mm"),
            ],
        })
        .collect();
    groups.push(Group {
        name: "area".to_owned(),
        direction: None,
        numbers: vec![Number::new("area_shrinkage", found.of_area(), "shrinkage", PERCENT, "%")],
    });
    let series = |name: &str, ys: [f64; 2]| Series {
        name: name.to_owned(),
        xs: vec![0.0, 90.0],
        ys: ys.map(|y| y / MM).to_vec(),
    };
    Report {
        what: format!("relaxation shrinkage, by a {what}"),
        groups,
        heads: heads(["direction [deg]", "as knitted [m]", "at rest [m]"]),
        rows: (0..2).map(|axis| vec![90.0 * axis as f64, found.knitted[axis], found.relaxed[axis]]).collect(),
        plot: Plot::lines(
            title,
            "direction [deg]",
            "size of a loop [mm]",
            &[series("as knitted", found.knitted), series("at rest", found.relaxed)],
        ),
        remarks: vec![
            "as knitted is as the scene lays it out: give loop_length, and wale_spacing and course_spacing as they come off the needles"
                .to_owned(),
            "at rest is without friction, as after washing and tumbling".to_owned(),
        ],
        extras: Vec::new(),
    }
}
