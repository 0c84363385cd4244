//! What programs become, and how bad ones are refused.

use super::*;
use crate::pattern::loops::{Form, Stop};
use proptest::prelude::*;

const HEAD: &str = ";!knitout-2\n;;Carriers: 1 2 3\n";

fn knitted(lines: &str) -> Knitted {
    read_knitout(&format!("{HEAD}{lines}")).unwrap_or_else(|error| panic!("{error}"))
}

fn refused(lines: &str) -> (usize, String) {
    let error = read_knitout(&format!("{HEAD}{lines}")).unwrap_err();
    // Counted without the two lines of the head.
    (error.line - 2, error.reason.to_string())
}

/// Row and column of what the loop made at a line (without the head) is drawn through, front to back.
fn parents(knitted: &Knitted, line: u32) -> Vec<u32> {
    let of = knitted.graph.loops.iter().find(|of| of.source == line + 2).unwrap();
    of.parents.iter().map(|held| knitted.graph.of(held.of).source - 2).collect()
}

const CAST_ON: &str = "inhook 1\ntuck - f2 1\ntuck - f1 1\ntuck + f1 1\nreleasehook 1\n";

#[test]
fn rows_go_to_and_fro_over_both_beds() {
    let knitted = knitted(
        "in 1\ntuck - f2 1\ntuck - f1 1\nknit + f1 1\nknit + f2 1\nxfer f2 b2\nknit - b2 1\nknit - f1 1\nout 1\n",
    );
    let graph = &knitted.graph;
    assert_eq!((graph.loops.len(), graph.size), (6, [3, 2]));
    assert_eq!(parents(&knitted, 4), [3]);
    assert_eq!(parents(&knitted, 7), [5]);
    let purl = graph.loops.iter().find(|of| of.source == 9).unwrap();
    assert_eq!((purl.form, purl.row, purl.column), (Form::Worked { knit: false }, 2, 1));
    let loops = graph.strands[0].stops.iter().filter(|(stop, _)| matches!(stop, Stop::Loop { .. })).count();
    assert_eq!((graph.strands.len(), loops), (1, 6));
    assert_eq!(graph.unsupported().count(), 2, "what is on the needles at the end hangs free");
    assert!(knitted.remarks.is_empty());
}

#[test]
fn transfers_stack_and_the_bed_decides_what_lies_in_front() {
    let start = "in 1\ntuck - f2 1\ntuck - f1 1\nxfer f2 b2\nrack -1\nxfer b2 f1\nrack 0\n";
    let front = knitted(&format!("{start}knit + f1 1\n"));
    // The loop that was there first is in front on the front bed; a right-leaning decrease.
    assert_eq!(parents(&front, 8), [3, 2]);
    let back = knitted("in 1\ntuck - b2 1\ntuck - b1 1\nxfer b2 f2\nrack 1\nxfer f2 b1\nrack 0\nknit + b1 1\n");
    assert_eq!(parents(&back, 8), [2, 3]);
}

#[test]
fn an_empty_needle_takes_a_yarn_over() {
    let knitted = knitted(
        "in 1\ntuck - f2 1\ntuck - f1 1\nknit + f1 1\nknit + f2 1\nxfer f1 b1\nrack 1\nxfer b1 f2\nrack 0\nknit - f2 1\nknit - f1 1\n",
    );
    let over = knitted.graph.loops.iter().find(|of| of.source == 13).unwrap();
    assert_eq!((over.form, over.row), (Form::Open, 2));
    let what = "f1 was empty when it was knitted: the yarn is laid over it, as a tuck lays it";
    assert!(knitted.remarks.contains(&Remark { line: 13, what: what.to_owned() }), "{:?}", knitted.remarks);
    assert!(knitted.remarks.iter().any(|remark| remark.what.contains("never taken out")));
}

#[test]
fn a_split_keeps_the_old_loop_on_the_other_bed() {
    let knitted = knitted("in 1\ntuck - f1 1\nsplit + f1 b1 1\nknit - b1 1\nknit - f1 1\n");
    assert_eq!(parents(&knitted, 3), [2]);
    assert_eq!(parents(&knitted, 4), [2]);
    let old = knitted.graph.loops.iter().find(|of| of.source == 4).unwrap();
    assert_eq!(old.children.len(), 2);
}

#[test]
fn carriers_that_feed_together_are_one_yarn_and_floats_are_counted() {
    let knitted = knitted("in 1\nin 2 3\ntuck - f3 1\ntuck - f2 1\ntuck - f1 1\nknit + f1 2 3\nknit + f3 2 3\n");
    assert_eq!(knitted.carriers, ["1", "2 3"]);
    assert_eq!(knitted.graph.longest_float(), 1);
}

#[test]
fn programs_that_cannot_be_knitted_say_where_and_why() {
    let cases = [
        ("knit + f1 1\n", 1, "carrier 1 makes a loop but was not brought in; write `inhook 1` or `in 1` before"),
        ("in 4\n", 1, "carrier `4` is not among those of the header (1 2 3)"),
        ("in 1\nin 1\n", 2, "carrier 1 is brought in again; it was brought in at line 3"),
        ("out 1\n", 1, "carrier 1 is taken out but was not brought in"),
        ("rack 40\n", 1, "racked by 40: machines reach 12 needles to either side"),
        ("rack NaN\n", 1, "racked by NaN: machines reach 12 needles to either side"),
        (
            "inhook 1\ntuck - f1 1\nknit + f1 1\n",
            1,
            "the hook never lets carrier 1 go; write `releasehook 1` after its first stitches",
        ),
        ("inhook 1\ninhook 2\n", 2, "the hook still holds carrier 1 from line 3; write `releasehook 1` first"),
        ("in 1\nreleasehook 1\n", 2, "the hook does not hold carrier 1"),
        ("xfer f1 b2\n", 1, "f1 and b2 do not face each other: racked by 0, f1 faces b1"),
        (
            "rack 0.5\nxfer f1 b1\n",
            2,
            "f1 and b1 do not face each other: racked by 0.5, f1 faces the gap between two needles",
        ),
        ("knit + f2147483647 1\n", 1, "needle `f2147483647`: needles are numbered from -100000 to 100000"),
        ("knit + q1 1\n", 1, "needle `q1`: needles are numbered from -100000 to 100000"),
        ("knit f1 1\n", 1, "`knit` needs a direction (+ or -) first"),
        ("in 1\nknit + fs1 1\n", 2, "fs1 is a slider: it holds loops, none can be made on it"),
        ("purl + f1 1\n", 1, "`purl` is no operation of knitout"),
        ("rack\n", 1, "`rack` needs one number of needles"),
        ("in 1\n", 1, "the program makes no loop"),
        (
            "inhook 1\ntuck - f1 1\nreleasehook 1\ntuck - f2 1\nout 1\nknit + f1 1\n",
            6,
            "carrier 1 makes a loop but was not brought in; write `inhook 1` or `in 1` before",
        ),
        ("rack -12.5\n", 1, "racked by -12.5: machines reach 12 needles to either side"),
    ];
    for (lines, line, reason) in cases {
        assert_eq!(refused(lines), (line, reason.to_owned()), "{lines}");
    }
    let again = "tuck + f1 1\n";
    let stacked = "f1 holds 65 loops, and one is drawn through 7 at most";
    assert_eq!(refused(&format!("in 1\n{}", again.repeat(70))), (66, stacked.to_owned()));
    assert_eq!(refused(&format!("in{}\n", " 1".repeat(65))).1, "65 carriers: no machine has more than 64");
    assert!(refused(&format!("in {}\n", "a".repeat(50))).1.ends_with("names have at most 40 characters"));
    assert!(read_knitout("knit + f1 1\n").unwrap_err().to_string().contains("no knitout"));
    assert!(read_knitout("").unwrap_err().to_string().contains("no knitout"));
}

#[test]
fn yarns_beyond_the_limit_are_refused_where_they_begin() {
    let text: String = (0..251).map(|name| format!("in y{name}\ntuck + f{name} y{name}\nout y{name}\n")).collect();
    let error = read_knitout(&format!(";!knitout-2\n{text}")).unwrap_err();
    assert_eq!(error.to_string(), "line 753: there are more than 250 different yarns");
}

/// Each of these once took time with the square of the program's length.
#[test]
fn long_programs_are_worked_in_the_time_of_their_length() {
    let began = std::time::Instant::now();
    let bed: String = (0..20_000).map(|needle| format!("tuck + f{needle} 1\n")).collect();
    let floats = "knit + f0 1\nknit + f19999 1\n".repeat(20_000);
    let knitted = knitted(&format!("in 1\n{bed}{floats}"));
    assert_eq!(knitted.graph.longest_float(), 19_998);
    let dropped = "knit + f1 1\ndrop f1\n".repeat(50_000);
    assert!(read_knitout(&format!("{HEAD}in 1\n{dropped}")).is_ok());
    let header = format!(";!knitout-2\n;;Carriers:{}\n", " 1".repeat(50_000));
    assert_eq!(read_knitout(&header).unwrap_err().line, 2);
    // Minutes before; now less than a second.
    assert!(began.elapsed().as_secs() < 20, "{:?}", began.elapsed());
}

#[test]
fn cables_are_recognised() {
    let text = format!(
        "{CAST_ON}xfer f1 b1\nxfer f2 b2\nrack 1\nxfer b1 f2\nrack -1\nxfer b2 f1\nrack 0\n;!source: braid.js:7\nknit - f2 1\nknit - f1 1\n"
    );
    let error = read_knitout(&format!("{HEAD}{text}")).unwrap_err();
    assert!(matches!(*error.reason, KnitoutErrorReason::Cable { other } if other == 16), "{error}");
    assert_eq!(error.line, 17);
    assert!(error.to_string().ends_with("(made from braid.js:7)"));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_text_is_read_or_refused(text in ".{0,200}") {
        let _ = read_knitout(&text);
        let _ = read_knitout(&format!(";!knitout-2\n{text}"));
    }

    #[test]
    fn almost_right_programs_are_read_or_refused(
        lines in prop::collection::vec(
            (
                prop::sample::select(vec!["knit", "tuck", "split", "xfer", "drop", "miss", "rack", "in", "inhook", "releasehook", "out", "stitch"]),
                prop::sample::select(vec!["+", "-", "f1", "1", "-1", "0.5"]),
                prop::sample::select(vec!["f1", "f2", "b1", "b2", "fs1", "", "1"]),
                prop::sample::select(vec!["1", "2", "b1", "f2", "", "1 2"]),
            ),
            0..60,
        )
    ) {
        let body: String = lines.iter().map(|(a, b, c, d)| format!("{a} {b} {c} {d}\n")).collect();
        let text = format!("{HEAD}in 1\nin 2\ntuck - f2 1\ntuck - f1 1\n{body}");
        match read_knitout(&text) {
            Ok(knitted) => {
                let on_yarns: usize = knitted.graph.strands.iter().map(|strand| {
                    strand.stops.iter().filter(|(stop, _)| matches!(stop, Stop::Loop { .. })).count()
                }).sum();
                prop_assert_eq!(on_yarns, knitted.graph.loops.len());
            }
            Err(error) => prop_assert!(error.line <= lines.len() + 6 && text.get(error.span.clone()).is_some()),
        }
    }
}
