//! The laws of a fabric's stress that can be fitted, and the coordinates in which they are looked for.

use wale::energy::MembraneStiffness;

const COUNT: usize = MembraneStiffness::COUNT;
const XX: usize = 0;
const XY: usize = 1;
const YY: usize = 2;
/// The coupling of the stiffening.
const COUPLING: usize = COUNT - 1;
/// Bounds of stiffnesses, as parts of the geometric mean of the moduli.
const BOUNDS: [f64; 2] = [1e-6, 1e3];
/// Bounds of what couples two directions, over the geometric mean of what it couples.
const COUPLED: [f64; 2] = [-0.99, 0.99];

/// The law of a fabric's stress.
///
/// Coordinates are the logarithms of its stiffnesses. Where it stiffens, two directions may be coupled either way, so that `k_xy` is
/// `ρ √(k_xx k_yy)` with a coordinate `ρ`, and `m_xy` is one itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MembraneLaw {
    /// That of [Sperl2022, Eq. 1], of six positive numbers.
    Quadratic,
    /// With the four more of a fabric that stiffens: see [`MembraneStiffness`].
    Stiffening,
}

impl MembraneLaw {
    /// Whether a coordinate is a ratio, and no logarithm.
    fn is_ratio(self, k: usize) -> bool {
        self == Self::Stiffening && (k == XY || k == COUPLING)
    }

    /// The coordinates of a fabric.
    pub(super) fn coordinates(self, numbers: &[f64; COUNT]) -> [f64; COUNT] {
        std::array::from_fn(|k| match k {
            XY if self.is_ratio(k) => numbers[XY] / (numbers[XX] * numbers[YY]).sqrt(),
            _ if self.is_ratio(k) => numbers[k],
            _ => numbers[k].ln(),
        })
    }

    /// The fabric at coordinates, with numbers of stiffening that the paper's law does not use.
    pub(super) fn numbers(self, at: &[f64; COUNT]) -> [f64; COUNT] {
        std::array::from_fn(|k| match k {
            XY if self.is_ratio(k) => at[XY] * (0.5 * (at[XX] + at[YY])).exp(),
            _ if self.is_ratio(k) => at[k],
            _ => at[k].exp(),
        })
    }

    /// The stiffnesses of such numbers.
    pub(super) fn stiffness(self, numbers: &[f64; COUNT]) -> MembraneStiffness {
        match self {
            Self::Quadratic => MembraneStiffness::quadratic(std::array::from_fn(|k| numbers[k])),
            Self::Stiffening => MembraneStiffness::from_array(*numbers),
        }
    }

    /// Derivatives by the coordinates, of those by the numbers.
    pub(super) fn by_coordinates(self, numbers: &[f64; COUNT], slope: &[f64; COUNT]) -> [f64; COUNT] {
        let mut out: [f64; COUNT] = std::array::from_fn(|k| match k {
            XY if self.is_ratio(k) => slope[XY] * (numbers[XX] * numbers[YY]).sqrt(),
            _ if self.is_ratio(k) => slope[k],
            _ => slope[k] * numbers[k],
        });
        if self.is_ratio(XY) {
            out[XX] += 0.5 * slope[XY] * numbers[XY];
            out[YY] += 0.5 * slope[XY] * numbers[XY];
        }
        out
    }

    /// Least and largest coordinates, for moduli of the size `unit` \[N/m\]; those that the law does not use are held at `guess`.
    pub(super) fn bounds(self, unit: f64, guess: &[f64; COUNT]) -> [[f64; 2]; COUNT] {
        std::array::from_fn(|k| match self {
            _ if self.is_ratio(k) => COUPLED,
            Self::Quadratic if k >= MembraneStiffness::QUADRATIC => [guess[k]; 2],
            _ => BOUNDS.map(|part| (part * unit).ln()),
        })
    }

    /// Factors within which the numbers are known, of `e` to the power of the coordinates' intervals: a ratio may be off by that
    /// much of itself.
    pub(super) fn factors(self, at: &[f64; COUNT], intervals: &[f64; COUNT]) -> [f64; COUNT] {
        std::array::from_fn(|k| if self.is_ratio(k) { intervals[k].powf(1.0 / at[k].abs()) } else { intervals[k] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NUMBERS: [f64; COUNT] = [30.0, 4.0, 80.0, 7.0, 1.5, 3.0, 60.0, 200.0, 9.0, 0.4];

    #[test]
    fn numbers_and_coordinates_are_each_others_inverse() {
        for law in [MembraneLaw::Quadratic, MembraneLaw::Stiffening] {
            let again = law.numbers(&law.coordinates(&NUMBERS));
            for (a, b) in again.into_iter().zip(NUMBERS) {
                assert!((a / b - 1.0).abs() < 1e-14);
            }
        }
        let against = NUMBERS.map(|n| if n == 0.4 || n == 4.0 { -n } else { n });
        let again = MembraneLaw::Stiffening.numbers(&MembraneLaw::Stiffening.coordinates(&against));
        assert!((again[XY] + 4.0).abs() < 1e-13 && (again[COUPLING] + 0.4).abs() < 1e-14);
    }

    #[test]
    fn slopes_by_the_coordinates_are_those_of_differences() {
        // Of a function of the numbers whose derivatives are known.
        let weights: [f64; COUNT] = std::array::from_fn(|k| 0.3 + 0.1 * k as f64);
        let value = |numbers: [f64; COUNT]| numbers.iter().zip(weights).map(|(n, w)| w * n).sum::<f64>();
        for law in [MembraneLaw::Quadratic, MembraneLaw::Stiffening] {
            let at = law.coordinates(&NUMBERS);
            let slopes = law.by_coordinates(&NUMBERS, &weights);
            for k in 0..COUNT {
                let moved = |by: f64| {
                    let mut at = at;
                    at[k] += by;
                    value(law.numbers(&at))
                };
                let difference = (moved(1e-5) - moved(-1e-5)) / 2e-5;
                assert!((slopes[k] - difference).abs() < 1e-7 * (1.0 + difference.abs()), "{law:?} {k}");
            }
        }
    }
}
