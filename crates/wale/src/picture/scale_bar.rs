//! What is written over a picture: a bar of known length in millimetres, a caption, the scale of colours.

use super::{
    Image,
    color_map::ColorMap,
    lettering::{draw_text, text_width},
};

const INK: [u8; 3] = [58, 60, 66];

/// The longest of 1, 2, 5 times a power of ten that is at most `length`.
///
/// Zero for a length that is not a positive number.
#[must_use]
pub fn round_length(length: f64) -> f64 {
    if !(length.is_finite() && length > 0.0) {
        return 0.0;
    }
    let power = 10f64.powf(length.log10().floor());
    // Rounding of the logarithm may put the power one too high or low.
    [10.0, 5.0, 2.0, 1.0, 0.5].into_iter().map(|m| m * power).find(|l| *l <= length * (1.0 + 1e-12)).unwrap_or(power)
}

/// A length as a label in millimetres (micrometres below 0.1 mm).
#[must_use]
pub fn length_label(length: f64) -> String {
    let millimetres = length * 1e3;
    if millimetres >= 0.0999 {
        format!("{} mm", trimmed(millimetres))
    } else {
        format!("{} µm", trimmed(length * 1e6))
    }
}

/// A number with at most four digits that count and no idle zeros.
fn trimmed(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let digits = (3.0 - value.abs().log10().floor()).clamp(0.0, 9.0) as usize;
    let text = format!("{value:.digits$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    text.replace('-', "−")
}

/// Height of capitals that suits a picture.
fn letter_height(image: &Image) -> f32 {
    (image.height.min(image.width) as f32 / 50.0).clamp(7.0, 48.0)
}

/// Draws the bar at the bottom left. `pixel` is the length that a pixel covers in the plane of the camera's target \[m\].
pub(super) fn draw_scale_bar(image: &mut Image, pixel: f64) {
    let length = round_length(0.22 * image.width as f64 * pixel);
    if length <= 0.0 {
        return;
    }
    let height = letter_height(image);
    let pixels = (length / pixel) as f32;
    let (left, bottom) = (1.6 * height, image.height as f32 - 1.6 * height);
    let thick = (0.16 * height).max(1.0);
    fill(image, [left, bottom - thick, left + pixels, bottom], INK);
    for x in [left, left + pixels - thick] {
        fill(image, [x, bottom - 0.75 * height, x + thick, bottom], INK);
    }
    let label = length_label(length);
    let middle = left + 0.5 * (pixels - text_width(&label, 0.85 * height));
    draw_text(image, &label, middle.max(left), bottom - 0.5 * height - thick, 0.85 * height, INK);
}

/// Writes a line at the top left.
pub(super) fn draw_caption(image: &mut Image, caption: &str) {
    let height = letter_height(image);
    draw_text(image, caption, 1.6 * height, 2.3 * height, 0.85 * height, INK);
}

/// What the colours mean: a name, a unit, and the values at both ends in that unit.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Legend {
    pub title: String,
    pub range: [f64; 2],
    pub map: ColorMap,
}

/// Draws the scale of colours at the bottom right.
pub(super) fn draw_legend(image: &mut Image, legend: &Legend) {
    let height = letter_height(image);
    let text = 0.75 * height;
    let (long, wide) = ((0.26 * image.width as f32).round(), 0.55 * height);
    let (right, bottom) = ((image.width as f32 - 2.2 * height).round(), image.height as f32 - 2.6 * height);
    let left = right - long;
    let title_left = left - 0.8 * height - text_width(&legend.title, 0.85 * height);
    draw_text(image, &legend.title, title_left, bottom, 0.85 * height, INK);
    let table = legend.map.table(256);
    let steps = long as usize;
    for i in 0..steps {
        let color = table[255 * i / steps.max(2).saturating_sub(1)];
        let x = left + i as f32;
        fill(image, [x, bottom - wide, x + 1.0, bottom], color);
    }
    let span = legend.range[1] - legend.range[0];
    for i in 0..=4u8 {
        let s = f64::from(i) / 4.0;
        let value = legend.range[0] + s * span;
        // A value that rounding put beside zero is zero.
        let label = trimmed_to(if value.abs() < 1e-9 * span { 0.0 } else { value }, span);
        let x = left + s as f32 * long;
        fill(image, [x - 0.5, bottom, x + 0.5, bottom + 0.25 * height], INK);
        draw_text(image, &label, x - 0.5 * text_width(&label, text), bottom + 0.5 * height + text, text, INK);
    }
}

/// A number with the decimals that tell it from its neighbours on a scale of the given span.
fn trimmed_to(value: f64, span: f64) -> String {
    let digits = (1.0 - span.abs().max(1e-12).log10().floor()).clamp(0.0, 9.0) as usize;
    let text = format!("{value:.digits$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    text.replace('-', "−")
}

/// Fills the rectangle `[left, top, right, bottom]`, its edges weighed by the part of the pixel they cover.
fn fill(image: &mut Image, [left, top, right, bottom]: [f32; 4], color: [u8; 3]) {
    let part = |low: f32, high: f32, i: i64| (high.min(i as f32 + 1.0) - low.max(i as f32)).clamp(0.0, 1.0);
    for y in top.floor() as i64..bottom.ceil() as i64 {
        for x in left.floor() as i64..right.ceil() as i64 {
            image.blend(x, y, color, part(left, right, x) * part(top, bottom, y));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bar_lengths_are_1_2_5() {
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-9;
        for (given, wanted) in [(0.0234, 0.02), (0.0199, 0.01), (0.05, 0.05), (1.0, 1.0), (0.00099, 0.0005)] {
            assert!(near(round_length(given), wanted), "{given}");
        }
        assert_eq!(round_length(f64::NAN), 0.0);
        assert_eq!(length_label(0.02), "20 mm");
        assert_eq!(length_label(0.0005), "0.5 mm");
        assert_eq!(length_label(0.00002), "20 µm");
    }

    #[test]
    fn the_bar_is_as_long_as_it_says() {
        let mut image = Image::filled(1000, 400, [255; 3]);
        let pixel = 1e-4;
        draw_scale_bar(&mut image, pixel);
        let row =
            (0..image.height).map(|y| (0..image.width).filter(|x| image.pixel(*x, y)[0] < 120).count()).max().unwrap();
        let length = round_length(0.22 * 1000.0 * pixel);
        assert!((row as f64 * pixel - length).abs() < 2.0 * pixel, "{row}");
    }

    #[test]
    fn the_legend_shows_both_ends_of_the_map() {
        let mut image = Image::filled(600, 600, [255; 3]);
        let legend = Legend { title: "stretch [%]".to_owned(), range: [-3.0, 3.0], map: ColorMap::Diverging };
        draw_legend(&mut image, &legend);
        let ends =
            [ColorMap::Diverging.light(0.0), ColorMap::Diverging.light(1.0)].map(super::super::color_map::to_srgb);
        for end in ends {
            assert!(image.pixels.contains(&end));
        }
    }
}
