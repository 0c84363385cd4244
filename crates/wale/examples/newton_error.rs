//! Error of a time step by Newton iterations: one step of a scene, solved with fewer iterations and looser linear
//! solves, against the same step solved to the end.
//!
//! `cargo run -p wale --example newton_error -- scenes/stockinette-curl.toml 0.1`

use std::process::ExitCode;

use wale::model::LinearSolver;
use wale::scene::Scene;
use wale::simulation::{Simulation, Start};

/// Iterations of the step that the others are measured against.
const TO_THE_END: u32 = 60;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, path, until] = arguments.as_slice() else {
        eprintln!("usage: newton_error SCENE SECONDS");
        return ExitCode::from(2);
    };
    match run(path, until.parse().unwrap_or(0.1)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn run(path: &str, until: f64) -> Result<(), Box<dyn std::error::Error>> {
    let text = std::fs::read_to_string(path)?;
    let scene = Scene::from_text(&text, path)?;
    let start = Start::new(&scene.structure, &scene.yarns, &scene.fabric, true);
    let simulation = |iterations: Option<u32>, solver: LinearSolver, tolerance: f64| {
        let mut plan = scene.plan.clone();
        if let Some(iterations) = iterations {
            plan.simulation.newton_iterations = iterations;
            plan.simulation.newton_tolerance = 1e-12;
            plan.simulation.linear_solver = solver;
            plan.simulation.linear_tolerance = tolerance;
        }
        Simulation::new(start.network.clone(), &scene.yarns, &scene.fabric, plan)
    };
    let mut before = simulation(None, LinearSolver::Automatic, 0.0);
    while before.state().time < until {
        before.step()?;
    }
    let nodes = before.network().node_count();
    let radius = scene.yarns.first().radius;
    println!("{path}: {nodes} nodes, one step from {:.3} s; errors in yarn radii", before.state().time);
    println!("                         0.001            0.03                 0.1                 0.3");
    println!("iterations      mean   largest      mean   largest      mean   largest      mean   largest");
    let mut reference = simulation(Some(TO_THE_END), LinearSolver::ConjugateGradient, 1e-3);
    reference.restore(before.state().clone());
    reference.step()?;
    let error = |other: &Simulation| {
        let (a, b) = (reference.frame(), other.frame());
        let errors = a.positions.iter().zip(&b.positions).map(|(a, b)| a.distance_squared(*b));
        let (sum, largest) = errors.fold((0.0, 0.0f64), |(sum, largest), e| (sum + e, largest.max(e)));
        ((sum / nodes as f64).sqrt() / radius, largest.sqrt() / radius)
    };
    for iterations in [1, 2, 3, 4, 5, 6, 8, 10, 15] {
        print!("{iterations:10}");
        for (solver, tolerance) in [
            (LinearSolver::ConjugateGradient, 0.001),
            (LinearSolver::ConjugateGradient, 0.03),
            (LinearSolver::ConjugateGradient, 0.1),
            (LinearSolver::ConjugateGradient, 0.3),
        ] {
            let mut other = simulation(Some(iterations), solver, tolerance);
            other.restore(before.state().clone());
            other.step()?;
            let same = (reference.state().time - other.state().time).abs() < 1e-12;
            if same {
                let (mean, largest) = error(&other);
                print!("  {mean:8.1e}  {largest:8.1e}");
            } else {
                print!("    (rejected)      ");
            }
        }
        println!();
    }
    let mut own = simulation(None, LinearSolver::ConjugateGradient, 0.0);
    own.restore(before.state().clone());
    let report = own.step()?;
    let (mean, largest) = error(&own);
    println!(
        "as it ends by itself: {mean:.1e} {largest:.1e} after {} iterations, {} linear",
        report.newton_iterations, report.linear_iterations
    );
    Ok(())
}
