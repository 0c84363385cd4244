//! `wale fit` from a fabric file to its card, and what it says of bad input.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn wale(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_wale")).args(arguments).output().unwrap()
}

fn fabric() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fabrics/acrylic-stockinette/fabric.toml")
}

fn error(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn a_measured_fabric_becomes_a_card_curves_and_a_report() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("fit");
    let [fabric, out_text] = [fabric(), out.clone()].map(|path| path.to_str().unwrap().to_owned());
    let output = wale(&["fit", &fabric, "--out", &out_text, "--shell-only", "--json", "--threads", "2"]);
    assert!(output.status.success(), "{}", error(&output));
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let number = |key: &str| found[key].as_f64().unwrap();
    // Wales are pulled less far than courses by the same force.
    let membrane: Vec<f64> =
        found["membrane_N_per_m"].as_array().unwrap().iter().map(|k| k.as_f64().unwrap()).collect();
    assert!(membrane[2] > 1.5 * membrane[0], "{membrane:?}");
    // The shell is a quadratic law in Green's strain; this yarn stiffens faster.
    assert!(number("force_error") < 0.2 && number("compression_error") < 0.2, "{found}");
    let open = found["open"].to_string();
    assert!(open.contains("no stretch test along the bias") && open.contains("k_ss is not determined"), "{open}");
    let read = |name: &str| fs::read_to_string(out.join(name)).unwrap();
    assert!(read("card.toml").contains("k_xx = ") && read("curves.csv").lines().count() == 17);
    let report = read("report.html");
    assert!(report.contains("<svg") && report.contains("Acrylic stockinette") && !report.contains("src="));

    // One thread finds the same bits, and nothing is overwritten unasked.
    let card = read("card.toml");
    let refused = wale(&["fit", &fabric, "--out", &out_text]);
    assert_eq!(refused.status.code(), Some(3));
    assert!(error(&refused).contains("--force"), "{}", error(&refused));
    let again = wale(&["fit", &fabric, "--out", &out_text, "--shell-only", "--force", "--threads", "1"]);
    assert!(again.status.success(), "{}", error(&again));
    assert_eq!(read("card.toml"), card);
}

#[test]
fn how_tables_are_understood_can_be_asked_for() {
    let fabric = fabric();
    let output = wale(&["fit", "--read-only", fabric.to_str().unwrap()]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{}", error(&output));
    for says in [
        "stretch along the weft: 10 samples to 50.2 %",
        "line_force: column 2, \"line force (N/mm)\", in N/mm",
        "table: comma between cells, decimal point, 3 lines before the numbers, 10 rows",
        "no bending test along the warp",
    ] {
        assert!(text.contains(says), "{says}: {text}");
    }
    assert!(!fabric.with_extension("fit").exists());
}

#[test]
fn bad_fabrics_end_with_one_error_and_leave_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fabric.toml");
    let curve = folder.path().join("weft.csv");
    let head = "schema = 1\n[[stretch]]\ndirection = \"weft\"\nfile = \"weft.csv\"\n";
    let good = "strain,force (N)\n0,0\n0.1,1\n0.2,3\n";
    let cases = [
        ("schema = 1\n", good, "has no stretch test"),
        ("schema = 1\n[[strech]]\n", good, "unknown key `strech`"),
        (head, "strain,force (N)\n0,0\n0.1,nan\n0.2,3\n", "weft.csv:3"),
        (head, "strain,force (N)\n0,0\n0.2,1\n0.1,3\n", "weft.csv:4: stretch falls"),
        (head, "strain,force (N)\n0,0\n0.1,0\n0.2,0\n", "no force was measured"),
    ];
    for (text, table, says) in cases {
        fs::write(&path, text).unwrap();
        fs::write(&curve, table).unwrap();
        let output = wale(&["fit", path.to_str().unwrap()]);
        assert!(matches!(output.status.code(), Some(3 | 5)), "{says}: {:?} {}", output.status, error(&output));
        assert!(error(&output).contains(says), "{says}: {}", error(&output));
        assert!(!path.with_extension("fit").exists(), "{says}");
    }
    let missing = wale(&["fit", folder.path().join("none.toml").to_str().unwrap()]);
    assert_eq!(missing.status.code(), Some(3));
}
