//! Arithmetic of single 5 × 5 blocks.

use crate::block_matrix::{BLOCK, SLOTS};
use crate::scalar::Scalar;

/// `a b`, both row-major.
#[inline(always)]
pub(crate) fn product(a: &[f64; BLOCK], b: &[f64; BLOCK]) -> [f64; BLOCK] {
    let mut out = [0.0; BLOCK];
    add_product(&mut out, a, b, 1.0);
    out
}

/// `remains -= a b`, all row-major.
#[inline(always)]
pub(crate) fn subtract_product(remains: &mut [f64; BLOCK], a: &[f64; BLOCK], b: &[f64; BLOCK]) {
    add_product(remains, a, b, -1.0);
}

#[inline(always)]
fn add_product(out: &mut [f64; BLOCK], a: &[f64; BLOCK], b: &[f64; BLOCK], scale: f64) {
    for r in 0..SLOTS {
        let mut sums: [f64; SLOTS] = std::array::from_fn(|c| out[r * SLOTS + c]);
        for l in 0..SLOTS {
            let factor = scale * a[r * SLOTS + l];
            for c in 0..SLOTS {
                sums[c] = factor.fused(b[l * SLOTS + c], sums[c]);
            }
        }
        out[r * SLOTS..(r + 1) * SLOTS].copy_from_slice(&sums);
    }
}

#[inline(always)]
pub(crate) fn transposed(a: &[f64; BLOCK]) -> [f64; BLOCK] {
    std::array::from_fn(|k| a[k % SLOTS * SLOTS + k / SLOTS])
}

/// Inverse of a symmetric positive definite block, or `None` if it is not one.
///
/// By Gauss-Jordan: five divisions, no square root. A pivot counts as zero when it has fallen to
/// `smallest_pivot` of its own diagonal entry.
pub(crate) fn inverse_of_positive(block: &[f64; BLOCK], smallest_pivot: f64) -> Option<[f64; BLOCK]> {
    let mut a = *block;
    for k in 0..SLOTS {
        let pivot = a[k * (SLOTS + 1)];
        // Written so that a NaN fails.
        if !(pivot > smallest_pivot * block[k * (SLOTS + 1)] && pivot < f64::INFINITY) {
            return None;
        }
        let reciprocal = 1.0 / pivot;
        let column: [f64; SLOTS] = std::array::from_fn(|i| a[i * SLOTS + k]);
        let row: [f64; SLOTS] = std::array::from_fn(|j| a[k * SLOTS + j] * reciprocal);
        for i in 0..SLOTS {
            for j in 0..SLOTS {
                a[i * SLOTS + j] -= column[i] * row[j];
            }
        }
        for i in 0..SLOTS {
            a[i * SLOTS + k] = -column[i] * reciprocal;
            a[k * SLOTS + i] = row[i];
        }
        a[k * (SLOTS + 1)] = reciprocal;
    }
    // Symmetric to the last bit.
    Some(std::array::from_fn(|k| {
        let (i, j) = (k / SLOTS, k % SLOTS);
        a[i.max(j) * SLOTS + i.min(j)]
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
