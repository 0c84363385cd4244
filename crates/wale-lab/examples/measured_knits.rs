//! Yarns fitted to hand-knitted stockinette and garter of one acrylic yarn [Singal2024], and garter foretold from stockinette alone.
//!
//! ```text
//! cargo run --release -p wale-lab --example measured_knits -- [all|near|foretell|sizes [SUMMARY.csv [NUMBERS]]]
//! ```
//!
//! `near` fits garter by least squares from the yarn of stockinette alone; `foretell` leaves out the fit of garter. Both leave out that of
//! stockinette if the seven numbers of its yarn are given. `sizes` fits nothing and tells how the tiles lie.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use wale_lab::fabric_file::FabricFile;
use wale_lab::shell::membrane_fit::MembraneFitSettings;
use wale_lab::shell::of_fabric::fit_shell;
use wale_lab::yarn_fit::gradients::{GradientSettings, Round, improve};
use wale_lab::yarn_fit::of_fabric::{Ablation, yarn_problem};
use wale_lab::yarn_fit::problem::{Answers, Here, P, Question, YarnProblem};
use wale_lab::yarn_fit::run::{Way, fit_yarn};
use wale_lab::yarn_fit::{Progress, RodSpace, Target, YarnFitError, errors};
use wale_lab::yarn_tile::{YarnTile, contact_radius};

type Failure = Box<dyn std::error::Error + Send + Sync>;

const POINTS: usize = 8;
/// A swatch of the yarn. Lengths are those with which the authors compute one stitch (`code/fabric_simulations` of
/// `sabetta/stitch-by-stitch`): the whole of its yarn, and the cell in which it begins. Stockinette of 33 by 33 stitches of that cell is
/// as large as the swatch was.
struct Swatch {
    stitch: &'static str,
    loop_length: &'static str,
    spacing: [&'static str; 2],
}

const FABRICS: [Swatch; 2] = [
    Swatch { stitch: "stockinette", loop_length: "11.28 mm", spacing: ["2.9 mm", "2.03 mm"] },
    Swatch { stitch: "garter", loop_length: "10.55 mm", spacing: ["3.2 mm", "1.29 mm"] },
];
/// Thickness of the yarn's core, which the authors' yarns are pressed to: 0.65 mm in stockinette, 0.51 mm in garter.
const DIAMETER: &str = "0.6 mm";
/// Width of garter pulled along the course \[mm\]. The table's 35.2 mm is less than the 48.4 mm between two pins in it; if its clamps held
/// as much of it as those of stockinette did, it was 58 mm wide, if it had as many courses as wales, 52 mm.
const GARTER_WIDTH: f64 = 55.0;

/// A fabric file of the means over the trials, in a folder.
fn fabric(table: &Path, folder: &Path, swatch: &Swatch) -> Result<FabricFile, Failure> {
    let Swatch { stitch, loop_length, spacing: [wales, courses] } = swatch;
    let text = std::fs::read_to_string(table)?;
    let mut rows = text.lines().filter(|line| !line.starts_with('#')).map(|line| line.split(',').collect::<Vec<_>>());
    let heads = rows.next().ok_or("the table is empty")?;
    let column = |name: &str| heads.iter().position(|head| *head == name).ok_or(format!("there is no column {name}"));
    let (kind, direction, force) = (column("stitch")?, column("direction")?, column("line_force_N_per_mm")?);
    let (strain, across) = (column("axial_strain_mean")?, column("transverse_strain_mean")?);
    let (width, length) = (column("fabric_width_mm")?, column("initial_clamp_length_mm")?);
    let rows: Vec<Vec<&str>> =
        rows.filter(|row| row[column("yarn").unwrap_or(0)] == "acrylic" && row[kind] == *stitch).collect();
    let mut file = format!(
        "schema = 1\ntitle = \"Acrylic {stitch}\"\n[structure]\nscene = \"{stitch}-scene.toml\"\nwale_spacing = \"{wales}\"\n\
         course_spacing = \"{courses}\"\n"
    );
    for (letter, name) in [("X", "course"), ("Y", "wale")] {
        let mut curve = "strain,line force (N/mm),transverse strain\n0,0,0\n".to_owned();
        let first = rows.iter().find(|row| row[direction] == letter).ok_or("a direction is missing")?;
        let told: f64 = first[width].parse()?;
        let true_width = if *stitch == "garter" && letter == "X" { GARTER_WIDTH } else { told };
        for row in rows.iter().filter(|row| row[direction] == letter) {
            let line_force = row[force].parse::<f64>()? * told / true_width;
            let _ = writeln!(curve, "{},{line_force},{}", row[strain], row[across]);
        }
        let _ = write!(
            file,
            "[[stretch]]\ndirection = \"{name}\"\nfile = \"{stitch}-{name}.csv\"\nlength = \"{} mm\"\nwidth = \"{} mm\"\n",
            first[length], true_width
        );
        std::fs::write(folder.join(format!("{stitch}-{name}.csv")), curve)?;
    }
    let scene = format!(
        "schema = 1\n[yarn]\npreset = \"thick-acrylic\"\ndiameter = \"{DIAMETER}\"\n[fabric]\nloop_length = \"{loop_length}\"\n\
         [fabric.chart]\npattern = \"{stitch}\"\ncolumns = 8\nrows = 8\n"
    );
    std::fs::write(folder.join(format!("{stitch}-scene.toml")), scene)?;
    let path = folder.join(format!("{stitch}.toml"));
    std::fs::write(&path, file)?;
    Ok(FabricFile::read(&path)?)
}

fn problem(fabric: &FabricFile) -> Result<YarnProblem, Failure> {
    let settings = MembraneFitSettings { targets: POINTS, ..MembraneFitSettings::default() };
    Ok(yarn_problem(fabric, &fit_shell(fabric, &settings)?, Ablation::default())?)
}

/// What a tile does with a yarn, and how far that is from the targets.
fn judge(problem: &YarnProblem, parameters: [f64; P]) -> Option<YarnFitError> {
    let Ok(found) = Here::new(problem).answer(&Question::of(parameters, POINTS, false));
    let targets: Vec<Target> = problem.targets.iter().map(|target| target.resampled(POINTS)).collect();
    let found = found?;
    for (target, answers) in targets.iter().zip(&found.stretch) {
        println!(
            "  along {:.0}°: stretch, stress wanted and found [N/m], compression wanted and found",
            target.angle.to_degrees()
        );
        for (point, answer) in target.points.iter().zip(answers) {
            let [s, force, compression] = point;
            println!(
                "    {s:6.3} {force:8.1} {:8.1} {compression:7.3} {:7.3}",
                answer.point.force, answer.point.compression
            );
        }
    }
    Some(errors(&targets, &found.stretch))
}

/// How the yarns of a tile lie.
fn describe(tile: &YarnTile) {
    let heights = tile.vertices().iter().map(|x| x[2]);
    let thick = heights.clone().fold(f64::NEG_INFINITY, f64::max) - heights.fold(f64::INFINITY, f64::min);
    let yarn: f64 = tile.lengths().iter().sum();
    println!(
        "  tile of {} vertices, {:.2} by {:.2} mm, {:.2} mm from lowest to highest centreline, {:.2} mm of yarn, contact radius {:.3} mm",
        tile.vertex_count(),
        1e3 * tile.periods()[0],
        1e3 * tile.periods()[1],
        1e3 * thick,
        1e3 * yarn,
        1e3 * contact_radius(tile)
    );
}

fn main() -> Result<(), Failure> {
    let near = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/knit-tensile-singal2024/summary.csv");
    let what = std::env::args().nth(1).unwrap_or_else(|| "all".to_owned());
    let table = std::env::args().nth(2).map_or(near, PathBuf::from);
    if !table.exists() {
        println!("{} is not there: nothing to fit", table.display());
        return Ok(());
    }
    let folder = tempfile::tempdir()?;
    let problems = FABRICS
        .iter()
        .map(|swatch| problem(&fabric(&table, folder.path(), swatch)?))
        .collect::<Result<Vec<_>, Failure>>()?;
    let given: Vec<f64> = std::env::args().skip(3).map(|number| number.parse()).collect::<Result<_, _>>()?;
    let mut of_stockinette: Option<[f64; P]> = given.try_into().ok();
    for (k, (swatch, problem)) in FABRICS.iter().zip(&problems).enumerate() {
        println!("{}", swatch.stitch);
        describe(&problem.tile);
        if what == "sizes" || (what != "all" && (k > 0 || of_stockinette.is_some())) {
            continue;
        }
        let begun = Instant::now();
        let silent = |_: &wale_lab::yarn_fit::Step| {};
        let way = Way::Gradients(GradientSettings::default());
        let Ok(found) = fit_yarn(problem, &Here::new(problem), &way, &Progress::new(&silent));
        let found = found.ok_or("the tile could not be tested")?;
        let parameters = found.material.parameters();
        println!("  fitted in {:.0} s: {:?}", begun.elapsed().as_secs_f64(), found.error);
        println!("  {parameters:?}\n  {}", found.open.join("; "));
        judge(problem, parameters);
        of_stockinette.get_or_insert(parameters);
    }
    if let Some(parameters) = of_stockinette {
        println!("garter, of the yarn of stockinette");
        // The yarn is the same; its inner contact is that of stockinette, too.
        let foretold = YarnProblem { base: problems[0].base, ..problems[1].clone() };
        println!("  {:?}", judge(&foretold, parameters));
        if what == "near" {
            let (garter, begun) = (&problems[1], Instant::now());
            let silent = |_: &wale_lab::yarn_fit::Step| {};
            let round = Round { starts: 1, evaluations: 12, samples: 4 };
            let from = RodSpace::coordinates(parameters);
            let Ok(found) =
                improve(std::slice::from_ref(garter), &Here::new(garter), from, &round, 0.01, &Progress::new(&silent));
            let found = RodSpace::parameters(found.ok_or("the tile could not be tested")?.coordinates);
            println!("garter, fitted from there in {:.0} s: {found:?}", begun.elapsed().as_secs_f64());
            println!("  {:?}", judge(garter, found));
        }
    }
    Ok(())
}
