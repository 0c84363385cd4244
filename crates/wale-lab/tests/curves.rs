//! Tables of instruments become curves, or one error that says what to do.

#[path = "../../wale/tests/shared/mod.rs"]
mod shared;

use std::collections::BTreeMap;
use std::path::Path;

use shared::shared;
use wale_lab::curve::{
    ColumnName, CurveError, Decimal, Delimiter, LoopCurve, Meaning, Request, Specimen, StretchCurve, Table, TableFormat,
};

const SPECIMEN: Specimen = Specimen { length: 0.1, width: 0.06 };

fn stretch(text: &str, request: &Request) -> Result<StretchCurve, CurveError> {
    StretchCurve::of(&Table::from_text(text, "curve.csv", TableFormat::default())?, request, SPECIMEN)
}

fn loops(text: &str) -> Result<LoopCurve, CurveError> {
    LoopCurve::of(&Table::from_text(text, "loop.csv", TableFormat::default())?, &Request::default(), SPECIMEN)
}

fn says_all(found: Result<impl std::fmt::Debug, CurveError>, says: &[&str]) {
    let error = found.expect_err(says[0]).to_string();
    for word in says {
        assert!(error.contains(word), "\"{word}\" is not in: {error}");
    }
}

fn refused(text: &str, says: &[&str]) {
    says_all(stretch(text, &Request::default()), says);
}

fn unit(meaning: Meaning, unit: &str) -> Request {
    Request { units: BTreeMap::from([(meaning, unit.to_owned())]), ..Request::default() }
}

fn number(meaning: Meaning, column: usize) -> Request {
    Request { columns: BTreeMap::from([(meaning, ColumnName::Number(column))]), ..Request::default() }
}

fn assert_near(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() < 1e-12, "{found:?} is not {expected:?}");
    }
}

#[test]
fn the_same_curve_whatever_wrote_it() {
    let plain = "strain,force (N),compression\n0,0,0\n0.1,0.5,0.02\n0.2,1.5,0.05\n";
    let german = "Dehnung [%];Kraft [cN];Querdehnung [%]\n0;0;0\n10,0;50;-2\n20,0;150;-5\n";
    let instrument = "Universal tester 5\nOperator, A\n\nTime,Extension,Load,Width\n(s),(mm),(N),(mm)\n\
                      0,0,0,60\n1,10,0.5,58.8\n2,20,1.5,57\n";
    let tabs = "# from a spreadsheet\nelongation_mm\tload_gf\n0\t0\n10\t50.985810649\n20\t152.957431947\n";
    for text in [plain, german, instrument, tabs] {
        let curve = stretch(text, &Request::default()).unwrap();
        assert_near(&curve.stretch, &[0.0, 0.1, 0.2]);
        for (a, b) in curve.force.iter().zip([0.0, 0.5, 1.5]) {
            assert!((a - b).abs() < 1e-9, "{text}: {:?}", curve.force);
        }
        if text != tabs {
            assert_near(curve.compression.as_ref().unwrap(), &[0.0, 0.02, 0.05]);
        }
    }
}

#[test]
fn columns_units_and_rows_can_be_said() {
    let text = "trial,a,b\nx,0,0\ny,0,0\nx,5,100\ny,10,100\ny,20,300\n";
    let request = Request {
        columns: BTreeMap::from([
            (Meaning::Stretch, ColumnName::Head("a".to_owned())),
            (Meaning::LineForce, ColumnName::Number(3)),
        ]),
        units: BTreeMap::from([(Meaning::Stretch, "%".to_owned()), (Meaning::LineForce, "N/m".to_owned())]),
        only: BTreeMap::from([("trial".to_owned(), "y".to_owned())]),
    };
    let curve = stretch(text, &request).unwrap();
    assert_near(&curve.stretch, &[0.0, 0.1, 0.2]);
    assert_near(&curve.force, &[0.0, 6.0, 18.0]);
    let read_as =
        "table: comma between cells, decimal point, 1 line before the numbers, 3 of 5 rows, only trial = \"y\"";
    assert_eq!(curve.table_read_as, read_as);
    assert_eq!(curve.read_as, ["stretch: column 2, \"a\", in %", "line_force: column 3, \"b\", in N/m"]);
    let (force, compression) = curve.at(0.15);
    assert!((force - 12.0).abs() < 1e-12 && compression.is_none());
    assert_eq!(curve.at(9.0).0, curve.force[2]);
}

#[test]
fn what_is_asked_for_goes_before_what_is_found() {
    let text = "strain,pins,force (N),tension (N/m)\n0,0,0,0\n0.1,0.2,1,50\n0.2,0.3,2,100\n";
    let found = stretch(text, &Request::default()).unwrap();
    assert_near(&found.force, &[0.0, 1.0, 2.0]);
    let columns = BTreeMap::from([
        (Meaning::LineForce, ColumnName::Head("tension".to_owned())),
        (Meaning::Stretch, ColumnName::Head("pins".to_owned())),
    ]);
    let asked = stretch(text, &Request { columns, ..Request::default() }).unwrap();
    assert_near(&asked.stretch, &[0.0, 0.2, 0.3]);
    assert_near(&asked.force, &[0.0, 3.0, 6.0]);
}

#[test]
fn a_loop_has_distances_and_ratios() {
    let curve = loops("distance (mm);h/p\n3;1,9\n34;0,8\n").unwrap();
    assert_near(&curve.distance, &[0.003, 0.034]);
    assert_near(&curve.aspect_ratio, &[1.9, 0.8]);
}

#[test]
fn what_is_wrong_is_said_with_its_line_and_the_mend() {
    let head = "strain,force (N)\n";
    refused(&format!("{head}0,0\n0.1,NaN\n0.2,1\n"), &["curve.csv:3:", "NaN", "leave rows without a value out"]);
    refused(&format!("{head}0,0\n0.1,1\n0.2,inf\n"), &["curve.csv:4:", "inf"]);
    refused(&format!("{head}0,0\n0.2,1\n0.1,1\n"), &["curve.csv:4:", "stretch falls", "loading branch"]);
    refused(&format!("{head}0,0\n0.1,50 cN\n0.2,1\n"), &["curve.csv:3:", "50 cN", "a unit belongs in the head"]);
    refused(&format!("{head}0,0\n0.1,\n0.2,1\n"), &["curve.csv:3:", "is empty"]);
    refused(&format!("{head}0,0\n0.1,broke\n0.2,1\n"), &["curve.csv:3:", "broke", "no number"]);
    refused(&format!("{head}0,0\n0.2,1\n"), &["has 2 samples", "three"]);
    refused(&format!("{head}0,0\n10,1\n20,2\n"), &["curve.csv:3:", "a stretch of 10", "per cent", "unit"]);
    refused("strain (1),force (N)\n0,0\n10,1\n20,2\n", &["curve.csv:3:", "a stretch of 10.000 cannot be", "unit"]);
    refused("strain,force\n0,0\n0.1,1\n0.2,2\n", &["has no unit", "units = { force", "cN"]);
    refused("strain,force (mm)\n0,0\n0.1,1\n0.2,2\n", &["no column is recognised as force"]);
    refused("strain,pull (N)\n0,0\n0.1,1\n0.2,2\n", &["no column is recognised as force", "columns ="]);
    refused("0,0\n0.1,1\n0.2,2\n", &["it has no heads"]);
    refused("nothing here\n", &["has no row with two numbers"]);
    refused("", &["has no row with two numbers"]);
    let missing = Table::read(Path::new("no such file.csv"), TableFormat::default());
    says_all(missing, &["no such file.csv: cannot be read"]);
    let latin = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(latin.path(), b"Pr\xfcfung,force (N)\n0,0\n").unwrap();
    says_all(Table::read(latin.path(), TableFormat::default()), &["is not text in UTF-8; save it as CSV in UTF-8"]);
}

#[test]
fn units_that_contradict_each_other_are_refused() {
    let below = "strain,Load (N)\n,(cN)\n0,0\n0.1,50\n0.2,150\n";
    refused(below, &["curve.csv:2: ", "column 2", "to be in N and in cN", "units = { force = \"N\" }"]);
    let beside = "strain,force_N (cN)\n0,0\n0.1,50\n0.2,150\n";
    refused(beside, &["curve.csv:1: ", "to be in cN and in N"]);
    let bare = "Dehnung [%];Kraft [N]\n-;N\n0;0\n1;2\n2;4\n";
    refused(bare, &["curve.csv:2: ", "column 1", "to be in - and in %"]);
    assert_near(&stretch(below, &unit(Meaning::Force, "cN")).unwrap().force, &[0.0, 0.5, 1.5]);
    // The same said twice is no contradiction.
    let twice = "strain,force_N\n(%),N\n0,0\n10,1\n20,2\n";
    assert_near(&stretch(twice, &unit(Meaning::Stretch, "%")).unwrap().force, &[0.0, 1.0, 2.0]);
}

#[test]
fn short_words_and_heads_with_units_are_no_units_of_the_line_above() {
    for heads in ["Dehnung [%];Last [N]", "Weg [mm];Last [N]"] {
        let text = format!("Operator;A\n{heads}\n0;0\n10;1\n20;2\n");
        assert_near(&stretch(&text, &Request::default()).unwrap().stretch, &[0.0, 0.1, 0.2]);
    }
    let short = "Operator;A\nWeg;Last\n0;0\n10;1\n20;2\n";
    let mut request = unit(Meaning::Extension, "mm");
    request.units.insert(Meaning::Force, "N".to_owned());
    assert_near(&stretch(short, &request).unwrap().force, &[0.0, 1.0, 2.0]);
}

#[test]
fn columns_that_could_both_be_meant_must_agree() {
    let two = |heads: &str, factor: f64| {
        let rows: String = [0.0, 0.5, 1.5].iter().enumerate().fold(String::new(), |text, (k, force)| {
            text + &format!("{},{force},{}\n", k as f64 / 10.0, force * factor)
        });
        format!("strain,{heads}\n{rows}")
    };
    let differ = ["columns 2 (", ") and 3 (", "could both be force and differ", "columns = { force = 3 }"];
    refused(&two("Load (N),Load (cN)", 110.0), &["curve.csv:3: ", "\"Load (N)\": 0.5", "\"Load (cN)\": 55", differ[3]]);
    refused(&two("Load (N),Load (N)", 2.0), &differ);
    refused(&two("Load (N),Force (N)", 2.0), &["columns 3 (", ") and 2 ("]);
    refused(&two("Load 1 (N),Load 2 (N)", 2.0), &differ);
    assert_near(&stretch(&two("Load (N),Load (N)", 2.0), &number(Meaning::Force, 3)).unwrap().force, &[0.0, 1.0, 3.0]);
    // A name that two heads have does not say which.
    let columns = BTreeMap::from([(Meaning::Force, ColumnName::Head("Load".to_owned()))]);
    let request = Request { columns, ..Request::default() };
    says_all(stretch(&two("Load (N),Load (cN)", 110.0), &request), &differ);
    // The same quantity, within rounding; an empty channel; and what is told apart by its word, its unit or its kind.
    let apart = [
        ("Load (N),Load (cN)", 100.0),
        ("Load (N),Load (cN)", 100.1),
        ("Load (N),Load at break (N)", 2.0),
        ("Load (N),Load", 2.0),
        ("Load (N),Stress (MPa)", 2.0),
        ("Load (N),Load (MPa)", 2.0),
        ("Force (N),Tension (N/m)", 2.0),
    ];
    for (heads, factor) in apart {
        let curve = stretch(&two(heads, factor), &Request::default()).unwrap();
        assert_near(&curve.force, &[0.0, 0.5, 1.5]);
        assert!(curve.read_as[1].contains("column 2"), "{heads}");
    }
    let empty = "strain,Load (N),Load (N)\n0,0,\n0.1,0.5,\n0.2,1.5,\n";
    assert_near(&stretch(empty, &Request::default()).unwrap().force, &[0.0, 0.5, 1.5]);
    refused("strain,Strain (%),Load (N)\n0,0,0\n0.1,20,1\n0.2,30,2\n", &["could both be stretch", "stretch = 2"]);
}

#[test]
fn per_cent_without_a_unit_are_refused() {
    let text = "strain,force (N)\n0,0\n1,1\n2.5,2\n";
    refused(text, &["curve.csv:4: ", "a stretch of 2.5", "per cent", "units = { stretch = \"%\" }"]);
    assert_near(&stretch(text, &unit(Meaning::Stretch, "%")).unwrap().stretch, &[0.0, 0.01, 0.025]);
    assert_near(&stretch(text, &unit(Meaning::Stretch, "1")).unwrap().stretch, &[0.0, 1.0, 2.5]);
    assert_near(
        &stretch(&text.replace("strain", "strain (mm/mm)"), &Request::default()).unwrap().stretch,
        &[0.0, 1.0, 2.5],
    );
    assert!(stretch("strain,force (N)\n0,0\n1,1\n2,2\n", &Request::default()).is_ok());
}

#[test]
fn decimal_commas_in_quotes_are_read() {
    let quoted = "strain,\"force (N)\"\n\"0\",\"0\"\n\"0,1\",\"0,5\"\n\"0,2\",\"1,5\"\n";
    let curve = stretch(quoted, &Request::default()).unwrap();
    assert_near(&curve.stretch, &[0.0, 0.1, 0.2]);
    assert_near(&curve.force, &[0.0, 0.5, 1.5]);
    assert!(curve.table_read_as.contains("comma between cells, decimal comma"), "{}", curve.table_read_as);
    // Commas that nothing tells from those between cells, or from those before thousands.
    refused("strain,force (N)\n0,0\n0,1,0,5\n0,2,1,5\n", &["curve.csv:3: 4 cells stand under 2 heads", "quotes"]);
    let remark = "strain (%),force (N)\n0,0\n10,1,slips\n20,2\n";
    assert_near(&stretch(remark, &Request::default()).unwrap().force, &[0.0, 1.0, 2.0]);
    let thousands = "strain (%),force (N)\n0,0\n1,\"1,500\"\n2,\"2,750\"\n";
    refused(thousands, &["curve.csv:3: ", "\"1,500\"", "before thousands", "decimal = \",\""]);
    let pointed = "strain,force (N)\n0,0\n0.1,\"1,500\"\n0.2,\"2,750\"\n";
    refused(pointed, &["curve.csv:3: ", "\"1,500\", with a comma", "decimal points"]);
}

#[test]
fn how_a_table_is_written_can_be_said() {
    // More remarks with commas than rows with semicolons.
    let text = format!("{}strain;force (N)\n0;0\n0,1;1\n0,2;2\n", "Tester, 5\n".repeat(9));
    refused(&text, &["delimiter"]);
    let format = |delimiter, decimal| TableFormat { delimiter: Some(delimiter), decimal };
    let read = |text: &str, format| {
        StretchCurve::of(&Table::from_text(text, "curve.csv", format)?, &Request::default(), SPECIMEN)
    };
    let curve = read(&text, format(Delimiter::Semicolon, None)).unwrap();
    assert_near(&curve.stretch, &[0.0, 0.1, 0.2]);
    assert!(curve.table_read_as.contains("semicolon between cells, decimal comma, 10 lines before the numbers"));
    let bars = "strain (%)|force (N)\n0|0\n1|1,500\n2|2,750\n";
    let curve = read(bars, format(Delimiter::Bar, Some(Decimal::Comma))).unwrap();
    assert_near(&curve.force, &[0.0, 1.5, 2.75]);
    says_all(read(bars, format(Delimiter::Bar, Some(Decimal::Point))), &["curve.csv:3: ", "with a comma"]);
}

#[test]
fn fabrics_that_push_or_lose_their_width_are_refused() {
    let head = "strain,force (N)\n";
    refused(&format!("{head}0,0\n0.1,-1\n0.2,-3\n"), &["curve.csv:3: ", "-1.0000 N pushes", "turn the sign"]);
    refused(&format!("{head}0,0\n0.1,-0.1\n0.2,1\n"), &["curve.csv:3: ", "pushes"]);
    let noise = stretch(&format!("{head}0,-0.01\n0.1,0.2\n0.2,1\n"), &Request::default()).unwrap();
    assert_near(&noise.force, &[-0.01, 0.2, 1.0]);
    let head = "strain,force (N),compression\n0,0,0\n";
    let unit = "units = { compression = \"%\" }";
    for (value, does) in [("1", "leaves no width"), ("1.2", "leaves no width"), ("-1", "doubles the width")] {
        refused(&format!("{head}0.1,1,{value}\n0.2,2,0.2\n"), &["curve.csv:3: ", does, unit]);
    }
    let all = "strain,force (N),compression (%)\n0,0,0\n0.1,1,50\n0.2,2,120\n";
    refused(all, &["curve.csv:4: ", "a compression of 1.200 leaves no width", "unit of that column"]);
    let wide = "strain,force (N),width (mm)\n0,0,130\n0.1,1,125\n0.2,2,120\n";
    refused(wide, &["curve.csv:2: ", "a compression of -1.167", "specimen's width"]);
}

#[test]
fn loops_that_cannot_be_are_refused() {
    let head = "distance (mm),h/p\n";
    says_all(loops(&format!("{head}3,1.9\n")), &["has one loop", "needs two"]);
    says_all(loops(&format!("{head}3,1.9\n34,NaN\n")), &["loop.csv:3: ", "NaN", "leave rows without a value out"]);
    says_all(loops(&format!("{head}3,1.9\n-4,0.8\n")), &["loop.csv:3: ", "both are positive"]);
    says_all(loops(&format!("{head}0,1.9\n4,0.8\n")), &["loop.csv:2: ", "both are positive"]);
    says_all(loops(&format!("{head}3,1.9\n34,-0.8\n")), &["loop.csv:3: ", "both are positive"]);
    says_all(loops(&format!("{head}3,1.9\n3,1.8\n")), &["loop.csv:3: ", "from 0.003 m to 0.003 m", "one trial"]);
    says_all(loops(&format!("{head}3,1.9\n30,0.9\n3,1.8\n30,0.8\n")), &["loop.csv:4: ", "`only`"]);
    says_all(loops(&format!("{head}30,0.9\n3,1.8\n30,0.8\n")), &["loop.csv:4: ", "`only`"]);
    says_all(loops("distance (m),h/p\n3,1.9\n34,0.8\n"), &["loop.csv:2: ", "pull a specimen of 0.1 m straight"]);
    // From far to near is an order, too.
    assert_near(&loops(&format!("{head}34,0.8\n20,1.2\n3,1.9\n")).unwrap().distance, &[0.034, 0.02, 0.003]);
}

#[test]
fn the_measured_curves_of_the_folder_are_read() {
    let Some(path) = shared("knit-tensile-singal2024/binned.csv") else { return };
    let table = Table::read(&path, TableFormat::default()).unwrap();
    let word = |head: &str, word: &str| (head.to_owned(), word.to_owned());
    let request = Request {
        columns: BTreeMap::from([
            (Meaning::Stretch, ColumnName::Head("axial_strain_clamp".to_owned())),
            (Meaning::TransverseStrain, ColumnName::Head("transverse_strain_pins".to_owned())),
        ]),
        only: BTreeMap::from([word("stitch", "stockinette"), word("direction", "X"), word("trial", "2")]),
        ..Request::default()
    };
    match StretchCurve::of(&table, &request, Specimen { length: 0.09, width: 0.035 }) {
        Ok(curve) => {
            assert!(curve.stretch.len() > 20 && *curve.stretch.last().unwrap() > 0.2, "{curve:?}");
            assert!(curve.force.last() > curve.force.first());
        }
        Err(error) => panic!("{error}"),
    }
}
