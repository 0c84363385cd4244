//! Tables of instruments become curves, or one error that says what to do.

use std::collections::BTreeMap;
use std::path::Path;

use wale_lab::curve::{ColumnName, CurveError, LoopCurve, Meaning, Request, Specimen, StretchCurve, Table};

const SPECIMEN: Specimen = Specimen { length: 0.1, width: 0.06 };

fn stretch(text: &str, request: &Request) -> Result<StretchCurve, CurveError> {
    StretchCurve::of(&Table::from_text(text, "curve.csv")?, request, SPECIMEN)
}

fn refused(text: &str, says: &[&str]) {
    let error = stretch(text, &Request::default()).expect_err(text).to_string();
    for word in says {
        assert!(error.contains(word), "\"{word}\" is not in: {error}");
    }
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
    let table = Table::from_text("distance (mm);h/p\n3;1,9\n34;0,8\n", "loop.csv").unwrap();
    let curve = LoopCurve::of(&table, &Request::default()).unwrap();
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
    refused(&format!("{head}0,0\n10,1\n20,2\n"), &["curve.csv:3:", "a stretch of 10", "unit"]);
    refused("strain,force\n0,0\n0.1,1\n0.2,2\n", &["has no unit", "units = { force", "cN"]);
    refused("strain,force (mm)\n0,0\n0.1,1\n0.2,2\n", &["no column is recognised as force"]);
    refused("strain,pull (N)\n0,0\n0.1,1\n0.2,2\n", &["no column is recognised as force", "columns ="]);
    refused("0,0\n0.1,1\n0.2,2\n", &["it has no heads"]);
    refused("nothing here\n", &["has no row with two numbers"]);
    refused("", &["has no row with two numbers"]);
    let missing = Table::read(Path::new("no such file.csv")).unwrap_err();
    assert!(missing.to_string().contains("cannot be read"), "{missing}");
}

#[test]
fn the_measured_curves_of_the_folder_are_read() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/knit-tensile-singal2024/binned.csv");
    if !path.exists() {
        eprintln!("SKIPPED: {} is not there", path.display());
        return;
    }
    let table = Table::read(&path).unwrap();
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
