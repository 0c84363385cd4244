//! Colour maps that the eye reads evenly, and sRGB to and from light.
//!
//! Both maps are paths through Ottosson's OKLab space with lightness going in equal steps: one from dark violet through
//! green to light yellow, one from blue through near white to red. They are computed here, not tabulated.

use glam::Vec3;

/// Light (linear RGB) of an sRGB colour.
#[must_use]
pub fn to_linear(color: [u8; 3]) -> Vec3 {
    let one = |c: u8| {
        let c = f32::from(c) / 255.0;
        if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    };
    Vec3::new(one(color[0]), one(color[1]), one(color[2]))
}

/// The sRGB colour of light, values beyond the screen's range cut.
#[must_use]
pub fn to_srgb(light: Vec3) -> [u8; 3] {
    let one = |c: f32| {
        let c = c.clamp(0.0, 1.0);
        let s = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
        (255.0 * s).round() as u8
    };
    [one(light.x), one(light.y), one(light.z)]
}

/// Light of an OKLab colour \[Ottosson 2020\].
fn from_oklab(lightness: f32, a: f32, b: f32) -> Vec3 {
    let cube = |x: f32| x * x * x;
    let l = cube(lightness + 0.396_337_78 * a + 0.215_803_76 * b);
    let m = cube(lightness - 0.105_561_346 * a - 0.063_854_17 * b);
    let s = cube(lightness - 0.089_484_18 * a - 1.291_485_5 * b);
    Vec3::new(
        4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_94 * s,
        -1.268_438 * l + 2.609_757_4 * m - 0.341_319_38 * s,
        -0.004_196_086_3 * l - 0.703_418_6 * m + 1.707_614_7 * s,
    )
}

/// Which way numbers become colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColorMap {
    /// Dark to light, for what has a least value.
    Sequential,
    /// Blue below, red above, for what has a middle.
    Diverging,
}

impl ColorMap {
    /// Light of a value from 0 to 1 (cut outside; not a number is grey).
    #[must_use]
    pub fn light(self, value: f64) -> Vec3 {
        if value.is_nan() {
            return Vec3::splat(0.2);
        }
        let s = value.clamp(0.0, 1.0) as f32;
        let color = match self {
            Self::Sequential => {
                let lightness = 0.27 + 0.65 * s;
                let hue = (310.0 - 205.0 * s).to_radians();
                let chroma = 0.125 + 0.03 * s;
                from_oklab(lightness, chroma * hue.cos(), chroma * hue.sin())
            }
            Self::Diverging => {
                let away = (2.0 * s - 1.0).abs();
                let hue: f32 = if s < 0.5 { 255.0 } else { 30.0 };
                let chroma = 0.17 * away * (1.0 - 0.12 * away);
                let lightness = 0.93 - 0.43 * away;
                let hue = hue.to_radians();
                from_oklab(lightness, chroma * hue.cos(), chroma * hue.sin())
            }
        };
        color.clamp(Vec3::ZERO, Vec3::ONE)
    }

    /// The map in `count` equal steps, sRGB.
    #[must_use]
    pub fn table(self, count: usize) -> Vec<[u8; 3]> {
        let last = count.saturating_sub(1).max(1) as f64;
        (0..count).map(|i| to_srgb(self.light(i as f64 / last))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_goes_to_light_and_back() {
        for c in 0..=255u8 {
            let color = [c, 255 - c, c / 2];
            assert_eq!(to_srgb(to_linear(color)), color);
        }
    }

    #[test]
    fn lightness_rises_steadily_in_the_sequential_map() {
        let luminance = |v: Vec3| 0.2126 * v.x + 0.7152 * v.y + 0.0722 * v.z;
        let steps: Vec<f32> =
            (0..=32).map(|i| luminance(ColorMap::Sequential.light(f64::from(i) / 32.0)).cbrt()).collect();
        for pair in steps.windows(2) {
            let rise = pair[1] - pair[0];
            assert!((0.008..0.04).contains(&rise), "{steps:?}");
        }
    }

    #[test]
    fn the_diverging_map_is_blue_then_pale_then_red() {
        let [low, middle, high] = [0.0, 0.5, 1.0].map(|s| ColorMap::Diverging.light(s));
        assert!(low.z > 2.0 * low.x && high.x > 2.0 * high.z);
        assert!(middle.min_element() > 0.7);
        assert!(ColorMap::Diverging.light(f64::NAN).is_finite());
    }
}
