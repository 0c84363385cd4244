//! Charts, programs, images and drafts that are checked and inspected without a scene: what is said of the fabric before it moves.

mod common;

use std::fs;
use std::process::Output;

use common::{Workshop, assert_fails, assert_succeeds, wale};
use serde_json::Value;

const STRANDED: &str = "Cast on 12\nRow 1 (RS): with A, k2, with B, k8, with A, k2\nRow 2 (WS): with A, p\n";
const PLATED: &str = include_str!("../../wale/tests/corpus/knitout/plated.k");
const DRAFT: &str = "[WIF]\nVersion=1.1\n[WEAVING]\nShafts=2\nTreadles=2\n\
    [WARP]\nThreads=8\nUnits=centimeters\nSpacing=0.1\nColor=1\n[WEFT]\nThreads=4\nUnits=centimeters\nSpacing=0.125\nColor=2\n\
    [COLOR PALETTE]\nRange=0,255\n[COLOR TABLE]\n1=255,0,0\n2=0,0,255\n3=0,255,0\n[WARP COLORS]\n1=3\n2=3\n\
    [THREADING]\n1=1\n2=2\n3=1\n4=2\n5=1\n6=2\n7=1\n8=2\n[TIEUP]\n1=1\n2=2\n[TREADLING]\n1=1\n2=2\n3=1\n4=2\n";

/// A file of a name and its text, told by a command.
struct Told {
    workshop: Workshop,
    path: String,
}

impl Told {
    fn of(name: &str, content: impl AsRef<[u8]>) -> Self {
        let workshop = Workshop::new();
        fs::write(workshop.path(name), content).unwrap();
        let path = workshop.text(name);
        Self { workshop, path }
    }

    fn output(&self, command: &str, more: &[&str]) -> Output {
        wale(&[&[command, self.path.as_str()], more].concat())
    }

    fn lines(&self, command: &str, more: &[&str]) -> Vec<String> {
        let output = self.output(command, more);
        assert_succeeds(&output);
        String::from_utf8(output.stdout).unwrap().lines().map(str::to_owned).collect()
    }

    fn json(&self, command: &str, more: &[&str]) -> Value {
        let output = self.output(command, &[&["--json"], more].concat());
        assert_succeeds(&output);
        serde_json::from_slice(&output.stdout).unwrap()
    }
}

#[track_caller]
fn assert_line(lines: &[String], line: &str) {
    assert!(lines.iter().any(|known| known == line), "`{line}` is not in\n{}", lines.join("\n"));
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// The lines of a census that follow from its numbers.
#[track_caller]
fn assert_told_as_counted(told: &Told, more: &[&str]) {
    for command in ["check", "inspect"] {
        let (lines, facts) = (told.lines(command, more), told.json(command, more));
        let (fabric, shape) = (&facts["fabric"], &facts["shape"]);
        let density = number(&shape["stitch_density_per_m2"]);
        let areal = number(&fabric["mass_kg"]) * density / number(&fabric["loops"]);
        assert!((areal / number(&facts["areal_mass_kg_per_m2"]) - 1.0).abs() < 1e-12);
        assert_line(&lines, &format!("  mass     {:.0} g/m²", 1e3 * areal));
        assert!(lines.iter().any(|line| line.contains(&format!(", {:.2} ", 1e-4 * density)) && line.contains("/cm²")));
        let amounts = fabric["amounts"].as_array().unwrap();
        let mass: f64 = amounts.iter().map(|of| number(&of["mass_kg"])).sum();
        assert!((mass / number(&fabric["mass_kg"]) - 1.0).abs() < 1e-12, "every yarn is counted, none twice");
        for of in amounts.iter().filter(|_| amounts.len() > 1) {
            let (length, mass) = (number(&of["length_m"]), 1e3 * number(&of["mass_kg"]));
            let amount = format!("{length:>8.3} m, {mass:.3} g of {}", of["name"].as_str().unwrap());
            assert!(lines.iter().any(|line| line.trim_start().starts_with(amount.trim_start())), "{amount}: {lines:?}");
        }
        assert_eq!(facts["assumed_yarn"], more.get(1).copied().unwrap_or("worsted-wool"));
        let assumed = format!("  assumed  the yarn {}; another by --yarn, ", facts["assumed_yarn"].as_str().unwrap());
        assert!(lines[1].starts_with(&assumed) && lines[1].contains("`wale new`"), "{}", lines[1]);
    }
}

#[test]
fn instructions_tell_yarn_mass_density_and_floats_with_their_places() {
    let told = Told::of("stranded.knit", STRANDED);
    assert_told_as_counted(&told, &[]);
    assert_told_as_counted(&told, &["--yarn", "thick-acrylic"]);
    for command in ["check", "inspect"] {
        let lines = told.lines(command, &[]);
        // Right-side rows run from the right: the yarn leaves the second stitch from there.
        let float = "1 pass more than 5 stitches, the longest 8: row 1 column 11 past 8";
        assert_line(&lines, &format!("  floats   {float}"));
        assert!(!lines.iter().any(|line| line.starts_with("  dropped")), "all is bound off");
        let patient = told.lines(command, &["--longest-float", "8"]);
        assert!(!patient.iter().any(|line| line.starts_with("  floats")));
        let facts = told.json(command, &[]);
        assert_eq!(facts["fabric"]["floats"][0], serde_json::json!({ "over": 8, "row": 0, "column": 10 }));
        let amounts = facts["fabric"]["amounts"].as_array().unwrap();
        assert_eq!([&amounts[0]["name"], &amounts[1]["name"]], ["A", "B"]);
        // 16 stitches and the cast-on and bind-off of one, 8 stitches of the other.
        assert!(number(&amounts[0]["length_m"]) > 16.0 * 0.02 && number(&amounts[1]["length_m"]) > 8.0 * 0.02);
        let tex = 1e6 * number(&amounts[0]["mass_kg"]) / number(&amounts[0]["length_m"]);
        assert!((tex - 500.0).abs() < 1e-6, "{tex}");
    }
    let (checked, inspected) = (told.json("check", &[]), told.json("inspect", &[]));
    assert_eq!((&checked["fabric"], &checked["shape"]), (&inspected["fabric"], &inspected["shape"]));
}

#[test]
fn a_program_tells_dropped_loops_plated_yarns_and_remarks() {
    let told = Told::of("plated.k", PLATED);
    assert_told_as_counted(&told, &[]);
    for command in ["check", "inspect"] {
        let dropped = "row 3 column 1, row 3 column 2, row 3 column 3, row 3 column 4";
        assert_line(&told.lines(command, &[]), &format!("  dropped  4 loops that nothing holds: {dropped}"));
        let amounts = told.json(command, &[])["fabric"]["amounts"].clone();
        assert_eq!([&amounts[0]["name"], &amounts[1]["name"]], ["1", "2"]);
        // Carrier 2 only runs together with carrier 1.
        let tex = number(&amounts[1]["mass_kg"]) / number(&amounts[1]["length_m"]);
        assert!((tex - 500e-6).abs() < 1e-12 && number(&amounts[0]["length_m"]) > number(&amounts[1]["length_m"]));
    }
    let told = Told::of("never-out.knitout", PLATED.replace("out 1\nout 2\n", ""));
    for command in ["check", "inspect"] {
        assert_line(&told.lines(command, &[]), "  line 16   carrier 1 2 is never taken out; its end hangs free");
        assert!(told.json(command, &[])["remarks"][0]["what"].as_str().unwrap().contains("never taken out"));
    }
}

#[test]
fn a_draft_tells_its_sett_and_a_length_for_every_color() {
    let told = Told::of("colors.wif", DRAFT);
    let cotton = ["--yarn", "fine-cotton-jersey"];
    assert_told_as_counted(&told, &cotton);
    for command in ["check", "inspect"] {
        assert_line(&told.lines(command, &cotton), "  sett     10.0 ends/cm, 8.0 picks/cm");
        let amounts = told.json(command, &cotton)["fabric"]["amounts"].clone();
        let of = |at: usize| (amounts[at]["name"].as_str().unwrap(), amounts[at]["color"].as_str().unwrap());
        assert_eq!([of(0), of(1), of(2)], [("warp", "#00ff00"), ("warp", "#ff0000"), ("weft", "#0000ff")]);
        let [green, red] = [0, 1].map(|at| number(&amounts[at]["length_m"]));
        assert!((red / green - 3.0).abs() < 1e-9, "two ends of eight are green");
    }
    // A thick yarn does not go so close, and a draft need not say how close; both mends lead on.
    let scene =
        "in a scene, with file = \"colors.wif\" under [fabric.weave]; the yarn worsted-wool was assumed, and --yarn";
    let unwrapped = |output: &Output| {
        common::told(output).split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ")
    };
    let jammed = told.output("check", &[]);
    assert_fails(&jammed, 3, &["colors.wif", "thinner yarns"]);
    assert!(unwrapped(&jammed).contains(scene), "{}", unwrapped(&jammed));
    fs::write(&told.path, DRAFT.replace("Spacing=0.1\n", "")).unwrap();
    let silent = told.output("check", &[]);
    assert_fails(&silent, 3, &["colors.wif", "nothing says how close the threads lie", "end_spacing"]);
    assert!(unwrapped(&silent).contains(scene), "{}", unwrapped(&silent));
}

#[test]
fn an_image_is_a_yarn_for_every_color() {
    let picture = |colors: usize| {
        let mut bytes = Vec::new();
        let pixels = (0..40).map(|at| [if at % 8 < 4 { 0xc0 } else { 0x10 }, (at % colors) as u8, 0x20]).collect();
        wale::picture::write_png(&wale::picture::Image { width: 8, height: 5, pixels }, &mut bytes).unwrap();
        bytes
    };
    let told = Told::of("fox.PNG", picture(1));
    assert_told_as_counted(&told, &[]);
    let lines = told.lines("check", &[]);
    assert_line(&lines, "  chart    5 rows, 8 columns, 40 loops");
    assert!(lines.iter().any(|line| line.ends_with(" g of #c00020")), "{lines:?}");
    fs::write(&told.path, picture(20)).unwrap();
    assert_fails(&told.output("inspect", &[]), 3, &["fox.PNG", "40 colours", "16", "one colour for each yarn"]);
}

#[test]
fn only_what_has_no_yarn_takes_one_and_only_check_and_inspect_do_without_a_scene() {
    let told = Told::of("rib.knit", "Cast on 4\nRow 1: *k1, p1*\n");
    let scene = told.workshop.text("scene.toml");
    for command in ["check", "inspect"] {
        assert_fails(&wale(&[command, &scene, "--yarn", "thick-acrylic"]), 2, &["scene.toml", "--yarn"]);
        let bad = Told::of("rib.knit", "Cast on 5\nRow 1: *k1, p1*\n");
        assert_fails(&bad.output(command, &[]), 3, &["rib.knit:2:", "multiple"]);
        assert_fails(&wale(&[command, &told.workshop.text("nowhere.wif")]), 3, &["nowhere.wif", "cannot be read"]);
    }
    assert_fails(&told.output("run", &[]), 3, &["rib.knit", "no scene", "wale new"]);
    // What it resolves to is a scene.
    let resolved = told.output("check", &["--resolved"]);
    assert_succeeds(&resolved);
    fs::write(told.workshop.path("resolved.toml"), &resolved.stdout).unwrap();
    assert_succeeds(&wale(&["check", &told.workshop.text("resolved.toml")]));
    assert_succeeds(&told.output("check", &["--topology"]));
}
