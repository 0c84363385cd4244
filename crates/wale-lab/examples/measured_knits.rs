//! Yarns fitted to hand-knitted stockinette and garter of one acrylic yarn [Singal2024], and garter foretold from stockinette alone.
//!
//! ```text
//! cargo run --release -p wale-lab --example measured_knits -- [all|near|foretell|sizes [NUMBERS]]
//! ```
//!
//! `near` fits garter by least squares from the yarn of stockinette alone; `foretell` leaves out the fit of garter. Both leave out that of
//! stockinette if the seven numbers of its yarn are given. `sizes` fits nothing and tells how the tiles lie.

use std::path::Path;
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
const FABRICS: [&str; 2] = ["acrylic-stockinette", "acrylic-garter"];

fn problem(name: &str) -> Result<YarnProblem, Failure> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fabrics").join(name).join("fabric.toml");
    let fabric = FabricFile::read(&path)?;
    let settings = MembraneFitSettings { targets: POINTS, ..MembraneFitSettings::default() };
    Ok(yarn_problem(&fabric, &fit_shell(&fabric, &settings)?, Ablation::default())?)
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
    let what = std::env::args().nth(1).unwrap_or_else(|| "all".to_owned());
    let problems = FABRICS.iter().map(|name| problem(name)).collect::<Result<Vec<_>, Failure>>()?;
    let given: Vec<f64> = std::env::args().skip(2).map(|number| number.parse()).collect::<Result<_, _>>()?;
    let mut of_stockinette: Option<[f64; P]> = given.try_into().ok();
    for (k, (name, problem)) in FABRICS.iter().zip(&problems).enumerate() {
        println!("{name}");
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
