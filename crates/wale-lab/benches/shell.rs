//! Time of a load step of a clamped swatch of 5,000 triangles on one core: `cargo bench -p wale-lab --bench shell`.

use std::time::Instant;

use wale::energy::{BendingStiffness, MembraneStiffness};
use wale::fabric::coordinates::BLOCK;
use wale_lab::shell::mesh::Rectangle;
use wale_lab::shell::rest::come_to_rest;
use wale_lab::shell::{ClampedStretch, OutOfPlane, RestSettings, ShellCard, ShellSystem};

fn main() {
    let membrane =
        MembraneStiffness { xx: 25.0, xy: 4.0, yy: 80.0, ss: 7.0, n1: 1.5, n2: 3.0, ..MembraneStiffness::NONE };
    let card = ShellCard { membrane, bending: BendingStiffness::isotropic(2e-6), areal_mass: 0.2 };
    let edge = 1.66e-3;
    let rectangle = Rectangle::new(0.1, 0.06, edge).expect("a rectangle");
    let triangles = rectangle.mesh.triangles.len();
    println!("{triangles} triangles, {} vertices", rectangle.mesh.points.len());
    for (name, out_of_plane) in
        [("flat", OutOfPlane::Flat), ("free to wrinkle", OutOfPlane::Free { disturbance: 1e-4 })]
    {
        for degrees in [0.0f64, 45.0] {
            let test = ClampedStretch { edge, angle: degrees.to_radians(), out_of_plane, ..ClampedStretch::default() };
            let begin = Instant::now();
            let stretches = [0.2, 0.4, 0.6, 0.8];
            match test.run(&card, &stretches) {
                Ok(points) => {
                    let seconds = begin.elapsed().as_secs_f64() / stretches.len() as f64;
                    println!("{name}, {degrees}°: {seconds:.3} s a load step of 20 %; {:.4} N", points[3].force);
                }
                Err(error) => println!("{name}, {degrees}°: {error}"),
            }
        }
    }
    parts(&rectangle, &card);
}

/// What an iteration of Newton's method in three dimensions is made of, each the least of ten.
fn parts(rectangle: &Rectangle, card: &ShellCard) {
    let mut held = vec![[false; 3]; rectangle.mesh.points.len()];
    for end in rectangle.ends() {
        held[end].fill([true; 3]);
    }
    let begin = Instant::now();
    let mut system = ShellSystem::new(&rectangle.mesh, card, 0.0, [0.0; 3], &held).expect("a system");
    println!("set up: {:.1} ms", 1e3 * begin.elapsed().as_secs_f64());
    let mut q = vec![0.0; BLOCK * rectangle.mesh.points.len()];
    for (v, [x, y]) in rectangle.mesh.points.iter().enumerate() {
        q[BLOCK * v..BLOCK * v + 3].copy_from_slice(&[1.2 * x, *y, 1e-4 * (300.0 * y).sin()]);
    }
    for (name, convexity) in [("exact", 0.0), ("convex", 1.0)] {
        println!("{name} second derivatives: {:.1} ms", 1e3 * least(|| _ = system.linearise(&q, convexity)));
    }
    let mut definite = true;
    let seconds = least(|| definite &= system.step(0.0).expect("finite").is_some());
    println!("factor and solve: {:.1} ms (definite: {definite})", 1e3 * seconds);
    println!("energy: {:.1} ms", 1e3 * least(|| assert!(system.energy(&q) > 0.0)));
    match come_to_rest(&mut system, &mut q, &RestSettings::default()) {
        Ok(report) => println!("at rest after {} iterations", report.iterations),
        Err(error) => println!("{error}"),
    }
}

/// Least time of ten runs \[s\]: what others do on the machine can only add to it.
fn least(mut run: impl FnMut()) -> f64 {
    (0..10)
        .map(|_| {
            let begin = Instant::now();
            run();
            begin.elapsed().as_secs_f64()
        })
        .fold(f64::INFINITY, f64::min)
}
