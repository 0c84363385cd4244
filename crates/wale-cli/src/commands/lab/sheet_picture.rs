//! A sheet of triangles as an SVG picture: from the far ones to the near ones, shaded by how they face the light.

use std::fmt::Write;

/// Size of the picture in SVG units.
const SIZE: [f64; 2] = [800.0, 560.0];
/// How far the eye looks down \[rad\].
const DOWN: f64 = 0.5;
/// Where light comes from: beside the eye and above.
const LIGHT: [f64; 3] = [-0.45, -0.55, 0.70];
/// Colours of the face that points up where the sheet lies flat, and of the other.
const FACES: [[f64; 3]; 2] = [[120.0, 150.0, 190.0], [190.0, 150.0, 120.0]];

/// Draws a sheet as seen from the front and above.
pub fn sheet_picture(places: &[[f64; 3]], triangles: &[[u32; 3]]) -> String {
    let (sin, cos) = DOWN.sin_cos();
    // To the right, up in the picture, and towards the eye.
    let seen = |[x, y, z]: [f64; 3]| [x, sin * y + cos * z, sin * z - cos * y];
    let seen: Vec<[f64; 3]> = places.iter().map(|&p| seen(p)).collect();
    let bound = |axis: usize, of: fn(f64, f64) -> f64, start: f64| seen.iter().fold(start, |m, p| of(m, p[axis]));
    let low = [0, 1].map(|axis| bound(axis, f64::min, f64::INFINITY));
    let high = [0, 1].map(|axis| bound(axis, f64::max, f64::NEG_INFINITY));
    let size = [0, 1].map(|axis| (high[axis] - low[axis]).max(1e-9));
    let scale = (0.9 * SIZE[0] / size[0]).min(0.9 * SIZE[1] / size[1]);
    let place = |v: u32| {
        let p = seen[v as usize];
        let middle = [0, 1].map(|axis| 0.5 * (low[axis] + high[axis]));
        [0.5 * SIZE[0] + scale * (p[0] - middle[0]), 0.5 * SIZE[1] - scale * (p[1] - middle[1])]
    };
    let mut order: Vec<(f64, &[u32; 3])> =
        triangles.iter().map(|t| (t.iter().map(|&v| seen[v as usize][2]).sum::<f64>(), t)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\"><rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
        SIZE[0], SIZE[1]
    );
    for (_, t) in order {
        let [p, q, r] = t.map(|v| places[v as usize]);
        let (a, b) = ([0, 1, 2].map(|k| q[k] - p[k]), [0, 1, 2].map(|k| r[k] - p[k]));
        let normal = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        let length = normal.iter().map(|n| n * n).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
        let to_eye = sin * normal[2] - cos * normal[1];
        let (face, turned) = if to_eye >= 0.0 { (FACES[0], 1.0) } else { (FACES[1], -1.0) };
        let lit = turned * normal.iter().zip(LIGHT).map(|(n, l)| n * l).sum::<f64>() / length;
        let bright = 0.45 + 0.75 * lit.max(0.0);
        let [red, green, blue] = face.map(|c| (c * bright).clamp(0.0, 255.0).round());
        let [p, q, r] = t.map(place);
        let color = format!("#{:02x}{:02x}{:02x}", red as u8, green as u8, blue as u8);
        let _ = writeln!(
            text,
            "<path d=\"M{:.1} {:.1}L{:.1} {:.1}L{:.1} {:.1}Z\" fill=\"{color}\" stroke=\"{color}\" stroke-width=\".4\"/>",
            p[0], p[1], q[0], q[1], r[0], r[1]
        );
    }
    text + "</svg>\n"
}
