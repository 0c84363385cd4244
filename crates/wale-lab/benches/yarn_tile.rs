//! Equilibria a second of a yarn tile along strain paths, each equilibrium from the one before: `cargo bench -p wale-lab --bench
//! yarn_tile -- [PATTERN.pyp]`; without a tile, the stored stockinette of a hundred vertices, where it stands beside the project.

use std::path::{Path, PathBuf};
use std::time::Instant;

use rayon::prelude::*;
use wale::energy::ContactReading;
use wale_lab::yarn_tile::{CoarseDeformation, EquilibriumSettings, RodMaterial, TileSolver, read_pattern};

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Strains of a path: up to a fifth in steps of one in a hundred.
const STEPS: u32 = 20;
const STEP: f64 = 0.01;
/// Directions in which it is stretched, evenly over half a turn.
const PATHS: usize = 8;

/// Readings of contact with a stiffness \[J/m²\]: very soft as printed, and as hard as a yarn that keeps its shape.
const CONTACTS: [(ContactReading, f64); 2] = [(ContactReading::SquareOfBarrier, 1e2), (ContactReading::Barrier, 2.3e3)];

fn main() -> Result<(), Failure> {
    let near = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/yarn-tiles-madypg/stockinette.pyp");
    // Cargo says --bench to every bench.
    let path = std::env::args().skip(1).find(|argument| argument != "--bench").map_or(near, PathBuf::from);
    if !path.exists() {
        println!("{} is not there: nothing is measured", path.display());
        return Ok(());
    }
    let tile = read_pattern(&path.display().to_string(), &std::fs::read_to_string(&path)?)?;
    for (free, (reading, contact)) in [false, true].into_iter().flat_map(|free| CONTACTS.map(|contact| (free, contact)))
    {
        let material = RodMaterial { reading, ..RodMaterial::solid_rod(tile.radius(), 1e6, contact) };
        let run = |index: usize| -> Result<[usize; 2], Failure> {
            let angle = std::f64::consts::PI * index as f64 / PATHS as f64;
            let make = if free { TileSolver::free_compression } else { TileSolver::new };
            let mut solver = make(&tile, &material, EquilibriumSettings::default())?;
            let mut compression = 0.0;
            let mut count = [0; 2];
            for step in 0..=STEPS {
                let stretch = STEP * f64::from(step);
                let found = solver.solve(&CoarseDeformation::stretched(angle, stretch, compression))?;
                compression = found.deformation.compression();
                count[0] += usize::from(found.converged);
                count[1] += found.iterations;
            }
            Ok(count)
        };
        let begun = Instant::now();
        let counts: Vec<[usize; 2]> = (0..PATHS).into_par_iter().map(run).collect::<Result<_, _>>()?;
        let seconds = begun.elapsed().as_secs_f64();
        let all = PATHS * (STEPS as usize + 1);
        let (reached, iterations) = counts.iter().fold((0, 0), |(a, b), c| (a + c[0], b + c[1]));
        println!(
            "{} vertices, {reading:?}, compression {}: {reached} of {all} equilibria in {seconds:.2} s on {} threads: {:.1} a second, \
             {:.1} iterations each, {:.2} ms an iteration and thread",
            tile.vertex_count(),
            if free { "free" } else { "held" },
            rayon::current_num_threads(),
            reached as f64 / seconds,
            iterations as f64 / all as f64,
            1e3 * seconds * rayon::current_num_threads() as f64 / iterations as f64,
        );
    }
    Ok(())
}
