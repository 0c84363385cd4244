//! The view page in a real browser: opened in headless Chromium, a screenshot taken, its pixels looked at.
//!
//! Without a Chromium the tests say so and pass; with `WALE_REQUIRE_CHROMIUM=1` they fail instead.

mod chromium;

use std::{
    collections::HashSet,
    fs,
    path::{Path, PathBuf},
};

use chromium::{browse, chromium_or_say_so};
use glam::{DQuat, DVec3};
use wale::{
    geometry::{Curve, PointScalars, Solid, SolidShape},
    picture::{Image, read_png},
    view::{ViewData, ViewFrame, ViewSettings, write_html},
};

const WIDTH: usize = 900;
const HEIGHT: usize = 600;
const BACKGROUND: [u8; 3] = [243, 242, 239];

/// Rows of loops of two colours that rise and bend with time, a ball behind them.
fn swatch(frames: usize) -> ViewData {
    let (rows, columns, samples) = (8, 8, 32);
    let (wale, course, radius) = (5.0e-3, 3.6e-3, 0.8e-3);
    let frame = |f: usize| {
        let t = f as f64 / (frames.max(2) - 1) as f64;
        let mut frame = ViewFrame { time: 0.5 * t, ..ViewFrame::default() };
        for row in 0..rows {
            let mut curve =
                Curve { radius, color: if row % 4 < 2 { [176, 42, 48] } else { [38, 90, 150] }, ..Curve::default() };
            let (mut stretch, mut length) = (Vec::new(), 0.0);
            for i in 0..=columns * samples {
                let a = i as f64 / samples as f64 * std::f64::consts::TAU;
                let x = wale * a / std::f64::consts::TAU + 0.26 * wale * (2.0 * a).sin();
                let y = course * (row as f64 - 0.95 * a.cos());
                let z = -1.05 * radius * (2.0 * a).cos() + 25.0 * t * (x - 0.02) * (x - 0.02);
                let point = DVec3::new(x, y, z);
                length += curve.points.last().map_or(0.0, |last: &DVec3| last.distance(point));
                curve.points.push(point);
                curve.arc_length.push(length);
                curve.pass.push(0);
                stretch.push(t * 0.1 * (x / 0.04 - 0.5));
            }
            frame.curves.push(curve);
            frame.scalars.stretch.push(stretch);
        }
        let zeros: Vec<Vec<f64>> = frame.curves.iter().map(|c| vec![0.0; c.points.len()]).collect();
        frame.scalars = PointScalars { sliding: zeros.clone(), curvature: zeros, ..frame.scalars };
        let ball = Solid::new(SolidShape::Sphere { radius: 5e-3 }, DVec3::new(0.02, 0.013, -8e-3));
        let slab = SolidShape::Box { half_extents: DVec3::new(0.03, 0.005, 1e-3) };
        frame.solids = vec![
            ball,
            Solid { rotation: DQuat::from_rotation_z(0.3), ..Solid::new(slab, DVec3::new(0.02, -0.01, -0.012)) },
        ];
        frame
    };
    ViewData { title: "Swatch & test".to_owned(), frames: (0..frames).map(frame).collect(), plies: 3, twist: 120.0 }
}

/// What the browser shows of a page in the state that `fragment` asks for.
fn screenshot(browser: &Path, page: &Path, fragment: &str) -> Image {
    let folder = tempfile::tempdir().expect("a folder for the browser");
    let shot = folder.path().join("shot.png");
    let more = [
        "--use-angle=swiftshader".to_owned(),
        "--enable-unsafe-swiftshader".to_owned(),
        format!("--window-size={WIDTH},{HEIGHT}"),
        format!("--screenshot={}", shot.display()),
    ];
    browse(browser, folder.path(), &format!("file://{}#{fragment}", page.display()), &more);
    let bytes = fs::read(&shot).expect("Chromium wrote a screenshot");
    if let Some(keep) = std::env::var_os("WALE_KEEP_SCREENSHOTS") {
        let name = fragment.replace(['=', '&'], "_");
        fs::write(Path::new(&keep).join(format!("shot_{name}.png")), &bytes).expect("screenshots can be kept");
    }
    read_png(&bytes).expect("the screenshot is a picture")
}

fn page(data: &ViewData, folder: &Path) -> PathBuf {
    let path = folder.join("view.html");
    write_html(data, &ViewSettings::default(), fs::File::create(&path).expect("a file")).expect("a page");
    path
}

/// Pixels of the middle of the picture (away from title and buttons) that are clearly not background.
fn drawn(image: &Image) -> Vec<[u8; 3]> {
    let rows = image.height / 8..image.height * 3 / 4;
    rows.flat_map(|y| (0..image.width).map(move |x| (x, y)))
        .map(|(x, y)| image.pixel(x, y))
        .filter(|p| p.iter().zip(BACKGROUND).any(|(a, b)| a.abs_diff(b) > 24))
        .collect()
}

/// Part of the pixels in which the two pictures differ clearly.
fn difference(a: &Image, b: &Image) -> f64 {
    let unlike = |p: &[u8; 3], q: &[u8; 3]| p.iter().zip(q).any(|(x, y)| x.abs_diff(*y) > 24);
    let count = a.pixels.iter().zip(&b.pixels).filter(|(p, q)| unlike(p, q)).count();
    count as f64 / a.pixels.len() as f64
}

#[test]
fn the_page_draws_yarns_and_follows_its_address() {
    let Some(browser) = chromium_or_say_so("the_page_draws_yarns_and_follows_its_address") else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let path = page(&swatch(12), folder.path());
    let first = screenshot(&browser, &path, "frame=1&view=front");
    let pixels = drawn(&first);
    assert!(pixels.len() > WIDTH * HEIGHT / 12, "only {} pixels are drawn", pixels.len());
    let shades: HashSet<[u8; 3]> = pixels.iter().map(|p| p.map(|c| c / 8)).collect();
    assert!(shades.len() > 60, "only {} shades: no light on the yarns", shades.len());
    let red = pixels.iter().filter(|p| p[0] / 2 > p[2].max(20)).count();
    let blue = pixels.iter().filter(|p| p[2] / 2 > p[0].max(20)).count();
    assert!(red > 5_000 && blue > 5_000, "{red} red and {blue} blue pixels: yarns lack their colours");

    let last = screenshot(&browser, &path, "frame=12&view=front");
    assert!(difference(&first, &last) > 0.02, "frame 12 looks like frame 1");
    let stretch = screenshot(&browser, &path, "frame=12&view=front&color=stretch");
    assert!(difference(&last, &stretch) > 0.05, "colour by stretch looks like colour by yarn");
    let side = screenshot(&browser, &path, "frame=12&view=three-quarter");
    assert!(difference(&last, &side) > 0.05, "three-quarter view looks like the front view");
}

#[test]
fn an_impossible_address_is_told_to_the_user() {
    let Some(browser) = chromium_or_say_so("an_impossible_address_is_told_to_the_user") else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let path = page(&swatch(2), folder.path());
    let wrong = screenshot(&browser, &path, "color=taste");
    let right = screenshot(&browser, &path, "color=yarn");
    // The message lies on a white card over the middle.
    let white = |image: &Image| image.pixels.iter().filter(|p| **p == [255; 3]).count();
    assert!(white(&wrong) > white(&right) + 20_000, "{} {}", white(&wrong), white(&right));
}
