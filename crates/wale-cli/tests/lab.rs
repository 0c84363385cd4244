//! `wale lab` from a card to numbers, table and plot, and what it says of bad input.

mod common;

use std::fs;
use std::path::Path;
use std::process::Output;

use common::{wale, wale_given};

fn error(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A card of stiff yarns with B = 0.1 gf·cm²/cm, and `k_ss` that no test determined.
fn write_card(path: &Path) {
    let half = 0.5 * 0.1 * 9.806_65e-5;
    let bending = format!("[\"{half:?} N m\", \"{half:?} N m\", \"{half:?} N m\"]");
    let text = format!(
        "schema = 1\ntitle = \"Suiting\"\nareal_mass = \"0.2 kg/m^2\"\n[shell]\nk_xx = \"2000.0 N/m\"\nk_xy = \"0.0 N/m\"\n\
         k_yy = \"1000.0 N/m\"\nk_ss = \"40.0 N/m\"\nk_n1 = \"0.0 N/m\"\nk_n2 = \"0.0 N/m\"\n\
         within = [1.1, 1.1, 1.1, inf, 1.1, 1.1]\nbending = {bending}\n"
    );
    fs::write(path, text).unwrap();
}

#[test]
fn a_card_is_tested_and_told_in_the_units_of_instruments() {
    let folder = tempfile::tempdir().unwrap();
    let card = folder.path().join("card.toml");
    write_card(&card);
    let card = card.to_str().unwrap();
    let output = wale(&["lab", "kes-bending", card, "--direction", "weft", "--direction", "30 deg", "--threads", "1"]);
    assert!(output.status.success(), "{}", error(&output));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    for says in
        ["Suiting: KES-FB2", "0.1000 gf·cm²/cm", "30°", "an elastic model cannot tell", "k_ss", "zero of any card"]
    {
        assert!(text.contains(says), "{says}: {text}");
    }
    let out = folder.path().join("card.lab");
    let csv = fs::read_to_string(out.join("kes-bending.csv")).unwrap();
    assert!(csv.starts_with("direction [deg],curvature [1/m],moment by width [N]\n") && csv.lines().count() == 43);
    assert!(fs::read_to_string(out.join("kes-bending.svg")).unwrap().contains("<svg"));

    // A folder that holds this test is not overwritten unasked; another test goes into it.
    let refused = wale(&["lab", "kes-bending", card]);
    assert_eq!(refused.status.code(), Some(3));
    assert!(error(&refused).contains("--force"), "{}", error(&refused));
    let output = wale(&["lab", "picture-frame", card, "--json", "--to", "30 deg"]);
    assert!(output.status.success(), "{}", error(&output));
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let result = &found["results"][0];
    // Without area terms F_s/L = k_ss sin γ.
    assert!((result["rigidity_N_per_m_rad"].as_f64().unwrap() - 40.0).abs() < 1e-9, "{found}");
    assert!((result["shear_force_N_per_m"].as_f64().unwrap() - 20.0).abs() < 1e-9, "{found}");
    assert_eq!(
        fs::read_to_string(out.join("picture-frame.json")).unwrap().trim(),
        String::from_utf8_lossy(&output.stdout).trim()
    );
}

/// A card with the yarn of a plain weave, and its tile beside it.
fn write_woven_card(folder: &Path) -> String {
    use wale::pattern::weave::Draft;
    use wale_lab::yarn_tile::{RodMaterial, tile_of_draft, write_pattern};
    let (spacing, radius) = (1.0e-3, 0.2e-3);
    let tile = tile_of_draft(&Draft::plain(), radius, [spacing; 2], [2.0 * radius; 2]).unwrap();
    let material = RodMaterial::solid_rod(radius, 1e7, 10.0);
    let path = folder.join("woven.toml");
    write_card(&path);
    let [one, two] = material.contact;
    let text = format!(
        "{}[yarn]\nk_s1 = \"{} N\"\nk_s2 = \"{} N\"\nonset = {:?}\nk_b = \"{} N m^2\"\nR_1 = \"{} m\"\nk_c1 = \"{} N/m\"\n\
         k_h = \"0 Pa\"\nR_2 = \"{} m\"\nk_c2 = \"{} N/m\"\ncontact = \"barrier\"\n\
         within = [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]\ntile = \"tile.pyp\"\n",
        fs::read_to_string(&path).unwrap(),
        material.soft_stretch,
        material.stiff_stretch,
        material.onset,
        material.bending,
        one.radius,
        one.stiffness,
        two.radius,
        two.stiffness
    );
    fs::write(&path, text).unwrap();
    fs::write(folder.join("tile.pyp"), write_pattern(&tile)).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn a_tile_is_tested_and_says_what_it_cannot_do() {
    let folder = tempfile::tempdir().unwrap();
    let card = write_woven_card(folder.path());
    let json = |arguments: &[&str]| -> serde_json::Value {
        let output = wale(&[&["lab"], arguments, &[&card, "--by", "tile", "--json"]].concat());
        assert!(output.status.success(), "{arguments:?}: {}", error(&output));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let pulled = json(&["strip", "--to", "3 %", "--direction", "weft", "--direction", "warp"]);
    let number = |value: &serde_json::Value, at: usize, key: &str| value["results"][at][key].as_f64().unwrap();
    // A balanced plain weave is the same along weft and warp.
    let [weft, warp] = [0, 1].map(|at| number(&pulled, at, "line_force_N_per_m"));
    assert!(weft > 1.0 && (weft / warp - 1.0).abs() < 1e-3, "{weft} {warp}");
    let bent = json(&["kes-bending", "--direction", "weft"]);
    // Each metre of it has a thousand yarns.
    let rods = wale_lab::yarn_tile::RodMaterial::solid_rod(0.2e-3, 1e7, 10.0).bending / 1e-3;
    let ratio = number(&bent, 0, "B_N_m") / rods;
    assert!(ratio > 0.5 && ratio < 1.5, "{ratio}");
    let cases: [(&[&str], i32, &str); 5] = [
        (&["lab", "drape", &card, "--by", "tile"], 2, "nothing of it can hang"),
        (&["lab", "kes-shear", &card, "--by", "contacts"], 2, "use --by tile"),
        (&["lab", "curl", &card, "--by", "shell"], 2, "flat at rest"),
        (&["lab", "strip", &card, "--by", "yarns"], 3, "swatch.toml is not there"),
        (&["lab", "cantilever", &card, "--by", "tile", "--areal-mass", "0 kg/m^2"], 2, "must be positive"),
    ];
    for (arguments, code, says) in cases {
        let output = wale(arguments);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {}", error(&output));
        assert!(error(&output).contains(says), "{says}: {}", error(&output));
    }
    fs::remove_file(folder.path().join("tile.pyp")).unwrap();
    let output = wale(&["lab", "kes-tensile", "--by", "tile", &card]);
    assert_eq!(output.status.code(), Some(3));
    assert!(error(&output).contains("tile.pyp is not there"), "{}", error(&output));
}

#[test]
fn a_weave_is_tested_by_its_contacts() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("weave.toml");
    let text = "schema = 1\n[yarn]\nlinear_density = \"20 tex\"\ndiameter = \"0.16 mm\"\nstretch_stiffness = \"10 N\"\n\
        bending_stiffness = 1e-9\n[yarns.weft]\nstretch_stiffness = \"4 N\"\n[fabric.weave]\npattern = \"twill 2/1\"\n\
        ends = 6\npicks = 6\nend_spacing = \"0.5 mm\"\npick_spacing = \"0.4 mm\"\n";
    fs::write(&scene, text).unwrap();
    let scene = scene.to_str().unwrap();
    let strip = |arguments: &[&str]| {
        let output =
            wale(&[&["lab", "strip", scene, "--by", "contacts", "--to", "2 %", "--force"], arguments].concat());
        assert!(output.status.success(), "{}", error(&output));
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    let found: serde_json::Value = serde_json::from_str(&strip(&["--json"])).unwrap();
    let force = |at: usize| found["results"][at]["line_force_N_per_m"].as_f64().unwrap();
    // 4 N every 0.4 mm along the weft, 10 N every 0.5 mm along the warp; on the bias it shears.
    assert!((force(0) / (0.02 * 1e4) - 1.0).abs() < 1e-9 && (force(2) / (0.02 * 2e4) - 1.0).abs() < 1e-9, "{found}");
    assert!(force(1) < 0.05 * force(0), "{found}");
    let remark = "may not shear";
    assert!(!strip(&[]).contains(remark) && strip(&["--direction", "20 deg"]).contains(remark));
    let output = wale(&["lab", "relaxation", scene, "--by", "contacts"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(error(&output).contains("at rest at the sett"), "{}", error(&output));
}

#[test]
fn a_test_that_is_answered_elsewhere_writes_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let (one, other) = (folder.path().join("one.toml"), folder.path().join("other.toml"));
    write_card(&one);
    write_card(&other);
    let text = fs::read_to_string(&other).unwrap().replace("2000.0 N/m", "1500.0 N/m");
    fs::write(&other, text).unwrap();
    let fabrics = [one.to_str().unwrap(), other.to_str().unwrap()];
    let test = [&["lab", "kes-tensile"], &fabrics[..], &["--direction", "weft", "--direction", "warp"]].concat();
    let with = |more: &[&'static str]| [&test[..], more].concat();
    let here = wale(&test);
    assert!(here.status.success(), "{}", error(&here));
    let files = |name: &str| -> Vec<String> {
        let out = folder.path().join(name).with_extension("lab");
        ["kes-tensile.csv", "kes-tensile.svg", "kes-tensile.json", "report.html"]
            .map(|name| fs::read_to_string(out.join(name)).unwrap())
            .to_vec()
    };
    let written = [files("one"), files("other")];
    for name in ["one", "other"] {
        fs::remove_dir_all(folder.path().join(name).with_extension("lab")).unwrap();
    }

    // A question for each fabric and direction, which carries its card.
    let asked = wale(&with(&["--ask"]));
    let questions = String::from_utf8(asked.stdout).unwrap();
    assert_eq!(questions.lines().count(), 4);
    fs::remove_file(&one).unwrap();
    let answers: Vec<String> = questions
        .lines()
        .map(|question| {
            let output = wale_given(&["lab", "--answer", "--threads", "1"], question);
            assert!(output.status.success(), "{}", error(&output));
            String::from_utf8(output.stdout).unwrap()
        })
        .collect();
    write_card(&one);

    // One is lost, one comes twice.
    let some = [&answers[2][..], &answers[0], &answers[2], &answers[3]].concat();
    let rest = wale_given(&with(&["--ask", "--tell", "-"]), &some);
    assert_eq!(String::from_utf8_lossy(&rest.stdout).trim_end(), questions.lines().nth(1).unwrap());
    let lost = wale_given(&with(&["--tell", "-"]), &some);
    assert_eq!(lost.status.code(), Some(3));
    assert!(error(&lost).contains("one.toml: not all questions are answered"), "{}", error(&lost));
    // Fonts are part of the plots: too much to print where they differ.
    assert!(files("other") == written[1]);
    assert!(!folder.path().join("one.lab").exists());
    let all = wale_given(&with(&["--tell", "-", "--force"]), &answers.concat());
    assert!(all.status.success(), "{}", error(&all));
    assert_eq!(all.stdout, here.stdout);
    assert!([files("one"), files("other")] == written);

    // What answers another question, or the same one differently, is refused with its line.
    let foreign = answers[0].replacen("\"id\":\"", "\"id\":\"0", 1);
    let changed = answers[0].replacen("LT", "TL", 1);
    for (bad, says) in [
        (format!("{}{foreign}", answers[0]), "standard input:2: this answers another question"),
        (format!("{}{changed}", answers[0]), "standard input:2: this question was answered before"),
        ("{\"id\":".to_owned(), "standard input:1:"),
    ] {
        let output = wale_given(&with(&["--tell", "-", "--force"]), &bad);
        assert_eq!(output.status.code(), Some(3), "{}", error(&output));
        assert!(error(&output).contains(says), "{says}: {}", error(&output));
    }
    // As is a question that was changed, or that another version asks.
    let question = questions.lines().next().unwrap();
    for (bad, says) in [
        (question.replacen("Suiting", "Shirting", 1), "changed on its way"),
        (question.replacen("\"wale\":\"", "\"wale\":\"9", 1), "use the same version"),
        (question.replacen("\"question\":", "\"riddle\":", 1), "riddle"),
    ] {
        let output = wale_given(&["lab", "--answer"], &bad);
        assert_eq!(output.status.code(), Some(3), "{}", error(&output));
        assert!(error(&output).contains(says), "{says}: {}", error(&output));
    }
    let output = wale(&with(&["--out", "somewhere"]));
    assert_eq!(output.status.code(), Some(2));
    assert!(error(&output).contains("folder of one fabric"), "{}", error(&output));
}

#[test]
fn a_limp_drape_on_a_coarse_mesh_is_warned_of() {
    let folder = tempfile::tempdir().unwrap();
    let card = folder.path().join("card.toml");
    write_card(&card);
    let card = card.to_str().unwrap();
    // (B/W)^(1/3) is 8 and 80 mm.
    for (bending, warned) in [("0.01 gf cm^2/cm", true), ("10 gf cm^2/cm", false)] {
        let arguments = ["lab", "drape", card, "--edge", "20 mm", "--starts", "1", "--force", "--bending", bending];
        let output = wale(&arguments);
        assert!(output.status.success(), "{}", error(&output));
        assert_eq!(String::from_utf8_lossy(&output.stdout).contains("WARNING"), warned, "{bending}");
    }
}

#[test]
fn swatches_leave_pictures_of_each_direction() {
    let folder = tempfile::tempdir().unwrap();
    let card = folder.path().join("card.toml");
    write_card(&card);
    let directions = ["--direction", "bias", "--direction", "30 deg"];
    let output = wale(&[&["lab", "stretch", card.to_str().unwrap(), "--to", "5 %"], &directions[..]].concat());
    assert!(output.status.success(), "{}", error(&output));
    for name in ["bias", "30-deg"] {
        let picture = fs::read_to_string(folder.path().join(format!("card.lab/stretch-{name}-sheet.svg"))).unwrap();
        assert!(picture.starts_with("<svg") && picture.matches("<path").count() > 500, "{name}");
    }
    // A picture that is there is not overwritten unasked.
    fs::remove_file(folder.path().join("card.lab/stretch.csv")).unwrap();
    let again = wale(&["lab", "stretch", card.to_str().unwrap(), "--to", "5 %", "--direction", "bias"]);
    assert_eq!(again.status.code(), Some(3), "{}", error(&again));
}

#[test]
fn a_drape_leaves_a_picture_of_its_sheet() {
    let folder = tempfile::tempdir().unwrap();
    let card = folder.path().join("card.toml");
    write_card(&card);
    // Twenty times as stiff as on the card, which is quickly at rest.
    let output = wale(&[
        "lab",
        "drape",
        card.to_str().unwrap(),
        "--bending",
        "20 gf cm^2/cm",
        "--edge",
        "12 mm",
        "--starts",
        "1",
        "--json",
    ]);
    assert!(output.status.success(), "{}", error(&output));
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let coefficient = found["results"][0]["drape_coefficient"].as_f64().unwrap();
    assert!(coefficient > 0.99 && coefficient < 1.0, "{coefficient}");
    let picture = fs::read_to_string(folder.path().join("card.lab/drape-sheet.svg")).unwrap();
    assert!(picture.starts_with("<svg") && picture.matches("<path").count() > 500);
}

#[test]
fn bad_input_ends_with_one_error_and_its_mend() {
    let folder = tempfile::tempdir().unwrap();
    let fabric = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fabrics/acrylic-stockinette");
    for name in ["fabric.toml", "stockinette.toml", "course.csv", "wale.csv"] {
        fs::copy(fabric.join(name), folder.path().join(name)).unwrap();
    }
    let fabric = folder.path().join("fabric.toml");
    let fabric = fabric.to_str().unwrap();
    // Not named `card.toml`: that would be the fabric's own.
    let card = folder.path().join("suiting.toml");
    write_card(&card);
    let without = folder.path().join("without.toml");
    let text = fs::read_to_string(&card).unwrap();
    fs::write(&without, &text[..text.find("bending").unwrap()]).unwrap();
    let (card, without) = (card.to_str().unwrap(), without.to_str().unwrap());
    let cases: [(&[&str], i32, &str); 9] = [
        (&["lab", "kes-tensile", fabric], 3, "run `wale fit "),
        (&["lab", "burst", card], 2, "burst"),
        (&["lab", "kes-tensile", "none.toml"], 3, "none.toml"),
        (&["lab", "kes-bending", without], 3, "--bending"),
        (&["lab", "stretch", card, "--direction", "sideways"], 2, "30 deg"),
        (&["lab", "stretch", card, "--length", "10"], 2, "no unit"),
        (&["lab", "drape", card, "--support", "30 cm"], 3, "larger than that of the support"),
        (&["lab", "bias-extension", card, "--length", "6 cm"], 3, "at least twice the width"),
        (&["lab", "picture-frame", card, "--to", "89 deg"], 3, "at most 85°"),
    ];
    for (arguments, code, says) in cases {
        let output = wale(arguments);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {}", error(&output));
        assert!(error(&output).contains(says), "{says}: {}", error(&output));
    }
    assert!(!folder.path().join("suiting.lab").exists() && !folder.path().join("fabric.lab").exists());
}
