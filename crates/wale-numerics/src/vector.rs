//! Sums and updates of long vectors, in parallel and with the same bits on any thread count.
//!
//! Vectors are cut in pieces of fixed length and the sums of pieces added in a tree whose shape
//! follows from the length alone. Nothing is allocated.

use rayon::prelude::*;

/// Numbers in one piece: 64 kB, which fits the second cache of any core.
const PIECE: usize = 8192;
/// Running sums within a piece, so that a vector unit is kept busy.
const LANES: usize = 16;

/// Scalar product.
///
/// # Panics
/// If the lengths differ.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    if a.len() <= PIECE {
        return dot_of_piece(a, b);
    }
    let middle = middle(a.len());
    let ((a0, a1), (b0, b1)) = (a.split_at(middle), b.split_at(middle));
    let (left, right) = rayon::join(|| dot(a0, b0), || dot(a1, b1));
    left + right
}

/// Euclidean norm.
pub fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// Largest absolute value; NaN if there is one.
pub fn largest_magnitude(a: &[f64]) -> f64 {
    if a.len() <= PIECE {
        let wider = |m: f64, v: &f64| {
            if v.abs() > m || v.is_nan() { v.abs() } else { m }
        };
        return a.iter().fold(0.0, wider);
    }
    let (head, tail) = a.split_at(middle(a.len()));
    let (left, right) = rayon::join(|| largest_magnitude(head), || largest_magnitude(tail));
    if left > right || left.is_nan() { left } else { right }
}

/// Sets every number.
pub fn fill(y: &mut [f64], value: f64) {
    each_piece(y, [], |y, []| y.fill(value));
}

/// `y = x`.
pub fn copy(x: &[f64], y: &mut [f64]) {
    each_piece(y, [x], |y, [x]| y.copy_from_slice(x));
}

/// `y += a x`.
pub fn add_scaled(y: &mut [f64], a: f64, x: &[f64]) {
    each_piece(y, [x], |y, [x]| {
        for (y, x) in y.iter_mut().zip(x) {
            *y += a * x;
        }
    });
}

/// `y = x + a y`, the new search direction of conjugate gradients.
pub fn scale_and_add(y: &mut [f64], a: f64, x: &[f64]) {
    each_piece(y, [x], |y, [x]| {
        for (y, x) in y.iter_mut().zip(x) {
            *y = x + a * *y;
        }
    });
}

/// Sets the slots that are not free to zero.
pub fn keep_free(y: &mut [f64], free: &[bool]) {
    assert_eq!(y.len(), free.len());
    let keep = |y: &mut [f64], free: &[bool]| {
        for (y, &free) in y.iter_mut().zip(free) {
            *y = if free { *y } else { 0.0 };
        }
    };
    if y.len() <= PIECE {
        return keep(y, free);
    }
    y.par_chunks_mut(PIECE).zip(free.par_chunks(PIECE)).for_each(|(y, free)| keep(y, free));
}

/// Where a vector of more than one piece is halved: always between two pieces.
fn middle(length: usize) -> usize {
    length.div_ceil(PIECE) / 2 * PIECE
}

fn dot_of_piece(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0; LANES];
    let (a_rows, a_rest) = a.as_chunks::<LANES>();
    let (b_rows, b_rest) = b.as_chunks::<LANES>();
    for (a, b) in a_rows.iter().zip(b_rows) {
        for lane in 0..LANES {
            lanes[lane] += a[lane] * b[lane];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    lanes.iter().sum::<f64>() + rest
}

/// Calls `update` for every piece of `y` with the same piece of each input.
fn each_piece<const N: usize>(y: &mut [f64], inputs: [&[f64]; N], update: impl Fn(&mut [f64], [&[f64]; N]) + Sync) {
    for input in inputs {
        assert_eq!(y.len(), input.len());
    }
    if y.len() <= PIECE {
        return update(y, inputs);
    }
    y.par_chunks_mut(PIECE).enumerate().for_each(|(index, y)| {
        let start = index * PIECE;
        update(y, inputs.map(|input| &input[start..start + y.len()]));
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(length: usize, factor: f64) -> Vec<f64> {
        (0..length).map(|i| factor * (i % 101) as f64 - 3.0).collect()
    }

    #[test]
    fn sums_and_updates_equal_plain_loops() {
        for length in [0, 1, 17, PIECE, PIECE + 1, 5 * PIECE + 123] {
            let (a, b) = (ramp(length, 1.0), ramp(length, 2.0));
            // Whole numbers below 2^53: exact in any order.
            let expected: f64 = a.iter().zip(&b).map(|(a, b)| a * b).sum();
            assert_eq!(dot(&a, &b), expected);
            let mut y = b.clone();
            add_scaled(&mut y, 3.0, &a);
            assert!((0..length).all(|i| y[i] == b[i] + 3.0 * a[i]));
            scale_and_add(&mut y, 2.0, &a);
            assert!((0..length).all(|i| y[i] == a[i] + 2.0 * (b[i] + 3.0 * a[i])));
            let free: Vec<bool> = (0..length).map(|i| i % 3 == 0).collect();
            keep_free(&mut y, &free);
            assert!((0..length).all(|i| free[i] || y[i] == 0.0));
            copy(&a, &mut y);
            assert_eq!(y, a);
            fill(&mut y, 7.0);
            assert!(y.iter().all(|&v| v == 7.0));
        }
    }

    #[test]
    fn largest_magnitude_sees_signs_and_not_a_number() {
        let mut a = ramp(3 * PIECE, 1.0);
        a[2 * PIECE + 5] = -1e4;
        assert_eq!(largest_magnitude(&a), 1e4);
        assert_eq!(norm(&[3.0, -4.0]), 5.0);
        for place in [0, PIECE, 3 * PIECE - 1] {
            let mut a = a.clone();
            a[place] = f64::NAN;
            assert!(largest_magnitude(&a).is_nan());
        }
    }
}
