//! Units in which textile instruments print, in SI units: a number that an instrument prints times its unit is SI.

/// 1 gf \[N\]: standard gravity on a gram.
pub const GF: f64 = 9.806_65e-3;
/// 1 gf/cm \[N/m\]: forces by width.
pub const GF_PER_CM: f64 = GF / 1e-2;
/// 1 gf·cm²/cm \[N·m\]: bending rigidity `B` of KES, moment by width and curvature.
pub const GF_CM2_PER_CM: f64 = GF * 1e-2 * 1e-2 / 1e-2;
/// 1 gf·cm/cm \[N\]: hysteresis of bending `2HB`, moment by width.
pub const GF_CM_PER_CM: f64 = GF;
/// 1 gf/(cm·deg) \[N/(m·rad)\]: shear rigidity `G` of KES, force by width and angle.
pub const GF_PER_CM_DEG: f64 = GF_PER_CM * 180.0 / std::f64::consts::PI;
/// 1 gf·cm/cm² \[J/m²\]: tensile work `WT`, by area.
pub const GF_CM_PER_CM2: f64 = GF * 1e-2 / 1e-4;
/// 1 µN·m \[N·m\]: bending rigidity of FAST.
pub const UN_M: f64 = 1e-6;
/// What FAST calls a mm² of formability \[m²\]: its formula takes stretch in per cent, so it is a hundredth of one.
pub const FAST_MM2: f64 = 1e-2 * 1e-6;
/// 1 %.
pub const PERCENT: f64 = 1e-2;
/// 1 mm \[m\].
pub const MM: f64 = 1e-3;
/// 1 cm² \[m²\].
pub const CM2: f64 = 1e-4;
/// 1 cm⁻¹ \[1/m\].
pub const PER_CM: f64 = 1e2;
/// 1° \[rad\].
pub const DEG: f64 = std::f64::consts::PI / 180.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_those_of_the_tables() {
        let same = |value: f64, known: f64, digits: f64| {
            assert!((value / known - 1.0).abs() < digits, "{value} is not {known}");
        };
        same(GF_CM2_PER_CM, 9.806_65e-5, 1e-15);
        same(GF_CM_PER_CM, 9.806_65e-3, 1e-15);
        // Tables print five digits.
        same(GF_PER_CM_DEG, 56.188, 1e-5);
        same(GF_CM_PER_CM2, 0.980_665, 1e-15);
        same(GF_PER_CM, 0.980_665, 1e-15);
        same(90.0 * DEG, std::f64::consts::FRAC_PI_2, 1e-15);
    }
}
