//! Warm calls take no memory: product, conjugate gradients, and every refactorisation.

mod common;

use allocation_counter::measure;
use common::*;
use std::sync::Arc;
use wale_numerics::coarse_space::CoarseSpace;
use wale_numerics::conjugate_gradient::{ConjugateGradient, ConjugateGradientSettings};
use wale_numerics::incomplete_cholesky::{IncompleteCholesky, IncompleteCholeskySettings};
use wale_numerics::preconditioner::{Additive, BlockJacobi};
use wale_numerics::prolongation::Prolongation;
use wale_numerics::sparse_cholesky::{BlockOrder, SparseCholesky};

#[test]
fn warm_calls_allocate_nothing() {
    let Swatch { matrix, coordinates, free } = swatch(50, 90);
    let pattern = matrix.pattern();
    let b = {
        let mut b = Sequence(1).vector(matrix.dimension());
        wale_numerics::vector::keep_free(&mut b, &free);
        b
    };
    let mut jacobi = BlockJacobi::new(matrix.rows());
    let mut incomplete = IncompleteCholesky::new(Arc::clone(pattern), IncompleteCholeskySettings::default());
    let hats = Prolongation::bilinear(&coordinates, 6.0);
    let mut coarse = CoarseSpace::new(Arc::clone(pattern), hats, &free).unwrap();
    let small = swatch(10, 20);
    let small_pattern = Arc::clone(small.matrix.pattern());
    let mut cholesky = SparseCholesky::new(small_pattern, &small.free, BlockOrder::MinimumDegree).unwrap();
    let mut small_solution = vec![1.0; small.matrix.dimension()];
    let mut gradient = ConjugateGradient::new(b.len());
    let mut x = vec![0.0; b.len()];
    let mut y = vec![0.0; b.len()];
    let goal = ConjugateGradientSettings { relative_tolerance: 1e-2, ..Default::default() };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let counts = pool.install(|| {
        let mut round = || {
            let product = measure(|| matrix.multiply(&b, &mut y));
            let local = measure(|| {
                jacobi.factor(&matrix);
                incomplete.factor(&matrix).unwrap();
            });
            let coarse_factor = measure(|| {
                coarse.factor(&matrix).unwrap();
            });
            let solve = measure(|| {
                x.fill(0.0);
                let mut both = Additive(&mut incomplete, &mut coarse);
                let report = gradient.solve(&matrix, &mut both, &b, &mut x, Some(&free), &goal);
                assert!(report.iterations > 3);
            });
            let direct = measure(|| {
                cholesky.factor(&small.matrix, 0.0).unwrap();
                cholesky.solve_in_place(&mut small_solution);
            });
            [product, local, coarse_factor, solve, direct].map(|counted| counted.count_total)
        };
        round();
        round()
    });
    assert_eq!(counts, [0; 5], "product, IC(0), coarse, PCG, direct");
}
