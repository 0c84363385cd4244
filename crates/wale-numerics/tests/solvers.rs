//! Conjugate gradients and their preconditioners.

mod common;

use common::*;
use std::sync::Arc;
use wale_numerics::block_matrix::{BlockMatrix, SLOTS};
use wale_numerics::block_pattern::BlockPattern;
use wale_numerics::coarse_space::CoarseSpace;
use wale_numerics::conjugate_gradient::{
    ConjugateGradient, ConjugateGradientEnd, ConjugateGradientReport, ConjugateGradientSettings,
};
use wale_numerics::incomplete_cholesky::{IncompleteCholesky, IncompleteCholeskySettings};
use wale_numerics::preconditioner::{Additive, BlockJacobi, Identity, Preconditioner};
use wale_numerics::prolongation::Prolongation;
use wale_numerics::sparse_cholesky::{BlockOrder, SparseCholesky};

fn settings(tolerance: f64) -> ConjugateGradientSettings {
    ConjugateGradientSettings { max_iterations: 3000, relative_tolerance: tolerance, ..Default::default() }
}

fn direct(matrix: &BlockMatrix, free: &[bool], b: &[f64]) -> Vec<f64> {
    let pattern = Arc::clone(matrix.pattern());
    let mut cholesky = SparseCholesky::new(pattern, free, BlockOrder::MinimumDegree).unwrap();
    cholesky.factor(matrix, 0.0).unwrap();
    let mut x = b.to_vec();
    cholesky.solve_in_place(&mut x);
    x
}

fn right_hand_side(free: &[bool], seed: u64) -> Vec<f64> {
    let mut b = Sequence(seed).vector(free.len());
    wale_numerics::vector::keep_free(&mut b, free);
    b
}

#[test]
fn all_preconditioners_lead_to_the_direct_solution() {
    let Swatch { matrix, coordinates, free } = swatch(12, 20);
    let b = right_hand_side(&free, 1);
    let expected = direct(&matrix, &free, &b);
    let pattern = matrix.pattern();
    let mut jacobi = BlockJacobi::new(matrix.rows());
    jacobi.factor(&matrix);
    let cut = IncompleteCholeskySettings { rows_per_domain: 200, ..Default::default() };
    let mut incomplete = IncompleteCholesky::new(Arc::clone(pattern), cut);
    incomplete.factor(&matrix).unwrap();
    let hats = Prolongation::bilinear(&coordinates, 4.0);
    let mut coarse = CoarseSpace::new(Arc::clone(pattern), hats, &free).unwrap();
    coarse.factor(&matrix).unwrap();
    let mut iterations = Vec::new();
    let mut check = |preconditioner: &mut dyn Preconditioner| {
        let mut x = vec![0.0; b.len()];
        let mut gradient = ConjugateGradient::new(b.len());
        let report = gradient.solve(&matrix, preconditioner, &b, &mut x, None, &settings(1e-10));
        assert_eq!(report.end, ConjugateGradientEnd::Converged);
        assert!(report.final_residual <= 1e-10 * report.initial_residual);
        assert_eq!(gradient.history().len(), report.iterations + 1);
        let error = largest_difference(&x, &expected) / largest(&expected);
        assert!(error < 1e-6, "error {error}");
        iterations.push(report.iterations);
    };
    check(&mut Identity);
    check(&mut jacobi);
    check(&mut incomplete);
    check(&mut Additive(&mut jacobi, &mut coarse));
    check(&mut Additive(&mut incomplete, &mut coarse));
    // Each is better than what it is built from.
    let [_, jacobi, incomplete, jacobi_coarse, incomplete_coarse] = iterations[..] else { unreachable!() };
    assert!(incomplete < jacobi && jacobi_coarse < jacobi, "{iterations:?}");
    // On so few loops the coarse space has nothing to add to IC(0), and must not hurt it.
    assert!(incomplete_coarse < jacobi_coarse && incomplete_coarse < incomplete + 10, "{iterations:?}");
}

#[test]
fn conjugate_gradients_solve_a_random_matrix() {
    let matrix = random_matrix(400, 8, 5);
    let free = vec![true; matrix.dimension()];
    let b = right_hand_side(&free, 2);
    let expected = direct(&matrix, &free, &b);
    let mut jacobi = BlockJacobi::new(matrix.rows());
    jacobi.factor(&matrix);
    let mut gradient = ConjugateGradient::new(b.len());
    let mut x = vec![0.0; b.len()];
    let report = gradient.solve(&matrix, &mut jacobi, &b, &mut x, None, &settings(1e-11));
    assert_eq!(report.end, ConjugateGradientEnd::Converged);
    assert!(largest_difference(&x, &expected) < 1e-8 * largest(&expected));
    // Started from the solution there is nothing left to do.
    let goal = ConjugateGradientSettings { absolute_tolerance: 1e-6, ..settings(0.0) };
    let report = gradient.solve(&matrix, &mut jacobi, &b, &mut x, None, &goal);
    assert_eq!((report.iterations, report.end), (0, ConjugateGradientEnd::Converged));
}

#[test]
fn conjugate_gradients_go_on_until_the_solution_settles() {
    let Swatch { matrix, free, .. } = swatch(20, 20);
    let b = right_hand_side(&free, 6);
    let mut jacobi = BlockJacobi::new(matrix.rows());
    jacobi.factor(&matrix);
    let mut gradient = ConjugateGradient::new(b.len());
    let mut solve = |goal: ConjugateGradientSettings| {
        let mut x = vec![0.0; b.len()];
        let report = gradient.solve(&matrix, &mut jacobi, &b, &mut x, None, &goal);
        assert_eq!(report.end, ConjugateGradientEnd::Converged);
        (report, wale_numerics::vector::norm(&x))
    };
    let (by_residual, _) = solve(settings(0.3));
    let (settled, size) = solve(ConjugateGradientSettings { relative_update: 1e-3, ..settings(0.3) });
    assert!(by_residual.last_update > 1e-3 * size, "the residual alone is deceived");
    assert!(settled.last_update <= 1e-3 * size && settled.iterations > by_residual.iterations);
    // Small updates end it before the residual does.
    let small = 1e-2 * size;
    let (exact, _) = solve(settings(1e-2));
    let (early, _) = solve(ConjugateGradientSettings { absolute_update: small, ..settings(1e-2) });
    assert!(early.last_update <= small && early.iterations < exact.iterations);
    assert!(early.final_residual <= 3.0 * 1e-2 * early.initial_residual);
}

#[test]
fn a_filter_does_what_taking_slots_out_does() {
    let matrix = random_matrix(150, 6, 15);
    let free: Vec<bool> = (0..matrix.dimension()).map(|s| s % 7 != 3).collect();
    let mut b = Sequence(3).vector(matrix.dimension());
    let expected = direct(&matrix, &free, &b);
    let mut jacobi = BlockJacobi::new(matrix.rows());
    jacobi.factor(&matrix);
    let mut gradient = ConjugateGradient::new(b.len());
    // What stands in b on fixed slots must not matter.
    for (b, &free) in b.iter_mut().zip(&free) {
        *b = if free { *b } else { 1e9 };
    }
    let mut x = vec![0.0; b.len()];
    let report = gradient.solve(&matrix, &mut jacobi, &b, &mut x, Some(&free), &settings(1e-11));
    assert_eq!(report.end, ConjugateGradientEnd::Converged);
    assert!(largest_difference(&x, &expected) < 1e-8 * largest(&expected));
    assert!(x.iter().zip(&free).all(|(&x, &free)| free || x == 0.0));
}

#[test]
fn ends_are_told_apart() {
    let mut matrix = random_matrix(60, 6, 25);
    let free = vec![true; matrix.dimension()];
    let b = right_hand_side(&free, 4);
    let mut gradient = ConjugateGradient::new(b.len());
    let solve = |matrix: &BlockMatrix, b: &[f64], gradient: &mut ConjugateGradient, limit| {
        let mut x = vec![0.0; b.len()];
        let goal = ConjugateGradientSettings { max_iterations: limit, ..settings(1e-9) };
        gradient.solve(matrix, &mut Identity, b, &mut x, None, &goal)
    };
    let report = solve(&matrix, &b, &mut gradient, 2);
    assert_eq!((report.iterations, report.end), (2, ConjugateGradientEnd::IterationLimit));
    let mut spike = vec![0.0; b.len()];
    spike[100] = -50.0;
    matrix.add_diagonal(&spike, 1.0);
    let report = solve(&matrix, &b, &mut gradient, 500);
    assert_eq!(report.end, ConjugateGradientEnd::NegativeCurvature);
    let direction = gradient.direction().to_vec();
    let mut product = vec![0.0; b.len()];
    matrix.multiply(&direction, &mut product);
    assert!(wale_numerics::vector::dot(&direction, &product) <= 0.0);
    spike[100] = f64::NAN;
    matrix.add_diagonal(&spike, 1.0);
    let report = solve(&matrix, &b, &mut gradient, 500);
    assert_eq!(report.end, ConjugateGradientEnd::Breakdown);
    let zero = vec![0.0; b.len()];
    let report = solve(&random_matrix(60, 6, 25), &zero, &mut gradient, 500);
    assert_eq!((report.iterations, report.end), (0, ConjugateGradientEnd::Converged));
}

/// A chain of blocks, whose factor has no fill.
fn chain(rows: usize) -> BlockMatrix {
    let pairs = (1..rows as u32).map(|i| (i - 1, i));
    let mut matrix = BlockMatrix::zeros(Arc::new(BlockPattern::from_pairs(rows, pairs)));
    let mut sequence = Sequence(17);
    for i in 0..rows - 1 {
        let g: Vec<f64> = sequence.vector(2 * SLOTS);
        for (a, row) in [i, i + 1].into_iter().enumerate() {
            for (b, column) in [i, i + 1].into_iter().enumerate() {
                let block = matrix.block_mut(row, column).unwrap();
                for k in 0..SLOTS * SLOTS {
                    block[k] += g[a * SLOTS + k % SLOTS] * g[b * SLOTS + k / SLOTS];
                }
            }
        }
    }
    matrix.add_diagonal(&vec![0.1; rows * SLOTS], 1.0);
    matrix
}

/// The factor is kept in 16 bits, eight of them precision; what a sweep sums up is off by some times that.
const ROUNDED: f64 = 1.0 / 256.0;

#[test]
fn incomplete_cholesky_is_exact_where_there_is_no_fill() {
    let matrix = chain(300);
    let free = vec![true; matrix.dimension()];
    let b = right_hand_side(&free, 6);
    let expected = direct(&matrix, &free, &b);
    let mut incomplete = IncompleteCholesky::new(Arc::clone(matrix.pattern()), IncompleteCholeskySettings::default());
    let report = incomplete.factor(&matrix).unwrap();
    assert_eq!((report.largest_shift, report.domains), (0.0, 1));
    let mut x = vec![f64::NAN; b.len()];
    incomplete.apply(&b, &mut x);
    println!("off by {:e}", largest_difference(&x, &expected) / largest(&expected));
    assert!(largest_difference(&x, &expected) < ROUNDED * largest(&expected));
    // What is rounded off, conjugate gradients make good in a few iterations.
    let settings = ConjugateGradientSettings { relative_tolerance: 1e-9, ..Default::default() };
    let mut solved = vec![0.0; b.len()];
    let mut gradient = ConjugateGradient::new(b.len());
    let report = gradient.solve(&matrix, &mut incomplete, &b, &mut solved, None, &settings);
    println!("{} iterations", report.iterations);
    assert!(report.iterations < 10 && largest_difference(&solved, &expected) < 1e-7 * largest(&expected));
    // It is symmetric, rounded or not.
    let other = right_hand_side(&free, 9);
    let mut y = vec![0.0; b.len()];
    incomplete.apply(&other, &mut y);
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let size = (product(&x, &x) * product(&other, &other)).sqrt();
    assert!((product(&x, &other) - product(&y, &b)).abs() < 1e-5 * size);
    let mut twice = x.clone();
    incomplete.add(&b, &mut twice);
    assert!((0..x.len()).all(|s| twice[s] == x[s] + x[s]));
}

#[test]
fn domains_drop_what_couples_them() {
    let matrix = chain(100);
    let cut = IncompleteCholeskySettings { rows_per_domain: 25, ..Default::default() };
    let mut incomplete = IncompleteCholesky::new(Arc::clone(matrix.pattern()), cut);
    assert_eq!(incomplete.factor(&matrix).unwrap().domains, 4);
    let mut uncoupled = matrix.clone();
    for border in [25, 50, 75] {
        for (row, column) in [(border - 1, border), (border, border - 1)] {
            uncoupled.block_mut(row, column).unwrap().fill(0.0);
        }
    }
    let free = vec![true; matrix.dimension()];
    let b = right_hand_side(&free, 8);
    let mut x = vec![0.0; b.len()];
    incomplete.apply(&b, &mut x);
    let expected = direct(&uncoupled, &free, &b);
    println!("off by {:e}", largest_difference(&x, &expected) / largest(&expected));
    assert!(largest_difference(&x, &expected) < ROUNDED * largest(&expected));
    let whole = direct(&matrix, &free, &b);
    assert!(largest_difference(&x, &whole) > 2.0 * largest_difference(&x, &expected), "cut, not coupled");
}

#[test]
fn incomplete_cholesky_shifts_where_pivots_fail_and_says_when_none_helps() {
    let mut matrix = chain(50);
    // Push it just over the edge: springs alone leave many motions free, each at the 0.1 that was
    // added to the diagonal.
    let settings = || IncompleteCholeskySettings::default();
    let pattern = Arc::clone(matrix.pattern());
    let mut incomplete = IncompleteCholesky::new(pattern, settings());
    matrix.add_diagonal(&vec![0.1 + 1e-5; matrix.dimension()], -1.0);
    let report = incomplete.factor(&matrix).unwrap();
    assert!(report.largest_shift > 0.0 && report.shifted_domains == 1, "{report:?}");
    let mut spike = vec![0.0; matrix.dimension()];
    spike[20 * SLOTS] = -100.0;
    matrix.add_diagonal(&spike, 1.0);
    assert_eq!(incomplete.factor(&matrix).unwrap_err().row, 20);
}

#[test]
fn coarse_matrix_equals_the_dense_product() {
    let matrix = random_matrix(60, 5, 41);
    let mut sequence = Sequence(9);
    let coordinates: Vec<[f64; 2]> = (0..60).map(|_| [7.0 * sequence.number(), 11.0 * sequence.number()]).collect();
    let free: Vec<bool> = (0..matrix.dimension()).map(|s| s % 9 != 1).collect();
    let hats = Prolongation::bilinear(&coordinates, 6.0);
    let count = hats.coarse_nodes();
    // P as a dense matrix, rows of fixed slots zero.
    let mut carry = vec![vec![0.0; count * SLOTS]; matrix.dimension()];
    for block in 0..60 {
        let (corners, weights) = hats.weights_of(block);
        for (&corner, &weight) in corners.iter().zip(weights) {
            for axis in 0..3 {
                if free[block * SLOTS + axis] {
                    carry[block * SLOTS + axis][corner as usize * SLOTS + axis] += weight;
                }
            }
        }
    }
    let pattern = Arc::clone(matrix.pattern());
    let mut coarse = CoarseSpace::new(pattern, hats, &free).unwrap();
    coarse.factor(&matrix).unwrap();
    let (fine, found) = (dense(&matrix), dense(coarse.coarse_matrix()));
    let mut expected = vec![vec![0.0; count * SLOTS]; count * SLOTS];
    for (i, row) in fine.iter().enumerate() {
        for (j, &entry) in row.iter().enumerate() {
            for a in (0..count * SLOTS).filter(|&a| carry[i][a] != 0.0) {
                for b in 0..count * SLOTS {
                    expected[a][b] += carry[i][a] * entry * carry[j][b];
                }
            }
        }
    }
    let size = expected.iter().map(|row| largest(row)).fold(0.0, f64::max);
    for (expected, found) in expected.iter().zip(&found) {
        assert!(largest_difference(expected, found) < 1e-13 * size);
    }

    // And applying it is P (PᵀAP)⁻¹ Pᵀ, checked by what that projection does: it solves exactly
    // for right-hand sides A P c.
    let c = Sequence(10).vector(count * SLOTS);
    let x = dense_times(&carry, &c);
    let b = dense_times(&fine, &x);
    let mut out = vec![0.0; b.len()];
    coarse.apply(&b, &mut out);
    assert!(largest_difference(&out, &x) < 1e-6 * largest(&x));
}

#[test]
fn degenerate_coarse_spaces_do_no_harm() {
    let matrix = random_matrix(80, 6, 51);
    let everything = vec![true; matrix.dimension()];
    let only_first: Vec<bool> = (0..matrix.dimension()).map(|s| s < 10).collect();
    let two = Prolongation::new(2, vec![[0, 1, 0, 0]; 80], vec![[0.5, 0.5, 0.0, 0.0]; 80]);
    let unused = Prolongation::new(3, vec![[2, 0, 0, 0]; 80], vec![[1.0, 0.0, 0.0, 0.0]; 80]);
    let far: Vec<[f64; 2]> = (0..80).map(|i| [f64::from(i % 2) * 1e4, 0.0]).collect();
    let cases = [
        (two, &everything),
        (unused, &everything),
        (Prolongation::bilinear(&far, 100.0), &everything),
        (Prolongation::bilinear(&far, 100.0), &only_first),
    ];
    for (prolongation, free) in cases {
        let pattern = Arc::clone(matrix.pattern());
        let mut coarse = CoarseSpace::new(pattern, prolongation, free).unwrap();
        coarse.factor(&matrix).unwrap();
        let mut jacobi = BlockJacobi::new(80);
        jacobi.factor(&matrix);
        let b = right_hand_side(free, 12);
        let mut x = vec![0.0; b.len()];
        let mut gradient = ConjugateGradient::new(b.len());
        let mut both = Additive(&mut jacobi, &mut coarse);
        let report = gradient.solve(&matrix, &mut both, &b, &mut x, Some(free), &settings(1e-10));
        assert_eq!(report.end, ConjugateGradientEnd::Converged);
        let expected = direct(&matrix, free, &b);
        assert!(largest_difference(&x, &expected) < 1e-7 * largest(&expected));
    }
}

/// Two-level solve of a few iterations, as Newton uses it.
fn two_level(swatch: &Swatch, b: &[f64]) -> (Vec<f64>, ConjugateGradientReport) {
    let matrix = &swatch.matrix;
    let pattern = matrix.pattern();
    let mut incomplete = IncompleteCholesky::new(Arc::clone(pattern), IncompleteCholeskySettings::default());
    incomplete.factor(matrix).unwrap();
    let hats = Prolongation::bilinear(&swatch.coordinates, 6.0);
    let mut coarse = CoarseSpace::new(Arc::clone(pattern), hats, &swatch.free).unwrap();
    coarse.factor(matrix).unwrap();
    let mut x = vec![0.0; b.len()];
    let report = ConjugateGradient::new(b.len()).solve(
        matrix,
        &mut Additive(&mut incomplete, &mut coarse),
        b,
        &mut x,
        None,
        &ConjugateGradientSettings { max_iterations: 20, ..settings(0.1) },
    );
    (x, report)
}

#[test]
fn solutions_have_the_same_bits_on_any_thread_count() {
    let swatch = swatch(60, 90);
    assert!(swatch.matrix.rows() > 20_000);
    let b = right_hand_side(&swatch.free, 14);
    let [one, two, four] = on_threads(|| two_level(&swatch, &b));
    assert!(one.1.iterations > 3);
    assert!(one == two && one == four);
}
