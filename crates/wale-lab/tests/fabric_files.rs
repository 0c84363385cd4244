//! A fabric file with its tables becomes numbers, or one error that says what to do.

use std::fs;
use std::path::Path;

use wale_lab::fabric_file::{FabricFile, Structure};
use wale_lab::yarn_tile::RodParameter;

const WHOLE: &str = r#"
schema = 1
title = "Plated jersey"
areal_mass = "170 g/m^2"

[[yarn]]
name = "polyester"
linear_density = "72 den"
filaments = 75
share = "90 %"
stiffness = "120 cN"

[[yarn]]
name = "spandex"
linear_density = "20 den"
share = "10 %"

[structure]
scene = "jersey.toml"

[[stretch]]
direction = "warp"
file = "warp.csv"

[[stretch]]
direction = "course"
file = "weft.csv"
length = "80 mm"
width = "50 mm"

[[bending]]
direction = "30 deg"
file = "loop.csv"
"#;

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("fabric.toml", WHOLE);
    write("warp.csv", "strain,force (N),compression\n0,0,0\n0.1,1,0.03\n0.2,4,0.07\n");
    write("weft.csv", "extension (mm);load (cN)\n0;0\n8;50\n16;120\n");
    write("loop.csv", "clamp distance (mm),aspect ratio\n3,1.8\n34,0.9\n");
    write("jersey.toml", "schema = 1\n[fabric.chart]\npattern = \"stockinette\"\ncolumns = 4\nrows = 4\n");
    folder
}

fn read(folder: &Path) -> Result<FabricFile, String> {
    FabricFile::read(&folder.join("fabric.toml")).map_err(|error| error.to_string())
}

#[test]
fn a_whole_file_is_read() {
    let folder = folder();
    let fabric = read(folder.path()).unwrap();
    assert_eq!(fabric.title, "Plated jersey");
    assert!((fabric.areal_mass.unwrap() - 0.17).abs() < 1e-15);
    assert!((fabric.yarns[0].linear_density - 8e-6).abs() < 1e-18);
    assert_eq!(fabric.yarns[0].stiffness, Some(1.2));
    assert_eq!(fabric.yarns[1].share, Some(0.1));
    assert!(matches!(&fabric.structure, Some(Structure::Scene(scene)) if scene.structure.size() == [4, 4]));
    // Sorted by direction, with their own specimens.
    assert_eq!(fabric.stretch[0].specimen.length, 0.08);
    assert!((fabric.stretch[0].curve.stretch[1] - 0.1).abs() < 1e-15);
    assert!((fabric.stretch[1].direction - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
    assert_eq!(fabric.stretch[1].specimen.width, 0.06);
    assert!((fabric.bending[0].direction - 30f64.to_radians()).abs() < 1e-15);
    assert_eq!(fabric.inputs.len(), 5);
    assert_eq!(
        fabric.gaps(),
        [
            "no orthogonal compression along the weft",
            "no bending test along the weft",
            "no stretch test along the bias",
            "no bending test along the bias",
            "no bending test along the warp",
        ]
    );
}

#[test]
fn rigidities_that_instruments_print_are_read() {
    let folder = folder();
    let printed = "[[rigidity]]\ndirection = \"warp\"\nvalue = \"0.1 gf cm^2/cm\"\n[[rigidity]]\ndirection = \"weft\"\nvalue = \"5 uN m\"\n";
    let without_loops = WHOLE.split("[[bending]]").next().unwrap();
    fs::write(folder.path().join("fabric.toml"), format!("{without_loops}{printed}")).unwrap();
    let fabric = read(folder.path()).unwrap();
    let values: Vec<f64> = fabric.rigidity.iter().map(|test| test.value).collect();
    assert!((values[0] - 5e-6).abs() < 1e-18 && (values[1] - 9.806_65e-6).abs() < 1e-12, "{values:?}");
    let gaps = fabric.gaps();
    assert!(gaps.iter().all(|gap| !gap.contains("bending test along the w")), "{gaps:?}");
    fs::write(folder.path().join("fabric.toml"), format!("{without_loops}{}", printed.replace("uN m", "N"))).unwrap();
    assert!(read(folder.path()).unwrap_err().contains("uN m"));
}

#[test]
fn how_a_table_is_written_is_taken_from_the_fabric_file() {
    let folder = folder();
    fs::write(folder.path().join("warp.csv"), "strain (%)|force (N)\n0|0\n1|1,500\n2|2,750\n").unwrap();
    let written = "file = \"warp.csv\"\ndelimiter = \"|\"\ndecimal = \",\"";
    fs::write(folder.path().join("fabric.toml"), WHOLE.replace("file = \"warp.csv\"", written)).unwrap();
    assert_eq!(read(folder.path()).unwrap().stretch[1].curve.force, [0.0, 1.5, 2.75]);
    let tabs = fs::read_to_string(folder.path().join("warp.csv")).unwrap().replace('|', "\t");
    fs::write(folder.path().join("warp.csv"), tabs).unwrap();
    for tab in ["\\t", "tab"] {
        let written = written.replace('|', tab);
        fs::write(folder.path().join("fabric.toml"), WHOLE.replace("file = \"warp.csv\"", &written)).unwrap();
        assert_eq!(read(folder.path()).unwrap().stretch[1].curve.force, [0.0, 1.5, 2.75]);
    }
}

#[test]
fn the_fabrics_of_the_project_are_read() {
    let fabrics = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fabrics");
    let mut count = 0;
    for folder in fs::read_dir(fabrics).unwrap() {
        let fabric = FabricFile::read(&folder.unwrap().path().join("fabric.toml")).unwrap();
        for test in &fabric.stretch {
            let columns = &test.curve.read_as;
            assert!(
                columns[0].starts_with("stretch: column 1, ") && columns[1].contains("force: column 2, "),
                "{columns:?}"
            );
            assert!(columns[2].contains("column 3, "), "{columns:?}");
        }
        count += 1;
    }
    assert!(count >= 7);
}

#[test]
fn what_is_wrong_is_said_where_it_stands() {
    let cases = [
        ("schema = 1", "schema = 7", "fabric.toml:2:10: schema 7 is not known"),
        ("\"90 %\"", "\"70 %\"", "the shares of the yarns sum to 80.0 %"),
        ("\"90 %\"", "\"190 %\"", "at most 1"),
        ("\"72 den\"", "\"72 N\"", "fabric.toml:8:18"),
        ("\"warp.csv\"", "\"wrap.csv\"", "\"wrap.csv\" is not there"),
        ("\"30 deg\"", "\"sideways\"", "\"sideways\" is no direction"),
        ("\"30 deg\"", "\"400 deg\"", "\"400 deg\" is no direction"),
        ("title", "titel", "unknown key `titel`"),
        ("scene = \"jersey.toml\"", "", "one tile or one scene"),
        (
            "file = \"warp.csv\"",
            "file = \"warp.csv\"\ncolumns = { force = \"Load\" }",
            "warp.csv: has no column \"Load\"",
        ),
        ("file = \"warp.csv\"", "file = \"warp.csv\"\nunits = { force = \"mm\" }", "no unit of it"),
        ("file = \"warp.csv\"", "file = \"warp.csv\"\ndelimiter = \":\"", "unknown value `:`"),
        ("file = \"warp.csv\"", "file = \"warp.csv\"\ndecimal = \";\"", "fabric.toml:24:11: unknown value `;`"),
        ("file = \"warp.csv\"", "file = \"warp.csv\"\ndelimiter = \";\"", "has no row with two numbers"),
        ("file = \"warp.csv\"", "file = \"warp.csv\"\nonly = { trial = \"3\" }", "to choose rows by"),
    ];
    for (from, to, says) in cases {
        let folder = folder();
        fs::write(folder.path().join("fabric.toml"), WHOLE.replacen(from, to, 1)).unwrap();
        let error = read(folder.path()).expect_err(to);
        assert!(error.contains(says), "{to}: {error}");
    }
    let folder = folder();
    fs::write(folder.path().join("weft.csv"), "extension (mm);load (cN)\n0;0\n8;50\n4;120\n").unwrap();
    let error = read(folder.path()).unwrap_err();
    assert!(error.contains("weft.csv:4: stretch falls"), "{error}");
    assert!(FabricFile::read(Path::new("none.toml")).unwrap_err().to_string().contains("cannot be read"));
}

#[test]
fn numbers_of_the_yarn_may_be_held_or_kept_within_bounds() {
    let folder = folder();
    let with = |more: &str| {
        fs::write(folder.path().join("fabric.toml"), format!("{WHOLE}\n{more}")).unwrap();
        read(folder.path())
    };
    let known = with("[held]\nk_b = \"30 mN mm^2\"\n[within]\nonset = [\"2 %\", \"8 %\"]\n").unwrap().known;
    let [least, largest] = known[RodParameter::Bending as usize].unwrap();
    assert!((least / 3e-8 - 1.0).abs() < 1e-12 && least == largest);
    assert_eq!(known[RodParameter::Onset as usize], Some([0.02, 0.08]));
    assert_eq!(known.iter().flatten().count(), 2);
    for (more, says) in [
        ("[within]\nonset = [\"8 %\", \"2 %\"]\n", "the least onset is larger than the largest"),
        ("[held]\nk_b = 1e-8\n[within]\nk_b = [1e-9, 1e-7]\n", "k_b is held, and is to be looked for within bounds"),
        ("[held]\nk_s2 = \"100 N\"\n", "the stiffness of a yarn is its k_s2"),
        ("[held]\nk_b = \"-1 mN mm^2\"\n", "must be positive"),
        ("[held]\nk_x = 1\n", "k_x"),
    ] {
        let error = with(more).unwrap_err();
        assert!(error.contains(says) && error.contains("fabric.toml:"), "{error}");
    }
}
