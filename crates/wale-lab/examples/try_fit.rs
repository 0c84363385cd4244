//! Experiment: try_fit FABRIC.toml [PREDICT.toml ...]
use std::path::Path;
use std::time::Instant;
use wale_lab::fabric_file::FabricFile;
use wale_lab::fabric_fit::fit_fabric;
use wale_lab::shell::membrane_fit::MembraneFitSettings;
use wale_lab::yarn_fit::gradients::*;
use wale_lab::yarn_fit::of_fabric::*;
use wale_lab::yarn_fit::problem::*;
use wale_lab::yarn_fit::swarm::*;
use wale_lab::yarn_fit::*;

fn load(path: &str) -> YarnProblem {
    let fabric = FabricFile::read(Path::new(path)).unwrap_or_else(|e| panic!("{e}"));
    let shell = fit_fabric(&fabric, &MembraneFitSettings { targets: 8, ..Default::default() }).unwrap();
    println!("shell {:.3} {:.3}", shell.membrane.force_error, shell.membrane.compression_error);
    let p0 =
        yarn_problem(&fabric, &shell, Ablation { nothing_holds: std::env::var("FREE").is_ok(), ..Default::default() })
            .unwrap_or_else(|e| panic!("{e}"));
    let num = |n: &str| std::env::var(n).map_or(1.0, |x| x.parse::<f64>().unwrap());
    let (a, b, c) = (num("SX"), num("SY"), num("SZ"));
    let t = &p0.tile;
    let tile = wale_lab::yarn_tile::YarnTile::new(
        [a * t.periods()[0], b * t.periods()[1]],
        t.radius(),
        t.vertices().iter().map(|x| [a * x[0], b * x[1], c * x[2]]).collect(),
        t.edges().to_vec(),
        t.rest_lengths().to_vec(),
        t.rest_curvatures().to_vec(),
    )
    .unwrap()
    .at_rest_as_it_lies();
    let mut p = problem(
        tile,
        p0.targets.clone(),
        vec![],
        None,
        Ablation { nothing_holds: std::env::var("FREE").is_ok(), ..Default::default() },
    );
    println!("yarn length {} ", p.tile.lengths().iter().sum::<f64>());
    match std::env::var("READING").as_deref() {
        Ok("b") => p.base.reading = wale::energy::ContactReading::Barrier,
        Ok("s") => p.base.reading = wale::energy::ContactReading::BarrierOfSquare,
        _ => {}
    }
    if let Ok(a) = std::env::var("ANCHOR") {
        p.pull.equilibrium.anchor = a.parse().unwrap();
    }
    if let Ok(a) = std::env::var("LATE") {
        p.rest.late_rounds = a.parse().unwrap();
    }
    p
}

fn show(problem: &YarnProblem, here: &Here, at: [f64; 7]) {
    let q = Question::of(at, 8, false);
    let Ok(e) = here.answer(&q);
    let Some(e) = e else {
        println!("cannot be tested");
        return;
    };
    let t: Vec<Target> = problem.targets.iter().map(|t| t.resampled(8)).collect();
    for (t, a) in t.iter().zip(&e.stretch) {
        for (t, a) in t.points.iter().zip(a) {
            println!("   {:.3}: {:8.2} {:8.2} N/m   {:.3} {:.3}", t[0], t[1], a.point.force, t[2], a.point.compression);
        }
        println!("   comfort to {:.3}", problem.targets[0].comfort);
    }
    println!("{:?}", errors(&t, &e.stretch));
}

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let problem = load(&args[0]);
    println!(
        "{} vertices periods {:?} radius {} R_est {}",
        problem.tile.vertex_count(),
        problem.tile.periods(),
        problem.tile.radius(),
        problem.base.contact[0].radius
    );
    println!("{:?}", problem.space);
    let t0 = Instant::now();
    let tell = |s: &Step| {
        if s.evaluations % 16 == 0 {
            println!("{} best {:.3e} {:.1}s", s.evaluations, s.best, t0.elapsed().as_secs_f64())
        }
    };
    let progress = Progress::new(&tell);
    let here = Here::new(&problem);
    let mut g = GradientSettings::default();
    if let Ok(s) = std::env::var("SCREEN") {
        g.screened = s.parse().unwrap();
    }
    let Ok(found) = (if std::env::var("SWARM").is_ok() {
        fit_by_swarm(&problem, &here, &SwarmSettings::default(), &progress)
    } else {
        fit_by_gradients(&problem, &here, &g, &progress)
    });
    let found = found.unwrap();
    let at = RodSpace::parameters(found.coordinates);
    println!(
        "{:.1}s cost {:.3e} evals {} at {at:?}",
        t0.elapsed().as_secs_f64(),
        found.cost,
        progress.now().evaluations
    );
    if let Some(l) = &found.least_squares {
        println!("uncertainty {:?}", l.uncertainty);
    }
    show(&problem, &here, at);
    for other in &args[1..] {
        println!("--- {other}");
        let p = load(other);
        let p = YarnProblem { base: problem.base, ..p };
        show(&p, &Here::new(&p), at);
    }
}
