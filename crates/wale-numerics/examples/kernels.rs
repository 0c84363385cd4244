//! Times of the linear kernels on matrices shaped like a garter swatch, beside a memory triad.
//!
//! `cargo run -p wale-numerics --example kernels -- [wales courses]`

#[path = "../tests/common/mod.rs"]
mod common;

use common::*;
use std::sync::Arc;
use std::time::Instant;
use wale_numerics::block_matrix::{BlockMatrix, SLOTS};
use wale_numerics::coarse_space::CoarseSpace;
use wale_numerics::conjugate_gradient::{ConjugateGradient, ConjugateGradientSettings};
use wale_numerics::incomplete_cholesky::{IncompleteCholesky, IncompleteCholeskySettings};
use wale_numerics::preconditioner::{Additive, BlockJacobi, Preconditioner};
use wale_numerics::prolongation::Prolongation;
use wale_numerics::sparse_cholesky::{BlockOrder, SparseCholesky};
use wale_numerics::triad::triad_bandwidth;
use wale_numerics::vector;

/// Shortest of some calls, in seconds.
fn shortest(rounds: usize, mut run: impl FnMut()) -> f64 {
    (0..rounds)
        .map(|_| {
            let start = Instant::now();
            run();
            start.elapsed().as_secs_f64()
        })
        .fold(f64::INFINITY, f64::min)
}

/// More calls on small matrices, to find a quiet moment on a busy machine.
fn rounds_of(rows: usize) -> usize {
    (1_000_000 / rows).clamp(10, 500)
}

fn report(name: &str, seconds: f64, bytes: usize, triad: f64) {
    let speed = bytes as f64 / seconds;
    println!("{name:<28} {:9.3} ms  {:6.1} GB/s  {:5.2} of triad", seconds * 1e3, speed / 1e9, speed / triad);
}

fn incomplete(name: &str, matrix: &BlockMatrix, b: &[f64], domains: usize, triad: f64) {
    let settings = IncompleteCholeskySettings { max_domains: domains, ..Default::default() };
    let rounds = rounds_of(matrix.rows());
    let mut factor = IncompleteCholesky::new(Arc::clone(matrix.pattern()), settings);
    let mut outcome = None;
    let seconds = shortest(rounds.min(50), || outcome = Some(factor.factor(matrix)));
    let lower = (matrix.pattern().block_count() - matrix.rows()) / 2;
    let width = 4 * 25;
    println!("{name}: {outcome:?}");
    report(
        &format!("{name} factor"),
        seconds,
        matrix.pattern().block_count() * 100 + (lower + matrix.rows()) * width,
        triad,
    );
    let mut x = vec![0.0; b.len()];
    let seconds = shortest(rounds, || factor.apply(b, &mut x));
    let bytes = 2 * (lower + matrix.rows()) * width;
    report(&format!("{name} apply"), seconds, bytes, triad);
}

fn kernels(wales: usize, courses: usize) {
    let start = Instant::now();
    let Swatch { matrix, coordinates, free } = swatch(wales, courses);
    let rows = matrix.rows();
    let rounds = rounds_of(rows);
    let pattern = matrix.pattern();
    println!(
        "\n{wales} x {courses} loops: {rows} blocks, {:.2} blocks a row (built in {:.2} s)",
        pattern.block_count() as f64 / rows as f64,
        start.elapsed().as_secs_f64()
    );
    let triad = triad_bandwidth(8 << 20, 10);
    println!("triad {:.1} GB/s", triad / 1e9);
    let mut b = Sequence(1).vector(matrix.dimension());
    vector::keep_free(&mut b, &free);
    let mut x = vec![0.0; b.len()];

    let product_bytes =
        |width| pattern.block_count() * (25 * width + 4) + rows * (2 * SLOTS * width + size_of::<usize>());
    let seconds = shortest(rounds, || matrix.multiply(&b, &mut x));
    report("product f64", seconds, product_bytes(8), triad);
    let mut narrow = BlockMatrix::<f32>::zeros(Arc::clone(pattern));
    let seconds = shortest(5, || narrow.copy_from(&matrix));
    report("copy to f32", seconds, pattern.block_count() * 300, triad);
    let b32: Vec<f32> = b.iter().map(|&v| v as f32).collect();
    let mut x32 = b32.clone();
    let seconds = shortest(rounds, || narrow.multiply(&b32, &mut x32));
    report("product f32", seconds, product_bytes(4), triad);
    let mut sum = 0.0;
    let seconds = shortest(20, || sum = vector::dot(&b, &x));
    report("dot", seconds, 16 * b.len(), triad);
    let seconds = shortest(20, || vector::add_scaled(&mut x, sum * 1e-9, &b));
    report("add_scaled", seconds, 24 * b.len(), triad);

    let mut jacobi = BlockJacobi::new(rows);
    let seconds = shortest(rounds.min(50), || jacobi.factor(&matrix));
    report("block Jacobi factor", seconds, rows * 300, triad);
    let seconds = shortest(10, || jacobi.add(&b, &mut x));
    report("block Jacobi apply", seconds, rows * 220, triad);
    incomplete("IC(0)", &matrix, &b, 32, triad);
    incomplete("IC(0), 2 domains", &matrix, &b, 2, triad);

    let start = Instant::now();
    let hats = Prolongation::bilinear(&coordinates, 6.0);
    let mut coarse = CoarseSpace::new(Arc::clone(pattern), hats, &free).unwrap();
    println!("coarse: {} unknowns, set up in {:.0} ms", coarse.unknowns(), start.elapsed().as_secs_f64() * 1e3);
    let seconds = shortest(rounds.min(50), || {
        coarse.factor(&matrix).unwrap();
    });
    report("coarse factor", seconds, pattern.block_count() * 200, triad);
    let seconds = shortest(rounds, || coarse.add(&b, &mut x));
    report("coarse apply", seconds, rows * 100, triad);

    let mut local = IncompleteCholesky::new(Arc::clone(pattern), IncompleteCholeskySettings::default());
    local.factor(&matrix).unwrap();
    let mut gradient = ConjugateGradient::new(b.len());
    for tolerance in [1e-1, 1e-2] {
        let settings =
            ConjugateGradientSettings { relative_tolerance: tolerance, max_iterations: 200, ..Default::default() };
        let mut solve = |name: &str, preconditioner: &mut dyn Preconditioner| {
            let mut iterations = 0;
            let seconds = shortest(2, || {
                x.fill(0.0);
                let report = gradient.solve(&matrix, preconditioner, &b, &mut x, None, &settings);
                iterations = report.iterations;
            });
            println!(
                "PCG to {tolerance:.0e}, {name}: {iterations} iterations, {:.2} ms each",
                seconds * 1e3 / (iterations + 1) as f64
            );
        };
        solve("IC(0)", &mut local);
        solve("IC(0) + coarse", &mut Additive(&mut local, &mut coarse));
        if rows < 60_000 {
            solve("Jacobi + coarse", &mut Additive(&mut jacobi, &mut coarse));
        }
    }

    if rows <= 25_000 {
        let start = Instant::now();
        let mut direct = SparseCholesky::new(Arc::clone(pattern), &free, BlockOrder::MinimumDegree).unwrap();
        println!(
            "direct: symbolic {:.0} ms, {:.1} values an unknown",
            start.elapsed().as_secs_f64() * 1e3,
            direct.factor_values() as f64 / direct.unknowns() as f64
        );
        let seconds = shortest(2, || direct.factor(&matrix, 0.0).unwrap());
        println!("direct factor {:.1} ms", seconds * 1e3);
        let seconds = shortest(3, || {
            x.copy_from_slice(&b);
            direct.solve_in_place(&mut x);
        });
        let bytes = 16 * direct.factor_values();
        report("direct solve", seconds, bytes, triad);
    }
}

fn main() {
    let sizes: Vec<usize> = std::env::args().skip(1).filter_map(|s| s.parse().ok()).collect();
    match sizes[..] {
        [wales, courses] => kernels(wales, courses),
        _ => [[30, 30], [70, 70], [112, 112], [237, 237]].iter().for_each(|&[wales, courses]| kernels(wales, courses)),
    }
}
