use wale_lab::yarn_tile::*;
fn main() {
    let tile =
        read_pattern("s", &std::fs::read_to_string("/work/shared/data/yarn-tiles-madypg/stockinette.pyp").unwrap())
            .unwrap();
    let material = RodMaterial::solid_rod(tile.radius(), 1e6, 1e2);
    for free in [false, true] {
        for angle in [0.0, 0.785, 1.57] {
            let make = if free { TileSolver::free_compression } else { TileSolver::new };
            let mut solver = make(&tile, &material, EquilibriumSettings::default()).unwrap();
            let mut c = 0.0;
            print!("{free} {angle}:");
            let t = std::time::Instant::now();
            let mut sum = 0;
            for step in 0..=20 {
                let f = solver.solve(&CoarseDeformation::stretched(angle, 0.01 * step as f64, c)).unwrap();
                c = f.deformation.compression();
                sum += f.iterations;
                print!(" {}{}", if f.converged { "" } else { "!" }, f.iterations);
            }
            println!(" ms/it {:.2}", 1e3 * t.elapsed().as_secs_f64() / sum as f64);
        }
    }
}
