//! The dimensions of a scene's quantities, and the units that people write them in.

use super::units::Dimension;

/// Standard acceleration of gravity \[m/s²\].
pub const STANDARD_GRAVITY: f64 = 9.806_65;
const INCH: f64 = 0.0254;
const YARD: f64 = 0.9144;
const POUND: f64 = 0.453_592_37;
const DEGREE: f64 = std::f64::consts::PI / 180.0;

macro_rules! dimension {
    ($(#[$doc:meta])* $name:ident, $words:literal, $example:literal, at most $largest:expr,
     $si:literal $(, $unit:literal = $size:expr)* $(; also $other:path)?) => {
        $(#[$doc])*
        #[derive(Clone, Copy, PartialEq, Debug)]
        pub struct $name;

        impl Dimension for $name {
            const NAME: &'static str = $words;
            const SI: &'static str = $si;
            const UNITS: &'static [(&'static str, f64)] = &[($si, 1.0) $(, ($unit, $size))*];
            const EXAMPLE: &'static str = $example;
            const LARGEST: f64 = $largest;
            $(fn other_notation(text: &str) -> Option<Result<f64, String>> {
                $other(text)
            })?
        }
    };
}

dimension!(
    /// Length \[m\].
    Length, "a length", "\"0.5 mm\"", at most 1e3,
    "m", "cm" = 1e-2, "mm" = 1e-3, "um" = 1e-6, "in" = INCH, "inch" = INCH
);
dimension!(
    /// Time \[s\].
    Time, "a time", "\"20 ms\"", at most 1e8,
    "s", "ms" = 1e-3, "us" = 1e-6, "min" = 60.0, "h" = 3600.0
);
dimension!(
    /// Something per time \[1/s\].
    Rate, "a rate", "\"30 1/s\"", at most 1e9,
    "1/s", "/s" = 1.0, "Hz" = 1.0, "fps" = 1.0
);
dimension!(
    /// Speed \[m/s\].
    Speed, "a speed", "\"20 mm/s\"", at most 1e3,
    "m/s", "cm/s" = 1e-2, "mm/s" = 1e-3, "m/min" = 1.0 / 60.0, "mm/min" = 1e-3 / 60.0
);
dimension!(
    /// Acceleration \[m/s²\].
    Acceleration, "an acceleration", "\"9.81 m/s^2\"", at most 1e5,
    "m/s^2", "mm/s^2" = 1e-3, "g" = STANDARD_GRAVITY
);
dimension!(
    /// Angle \[rad\].
    Angle, "an angle", "\"90 deg\"", at most 1e5,
    "rad", "deg" = DEGREE
);
dimension!(
    /// Angular speed \[rad/s\].
    AngularSpeed, "an angular speed", "\"90 deg/s\"", at most 1e5,
    "rad/s", "deg/s" = DEGREE, "rpm" = 6.0 * DEGREE
);
dimension!(
    /// Force \[N\].
    Force, "a force", "\"5 cN\"", at most 1e6,
    "N", "kN" = 1e3, "cN" = 1e-2, "mN" = 1e-3, "uN" = 1e-6, "gf" = 1e-3 * STANDARD_GRAVITY
);
dimension!(
    /// Force per length \[N/m\].
    ForcePerLength, "a force per length", "\"0.2 N/mm\"", at most 1e9,
    "N/m", "N/mm" = 1e3, "cN/mm" = 10.0, "mN/mm" = 1.0
);
dimension!(
    /// Pressure or modulus \[Pa\].
    Pressure, "a modulus", "\"10 MPa\"", at most 1e13,
    "Pa", "kPa" = 1e3, "MPa" = 1e6, "GPa" = 1e9, "N/mm^2" = 1e6
);
dimension!(
    /// Bending stiffness \[N·m²\].
    BendingStiffness, "a bending stiffness", "\"10 mN mm^2\"", at most 1.0,
    "N m^2", "N mm^2" = 1e-6, "mN mm^2" = 1e-9, "cN cm^2" = 1e-6, "gf cm^2" = 1e-7 * STANDARD_GRAVITY
);
dimension!(
    /// Linear density \[kg/m\].
    LinearDensity, "a linear density", "\"30 tex\" or \"Nm 2/28\"", at most 1.0,
    "kg/m", "g/m" = 1e-3, "g/km" = 1e-6, "tex" = 1e-6, "dtex" = 1e-7, "ktex" = 1e-3, "denier" = 1e-6 / 9.0,
    "den" = 1e-6 / 9.0; also yarn_count
);
dimension!(
    /// Density \[kg/m³\].
    Density, "a density", "\"1520 kg/m^3\"", at most 3e4,
    "kg/m^3", "g/cm^3" = 1e3, "g/cc" = 1e3
);
dimension!(
    /// Turns per length \[1/m\].
    Twist, "a twist", "\"300 turns/m\"", at most 1e5,
    "1/m", "turns/m" = 1.0, "tpm" = 1.0, "turns/cm" = 100.0, "turns/in" = 1.0 / INCH, "tpi" = 1.0 / INCH
);
dimension!(
    /// Threads per length \[1/m\].
    ThreadCount, "a thread count", "\"24 /cm\"", at most 1e6,
    "1/m", "1/cm" = 100.0, "/cm" = 100.0, "1/in" = 1.0 / INCH, "/in" = 1.0 / INCH, "epi" = 1.0 / INCH, "ppi" = 1.0 / INCH
);
dimension!(
    /// Drag force per length of yarn and speed \[Pa·s\].
    Drag, "a drag", "\"0.001 Pa s\"", at most 1e6,
    "Pa s", "mPa s" = 1e-3, "N s/m^2" = 1.0, "kg/(m s)" = 1.0
);
dimension!(
    /// A pure number.
    Ratio, "a number", "0.3", at most 1e12,
    "", "%" = 1e-2
);

/// `Nm 28`, `Nm 2/28`, `Ne 30`, `Ne 30/2`: lengths per mass. In a ratio the smaller number is the ply count.
fn yarn_count(text: &str) -> Option<Result<f64, String>> {
    let lower = text.to_ascii_lowercase();
    let (rest, length_per_mass) = if let Some(rest) = lower.strip_prefix("nm") {
        (rest, 1e3)
    } else if let Some(rest) = lower.strip_prefix("ne") {
        (rest, 840.0 * YARD / POUND)
    } else {
        return None;
    };
    let number = |part: &str| part.trim().parse::<f64>().ok().filter(|n| *n > 0.0 && n.is_finite());
    let parsed = match rest.split_once('/') {
        None => number(rest).map(|count| (1.0, count)),
        Some((a, b)) => number(a).zip(number(b)).map(|(a, b)| (a.min(b), a.max(b))),
    };
    Some(match parsed {
        Some((plies, count)) if plies.fract() == 0.0 => Ok(plies / (count * length_per_mass)),
        _ => Err(format!(
            "\"{}\" is no yarn count\nwrite for instance \"Nm 28\", \"Nm 2/28\" (two plies of Nm 28) or \"Ne 30\"",
            super::error::shortened(text)
        )),
    })
}
