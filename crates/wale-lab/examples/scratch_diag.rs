use wale::pattern::weave::Draft;
use wale_lab::yarn_fit::of_fabric::{Ablation, problem};
use wale_lab::yarn_tile::*;
fn main() {
    let which = std::env::args().nth(1).unwrap_or_default();
    let radius = 0.25e-3;
    let draft = if which == "twill" { Draft::twill(2, 1).unwrap() } else { Draft::plain() };
    let tile = tile_of_draft(&draft, radius, [1.1e-3, 1.2e-3], [2.0 * radius; 2]).unwrap();
    let problem = problem(tile, Vec::new(), Vec::new(), Some(100.0), Ablation::default());
    let r = contact_radius(&problem.tile);
    let bending = 0.5 * 25.0 * r * r;
    let m = problem.base.with_parameters([8.0, 100.0, 0.05, bending, 1.05 * r, 5.0 / r, 0.4 * bending / r.powi(4)]);
    let begun = std::time::Instant::now();
    let tile = problem.rested(&m.parameters()).expect("rested");
    println!("rested in {:.2} s", begun.elapsed().as_secs_f64());
    for angle in [0.0, std::f64::consts::FRAC_PI_4] {
        let mut solver = TileSolver::free_compression(&tile, &m, problem.pull.equilibrium).unwrap();
        let mut c = 0.0;
        for k in 0..=8 {
            let s = if angle == 0.0 { 0.01 } else { 0.02 } * f64::from(k);
            let found = solver.solve(&CoarseDeformation::stretched(angle, s, c)).unwrap();
            c = found.deformation.compression();
            let slopes = solver.slopes().unwrap();
            // A micrometre beside it.
            let mut other = TileSolver::free_compression(&tile, &m, problem.pull.equilibrium).unwrap();
            let mut seed = 7u64;
            let shaken: Vec<[f64; 3]> = found
                .displacement
                .iter()
                .map(|u| {
                    let mut out = [0.0; 3];
                    for i in 0..3 {
                        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                        out[i] = u[i] + 1e-6 * ((seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0);
                    }
                    out
                })
                .collect();
            other.place(&found.deformation, &shaken).unwrap();
            let again = other.solve(&found.deformation).unwrap();
            println!(
                "{s:.2} c {c:.4} stress {:.3} after {} residual {:.1e} stable {} ; shaken {:.3} c {:.4} after {}",
                found.stress.stretch,
                found.iterations,
                found.residual,
                slopes.stable,
                again.stress.stretch,
                again.deformation.compression(),
                again.iterations
            );
        }
    }
}
