//! `wale register`: the page is written, and bad input is told.

mod common;

use std::fs;
use std::path::Path;

use common::{assert_fails, assert_succeeds, wale};
use wale::picture::{Image, write_png};

const SIZES: [&str; 4] = ["--period", "2.1 mm x 1.6 mm", "--radius", "0.2 mm"];

fn photograph(path: &Path) {
    write_png(&Image::filled(400, 300, [120, 110, 90]), fs::File::create(path).unwrap()).unwrap();
}

#[test]
fn a_page_holds_both_photographs_and_is_not_overwritten_unasked() {
    let folder = tempfile::tempdir().unwrap();
    let [front, back] = ["swatch.png", "back.png"].map(|name| folder.path().join(name));
    photograph(&front);
    photograph(&back);
    let [front, back] = [front, back].map(|path| path.to_str().unwrap().to_owned());
    let arguments = [&["register", &front, &back, "--scale", "10 um"], &SIZES[..]].concat();
    assert_succeeds(&wale(&arguments));
    let page = folder.path().join("swatch.register.html");
    let text = fs::read_to_string(&page).unwrap();
    assert_eq!(text.matches("data:image/png;base64,").count(), 2);
    let facts = text.split_once("id=\"facts\">").and_then(|(_, rest)| rest.split_once("</script>")).unwrap().0;
    let facts: serde_json::Value = serde_json::from_str(facts).unwrap();
    let near = |value: &serde_json::Value, expected: f64| (value.as_f64().unwrap() / expected - 1.0).abs() < 1e-12;
    assert!(near(&facts["scale_m"], 10e-6) && near(&facts["radius_m"], 0.2e-3) && near(&facts["periods_m"][1], 1.6e-3));
    assert_eq!((facts["name"].as_str(), facts["mirrored"].as_bool()), (Some("swatch"), Some(true)));

    fs::write(&page, "mine").unwrap();
    assert_fails(&wale(&arguments), 3, &["swatch.register.html", "--force"]);
    assert_eq!(fs::read_to_string(&page).unwrap(), "mine");
    assert_succeeds(&wale(&[&arguments[..], &["--force", "--back-as-it-is"]].concat()));
    assert!(fs::read_to_string(&page).unwrap().contains("\"mirrored\":false"));
}

#[test]
fn bad_photographs_and_sizes_are_told_and_leave_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    photograph(Path::new(&at("good.png")));
    fs::write(at("text.png"), "no picture").unwrap();
    let whole = fs::read(at("good.png")).unwrap();
    fs::write(at("cut.png"), &whole[..whole.len() / 2]).unwrap();
    let (good, out) = (at("good.png"), at("page.html"));
    let run = |photographs: &[&str], sizes: &[&str]| wale(&[&["register", "--out", &out], photographs, sizes].concat());
    assert_fails(&run(&[&at("missing.png")], &SIZES), 3, &["missing.png", "no such file"]);
    assert_fails(&run(&[&good, &at("text.png")], &SIZES), 3, &["text.png", "neither a PNG nor a JPEG"]);
    assert_fails(&run(&[&at("cut.png")], &SIZES), 3, &["cut.png", "cut off"]);
    assert_fails(&run(&[&good], &["--period", "2 mm x 2 mm", "--radius", "3 mm"]), 3, &["radius", "period"]);
    let far = [&SIZES[..], &["--scale", "1 um"]].concat();
    assert_fails(&run(&[&good], &far), 3, &["2100.0 pixels", "--scale"]);
    assert_fails(&run(&[&good], &["--period", "2 mm", "--radius", "0.2 mm"]), 2, &["two periods"]);
    assert_fails(&run(&[&good], &["--period", "2 mm x 2 mm", "--radius", "0"]), 2, &["--radius"]);
    assert_fails(&run(&[&good], &SIZES[..2]), 2, &["--radius"]);
    assert!(!Path::new(&out).exists());
}
