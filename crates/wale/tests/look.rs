//! scratch
use glam::DVec3;
use wale::geometry::Curve;
use wale::picture::*;

pub fn stockinette(rows: usize, columns: usize, samples: usize, yarns: [[u8; 3]; 2]) -> Vec<Curve> {
    let (w, c, r) = (5.0e-3, 3.6e-3, 0.85e-3);
    (0..rows)
        .map(|row| {
            let mut points = vec![];
            for i in 0..=(columns * samples) {
                let t = i as f64 / samples as f64 * std::f64::consts::TAU;
                let x = w * (t / std::f64::consts::TAU) + 0.26 * w * (2.0 * t).sin();
                let y = c * row as f64 - 0.95 * c * (t).cos();
                let z = -1.05 * r * (2.0 * t).cos();
                points.push(DVec3::new(x, y, z));
            }
            let mut u = vec![0.0];
            for p in points.windows(2) {
                u.push(u.last().unwrap() + p[0].distance(p[1]));
            }
            Curve { pass: vec![0; points.len()], arc_length: u, radius: r, color: yarns[row / 6 % 2], points }
        })
        .collect()
}

#[test]
fn look() {
    let curves = stockinette(14, 10, 48, [[176, 42, 48], [228, 221, 205]]);
    let subject = Subject { curves: &curves, ..Default::default() };
    let (points, radius) = subject.extent_points();
    for (name, view) in [("front", View::Front), ("nice", View::ThreeQuarter)] {
        let settings = Settings {
            twist: 110.0,
            caption: Some("stockinette, 14 × 10 loops".into()),
            ground: Some(view.ground_normal()),
            ..Settings::default()
        };
        let camera = Camera::framing(view, view.projection(), &points, radius, 4.0 / 3.0, 0.06);
        let t = std::time::Instant::now();
        let image = render(&subject, &camera, &settings);
        println!("{name} {:?}", t.elapsed());
        write_png(&image, std::fs::File::create(format!("/tmp/pics/{name}.png")).unwrap()).unwrap();
    }
}
