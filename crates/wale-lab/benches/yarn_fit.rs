//! Time of a yarn's fit from the fabric file to the numbers, by gradients and by the swarm: `cargo bench -p wale-lab --bench yarn_fit --
//! [gradients|swarm]`; without a way, both.

use std::path::Path;
use std::time::Instant;

use wale_lab::fabric_file::FabricFile;
use wale_lab::shell::membrane_fit::MembraneFitSettings;
use wale_lab::shell::of_fabric::fit_shell;
use wale_lab::yarn_fit::gradients::GradientSettings;
use wale_lab::yarn_fit::of_fabric::{Ablation, yarn_problem};
use wale_lab::yarn_fit::problem::Here;
use wale_lab::yarn_fit::run::{Way, fit_yarn};
use wale_lab::yarn_fit::swarm::SwarmSettings;
use wale_lab::yarn_fit::{Progress, Step};

type Failure = Box<dyn std::error::Error + Send + Sync>;

fn main() -> Result<(), Failure> {
    // Cargo says --bench to every bench.
    let only = std::env::args().skip(1).find(|argument| argument != "--bench");
    let begun = Instant::now();
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fabrics/acrylic-stockinette/fabric.toml");
    let fabric = FabricFile::read(&file)?;
    let shell = fit_shell(&fabric, &MembraneFitSettings::default())?;
    let problem = yarn_problem(&fabric, &shell, Ablation::default())?;
    println!(
        "shell and tile: {:.1} s; {} vertices, {} threads",
        begun.elapsed().as_secs_f64(),
        problem.tile.vertex_count(),
        rayon::current_num_threads()
    );
    let ways =
        [("gradients", Way::Gradients(GradientSettings::default())), ("swarm", Way::Swarm(SwarmSettings::default()))];
    for (name, way) in ways.iter().filter(|(name, _)| only.as_ref().is_none_or(|only| only == name)) {
        let begun = Instant::now();
        let silent = |_: &Step| {};
        let Ok(found) = fit_yarn(&problem, &Here::new(&problem), way, &Progress::new(&silent));
        let found = found.ok_or("the tile could not be tested")?;
        let error = found.error;
        println!(
            "{name}: {:.0} s, {} evaluations, sum of squares {:.4}; comfort {:.1} %, full range {:.1} %, compression {:.1} %",
            begun.elapsed().as_secs_f64(),
            found.evaluations,
            found.cost,
            100.0 * error.comfort,
            100.0 * error.full,
            100.0 * error.compression
        );
    }
    Ok(())
}
