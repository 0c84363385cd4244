//! Every test of `wale lab` by every model that makes it: its files, its line in the report, and a fact of each that physics demands.

mod common;

use std::fs;
use std::path::{Path, PathBuf};

use common::{assert_succeeds, told, wale};
use serde_json::Value;

/// Of tests and models, as the help has them.
const TESTS: [&str; 13] = [
    "stretch",
    "strip",
    "kes-tensile",
    "kes-shear",
    "kes-bending",
    "cantilever",
    "pear-loop",
    "drape",
    "picture-frame",
    "bias-extension",
    "fast",
    "curl",
    "relaxation",
];
const MODELS: [(&str, &[Case]); 4] = [("shell", SHELL), ("tile", TILE), ("contacts", CONTACTS), ("yarns", YARNS)];

const WEAVE: &str = "cotton-print";
const KNIT: &str = "acrylic-stockinette";
/// From the weave's card: shear stiffness \[N/m\], bending stiffness `B = 2k_θ` of weft and warp \[N·m\], weight by area \[N/m²\].
const SHEAR: f64 = 100.293_503_655_247_48;
const BENDING: f64 = 2.44e-5;
const WEIGHT: f64 = 0.22 * 9.81;
/// KES draws to 500 gf/cm \[N/m\], and shears under 10 gf/cm.
const GF_PER_CM: f64 = 0.980_665;

/// A test by a model: its name, the fabric, options that make it quick, and what must be true of it.
type Case = (&'static str, &'static str, &'static [&'static str], fn(&Made));

const SHELL: &[Case] = &[
    ("stretch", WEAVE, &["--wrinkle", "--to", "1 %", "--length", "4 cm", "--width", "3 cm"], |made| {
        made.rises("stretch [-]", "force [N]");
        made.bias_is_softer("force_N");
    }),
    ("strip", WEAVE, &["--to", "2 %"], |made| {
        made.rises("stretch [-]", "force [N]");
        made.bias_is_softer("force_N");
    }),
    ("kes-tensile", WEAVE, &[], |made| {
        made.rises("stretch [-]", "line force [N/m]");
        made.kes_formula(1e-6);
        assert!(made.number(1, "EMT") > made.number(0, "EMT"), "the bias gives more");
    }),
    // One direction of all tests that take seconds each.
    ("kes-shear", WEAVE, &["--direction", "weft"], |made| {
        // The pull is part of it.
        within(made.number(0, "G_N_per_m_rad"), SHEAR + 10.0 * GF_PER_CM, 0.1);
    }),
    ("kes-bending", WEAVE, &["--direction", "weft"], |made| within(made.number(0, "B_N_m"), BENDING, 0.01)),
    ("cantilever", WEAVE, &["--direction", "weft"], |made| {
        within(made.number(0, "overhang_m"), 2.0 * (BENDING / WEIGHT).cbrt(), 0.03);
        made.hangs_at(41.5);
    }),
    (
        "pear-loop",
        WEAVE,
        &["--gravity", "none", "--clamps", "side-by-side", "--distance", "10 mm", "--distance", "25 mm"],
        |made| {
            let [near, far] = ["first_aspect", "last_aspect"].map(|key| made.number(0, key));
            assert!(near > far && far > 0.3, "clamps that are farther apart open the loop: {near} {far}");
        },
    ),
    ("drape", WEAVE, &["--edge", "20 mm", "--starts", "1"], |made| {
        let (coefficient, depth) = (made.number(0, "drape_coefficient"), made.number(0, "depth_m"));
        assert!(coefficient > 0.3 && coefficient < 1.0, "{coefficient}");
        // It is 30 cm wide on 18 cm.
        assert!(depth > 0.01 && depth < 0.061, "{depth}");
    }),
    ("picture-frame", WEAVE, &[], |made| {
        made.rises("angle [rad]", "shear force by length [N/m]");
        within(made.number(0, "rigidity_N_per_m_rad"), SHEAR, 0.01);
    }),
    ("bias-extension", WEAVE, &[], |made| {
        made.rises("angle by travel [rad]", "shear force by length [N/m]");
        within(made.number(0, "rigidity_N_per_m_rad"), SHEAR, 0.2);
        assert!(made.number(0, "seen_angle_rad") < made.number(0, "angle_rad"));
    }),
    ("fast", WEAVE, &[], |made| {
        made.fast_rises();
        within(made.number(0, "B_N_m"), BENDING, 0.1);
    }),
];

const TILE: &[Case] = &[
    ("stretch", WEAVE, &["--to", "2 %"], |made| {
        made.rises("stretch [-]", "force [N]");
        made.bias_is_softer("force_N");
    }),
    ("strip", KNIT, &["--to", "5 %"], |made| made.rises("stretch [-]", "force [N]")),
    ("kes-tensile", WEAVE, &[], |made| {
        made.rises("stretch [-]", "line force [N/m]");
        made.kes_formula(1e-6);
        assert!(made.number(1, "EMT") > made.number(0, "EMT"), "the bias gives more");
    }),
    // The yarn was fitted to the weave's bias test, as the shell was.
    ("kes-shear", WEAVE, &[], |made| within(made.number(0, "G_N_per_m_rad"), SHEAR + 10.0 * GF_PER_CM, 0.25)),
    // Twenty yarns to the cm, that do not hold each other where they are bent a little.
    ("kes-bending", WEAVE, &[], |made| within(made.number(0, "B_N_m"), 2.492e-8 * 2000.0, 0.2)),
    ("cantilever", WEAVE, &[], |made| {
        // G = W c³ is nearly B; `kes-bending` has it.
        within(made.number(0, "G_N_m"), 2.492e-8 * 2000.0, 0.25);
        within(made.number(0, "overhang_m"), 2.0 * made.number(0, "c_m"), 1e-9);
        made.hangs_at(41.5);
    }),
    ("picture-frame", WEAVE, &[], |made| {
        made.rises("angle [rad]", "shear force by length [N/m]");
        within(made.number(0, "rigidity_N_per_m_rad"), SHEAR, 0.25);
    }),
    ("fast", WEAVE, &[], |made| {
        made.fast_rises();
        within(made.number(0, "B_N_m"), WEIGHT * made.number(0, "C_m").powi(3), 1e-9);
    }),
    ("curl", KNIT, &[], |made| {
        // Sides to the back, ends to the front.
        let [weft, warp] = [0, 1].map(|at| made.number(at, "own_curvature_per_m"));
        assert!(weft < -1.0 && warp > 1.0, "{weft} {warp}");
    }),
];

const CONTACTS: &[Case] = &[
    ("stretch", KNIT, &["--to", "10 %"], |made| made.rises("stretch [-]", "force [N]")),
    ("strip", WEAVE, &["--to", "2 %"], |made| {
        made.rises("stretch [-]", "force [N]");
        made.bias_is_softer("force_N");
    }),
    ("kes-tensile", WEAVE, &[], |made| {
        made.kes_formula(1e-6);
        assert!(made.number(1, "EMT") > 2.0 * made.number(0, "EMT"), "the bias gives more");
    }),
    ("fast", WEAVE, &[], Made::fast_rises),
    ("relaxation", KNIT, &[], Made::shrinks_a_little),
];

/// Swatches of some dozen loops: of the sizes that are standard, these take a minute each.
const YARNS: &[Case] = &[
    ("stretch", KNIT, &["--length", "2 cm", "--width", "2 cm", "--to", "5 %", "--direction", "weft"], Made::rubs),
    ("strip", KNIT, &["--length", "2 cm", "--width", "2 cm", "--to", "5 %", "--direction", "warp"], Made::rubs),
    // Its specimen is 20 cm wide whatever the fabric: 400 loops of any in `fabrics`, and minutes. This one has large loops.
    ("kes-tensile", "large-loops", &["--direction", "warp"], |made| {
        made.rubs();
        // A point is every half per cent: it ends a little above the load.
        within(made.number(0, "line_force_N_per_m"), 500.0 * GF_PER_CM, 0.03);
        made.kes_formula(1e-6);
        assert!(made.json["results"][0].get("stretch").is_none(), "{:?}", made.json["results"]);
    }),
    ("curl", KNIT, &["--columns", "6", "--rows", "6"], |made| {
        let edges = [0, 1, 2, 3].map(|at| made.number(at, "curvature_per_m"));
        assert!(edges[..2].iter().all(|&side| side < -10.0), "sides roll to the back: {edges:?}");
        assert!(edges[2..].iter().all(|&end| end > 10.0), "ends roll to the front: {edges:?}");
    }),
    ("relaxation", KNIT, &["--columns", "6", "--rows", "6"], Made::shrinks_a_little),
];

const LARGE_LOOPS: &str = "schema = 1\ntitle = \"Large loops\"\n[yarn]\npreset = \"worsted-wool\"\n[fabric]\nwale_spacing = \"20 mm\"\n\
    course_spacing = \"15 mm\"\n[fabric.chart]\npattern = \"stockinette\"\ncolumns = 4\nrows = 4\n";

#[track_caller]
fn within(value: f64, expected: f64, part: f64) {
    assert!((value / expected - 1.0).abs() <= part, "{value} is not {expected}, by more than {part}");
}

/// What a test left in its folder.
struct Made {
    json: Value,
    heads: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Made {
    /// Reads the files of a test and checks all that is true of any.
    fn read(folder: &Path, test: &str, by: &str) -> Self {
        let read = |suffix: &str| fs::read_to_string(folder.join(format!("{test}{suffix}"))).unwrap();
        let json: Value = serde_json::from_str(&read(".json")).unwrap();
        assert!(json["test"] == test && json["by"] == by && are_finite(&json), "{json}");
        let csv = read(".csv");
        let mut lines = csv.lines();
        let heads: Vec<String> = lines.next().unwrap().split(',').map(str::to_owned).collect();
        assert_eq!(json["columns"], serde_json::json!(heads));
        let rows: Vec<Vec<f64>> =
            lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
        assert!(rows.len() > 1 && rows.iter().all(|row| row.len() == heads.len()), "{csv}");
        assert!(rows.iter().flatten().all(|cell| cell.is_finite()), "{csv}");
        let svg = read(".svg");
        let drawn = svg.split_once("clip-path=\"url(").unwrap().1;
        assert!(drawn.contains("<path") || drawn.contains("<circle"), "{test} by {by}: nothing is drawn");

        let page = fs::read_to_string(folder.join("report.html")).unwrap();
        let line = format!(
            "<tr><td><a href=\"#{test}\">{test}</a></td><td>{}</td><td>{by}</td>",
            json["title"].as_str().unwrap()
        );
        assert!(page.contains(&line) && page.contains(&format!("<h2 id=\"{test}\">")), "{line}");
        let line = page.lines().find(|one| one.starts_with(&line)).unwrap();
        let printed = json["printed"].as_array().unwrap();
        assert_eq!(printed.len(), json["results"].as_array().unwrap().len());
        for number in printed.iter().flat_map(|group| group["numbers"].as_array().unwrap()) {
            let shown = number[1].as_str().unwrap();
            assert!(line.contains(&format!("<b>{shown}</b>")), "{shown}: {line}");
        }
        Self { json, heads, rows }
    }

    /// A number of a group of results, in SI.
    #[track_caller]
    fn number(&self, group: usize, key: &str) -> f64 {
        self.json["results"][group][key].as_f64().unwrap_or_else(|| panic!("{key}: {}", self.json["results"]))
    }

    fn column(&self, head: &str) -> usize {
        self.heads.iter().position(|one| one == head).unwrap_or_else(|| panic!("{head}: {:?}", self.heads))
    }

    /// What follows of each direction rises with what is done to it, from one row to the next.
    #[track_caller]
    fn rises(&self, done: &str, follows: &str) {
        let [done, follows] = [done, follows].map(|head| self.column(head));
        for pair in self.rows.windows(2).filter(|pair| pair[1][done] > pair[0][done]) {
            assert!(pair[1][follows] > pair[0][follows], "{pair:?}");
        }
    }

    /// Weft, bias and warp at the same stretch, of a weave.
    #[track_caller]
    fn bias_is_softer(&self, key: &str) {
        let [weft, bias, warp] = [0, 1, 2].map(|at| self.number(at, key));
        assert!(bias > 0.0 && bias < 0.7 * weft && bias < 0.7 * warp, "{weft} {bias} {warp}");
    }

    /// `WT = ½ LT F_m EMT`; the load is that of KES, or what was reached.
    #[track_caller]
    fn kes_formula(&self, part: f64) {
        let result = &self.json["results"][0];
        let load = result["line_force_N_per_m"].as_f64().unwrap_or(500.0 * GF_PER_CM);
        let [linearity, work, stretch] = ["LT", "WT_J_per_m2", "EMT"].map(|key| self.number(0, key));
        within(work, 0.5 * linearity * load * stretch, part);
        assert!(linearity > 0.4 && linearity < 1.3, "{linearity}");
    }

    /// A line that hangs from the edge, and ends at a slope \[deg\].
    #[track_caller]
    fn hangs_at(&self, slope: f64) {
        let [along, up] = ["along [m]", "up [m]"].map(|head| self.column(head));
        let last = &self.rows[self.rows.len() - 1];
        within((-last[up]).atan2(last[along]).to_degrees(), slope, 1e-3);
    }

    /// Of weft and warp, and of the bias, which gives most.
    #[track_caller]
    fn fast_rises(&self) {
        for at in 0..2 {
            let [least, middle, most] = ["E5", "E20", "E100"].map(|key| self.number(at, key));
            assert!(0.0 < least && least < middle && middle < most, "{least} {middle} {most}");
            assert!(self.number(2, "EB5") > least);
        }
    }

    /// Drawn by yarns: the force rises, and not all work comes back.
    #[track_caller]
    fn rubs(&self) {
        let [way, force] = ["there (1) or back (-1)", "force [N]"].map(|head| self.column(head));
        let there: Vec<f64> = self.rows.iter().filter(|row| row[way] > 0.0).map(|row| row[force]).collect();
        let most = there.iter().fold(0.0, |most: f64, &force| most.max(force));
        assert!(there.len() > 5 && most > 0.0 && most == there[there.len() - 1], "{there:?}");
        // A swatch that is hardly drawn yet may uncurl, and give a little.
        assert!(there.windows(2).all(|pair| pair[1] > pair[0] - 1e-3 * most), "{there:?}");
        let returned = self.number(0, "RT");
        assert!(returned > 0.2 && returned < 0.995, "{returned}");
    }

    /// The scene's layout is near to how its loops lie at rest.
    #[track_caller]
    fn shrinks_a_little(&self) {
        let [width, length] = [0, 1].map(|at| self.number(at, "shrinkage"));
        assert!([width, length].iter().all(|part| part.abs() > 1e-4 && part.abs() < 0.15), "{width} {length}");
        within(1.0 - self.number(2, "area_shrinkage"), (1.0 - width) * (1.0 - length), 1e-9);
    }
}

/// That no number is missing: those that are not finite are null in JSON.
fn are_finite(value: &Value) -> bool {
    match value {
        Value::Null => false,
        Value::Array(all) => all.iter().all(are_finite),
        Value::Object(all) => all.values().all(are_finite),
        _ => true,
    }
}

fn fabric(name: &str, folder: &Path) -> PathBuf {
    if name == "large-loops" {
        let path = folder.join("large-loops.toml");
        fs::write(&path, LARGE_LOOPS).unwrap();
        return path;
    }
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fabrics").join(name).join("fabric.toml")
}

/// All tests of a model, one after the other into the same folder; the report gathers them.
fn all_by(model: &str) {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let (_, cases) = MODELS.into_iter().find(|(name, _)| *name == model).unwrap();
    for (test, name, options, fact) in cases {
        let fabric = fabric(name, folder.path());
        let places = [fabric.to_str().unwrap(), "--out", out.to_str().unwrap(), "--by", model];
        let output = wale(&[&["lab", test], &places[..], options].concat());
        assert_eq!(output.status.code(), Some(0), "{test} by {model}: {}", told(&output));
        fact(&Made::read(&out, test, model));
    }
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert_eq!(page.matches("<tr><td>").count(), cases.len());
    assert_eq!(page.matches("<svg ").count(), cases.len());
}

#[test]
fn a_shell_makes_its_tests() {
    all_by("shell");
}

#[test]
fn a_tile_makes_its_tests() {
    all_by("tile");
}

#[test]
fn contacts_make_their_tests() {
    all_by("contacts");
}

#[test]
fn yarns_make_their_tests() {
    all_by("yarns");
}

#[test]
fn whatever_has_no_case_here_is_refused() {
    for (model, cases) in MODELS {
        for test in TESTS.into_iter().filter(|test| cases.iter().all(|case| case.0 != *test)) {
            let output = wale(&["lab", test, "none.toml", "--by", model]);
            assert_eq!(output.status.code(), Some(2), "{test} by {model}");
            assert!(told(&output).contains(" is not made by "), "{test} by {model}: {}", told(&output));
        }
    }
    let wrinkled = wale(&["lab", "stretch", "none.toml", "--by", "tile", "--wrinkle"]);
    assert!(wrinkled.status.code() == Some(2) && told(&wrinkled).contains("by shell alone"), "{}", told(&wrinkled));
    // The tests that are here are all that there are.
    let help = String::from_utf8(wale(&["lab", "--help"]).stdout).unwrap();
    let listed = help.split("Commands:").nth(1).unwrap().split("\n\n").next().unwrap();
    let names: Vec<&str> = listed.lines().filter_map(|line| line.split_whitespace().next()).collect();
    assert!(TESTS.iter().all(|test| names.contains(test)) && names.len() == TESTS.len() + 1, "{help}");
}

#[test]
fn a_weave_has_no_swatch_of_yarns_and_does_not_shrink() {
    let folder = tempfile::tempdir().unwrap();
    let fabric = fabric(WEAVE, folder.path());
    let all_of_yarns = YARNS.iter().map(|case| (case.0, "yarns", "as a shell, a tile or by its contacts"));
    for (test, model, says) in all_of_yarns.chain([("relaxation", "contacts", "at rest at the sett")]) {
        let out = folder.path().join("out");
        let places = [fabric.to_str().unwrap(), "--out", out.to_str().unwrap(), "--by", model];
        let output = wale(&[&["lab", test], &places[..]].concat());
        assert_eq!(output.status.code(), Some(3), "{test}: {}", told(&output));
        assert!(told(&output).contains(says) && !out.exists(), "{test}: {}", told(&output));
    }
}

#[test]
fn a_pear_loop_of_one_distance_is_a_point() {
    let folder = tempfile::tempdir().unwrap();
    let (fabric, out) = (fabric(WEAVE, folder.path()), folder.path().join("out"));
    let options = ["--distance", "10 mm", "--direction", "weft", "--out", out.to_str().unwrap()];
    assert_succeeds(&wale(&[&["lab", "pear-loop", fabric.to_str().unwrap()], &options[..]].concat()));
    let svg = fs::read_to_string(out.join("pear-loop.svg")).unwrap();
    assert!(svg.split_once("clip-path=\"url(").unwrap().1.contains("<circle"));
}
