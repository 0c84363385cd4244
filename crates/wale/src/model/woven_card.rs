//! What a woven fabric is like: every number that its mechanics need, in SI units.

use super::YarnCard;

/// A woven fabric: its sett, the crimp of its yarns, and the stiffnesses of the contact model. Of two numbers the first is
/// of the warp, the second of the weft.
#[derive(Clone, Debug, PartialEq)]
pub struct WovenCard {
    /// Distance of neighbouring ends, and of neighbouring picks \[m\].
    pub spacing: [f64; 2],
    /// Length of real yarn beyond that of the straight model's, as a part of it \[–\].
    pub crimp: [f64; 2],
    /// How far a yarn goes from the back of the fabric to its front where it interlaces \[m\]; the two make up the sum of
    /// the yarns' diameters.
    pub crimp_height: [f64; 2],
    /// Yarn length of warp and weft below which an interlacing is jammed \[m\].
    pub interlacing_spacing: [f64; 2],
    /// Likewise under a float, where the yarns that it passes may be pushed over each other \[m\].
    pub float_spacing: [f64; 2],
    /// Shear stiffness `k_x` \[N\].
    pub shear_stiffness: f64,
    /// Angle of shear from which the yarns of the same system lie side by side `φ_j` \[rad\].
    pub shear_jamming_angle: f64,
    /// Stiffness of the spacing barrier `k_c` \[N\].
    pub spacing_stiffness: f64,
    /// Stiffness of the friction anchors `k_f` \[N/m\].
    pub anchor_stiffness: f64,
    /// Smallest compression of a crossing `λ_min` \[N\].
    pub residual_compression: f64,
}

/// The shape of the yarns in a woven fabric, of which the rest of a card follows. Of two numbers the first is of the
/// warp, the second of the weft.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WovenGeometry {
    /// Distance of neighbouring ends, and of neighbouring picks \[m\].
    pub spacing: [f64; 2],
    /// Crimp \[–\].
    pub crimp: [f64; 2],
    /// Crimp height \[m\].
    pub crimp_height: [f64; 2],
    /// Yarn length of warp and weft below which an interlacing is jammed \[m\].
    pub interlacing_spacing: [f64; 2],
}

impl WovenCard {
    /// Spacing and anchor stiffness in proportion to those of yarns, as in knits.
    const SPACING_TO_STRETCH: f64 = 1.0 / 15.0;
    const ANCHOR_TO_STRETCH: f64 = 0.1;
    /// Part of a yarn's diameter to which yarns under a float can be pushed together, over each other.
    const UNDER_A_FLOAT: f64 = 0.25;
    /// Least and largest angle of shear at which a fabric jams \[rad\].
    const JAMMING: [f64; 2] = [0.15, 1.4];

    /// The card of a fabric of warp and weft with a geometry.
    ///
    /// Shear at small angles bends the yarns between crossings that clasp them: a span `p` of which both ends turn by half the
    /// angle stores `1.5 k_b φ²/p`, and a crossing has one span of each system, `½ k_x L φ² = Σ 1.5 k_b φ²/p`. Yarns lie side
    /// by side at the angle whose cosine is their diameter over their distance. Crossings are pressed by the bending of the
    /// yarns over each other: a span of `2p` pushed aside by `h` at its middle pushes back with `48 k_b h/(2p)³`.
    #[must_use]
    pub fn new(warp: &YarnCard, weft: &YarnCard, geometry: &WovenGeometry) -> Self {
        let yarns = [warp, weft];
        let mean = |of: fn(&YarnCard) -> f64| 0.5 * (of(warp) + of(weft));
        let stretch = mean(|yarn| yarn.stretch_stiffness);
        let pitch = 0.5 * (geometry.spacing[0] + geometry.spacing[1]);
        // A system's yarns run across the spacing of the other's.
        let span = [geometry.spacing[1], geometry.spacing[0]];
        let shear: f64 = (0..2).map(|k| 3.0 * yarns[k].bending_stiffness / span[k]).sum();
        let jamming = (0..2).map(|k| (2.0 * yarns[k].radius / geometry.spacing[k]).min(1.0).acos());
        let press: f64 = (0..2)
            .map(|k| 48.0 * yarns[k].bending_stiffness * geometry.crimp_height[k] / (2.0 * span[k]).powi(3))
            .sum();
        let [least, largest] = Self::JAMMING;
        Self {
            spacing: geometry.spacing,
            crimp: geometry.crimp,
            crimp_height: geometry.crimp_height,
            interlacing_spacing: geometry.interlacing_spacing,
            float_spacing: [1, 0].map(|other: usize| Self::UNDER_A_FLOAT * 2.0 * yarns[other].radius),
            shear_stiffness: shear / pitch,
            shear_jamming_angle: jamming.fold(largest, f64::min).max(least),
            spacing_stiffness: Self::SPACING_TO_STRETCH * stretch,
            anchor_stiffness: Self::ANCHOR_TO_STRETCH * stretch / pitch,
            residual_compression: 0.5 * press,
        }
    }
}
