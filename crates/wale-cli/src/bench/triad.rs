//! The memory triad: how fast this machine moves numbers, to read all other speeds against.

use std::time::Instant;

use rayon::prelude::*;

/// Numbers in each of the three arrays: 3 × 64 MB, more than caches hold.
const LENGTH: usize = 8 << 20;
/// Best of so many.
const REPEATS: usize = 5;
/// Numbers a task works on.
const PIECE: usize = 1 << 16;

/// Bandwidth of `a = b + s c` on all threads \[bytes/s\]: two reads and a write a number, best of a few.
#[must_use]
pub fn triad() -> f64 {
    let mut a = vec![0.0; LENGTH];
    let b = vec![1.0; LENGTH];
    let c = vec![2.0; LENGTH];
    let mut best = f64::INFINITY;
    for repeat in 0..=REPEATS {
        let scale = std::hint::black_box(repeat as f64);
        let began = Instant::now();
        a.par_chunks_mut(PIECE).zip(b.par_chunks(PIECE).zip(c.par_chunks(PIECE))).for_each(|(a, (b, c))| {
            for ((a, b), c) in a.iter_mut().zip(b).zip(c) {
                *a = b + scale * c;
            }
        });
        std::hint::black_box(&mut a);
        // The first touches the pages.
        if repeat > 0 {
            best = best.min(began.elapsed().as_secs_f64());
        }
    }
    (3 * LENGTH * size_of::<f64>()) as f64 / best
}
