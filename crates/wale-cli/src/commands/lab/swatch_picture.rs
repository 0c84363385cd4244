//! A pulled swatch as an SVG picture: coloured by how far it is stretched, over the outline that it had at rest.

use std::fmt::Write;

use wale_lab::shell::Sheet;

/// Width of the picture, and what is left free around the swatch, in SVG units.
const WIDTH: f64 = 800.0;
const MARGIN: f64 = 30.0;
/// Height of the line of words.
const WORDS: f64 = 40.0;
/// Colours from the least to the largest stretch.
const COLORS: [[f64; 3]; 4] = [[49.0, 84.0, 148.0], [86.0, 165.0, 160.0], [240.0, 205.0, 95.0], [190.0, 65.0, 50.0]];

/// Draws a swatch as seen from above, pulled to the right.
pub fn swatch_picture(name: &str, sheet: &Sheet) -> String {
    let stretches = sheet.principal_stretches();
    let bound = |start: f64, of: fn(f64, f64) -> f64| stretches.iter().fold(start, |m, &s| of(m, s));
    let (least, most) = (bound(f64::INFINITY, f64::min), bound(f64::NEG_INFINITY, f64::max));
    let flat = |places: &mut dyn Iterator<Item = [f64; 2]>| {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for place in places {
            for axis in 0..2 {
                low[axis] = low[axis].min(place[axis]);
                high[axis] = high[axis].max(place[axis]);
            }
        }
        (low, high)
    };
    let (rest_low, rest_high) = flat(&mut sheet.rest.iter().copied());
    let (low, high) = flat(&mut sheet.places.iter().map(|x| [x[0], x[1]]).chain(sheet.rest.iter().copied()));
    let scale = (WIDTH - 2.0 * MARGIN) / (high[0] - low[0]).max(f64::MIN_POSITIVE);
    let height = scale * (high[1] - low[1]) + 2.0 * MARGIN + WORDS;
    let place = |[x, y]: [f64; 2]| [MARGIN + scale * (x - low[0]), MARGIN + scale * (high[1] - y)];
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height:.0}\" font-family=\"sans-serif\" font-size=\"16\">\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
    );
    for (t, stretch) in sheet.triangles.iter().zip(&stretches) {
        let color = color((stretch - least) / (most - least).max(1e-9));
        let [p, q, r] = t.map(|v| {
            let [x, y, _] = sheet.places[v as usize];
            place([x, y])
        });
        let _ = writeln!(
            text,
            "<path d=\"M{:.1} {:.1}L{:.1} {:.1}L{:.1} {:.1}Z\" fill=\"{color}\" stroke=\"{color}\" stroke-width=\".4\"/>",
            p[0], p[1], q[0], q[1], r[0], r[1]
        );
    }
    let [from, to] = [place([rest_low[0], rest_high[1]]), place([rest_high[0], rest_low[1]])];
    let _ = writeln!(
        text,
        "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"none\" stroke=\"#333\" stroke-dasharray=\"6 4\"/>",
        from[0],
        from[1],
        to[0] - from[0],
        to[1] - from[1]
    );
    // What the colours say: a bar from the least to the largest.
    let line = height - 14.0;
    let _ = writeln!(
        text,
        "<text x=\"{MARGIN}\" y=\"{line:.0}\">along the {name}; locally stretched by {:.0} %</text>",
        100.0 * (least - 1.0)
    );
    for k in 0..40 {
        let x = 400.0 + 5.0 * f64::from(k);
        let _ = writeln!(
            text,
            "<rect x=\"{x}\" y=\"{:.0}\" width=\"5\" height=\"14\" fill=\"{}\"/>",
            line - 12.0,
            color(f64::from(k) / 39.0)
        );
    }
    let _ = writeln!(text, "<text x=\"610\" y=\"{line:.0}\">to {:.0} %</text>", 100.0 * (most - 1.0));
    text + "</svg>\n"
}

/// A colour of the scale, at a part of the way along it.
fn color(part: f64) -> String {
    let along = part.clamp(0.0, 1.0) * (COLORS.len() - 1) as f64;
    let k = (along as usize).min(COLORS.len() - 2);
    let t = along - k as f64;
    let [red, green, blue]: [u8; 3] =
        std::array::from_fn(|i| ((1.0 - t) * COLORS[k][i] + t * COLORS[k + 1][i]).round() as u8);
    format!("#{red:02x}{green:02x}{blue:02x}")
}
