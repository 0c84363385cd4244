//! Every kind of bad input ends with its exit code and one clear message.

mod common;

use std::fs;
use std::path::Path;

use common::{Workshop, assert_fails, assert_succeeds, code, program, scene, told, wale};

#[test]
fn a_wrong_command_line_is_usage() {
    assert_eq!(code(&wale(&[])), 2);
    for arguments in [
        &["knit"][..],
        &["run"],
        &["run", "a.toml", "--threads", "0"],
        &["check", "a.toml", "--max-memory", "lots"],
        &["render", "a.run", "--size", "0x0"],
        &["render", "a.run", "--frames", "5.."],
        &["render", "a.run", "--view", "beneath"],
        &["export", "a.run", "--format", "docx"],
    ] {
        assert_fails(&wale(arguments), 2, &[]);
    }
    assert_succeeds(&wale(&["--help"]));
    assert_succeeds(&wale(&["--version"]));
}

#[test]
fn bad_scenes_are_underlined() {
    let workshop = Workshop::new();
    let good = scene(0.1);
    let replaced = |from: &str, to: &str| {
        assert!(good.contains(from), "{from}");
        good.replace(from, to)
    };
    for (text, words) in [
        (String::new(), vec!["schema"]),
        ("schema = ".to_owned(), vec![]),
        (replaced("schema = 1", "schema = 99"), vec!["schema", "99"]),
        (replaced("columns = 6", "colums = 6"), vec!["colums", "columns"]),
        (replaced("columns = 6", "columns = 0"), vec!["columns"]),
        (replaced("columns = 6", "columns = -3"), vec!["columns"]),
        (replaced("\"18 mm\"", "\"-18 mm\""), vec!["-18 mm"]),
        (replaced("\"18 mm\"", "nan"), vec!["nan"]),
        (replaced("\"18 mm\"", "inf"), vec!["inf"]),
        (replaced("\"18 mm\"", "\"18 parsecs\""), vec!["parsecs"]),
        (replaced("\"2 ms\"", "\"2 mm\""), vec!["2 mm"]),
        (replaced("worsted-wool", "worsted-wol"), vec!["worsted-wool"]),
        (replaced("pattern = \"garter\"", "symbols = [\"kp\", \"k\"]"), vec![]),
        (replaced("pattern = \"garter\"", "symbols = []"), vec![]),
        (replaced("pattern = \"garter\"", "file = \"missing.knit\""), vec!["missing.knit"]),
        (replaced("pattern = \"garter\"", "file = \"../../etc/passwd\""), vec![]),
        ("a = ".to_owned() + &"[".repeat(100_000), vec![]),
    ] {
        fs::write(workshop.path("bad.toml"), &text).unwrap();
        let output = wale(&["check", &workshop.text("bad.toml")]);
        assert_fails(&output, 3, &words);
        assert!(told(&output).contains("bad.toml") || told(&output).contains(".knit"), "{}", told(&output));
        // A run refuses it likewise, and leaves nothing.
        let output = workshop.run("bad.toml", "bad.run", &[]);
        assert_eq!(code(&output), 3, "{}", told(&output));
        assert!(!workshop.path("bad.run").exists());
    }
    fs::write(workshop.path("bad.toml"), b"schema = 1 # \xff\xfe").unwrap();
    assert_fails(&wale(&["check", &workshop.text("bad.toml")]), 3, &["UTF-8"]);
    assert_fails(&wale(&["check", &workshop.text("nowhere.toml")]), 3, &["nowhere.toml"]);
    assert_fails(&wale(&["check", &workshop.text("")]), 3, &[]);
}

/// Charts, programs, drafts and images beside a scene: a place in the file where it has lines, and the reason. The files are
/// those of the readers' corpus.
#[test]
fn bad_charts_and_drafts_are_told_with_their_place() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../wale/tests/corpus");
    let workshop = Workshop::new();
    let chart = |key: &str, name: &str| format!("schema = 1\n[fabric.chart]\n{key} = \"{name}\"\n");
    let weave = |name: &str| {
        format!("schema = 1\n[fabric.weave]\nfile = \"{name}\"\nend_spacing = \"1 mm\"\npick_spacing = \"1 mm\"\n")
    };
    let check = |folder: &str, name: &str, text: String| {
        fs::copy(corpus.join(folder).join(name), workshop.path(name)).unwrap();
        fs::write(workshop.path("bad.toml"), text).unwrap();
        wale(&["check", &workshop.text("bad.toml")])
    };
    for (name, words) in [
        ("not-brought-in.k", ["not-brought-in.k:6:", "`inhook"]),
        ("racked-out-of-range.k", ["range.k:5:", "1e300"]),
        ("hook-never-released.k", ["released.k:3:", "`releasehook"]),
        ("stacked.k", ["stacked.k:68:", "65"]),
        ("no-magic.k", ["no-magic.k:1:", ";!knitout-2"]),
        ("cable-of-two-carriers.k", ["carriers.k:23:", "the one of line 20"]),
    ] {
        assert_fails(&check("knitout", name, chart("file", name)), 3, &words);
    }
    // A needle that is empty takes a tuck: no error, but worth a word.
    let output = check("knitout", "empty-needles.k", chart("file", "empty-needles.k"));
    assert_succeeds(&output);
    let said = format!("{}{}", String::from_utf8_lossy(&output.stdout), told(&output));
    assert!(said.contains("line 8    f1 was empty when it was knitted, as were 1 after it"), "{said}");
    for (name, code, words) in [
        ("color-out-of-range.wif", 3, ["range.wif:18:", "0,0,1000"]),
        ("two-values-for-one-thread.wif", 3, ["thread.wif:24:", "[THREADING]"]),
        ("four-billion-threads.wif", 4, ["threads.wif:12:", "4000000000"]),
        ("utf16.wif", 3, ["utf16.wif:1:", "UTF-16"]),
        ("no-sections.wif", 3, ["no-sections.wif:1:", "[WIF]"]),
    ] {
        assert_fails(&check("wif", name, weave(name)), code, &words);
    }
    let name = "counts-do-not-close.knit";
    assert_fails(&check("instructions", name, chart("file", name)), 3, &["close.knit:2:", "multiple"]);
    let palette = "palette = { \"#ffffff\" = \"A\" }";
    for (name, code, words) in [
        ("billion-by-billion.png", 4, ["bad.toml:3:", "1000000000"]),
        ("truncated.png", 3, ["bad.toml:3:", "truncated.png"]),
        ("too-few-rows.png", 3, ["bad.toml:3:", "too-few-rows.png"]),
        ("not-a-picture.png", 3, ["bad.toml:3:", "PNG"]),
        ("rgb.png", 3, ["bad.toml", "#c03020"]),
    ] {
        assert_fails(&check("image", name, format!("{}{palette}\n", chart("image", name))), code, &words);
    }
}

/// Lengths of a draft that a fabric does not take are no error, but worth a word wherever the draft is opened.
#[test]
fn what_is_unusual_in_a_draft_is_told_with_its_line() {
    let workshop = Workshop::new();
    let name = "lengths-passed-over.wif";
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../wale/tests/corpus/wif");
    fs::copy(corpus.join(name), workshop.path(name)).unwrap();
    let text = format!(
        "schema = 1\n[yarn]\nlinear_density = \"20 tex\"\ndiameter = \"0.2 mm\"\n[fabric.weave]\nfile = \"{name}\"\n\
         end_spacing = \"1 mm\"\n[simulation]\nduration = \"1 ms\"\n"
    );
    fs::write(workshop.path("draft.toml"), text).unwrap();
    let (scene, run) = (workshop.text("draft.toml"), workshop.text("draft.run"));
    for arguments in [&["check", &scene][..], &["inspect", &scene], &["run", &scene, "--out", &run]] {
        let output = wale(arguments);
        assert_succeeds(&output);
        let said = format!("{}{}", String::from_utf8_lossy(&output.stdout), told(&output));
        for words in [
            "line 8    [WARP] has no Units, so that its spacing is passed over",
            "line 12   the threads of [WEFT] are not evenly spaced",
            "line 13   thickness of [WEFT] is passed over",
        ] {
            assert!(said.contains(words), "{arguments:?} does not say `{words}`: {said}");
        }
    }
}

#[test]
fn a_scene_larger_than_memory_is_refused_up_front() {
    let workshop = Workshop::new();
    let limited = ["--max-memory", "100kB"];
    let scene = workshop.text("scene.toml");
    let output = wale(&[&["check", scene.as_str()][..], &limited].concat());
    assert_fails(&output, 4, &["memory", "largest item", "--max-memory"]);
    let output = workshop.run("scene.toml", "a.run", &limited);
    assert_fails(&output, 4, &["largest item"]);
    assert!(!workshop.path("a.run").exists());

    let huge =
        common::scene(0.1).replace("columns = 6", "columns = 4000000000").replace("rows = 6", "rows = 4000000000");
    fs::write(workshop.path("huge.toml"), huge).unwrap();
    let output = wale(&["check", &workshop.text("huge.toml")]);
    assert!([3, 4].contains(&code(&output)), "{}", told(&output));
}

#[test]
fn folders_that_are_no_runs_are_told() {
    let workshop = Workshop::new();
    let folder = workshop.path("pictures");
    fs::create_dir(&folder).unwrap();
    fs::write(folder.join("holiday.jpg"), "x").unwrap();
    let name = workshop.text("pictures");
    for command in ["resume", "render", "view", "inspect"] {
        assert_fails(&wale(&[command, &name]), 3, &["pictures"]);
        if command != "inspect" {
            assert_fails(&wale(&[command, &workshop.text("nowhere")]), 3, &["nowhere"]);
        }
    }
    assert_fails(&wale(&["export", &name, "--format", "usd"]), 3, &["not a run folder"]);
    // Nor is it filled or emptied, not even by force.
    for force in [&[][..], &["--force"]] {
        assert_fails(&workshop.run("scene.toml", "pictures", force), 3, &["not empty", "other files"]);
    }
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
}

#[test]
fn an_unwritable_place_is_a_matter_of_the_disk() {
    let workshop = Workshop::new();
    let output = wale(&["run", &workshop.text("scene.toml"), "--out", "/proc/wale.run", "--quiet"]);
    #[cfg(target_os = "linux")]
    assert!([3, 6].contains(&code(&output)), "{}", told(&output));
    assert!(!told(&output).contains("panicked"));
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_device_as_output_is_no_panic() {
    let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let output = program().arg("schema").stdout(full).output().unwrap();
    assert_fails(&output, 6, &["standard output"]);
}

#[test]
fn new_does_not_overwrite() {
    let workshop = Workshop::new();
    let name = workshop.text("new.toml");
    assert_succeeds(&wale(&["new", &name]));
    assert_succeeds(&wale(&["check", &name]));
    fs::write(workshop.path("new.toml"), "mine").unwrap();
    assert_fails(&wale(&["new", &name]), 3, &["--force"]);
    assert_eq!(fs::read_to_string(workshop.path("new.toml")).unwrap(), "mine");
    assert_succeeds(&wale(&["new", &name, "--force", "--preset", "fine-cotton-jersey"]));
    assert_succeeds(&wale(&["check", &name, "--json"]));
}
