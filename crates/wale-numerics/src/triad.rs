//! The memory bandwidth of this machine, to read all other speeds against.

use rayon::prelude::*;
use std::time::Instant;

/// Numbers in one parallel piece.
const PIECE: usize = 1 << 15;

/// Bytes a second of `a = b + s c` over vectors of `length` numbers, the best of `rounds`, on the
/// current thread pool.
///
/// Counts 24 bytes a number (two read, one written), as STREAM does; the vectors should together
/// be several times the last cache. Returns 0 if nothing could be timed. This is the only function
/// of the crate that reads a clock.
pub fn triad_bandwidth(length: usize, rounds: usize) -> f64 {
    let mut a = vec![0.0_f64; length];
    let b = vec![1.0_f64; length];
    let c = vec![2.0_f64; length];
    let mut best: f64 = 0.0;
    for round in 0..=rounds {
        let scale = round as f64;
        let start = Instant::now();
        a.par_chunks_mut(PIECE).zip(b.par_chunks(PIECE)).zip(c.par_chunks(PIECE)).for_each(|((a, b), c)| {
            for ((a, b), c) in a.iter_mut().zip(b).zip(c) {
                *a = b + scale * c;
            }
        });
        let seconds = start.elapsed().as_secs_f64();
        // The first round only brings the pages in. A wrong sum would mean the work was skipped.
        let done = a.first().is_none_or(|&first| first == 1.0 + 2.0 * scale);
        if round > 0 && seconds > 0.0 && done {
            best = best.max((24 * length) as f64 / seconds);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn some_bandwidth_is_found() {
        let bandwidth = triad_bandwidth(1 << 18, 3);
        assert!(bandwidth > 1e6 && bandwidth.is_finite());
        assert_eq!(triad_bandwidth(1 << 10, 0), 0.0);
    }
}
