//! What is made of a run: pictures, a page, exports, reports, each by its command and at the end of a run.

mod common;

use std::fs;
use std::path::Path;

use common::{Workshop, assert_fails, assert_succeeds, scene, wale};

fn size(path: &Path) -> u64 {
    fs::metadata(path).map_or(0, |metadata| metadata.len())
}

fn printed(output: &std::process::Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn json(arguments: &[&str]) -> serde_json::Value {
    let output = wale(arguments);
    assert_succeeds(&output);
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn a_run_makes_what_its_scene_asks_for() {
    let workshop = Workshop::new();
    let asked = scene(0.02)
        .replace(
            "pictures = \"none\"",
            "pictures = \"last\"\nexports = [\"usd\", \"vtk\", \"bcc\", \"obj\", \"ply\", \"csv\"]",
        )
        .replace("view = false", "view = true");
    fs::write(workshop.path("scene.toml"), asked).unwrap();
    assert_succeeds(&workshop.run("scene.toml", "a.run", &[]));
    let results = workshop.path("a.run").join("results");
    for name in [
        "picture.png",
        "plot.png",
        "view.html",
        "yarns.usda",
        "yarns.pvd",
        "yarns.0002.vtp",
        "yarns.0000.bcc",
        "yarns.0001.obj",
        "yarns.0002.ply",
        "metrics.csv",
    ] {
        assert!(size(&results.join(name)) > 100, "{name}");
    }
    assert!(fs::read(results.join("metrics.csv")).unwrap() == fs::read(workshop.path("a.run/metrics.csv")).unwrap());

    let run = workshop.text("a.run");
    let facts = json(&["inspect", &run, "--json"]);
    assert_eq!(facts["run"]["status"], "done");
    assert_eq!(facts["run"]["frames"], 3);
    assert_eq!(facts["fabric"]["loops"], 36);
    let summary: serde_json::Value =
        serde_json::from_slice(&fs::read(workshop.path("a.run/summary.json")).unwrap()).unwrap();
    assert_eq!(summary["shape"], facts["shape"], "measured in the run and from its last frame");
    assert_eq!(summary["fabric"], facts["fabric"]);
    assert_eq!(summary["grips"][0]["name"], "edge");
    let pulled = summary["grips"][0]["displacement_m"][0].as_f64().unwrap();
    assert!((pulled - 0.02 * 0.03).abs() < 1e-9, "{pulled}");

    let pictures = workshop.text("pictures");
    let drawn = wale(&["render", &run, "--frames", "all", "--size", "64x48", "--color", "stretch", "--out", &pictures]);
    assert_succeeds(&drawn);
    assert_eq!(printed(&drawn).lines().count(), 3);
    assert!(printed(&drawn).lines().all(|path| size(Path::new(path)) > 100));
    assert_fails(&wale(&["render", &run, "--frames", "3"]), 2, &["3 frames"]);
    assert_fails(&wale(&["view", &run, "--out", "/proc/x.html"]), 3, &["/proc"]);
    let page = workshop.text("page.html");
    assert_succeeds(&wale(&["view", &run, "--out", &page]));
    let usd = workshop.text("last.usda");
    assert_succeeds(&wale(&["export", &run, "-f", "usd", "--frames", "last", "--up", "y", "--out", &usd]));
    assert!(fs::read_to_string(&usd).unwrap().contains("upAxis = \"Y\""));
}

#[test]
fn reports_are_json() {
    let workshop = Workshop::new();
    let scene = workshop.text("scene.toml");
    let check = json(&["check", &scene, "--json"]);
    assert_eq!(check["fabric"]["loops"], 36);
    assert!(check["memory_bytes"].as_u64().unwrap() > 100_000);
    assert_eq!(check["frames"], 9);
    let relaxed = json(&["relax", &scene, "--json"]);
    assert!((1e-3..1e-2).contains(&relaxed["wale_spacing_m"].as_f64().unwrap()), "{relaxed}");
    assert!(relaxed["off_needles"].is_null(), "{relaxed}");
    let facts = json(&["inspect", &scene, "--json"]);
    for alike in ["fabric", "shape", "areal_mass_kg_per_m2"] {
        assert_eq!(check[alike], facts[alike], "{alike}: one fabric, whichever command measures it");
    }
    let stacks: u64 =
        facts["fabric"]["nodes_by_stack_size"].as_array().unwrap().iter().map(|n| n.as_u64().unwrap()).sum();
    assert_eq!(stacks, facts["fabric"]["nodes"].as_u64().unwrap());
    assert_eq!(json(&["schema"])["title"], "wale scene");
    assert_eq!(json(&["version", "--json"])["version"], env!("CARGO_PKG_VERSION"));
    // A resolved scene is a scene, and resolves to itself.
    let resolved = wale(&["check", &scene, "--resolved"]);
    fs::write(workshop.path("resolved.toml"), &resolved.stdout).unwrap();
    let again = wale(&["check", &workshop.text("resolved.toml"), "--resolved"]);
    assert_eq!(printed(&again), printed(&resolved));
}

#[test]
fn lace_keeps_of_its_needles_what_friction_holds() {
    let workshop = Workshop::new();
    fs::write(
        workshop.path("lace.toml"),
        "schema = 1\n[fabric]\ncontacts = \"thick\"\n\
         chart = { rows = 12, columns = 12, pattern = \"mesh\" }\n",
    )
    .unwrap();
    let scene = workshop.text("lace.toml");
    let spacing = |arguments: &[&str]| {
        let found = json(&[&["relax", &scene, "--json"], arguments].concat());
        (found["wale_spacing_m"].as_f64().unwrap(), found)
    };
    let (washed, _) = spacing(&[]);
    let told = |arguments: &[&str]| printed(&wale(&[&["relax", &scene], arguments].concat()));
    assert!(told(&[]).contains("see --off-needles") && !told(&["--off-needles"]).contains("see --off-needles"));
    let (kept, report) = spacing(&["--off-needles"]);
    let needles = |report: &serde_json::Value, name: &str| report["off_needles"][name].as_f64().unwrap();
    assert!((washed..needles(&report, "needle_pitch_m")).contains(&kept) && kept > 1.05 * washed, "{washed} {report}");
    // The yarn's coefficient times what every contact keeps of its compression, and the pull that is usual.
    assert!(needles(&report, "friction_N") > needles(&report, "take_down_N"), "{report}");
    let (wider, report) = spacing(&["--off-needles", "--needle-pitch", "5 mm", "--take-down", "5 mN"]);
    assert!(wider > kept, "{kept} {report}");
    assert_eq!([needles(&report, "needle_pitch_m"), needles(&report, "take_down_N")], [5e-3, 5e-3]);
    let too_far = wale(&["relax", &scene, "--off-needles", "--needle-pitch", "9 mm"]);
    assert_fails(&too_far, 3, &["--needle-pitch of 9.000 mm", "loops of 15."]);
    assert_fails(&wale(&["relax", &scene, "--needle-pitch", "3 mm"]), 2, &["--off-needles"]);
    assert_fails(&wale(&["relax", &scene, "--off-needles", "--shakes", "2"]), 2, &["--shakes"]);
    assert_fails(&wale(&["relax", &scene, "--off-needles", "--take-down", "3 mm"]), 2, &["--take-down", "force"]);
}

#[test]
fn a_run_too_short_for_a_plot_is_still_a_run() {
    let workshop = Workshop::new();
    let asked = scene(0.005).replace("pictures = \"none\"", "pictures = \"last\"");
    fs::write(workshop.path("scene.toml"), asked).unwrap();
    assert_succeeds(&workshop.run("scene.toml", "a.run", &[]));
    assert!(workshop.path("a.run/results/picture.png").exists());
}

#[test]
fn yarns_go_as_the_chart_says_before_and_after_a_run() {
    let workshop = Workshop::new();
    fs::write(workshop.path("scene.toml"), scene(0.02)).unwrap();
    let layout = wale(&["check", "--topology", &workshop.text("scene.toml")]);
    assert_succeeds(&layout);
    for words in ["each in order along itself", "0 the other way", "0 loops that nothing holds"] {
        assert!(printed(&layout).contains(words), "{words}: {}", printed(&layout));
    }
    assert_succeeds(&workshop.run("scene.toml", "a.run", &[]));
    let found = json(&["check", "--topology", &workshop.text("a.run"), "--json"]);
    let frames = found["frames"].as_array().unwrap();
    assert_eq!(frames.len(), 2, "the first and the last");
    for frame in frames {
        assert!(frame["contacts_in_order"].as_u64().unwrap() > 50, "{frame}");
        assert_eq!(frame["contacts_out_of_order"], 0);
        assert_eq!(frame["broken_yarns"].as_array().unwrap().len(), 0);
    }
    assert_eq!(found["yarns_passed_through"].as_array().unwrap().len(), 0);
}
