//! Coordinates of a fit: the numbers of a yarn within their bounds.

use serde::{Deserialize, Serialize};

use crate::yarn_tile::RodParameter;

/// Number of parameters.
const P: usize = RodParameter::COUNT;

/// Which numbers of a yarn are fitted, and within which bounds [Sperl2022, section 7.3.2].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RodSpace {
    /// Least and largest value of each number; one whose bounds meet is held.
    pub bounds: [[f64; 2]; P],
}

/// Stiffness that holds the yarns of the paper's model, which has none, in `k_b/R⁴`: less than anybody could measure.
const LEAST_HOLDING: f64 = 1e-6;
/// One unit of the coordinate of the onset \[–\]; the others are logarithms.
const ONSET_UNIT: f64 = 0.05;
const ONSET: usize = RodParameter::Onset as usize;

impl RodSpace {
    /// The paper's bounds for a yarn of a stiffness `k_s2` \[N\] whose edges all touch with a radius `R_est` \[m\]; `k_s2` is held.
    ///
    /// The paper has no unit for `k_c1 ∈ [10⁻², 10²]`; here it is J/m².
    #[must_use]
    pub fn paper(stiff_stretch: f64, contact_radius: f64) -> Self {
        let bending = 0.25 * stiff_stretch * contact_radius * contact_radius;
        Self {
            bounds: [
                [1e-3 * stiff_stretch, stiff_stretch],
                [stiff_stretch; 2],
                [0.0, 0.15],
                [1e-3 * bending, 10.0 * bending],
                [0.5 * contact_radius, 1.5 * contact_radius],
                [1e-2, 1e2],
                [LEAST_HOLDING * bending / contact_radius.powi(4); 2],
            ],
        }
    }

    /// Holds one number at a value.
    #[must_use]
    pub fn holding(mut self, parameter: RodParameter, value: f64) -> Self {
        self.bounds[parameter as usize] = [value; 2];
        self
    }

    /// Gives one number other bounds.
    #[must_use]
    pub fn within(mut self, parameter: RodParameter, bounds: [f64; 2]) -> Self {
        self.bounds[parameter as usize] = bounds;
        self
    }

    /// Gives those numbers other bounds of which some are known.
    #[must_use]
    pub fn narrowed(mut self, known: &[Option<[f64; 2]>; P]) -> Self {
        self.bounds.iter_mut().zip(known).for_each(|(bounds, known)| *bounds = known.unwrap_or(*bounds));
        self
    }

    /// Lets what holds the yarns be fitted too: from nothing to a yarn that is bent around its own radius.
    #[must_use]
    pub fn with_holding(self) -> Self {
        let least = self.bounds[RodParameter::Holding as usize][0];
        self.within(RodParameter::Holding, [least, least / LEAST_HOLDING])
    }

    /// The same bounds for coordinates.
    #[must_use]
    pub fn coordinate_bounds(&self) -> [[f64; 2]; P] {
        let [low, high] = [0, 1].map(|side| Self::coordinates(self.bounds.map(|pair| pair[side])));
        std::array::from_fn(|k| [low[k], high[k]])
    }

    /// Coordinates of parameters.
    #[must_use]
    pub fn coordinates(parameters: [f64; P]) -> [f64; P] {
        std::array::from_fn(|k| if k == ONSET { parameters[k] / ONSET_UNIT } else { parameters[k].ln() })
    }

    /// Parameters of coordinates.
    #[must_use]
    pub fn parameters(coordinates: [f64; P]) -> [f64; P] {
        std::array::from_fn(|k| if k == ONSET { coordinates[k] * ONSET_UNIT } else { coordinates[k].exp() })
    }

    /// Derivatives by coordinates of derivatives by parameters.
    #[must_use]
    pub fn by_coordinates(parameters: &[f64; P], slopes: [f64; P]) -> [f64; P] {
        std::array::from_fn(|k| slopes[k] * if k == ONSET { ONSET_UNIT } else { parameters[k] })
    }

    /// A place where all stiffnesses that are fitted are larger by a factor, as far as the bounds let them be.
    #[must_use]
    pub fn scaled(&self, coordinates: &[f64; P], factor: f64) -> [f64; P] {
        let bounds = self.coordinate_bounds();
        let is_stiffness = |k: usize| k != ONSET && k != RodParameter::OuterRadius as usize;
        std::array::from_fn(|k| {
            let by = if is_stiffness(k) { factor.ln() } else { 0.0 };
            (coordinates[k] + by).clamp(bounds[k][0], bounds[k][1])
        })
    }

    /// A place within the bounds, each coordinate a part of the way from its least to its largest value.
    #[must_use]
    pub fn at_parts(&self, parts: [f64; P]) -> [f64; P] {
        let bounds = self.coordinate_bounds();
        std::array::from_fn(|k| bounds[k][0] + parts[k] * (bounds[k][1] - bounds[k][0]))
    }
}
