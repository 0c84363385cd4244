//! Block products, assembly by row chunks, fixed slots and the sparse Cholesky factor.

mod common;

use common::*;
use std::sync::Arc;
use wale_numerics::block_matrix::{BLOCK, BlockMatrix, SLOTS};
use wale_numerics::block_pattern::BlockPattern;
use wale_numerics::sparse_cholesky::{BlockOrder, CholeskyError, SparseCholesky};

#[test]
fn product_equals_the_dense_one() {
    for (rows, degree) in [(1, 0), (2, 2), (37, 8), (150, 11)] {
        let matrix = random_matrix(rows, degree, 3);
        let x = Sequence(5).vector(rows * SLOTS);
        let mut y = vec![f64::NAN; x.len()];
        matrix.multiply(&x, &mut y);
        let expected = dense_times(&dense(&matrix), &x);
        assert!(largest_difference(&y, &expected) < 1e-13 * largest(&expected));

        let mut narrow = BlockMatrix::<f32>::zeros(Arc::clone(matrix.pattern()));
        narrow.copy_from(&matrix);
        let mut rounded = vec![[f32::NAN; 8]; rows];
        let mut wide = vec![f64::NAN; x.len()];
        narrow.multiply_rounded(&x, &mut rounded, &mut wide);
        assert!(largest_difference(&wide, &expected) < 1e-5 * largest(&expected));
        let x: Vec<f32> = x.iter().map(|&v| v as f32).collect();
        let mut y = vec![f32::NAN; x.len()];
        narrow.multiply(&x, &mut y);
        let y: Vec<f64> = y.iter().map(|&v| f64::from(v)).collect();
        assert!(largest_difference(&y, &expected) < 1e-5 * largest(&expected));
    }
}

#[test]
fn row_chunks_write_what_a_plain_loop_writes() {
    let pattern = Arc::clone(random_matrix(90, 8, 1).pattern());
    let value = |row: usize, column: usize, k: usize| (row * 1000 + column * 30 + k) as f64;
    let mut plain = BlockMatrix::<f64>::zeros(Arc::clone(&pattern));
    for row in 0..90 {
        let (columns, blocks) = plain.row_mut(row);
        for (block, &column) in blocks.iter_mut().zip(columns) {
            *block = std::array::from_fn(|k| value(row, column as usize, k));
        }
    }
    let bounds = [0, 13, 13, 50, 77, 90];
    let mut chunked = BlockMatrix::<f64>::zeros(Arc::clone(&pattern));
    let mut written = [0_usize; 5];
    chunked.for_each_row_chunk(&bounds, &mut written, |written, mut chunk| {
        for row in chunk.rows() {
            for &column in chunk.pattern().row(row) {
                let block = chunk.block_mut(row, column as usize);
                *block = std::array::from_fn(|k| value(row, column as usize, k));
                *written += BLOCK;
            }
        }
    });
    assert_eq!(plain.values, chunked.values);
    assert_eq!(written.iter().sum::<usize>(), plain.blocks().as_flattened().len());

    let mut split = BlockMatrix::<f64>::zeros(pattern);
    for mut chunk in split.split_rows(&bounds) {
        for row in chunk.rows() {
            let (columns, blocks) = chunk.row_mut(row);
            for (block, &column) in blocks.iter_mut().zip(columns) {
                *block = std::array::from_fn(|k| value(row, column as usize, k));
            }
        }
    }
    assert_eq!(plain.values, split.values);
}

#[test]
fn fixed_slots_leave_the_system() {
    let rows = 700;
    let mut matrix = random_matrix(rows, 6, 9);
    let before = matrix.clone();
    let free: Vec<bool> = (0..rows * SLOTS).map(|s| s % 3 != 0).collect();
    matrix.fix_slots(&free, 2.5);
    for row in 0..rows {
        for &column in matrix.pattern().row(row) {
            let column = column as usize;
            let (new, old) = (matrix.block(row, column).unwrap(), before.block(row, column).unwrap());
            for k in 0..BLOCK {
                let (r, c) = (row * SLOTS + k % SLOTS, column * SLOTS + k / SLOTS);
                let expected = match (free[r] && free[c], r == c) {
                    (true, _) => old[k],
                    (false, true) => 2.5,
                    (false, false) => 0.0,
                };
                assert_eq!(new[k], expected);
            }
        }
    }
}

#[test]
fn diagonal_is_read_and_shifted() {
    let mut matrix = random_matrix(20, 4, 2);
    let mut diagonal = vec![0.0; matrix.dimension()];
    matrix.diagonal_into(&mut diagonal);
    let full = dense(&matrix);
    for (s, &entry) in diagonal.iter().enumerate() {
        assert_eq!(entry, full[s][s]);
    }
    let weights = Sequence(4).vector(matrix.dimension());
    matrix.add_diagonal(&weights, 0.5);
    let shifted = dense(&matrix);
    for s in 0..matrix.dimension() {
        assert_eq!(shifted[s][s], full[s][s] + 0.5 * weights[s]);
    }
}

/// Largest residual on free slots, relative to the right-hand side.
fn residual(matrix: &BlockMatrix, free: &[bool], x: &[f64], b: &[f64]) -> f64 {
    let mut y = vec![0.0; x.len()];
    matrix.multiply(x, &mut y);
    let mut worst: f64 = 0.0;
    for s in 0..x.len() {
        if free[s] {
            worst = worst.max((y[s] - b[s]).abs());
        } else {
            assert_eq!(x[s], 0.0);
        }
    }
    worst / largest(b)
}

#[test]
fn cholesky_solves_and_refactors() {
    let rows = 300;
    let free: Vec<bool> = (0..rows * SLOTS).map(|s| s >= 12 && s % 11 != 4).collect();
    let mut matrix = random_matrix(rows, 8, 11);
    let backwards: Vec<u32> = (0..rows as u32).rev().collect();
    for order in [BlockOrder::MinimumDegree, BlockOrder::Given(&backwards)] {
        let mut cholesky = SparseCholesky::new(Arc::clone(matrix.pattern()), &free, order).unwrap();
        assert_eq!(cholesky.unknowns(), free.iter().filter(|&&f| f).count());
        for round in 0..3 {
            let b = Sequence(round).vector(matrix.dimension());
            cholesky.factor(&matrix, 0.0).unwrap();
            let mut x = b.clone();
            cholesky.solve_in_place(&mut x);
            let worst = residual(&matrix, &free, &x, &b);
            assert!(worst < 1e-12, "round {round}: {worst}");
            let more = vec![0.3; matrix.dimension()];
            matrix.add_diagonal(&more, 1.0);
        }
    }
}

#[test]
fn cholesky_says_when_the_matrix_is_not_positive_definite() {
    let mut matrix = random_matrix(40, 6, 21);
    let free = vec![true; matrix.dimension()];
    let pattern = Arc::clone(matrix.pattern());
    let mut cholesky = SparseCholesky::new(pattern, &free, BlockOrder::MinimumDegree).unwrap();
    let mut spike = vec![0.0; matrix.dimension()];
    spike[33] = -1e3;
    matrix.add_diagonal(&spike, 1.0);
    let error = cholesky.factor(&matrix, 0.0).unwrap_err();
    assert!(matches!(error, CholeskyError::NotPositiveDefinite { .. }));
    matrix.add_diagonal(&spike, -1.0);
    cholesky.factor(&matrix, 0.0).unwrap();
    spike[33] = f64::NAN;
    matrix.add_diagonal(&spike, 1.0);
    assert_eq!(cholesky.factor(&matrix, 0.0), Err(CholeskyError::NotFinite));
}

#[test]
fn a_matrix_that_only_its_rounding_makes_indefinite_is_factored() {
    let mut matrix = random_matrix(40, 6, 21);
    let free = vec![true; matrix.dimension()];
    let pattern = Arc::clone(matrix.pattern());
    let mut cholesky = SparseCholesky::new(pattern, &free, BlockOrder::MinimumDegree).unwrap();
    let mut spike = vec![0.0; matrix.dimension()];
    let mut fails = |matrix: &mut BlockMatrix, depth: f64, rounded: bool| {
        spike[33] = -depth;
        matrix.add_diagonal(&spike, 1.0);
        let result = if rounded { cholesky.factor_rounded(matrix) } else { cholesky.factor(matrix, 0.0) };
        matrix.add_diagonal(&spike, -1.0);
        result.is_err()
    };
    // The depth at which the matrix just is not positive definite.
    let (mut sound, mut broken) = (0.0, 1e3);
    for _ in 0..60 {
        let middle = 0.5 * (sound + broken);
        *(if fails(&mut matrix, middle, false) { &mut broken } else { &mut sound }) = middle;
    }
    let broken = broken * (1.0 + 1e-15);
    assert!(fails(&mut matrix, broken, false) && !fails(&mut matrix, broken, true));
    // What is indefinite in earnest stays so.
    assert!(fails(&mut matrix, 1.01 * broken, true) && !fails(&mut matrix, 0.99 * broken, true));
}

#[test]
fn a_relative_shift_multiplies_the_diagonal() {
    let mut matrix = random_matrix(25, 4, 31);
    let free = vec![true; matrix.dimension()];
    let pattern = Arc::clone(matrix.pattern());
    let mut cholesky = SparseCholesky::new(pattern, &free, BlockOrder::MinimumDegree).unwrap();
    let b = Sequence(1).vector(matrix.dimension());
    cholesky.factor(&matrix, 0.25).unwrap();
    let mut x = b.clone();
    cholesky.solve_in_place(&mut x);
    let mut diagonal = vec![0.0; matrix.dimension()];
    matrix.diagonal_into(&mut diagonal);
    matrix.add_diagonal(&diagonal, 0.25);
    assert!(residual(&matrix, &free, &x, &b) < 1e-12);
}

#[test]
fn nothing_free_is_solved_by_zero() {
    let matrix = BlockMatrix::zeros(Arc::new(BlockPattern::from_pairs(3, [(0, 2)])));
    let free = [false; 15];
    let pattern = Arc::clone(matrix.pattern());
    let mut cholesky = SparseCholesky::new(pattern, &free, BlockOrder::MinimumDegree).unwrap();
    cholesky.factor(&matrix, 0.0).unwrap();
    let mut x = [1.0; 15];
    cholesky.solve_in_place(&mut x);
    assert_eq!(x, [0.0; 15]);
}

#[test]
fn product_has_the_same_bits_on_any_thread_count() {
    let Swatch { matrix, .. } = swatch(60, 90);
    assert!(matrix.rows() > 20_000);
    let x = Sequence(8).vector(matrix.dimension());
    let [one, two, four] = on_threads(|| {
        let mut y = vec![0.0; x.len()];
        matrix.multiply(&x, &mut y);
        y
    });
    assert!(one == two && one == four);
}
