//! What a knitted fabric is like: every number that its mechanics need, in SI units.

use super::YarnCard;

/// A knitted fabric: the size of its stitches and the stiffnesses of the contact model.
#[derive(Clone, Debug, PartialEq)]
pub struct KnitCard {
    /// Length `ℓ` of one loop along the model's yarn \[m\].
    pub loop_length: f64,
    /// Length along the model's yarn per length of real yarn \[–\], in (0, 1] as a rule: the straight segments cut
    /// the corners of real loops. A metre of the model weighs `linear_density / path_ratio`.
    pub path_ratio: f64,
    /// Extra loop length per knit–purl change within a row, as a fraction of `ℓ` \[–\].
    pub transition_length: f64,
    /// Rest length `L` of a stitch contact \[m\].
    pub stitch_length: f64,
    /// Initial spacing of wales `W` \[m\].
    pub wale_spacing: f64,
    /// Initial spacing of courses `C` \[m\].
    pub course_spacing: f64,
    /// Wrapping stiffness `k_w` \[N\].
    pub wrapping_stiffness: f64,
    /// Rest wrapping angle of the course pair `ψ₀` \[rad\].
    pub wrapping_angle_course: f64,
    /// Rest wrapping angle of the leg pair `ψ₀` \[rad\].
    pub wrapping_angle_leg: f64,
    /// Rest bend angle of foot and head passes \[rad\].
    pub bend_angle_foot_head: f64,
    /// Rest bend angle of leg passes \[rad\].
    pub bend_angle_leg: f64,
    /// Stiffness of the stitch length `k_l` \[N\].
    pub length_stiffness: f64,
    /// Stiffness of the spacing barrier `k_c` \[N\].
    pub spacing_stiffness: f64,
    /// Spacing distance of legs `d` \[m\].
    pub spacing_leg: f64,
    /// Spacing distance of heads and sinkers `d` \[m\].
    pub spacing_head_sinker: f64,
    /// How thick the yarns are where they touch; none for yarns that meet in one point.
    pub thickness: Option<Thickness>,
    /// Stiffness of the friction anchors `k_f` \[N/m\].
    pub anchor_stiffness: f64,
    /// Smallest compression of a contact `λ_min` \[N\].
    pub residual_compression: f64,
}

/// Yarns that lie beside each other at their contacts instead of meeting in one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thickness {
    /// Distance of the centre lines of two yarns at a contact \[m\].
    pub contact_distance: f64,
    /// Distance of the middles of two neighbouring legs below which they push each other away \[m\].
    pub leg_distance: f64,
    /// Stiffness of their push \[N\].
    pub leg_stiffness: f64,
    /// Spacing distance of a strand that goes from one face of the fabric to the other, over that of one that stays on a
    /// face \[–\]: contacts on opposite sides of a yarn nest.
    pub crossing_spacing: f64,
    /// Distance of the middles of legs that meet where the wales between them fold away, below which they push each other
    /// away \[m\].
    pub facing_distance: f64,
}

impl Thickness {
    /// The same shape of another size and stiffness: lengths times `length`, forces times `force`.
    #[must_use]
    pub fn scaled(&self, length: f64, force: f64) -> Self {
        Self {
            contact_distance: length * self.contact_distance,
            leg_distance: length * self.leg_distance,
            leg_stiffness: force * self.leg_stiffness,
            crossing_spacing: self.crossing_spacing,
            facing_distance: length * self.facing_distance,
        }
    }
}

/// The shape of a relaxed loop in proportion to its length, and the stiffnesses that go with it: what a fabric card
/// is made of when only the yarn and the loop length are known.
///
/// The default is fitted to measured swatches of seven knit and purl patterns in one yarn: relative to stockinette
/// their relaxed widths and heights come within 0.10 (root mean square of the logarithms), the 1×1 rib a quarter too
/// wide. `tests/relaxed_sizes.rs` prints the table.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopProportions {
    /// Rest length of a stitch contact `L/ℓ` \[–\].
    pub stitch_length: f64,
    /// Wrapping stiffness `k_w L ℓ/k_b` \[–\].
    pub wrapping: f64,
    /// Rest wrapping angle of the course pair \[rad\].
    pub wrapping_angle_course: f64,
    /// Rest wrapping angle of the leg pair \[rad\].
    pub wrapping_angle_leg: f64,
    /// Rest bend angle of foot and head passes \[rad\].
    pub bend_angle_foot_head: f64,
    /// Rest bend angle of leg passes \[rad\].
    pub bend_angle_leg: f64,
    /// Spacing distance of legs `d/ℓ` \[–\].
    pub spacing_leg: f64,
    /// Spacing distance of heads and sinkers `d/ℓ` \[–\].
    pub spacing_head_sinker: f64,
    /// Thickness of the yarns at their contacts, in loop lengths and in `k_b/ℓ²`.
    pub thickness: Option<Thickness>,
    /// Stiffness of the spacing barrier in `k_b/ℓ²` \[–\], where it is fitted: how hard yarns press against each other before one
    /// takes length from the other. Without, it is so stiff that legs, heads and sinkers keep their lengths.
    pub spacing_stiffness: Option<f64>,
    /// Extra loop length per knit–purl change within a row \[–\].
    pub transition_length: f64,
    /// Wale spacing of relaxed stockinette `W/ℓ` \[–\].
    pub wale_spacing: f64,
    /// Course spacing of relaxed stockinette `C/ℓ` \[–\].
    pub course_spacing: f64,
    /// Length along the model's yarn per length of real yarn \[–\].
    pub path_ratio: f64,
}

impl Default for LoopProportions {
    fn default() -> Self {
        Self {
            stitch_length: 0.0971,
            wrapping: 2.147,
            wrapping_angle_course: 2.087,
            wrapping_angle_leg: 1.569,
            bend_angle_foot_head: 0.463,
            bend_angle_leg: 1.112,
            spacing_leg: 0.2113,
            spacing_head_sinker: 0.0680,
            thickness: None,
            spacing_stiffness: None,
            transition_length: 0.085,
            wale_spacing: 0.2993,
            course_spacing: 0.2578,
            // Relaxed plain knit has W = ℓ/4.2 and C = ℓ/5.5 in real yarn (textile constants of fully relaxed cloth), the model the W and C above:
            // 0.795 and 0.705, of which this is the mean.
            path_ratio: 0.75,
        }
    }
}

impl LoopProportions {
    /// Loops whose yarns lie beside each other at their contacts, fitted to measured swatches of eleven patterns. Relative to
    /// stockinette their relaxed widths and heights come within 0.02 and 0.03 (root mean square of the logarithms), those of fifteen
    /// others within 0.07 and 0.05; the example `knit_swatches` prints the tables.
    #[must_use]
    pub fn thick() -> Self {
        Self {
            stitch_length: 0.0979,
            wrapping: 1.5796,
            wrapping_angle_course: 1.5433,
            wrapping_angle_leg: 0.8821,
            bend_angle_foot_head: 0.5860,
            bend_angle_leg: 1.3047,
            spacing_leg: 0.3957,
            spacing_head_sinker: 0.0937,
            thickness: Some(Thickness {
                contact_distance: 0.0527,
                leg_distance: 0.2151,
                leg_stiffness: 639.5,
                crossing_spacing: 0.7345,
                facing_distance: 0.3009,
            }),
            spacing_stiffness: Some(93.35),
            // The extra yarn of the masses, of which no corner is cut.
            transition_length: 0.110,
            wale_spacing: 0.2985,
            course_spacing: 0.2430,
            path_ratio: 0.773,
        }
    }

    /// Spacing stiffness in proportion to stretch stiffness \[–\]; relaxed sizes hardly depend on it.
    const SPACING_TO_STRETCH: f64 = 1.0 / 15.0;
    /// Anchor stiffness `k_f W/k_s` \[–\].
    const ANCHOR_TO_STRETCH: f64 = 0.1;
    /// Smallest compression in units of `k_b/ℓ²` \[–\]: 2 mN for a yarn of 0.5 mm radius, and as much in
    /// proportion for others.
    const RESIDUAL_COMPRESSION: f64 = 230.0;

    /// The card of a fabric of this yarn whose loops are `loop_length` \[m\] long along the model's yarn.
    #[must_use]
    pub fn card(&self, yarn: &YarnCard, loop_length: f64) -> KnitCard {
        let force = yarn.bending_stiffness / (loop_length * loop_length);
        let wale_spacing = self.wale_spacing * loop_length;
        KnitCard {
            loop_length,
            path_ratio: self.path_ratio,
            transition_length: self.transition_length,
            stitch_length: self.stitch_length * loop_length,
            wale_spacing,
            course_spacing: self.course_spacing * loop_length,
            wrapping_stiffness: self.wrapping / self.stitch_length * force,
            wrapping_angle_course: self.wrapping_angle_course,
            wrapping_angle_leg: self.wrapping_angle_leg,
            bend_angle_foot_head: self.bend_angle_foot_head,
            bend_angle_leg: self.bend_angle_leg,
            length_stiffness: yarn.stretch_stiffness,
            spacing_stiffness: match self.spacing_stiffness {
                Some(stiffness) => stiffness * force,
                None => Self::SPACING_TO_STRETCH * yarn.stretch_stiffness,
            },
            spacing_leg: self.spacing_leg * loop_length,
            spacing_head_sinker: self.spacing_head_sinker * loop_length,
            thickness: self.thickness.map(|thickness| thickness.scaled(loop_length, force)),
            anchor_stiffness: Self::ANCHOR_TO_STRETCH * yarn.stretch_stiffness / wale_spacing,
            residual_compression: Self::RESIDUAL_COMPRESSION * force,
        }
    }
}
