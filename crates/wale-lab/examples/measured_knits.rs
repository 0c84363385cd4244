//! Yarns fitted to hand-knitted stockinette and garter of one acrylic yarn [Singal2024], and garter foretold from stockinette alone.
//!
//! ```text
//! cargo run --release -p wale-lab --example measured_knits -- [SUMMARY.csv]
//! ```

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use wale_lab::fabric_file::FabricFile;
use wale_lab::shell::membrane_fit::MembraneFitSettings;
use wale_lab::shell::of_fabric::fit_shell;
use wale_lab::yarn_fit::gradients::GradientSettings;
use wale_lab::yarn_fit::of_fabric::{Ablation, yarn_problem};
use wale_lab::yarn_fit::problem::{Answers, Here, P, Question, YarnProblem};
use wale_lab::yarn_fit::run::{Way, fit_yarn};
use wale_lab::yarn_fit::{Progress, Target, YarnFitError, errors};

type Failure = Box<dyn std::error::Error + Send + Sync>;

const POINTS: usize = 8;
/// Fabrics, with the loop length: twice what the authors give for their cell, which is half a loop.
const FABRICS: [(&str, &str); 2] = [("stockinette", "22.56 mm"), ("garter", "21.1 mm")];

/// A fabric file of the means over the trials, in a folder.
fn fabric(table: &Path, folder: &Path, stitch: &str, loop_length: &str) -> Result<FabricFile, Failure> {
    let text = std::fs::read_to_string(table)?;
    let mut rows = text.lines().filter(|line| !line.starts_with('#')).map(|line| line.split(',').collect::<Vec<_>>());
    let heads = rows.next().ok_or("the table is empty")?;
    let column = |name: &str| heads.iter().position(|head| *head == name).ok_or(format!("there is no column {name}"));
    let (kind, direction, force) = (column("stitch")?, column("direction")?, column("line_force_N_per_mm")?);
    let (strain, across) = (column("axial_strain_mean")?, column("transverse_strain_mean")?);
    let (width, length) = (column("fabric_width_mm")?, column("initial_clamp_length_mm")?);
    let rows: Vec<Vec<&str>> =
        rows.filter(|row| row[column("yarn").unwrap_or(0)] == "acrylic" && row[kind] == stitch).collect();
    let mut file = format!("schema = 1\ntitle = \"Acrylic {stitch}\"\n[structure]\nscene = \"{stitch}-scene.toml\"\n");
    for (letter, name) in [("X", "course"), ("Y", "wale")] {
        let mut curve = "strain,line force (N/mm),transverse strain\n0,0,0\n".to_owned();
        for row in rows.iter().filter(|row| row[direction] == letter) {
            let _ = writeln!(curve, "{},{},{}", row[strain], row[force], row[across]);
        }
        let first = rows.iter().find(|row| row[direction] == letter).ok_or("a direction is missing")?;
        let _ = write!(
            file,
            "[[stretch]]\ndirection = \"{name}\"\nfile = \"{stitch}-{name}.csv\"\nlength = \"{} mm\"\nwidth = \"{} mm\"\n",
            first[length], first[width]
        );
        std::fs::write(folder.join(format!("{stitch}-{name}.csv")), curve)?;
    }
    let scene = format!(
        "schema = 1\n[yarn]\npreset = \"thick-acrylic\"\n[fabric]\nloop_length = \"{loop_length}\"\n\
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

fn main() -> Result<(), Failure> {
    let near = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/knit-tensile-singal2024/summary.csv");
    let table = std::env::args().nth(1).map_or(near, PathBuf::from);
    if !table.exists() {
        println!("{} is not there: nothing to fit", table.display());
        return Ok(());
    }
    let folder = tempfile::tempdir()?;
    let problems = FABRICS
        .iter()
        .map(|(stitch, loop_length)| problem(&fabric(&table, folder.path(), stitch, loop_length)?))
        .collect::<Result<Vec<_>, Failure>>()?;
    let mut of_stockinette = None;
    for ((stitch, _), problem) in FABRICS.iter().zip(&problems) {
        let begun = Instant::now();
        let silent = |_: &wale_lab::yarn_fit::Step| {};
        let way = Way::Gradients(GradientSettings::default());
        let Ok(found) = fit_yarn(problem, &Here::new(problem), &way, &Progress::new(&silent));
        let found = found.ok_or("the tile could not be tested")?;
        let parameters = found.material.parameters();
        println!("{stitch}, fitted in {:.0} s: {:?}", begun.elapsed().as_secs_f64(), found.error);
        println!("  {parameters:?}\n  {}", found.open.join("; "));
        judge(problem, parameters);
        of_stockinette.get_or_insert(parameters);
    }
    if let Some(parameters) = of_stockinette {
        println!("garter, of the yarn of stockinette");
        // The yarn is the same; its inner contact is that of stockinette, too.
        let foretold = YarnProblem { base: problems[0].base, ..problems[1].clone() };
        println!("  {:?}", judge(&foretold, parameters));
    }
    Ok(())
}
