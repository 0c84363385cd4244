//! Numbers without a pattern that are the same everywhere.

use super::problem::P;

/// The bases of the sequence: a prime for each parameter.
const BASES: [usize; P] = [2, 3, 5, 7, 11, 13, 17];

/// Point `k` of Halton's sequence in the unit cube: points fill it evenly, however many there are \[Halton1960\].
#[must_use]
pub fn halton(k: usize) -> [f64; P] {
    BASES.map(|base| {
        let (mut index, mut part, mut value) = (k + 1, 1.0, 0.0);
        while index > 0 {
            part /= base as f64;
            value += part * (index % base) as f64;
            index /= base;
        }
        value
    })
}

/// Random numbers by SplitMix64 \[Steele2014\].
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// A sequence of its own for each seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next number, in `[0, 1)`.
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halton_fills_the_cube_evenly() {
        assert_eq!(halton(0)[..2], [0.5, 1.0 / 3.0]);
        assert_eq!(halton(5)[0], 0.375);
        for axis in 0..P {
            let below = (0..1000).filter(|&k| halton(k)[axis] < 0.3).count();
            assert!((290..=310).contains(&below), "{axis}: {below}");
        }
    }

    #[test]
    fn random_numbers_are_even_and_repeat_for_a_seed() {
        let mut random = Random::new(7);
        let mean = (0..10_000).map(|_| random.next()).sum::<f64>() / 1e4;
        assert!((mean - 0.5).abs() < 0.01);
        assert_eq!(Random::new(3).next(), Random::new(3).next());
        assert!(Random::new(3).next() != Random::new(4).next());
    }
}
