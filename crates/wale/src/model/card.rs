//! Yarn and fabric cards: every number the mechanics need, in SI units.

/// A yarn.
#[derive(Clone, Debug, PartialEq)]
pub struct YarnCard {
    /// Linear density \[kg/m\] (1 tex = 1e-6 kg/m).
    pub linear_density: f64,
    /// Radius \[m\].
    pub radius: f64,
    /// Stretch stiffness `k_s = EA` \[N\].
    pub stretch_stiffness: f64,
    /// Bending stiffness `k_b = EI` \[N·m²\].
    pub bending_stiffness: f64,
    /// Coefficient of sliding friction between yarns \[–\].
    pub friction_coefficient: f64,
    /// Mass damping `α` \[1/s\].
    pub mass_damping: f64,
    /// Stiffness damping `β` \[s\], acting on the rates of stretch, bend and wrap.
    pub stiffness_damping: f64,
    /// Ply count drawn in pictures.
    pub plies: u32,
    /// Twist drawn in pictures \[turns/m\].
    pub twist: f64,
}

/// A knitted fabric: the size of its stitches and the stiffnesses of the contact model.
#[derive(Clone, Debug, PartialEq)]
pub struct FabricCard {
    /// Yarn length of one loop `ℓ` \[m\].
    pub loop_length: f64,
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
    /// Stiffness of the friction anchors `k_f` \[N/m\].
    pub anchor_stiffness: f64,
    /// Smallest compression of a contact `λ_min` \[N\].
    pub residual_compression: f64,
}
