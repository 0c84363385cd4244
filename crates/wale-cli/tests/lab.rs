//! `wale lab` from a card to numbers, table and plot, and what it says of bad input.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn wale(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_wale")).args(arguments).output().unwrap()
}

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
    for says in ["Suiting: KES-FB2", "0.1000 gf·cm²/cm", "30°", "a shell cannot tell", "k_ss", "zero of any card"] {
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
