//! Arithmetic of single 5 × 5 blocks.

use crate::block_matrix::{BLOCK, SLOTS};

/// Inverse of a symmetric positive definite block, or `None` if it is not one.
///
/// By symmetric sweeps: five divisions, no square root. A pivot counts as zero when it has fallen
/// to `smallest_pivot` of its own diagonal entry; only the lower triangle's values matter.
pub(crate) fn inverse_of_positive(block: &[f64; BLOCK], smallest_pivot: f64) -> Option<[f64; BLOCK]> {
    let mut a = *block;
    for k in 0..SLOTS {
        let pivot = a[k * (SLOTS + 1)];
        // Written so that a NaN fails.
        if !(pivot > smallest_pivot * block[k * (SLOTS + 1)] && pivot < f64::INFINITY) {
            return None;
        }
        let reciprocal = 1.0 / pivot;
        let row: [f64; SLOTS] = std::array::from_fn(|j| if j < k { a[k * SLOTS + j] } else { a[j * SLOTS + k] });
        for i in 0..SLOTS {
            for j in 0..=i {
                let value = match (i == k, j == k) {
                    (true, true) => -reciprocal,
                    (true, false) => row[j] * reciprocal,
                    (false, true) => row[i] * reciprocal,
                    (false, false) => a[i * SLOTS + j] - row[i] * row[j] * reciprocal,
                };
                a[i * SLOTS + j] = value;
            }
        }
    }
    Some(std::array::from_fn(|k| {
        let (i, j) = (k / SLOTS, k % SLOTS);
        -a[i.max(j) * SLOTS + i.min(j)]
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_times_block_is_the_identity() {
        let g = |i: usize, j: usize| ((3 * i + 7 * j + i * j) % 11) as f64 - 5.0;
        let block: [f64; BLOCK] = std::array::from_fn(|k| {
            let (i, j) = (k / SLOTS, k % SLOTS);
            (0..SLOTS).map(|l| g(i, l) * g(j, l)).sum::<f64>() + if i == j { 2.0 } else { 0.0 }
        });
        let inverse = inverse_of_positive(&block, 0.0).unwrap();
        for i in 0..SLOTS {
            for j in 0..SLOTS {
                let entry: f64 = (0..SLOTS).map(|l| inverse[i * SLOTS + l] * block[l * SLOTS + j]).sum();
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((entry - expected).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn an_indefinite_or_undefined_block_has_none() {
        let mut block = [0.0; BLOCK];
        for k in 0..SLOTS {
            block[k * (SLOTS + 1)] = 1.0;
        }
        assert!(inverse_of_positive(&block, 0.0).is_some());
        (block[SLOTS], block[1]) = (1.5, 1.5);
        assert!(inverse_of_positive(&block, 0.0).is_none());
        (block[SLOTS], block[1]) = (f64::NAN, f64::NAN);
        assert!(inverse_of_positive(&block, 0.0).is_none());
    }
}
