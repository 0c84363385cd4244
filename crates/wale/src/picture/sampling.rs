//! Numbers that look random and spread evenly, and follow from the pixel alone.

/// Numbers from 0 to 1 of one sample of one pixel.
#[derive(Clone, Copy)]
pub(super) struct Dice {
    pub x: u32,
    pub y: u32,
    pub sample: u32,
}

impl Dice {
    /// Pair `n` of the given purpose: well spread over the pairs of a pixel, and so unlike between neighbouring pixels
    /// that what is left of the grain is too fine to see.
    pub fn pair(self, purpose: u32, n: u32) -> [f32; 2] {
        let (x, y) = ((self.x + 61 * purpose) as f32, (self.y + 83 * purpose) as f32);
        // Interleaved gradient noise [Jimenez 2014], and a lattice by the plastic number.
        let first = (52.982_918 * (0.067_110_56 * x + 0.005_837_15 * y).fract()).fract();
        let second = (0.754_877_7 * x).fract() + (0.569_840_3 * y).fract();
        plastic(n, [first, second.fract()])
    }
}

/// Point `n` of the sequence with the steps of the plastic number \[Roberts 2018\]: even for any count.
pub(super) fn plastic(n: u32, start: [f32; 2]) -> [f32; 2] {
    let n = n as f32;
    [(start[0] + 0.754_877_7 * n).fract(), (start[1] + 0.569_840_3 * n).fract()]
}

/// From 0..1 to a tent over −0.8..0.8.
pub(super) fn tent(u: f32) -> f32 {
    let v = if u < 0.5 { (2.0 * u).sqrt() - 1.0 } else { 1.0 - (2.0 - 2.0 * u).sqrt() };
    0.8 * v
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_of_a_pixel_fill_the_square_evenly() {
        let dice = Dice { x: 17, y: 401, sample: 0 };
        let mut cells = [0; 16];
        for n in 0..160 {
            let [a, b] = dice.pair(1, n);
            assert!((0.0..1.0).contains(&a) && (0.0..1.0).contains(&b));
            cells[(4.0 * a) as usize * 4 + (4.0 * b) as usize] += 1;
        }
        assert!(cells.iter().all(|c| (7..=13).contains(c)), "{cells:?}");
    }

    #[test]
    fn the_tent_is_even_about_zero_and_stays_within_its_width() {
        for i in 0..=50 {
            let u = i as f32 / 100.0;
            assert!((tent(u) + tent(1.0 - u)).abs() < 1e-6);
            assert!(tent(u).abs() <= 0.8);
        }
    }
}
