//! What programs become, and how bad ones are refused.

use std::collections::BTreeSet;

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

/// Needles cast on, the last one first, and knitted once by carrier 1.
fn knitted_once(needles: &[&str]) -> String {
    let row = |word: &str, way: &str, needles: &mut dyn Iterator<Item = &&str>| {
        needles.map(|needle| format!("{word} {way} {needle} 1\n")).collect::<String>()
    };
    format!("in 1\n{}{}", row("tuck", "-", &mut needles.iter().rev()), row("knit", "+", &mut needles.iter()))
}

#[track_caller]
fn assert_cable(lines: &str, first: &str, second: &str) {
    let error = read_knitout(&format!("{HEAD}{lines}")).expect_err("loops are crossed");
    let KnitoutErrorReason::Cable { other } = *error.reason else { panic!("{error}") };
    let line = |number: usize| lines.lines().nth(number - 3).unwrap();
    assert_eq!((line(other), line(error.line)), (first, second), "{error}");
    assert!(error.to_string().contains("a cable"), "{error}");
}

#[test]
fn a_knit_wale_that_crosses_a_purl_wale_is_a_cable() {
    // The knit wale goes from f0 by b0 to f4 and on to f2, the purl wale from b2 by f2 to b0.
    let crossed = "xfer f0 b0\nrack 4\nxfer b0 f4\nrack 0\nxfer b2 f2\nrack 2\nxfer f2 b0\nrack 0\nxfer f4 b4\n\
                   rack -2\nxfer b4 f2\nrack 0\n";
    let start = knitted_once(&["f0", "b2"]);
    assert_cable(&format!("{start}{crossed}knit - f2 1\nknit - b0 1\n"), "knit - f2 1", "knit - b0 1");
    // They may go anywhere else as long as neither passes the other.
    knitted(&format!("{start}xfer f0 b0\nrack 1\nxfer b0 f1\nrack 0\nknit - b2 1\nknit - f1 1\n"));
}

#[test]
fn wales_of_two_carriers_cross_in_a_cable() {
    let other = |way: &str, needles: [&str; 2]| needles.map(|needle| format!("knit {way} {needle} 2\n")).concat();
    let start = format!(
        "in 1\nin 2\ntuck - f1 1\ntuck - f0 1\ntuck - f3 2\ntuck - f2 2\nknit + f0 1\nknit + f1 1\n{}",
        other("+", ["f2", "f3"])
    );
    let crossed = "xfer f1 b1\nxfer f2 b2\nrack 1\nxfer b1 f2\nrack -1\nxfer b2 f1\nrack 0\n";
    // Yarns that stay where they are, and yarns that go with their wales.
    let stay = format!("{start}{crossed}knit - f1 1\nknit - f0 1\n{}", other("-", ["f3", "f2"]));
    assert_cable(&stay, "knit - f1 1", "knit - f2 2");
    let go = format!("{start}{crossed}knit - f2 1\nknit - f0 1\n{}", other("-", ["f3", "f1"]));
    assert_cable(&go, "knit - f2 1", "knit - f1 2");
    // A knit wale of the one and a purl wale of the other: nothing but their rows says that they are neighbours.
    let start = "in 1\nin 2\ntuck - f0 1\ntuck - b2 2\nknit + f0 1\nknit + b2 2\n";
    let crossed = "xfer b2 f2\nxfer f0 b0\nrack 4\nxfer b0 f4\nrack 2\nxfer f2 b0\nrack 0\n";
    assert_cable(&format!("{start}{crossed}knit - f4 1\nknit - b0 2\n"), "knit - f4 1", "knit - b0 2");
}

#[test]
fn wales_cross_in_a_cable_in_whatever_order_they_are_knitted() {
    let start = knitted_once(&["f0", "f1", "f2", "f3"]);
    let crossed = "xfer f1 b1\nxfer f2 b2\nrack 1\nxfer b1 f2\nrack -1\nxfer b2 f1\nrack 0\n";
    for (order, first, second) in [
        (["- f3", "- f2", "- f1", "- f0"], "knit - f2 1", "knit - f1 1"),
        // Another loop between them, on its needle or over an empty one.
        (["- f2", "- f9", "- f1", "- f0"], "knit - f2 1", "knit - f1 1"),
        // To and fro.
        (["- f3", "- f1", "+ f0", "+ f2"], "knit - f1 1", "knit + f2 1"),
    ] {
        let row: String = order.map(|at| format!("knit {at} 1\n")).concat();
        assert_cable(&format!("{start}{crossed}{row}"), first, second);
    }
    // Two wales over two others.
    let over = "xfer f0 b0\nxfer f1 b1\nrack 4\nxfer b0 f4\nxfer b1 f5\nrack 0\nxfer f2 b2\nxfer f3 b3\nrack -2\nxfer b2 f0\n\
                xfer b3 f1\nrack 0\n";
    let row: String = ["f5", "f4", "f1", "f0"].map(|at| format!("knit - {at} 1\n")).concat();
    assert_cable(&format!("{start}{over}{row}"), "knit - f5 1", "knit - f1 1");
}

#[test]
fn what_only_looks_like_a_cable_is_knitted() {
    // The front of a tube goes two needles to the right, its back two to the left.
    let start = knitted_once(&["f0", "f2", "f4"]) + "knit - b5 1\nknit - b3 1\nknit - b1 1\n";
    let tube = format!("{start}knit + f0 1\nknit + f2 1\nknit + f4 1\nknit - b5 1\nknit - b3 1\nknit - b1 1\n");
    let front: String =
        [4, 2, 0].map(|at| format!("xfer f{at} b{at}\nrack 2\nxfer b{at} f{}\nrack 0\n", at + 2)).concat();
    let back: String =
        [1, 3, 5].map(|at| format!("xfer b{at} f{at}\nrack 2\nxfer f{at} b{}\nrack 0\n", at - 2)).concat();
    let turned = "knit + f2 1\nknit + f4 1\nknit + f6 1\nknit - b3 1\nknit - b1 1\nknit - b-1 1\n";
    knitted(&format!("{tube}{front}{back}{turned}"));
    // The back bed of a rib is racked to and fro.
    let rib = knitted_once(&["f0", "b0", "f1", "b1"]);
    let row = |rack: &str, needles: [&str; 4]| {
        format!("rack {rack}\n{}", needles.map(|needle| format!("knit - {needle} 1\n")).concat())
    };
    knitted(&format!("{rib}{}{}", row("0.5", ["b1", "f1", "b0", "f0"]), row("-0.5", ["f1", "b1", "f0", "b0"])));
    // Two stitches together, and a yarn-over where one of them was.
    let lace = knitted_once(&["f0", "f1", "f2", "f3"]);
    knitted(&format!(
        "{lace}xfer f1 b1\nrack 1\nxfer b1 f2\nrack 0\nknit - f3 1\nknit - f2 1\nknit - f1 1\nknit - f0 1\n"
    ));
    // Loops that wait while others are worked twice; what waits is moved over to them, and they have moved before.
    let waiting = "knit - f3 1\nknit + f3 1\nxfer f3 b3\nrack 6\nxfer b3 f9\nrack 0\n";
    let moved: String =
        [0, 1, 2].map(|at| format!("xfer f{at} b{at}\nrack 4\nxfer b{at} f{}\nrack 0\n", at + 4)).concat();
    knitted(&format!("{lace}{waiting}{moved}knit - f9 1\nknit - f6 1\nknit - f5 1\nknit - f4 1\n"));
}

#[test]
fn a_loop_that_is_dropped_hangs_free_and_a_miss_makes_none() {
    let start = knitted_once(&["f0", "f1", "f2"]);
    let row = "knit - f2 1\nknit - f0 1\n";
    // By their lines: what is dropped, and what is on the needles at the end.
    let unsupported = |lines: &str| knitted(lines).graph.unsupported().map(|of| of.source - 2).collect::<BTreeSet<_>>();
    assert_eq!(unsupported(&format!("{start}drop f1\n{row}")), BTreeSet::from([6, 9, 10]));
    let again = "knit + f0 1\nknit + f1 1\nknit + f2 1\n";
    let held = format!("{start}knit - f2 1\nmiss - f1 1\nknit - f0 1\n{again}");
    assert_eq!(parents(&knitted(&held), 12), [6], "what was missed is on its needle still");
    assert_eq!(unsupported(&held), BTreeSet::from([11, 12, 13]));
    assert_eq!(knitted(&held).graph.longest_float(), 1, "and the yarn floated past it");
    let dropped = format!("{start}knit - f2 1\ndrop f1\nknit - f0 1\n{again}");
    let open = knitted(&dropped).graph.loops.iter().find(|of| of.source == 14).unwrap().clone();
    assert_eq!((open.form, open.parents.len()), (Form::Open, 0));
    assert_eq!(unsupported(&dropped), BTreeSet::from([6, 11, 12, 13]));
    assert_eq!(knitted(&dropped).graph.longest_float(), 0, "the yarn passes nothing where the needle is empty");
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
