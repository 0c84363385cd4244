//! What written instructions give, and how bad ones are refused.

use super::*;
use crate::pattern::Side;
use crate::pattern::stitch::Stitch;
use crate::pattern::symbols::write_symbols;
use proptest::prelude::*;

/// The chart's rows, the first worked first.
fn rows(text: &str) -> Vec<String> {
    let mut lines = write_symbols(&read_instructions(text, None).unwrap().chart);
    lines.reverse();
    lines
}

fn refused(text: &str) -> (String, String) {
    let error = read_instructions(text, None).unwrap_err();
    (error.to_string(), text[error.span.clone()].to_owned())
}

#[test]
fn right_side_rows_run_right_to_left_and_wrong_side_rows_show_their_back() {
    let text = "Cast on 5\nRow 1 (RS): k3, p2\nRow 2 (WS): k3, p2\n";
    assert_eq!(rows(text), ["ppkkk", "pppkk"]);
    let text = "Cast on 5\nRnd 1: k3, p2\nRnd 2: k3, p2\n";
    assert_eq!(rows(text), ["ppkkk", "ppkkk"]);
    let text = "Cast on 5\nRow 1 (WS): k3, p2\n";
    assert_eq!(rows(text), ["pppkk"]);
}

#[test]
fn a_row_worked_again_from_the_other_side_is_worked_alike_not_looking_alike() {
    assert_eq!(rows("Cast on 2\nRow 1: knit\nRows 2-4: rep row 1\n"), ["kk", "pp", "kk", "pp"], "garter");
    assert_eq!(rows("cast on 2 sts.\nROW 1: K\nrow 2: purl across\nRep rows 1-2 twice"), ["kk"; 6], "stockinette");
}

#[test]
fn repeats_of_every_form_fill_the_row() {
    for row in [
        "*k2, p2*",
        "*k2, p2; rep from * to end",
        "*k2, p2*; rep from * to last 4 sts, k2, p2",
        "*k2, p2; rep from * 2 more times",
        "[k2, p2] 3 times",
        "(k2, p2) to end of row",
        "k2, p2, *k2, p2*, k2, p2",
        "k2, p2, [k2, [p] twice] 2 times",
        "[k 2 sts, purl 2] x3",
        "k2, (p2, k2) 2 times, p to end",
        "k2, p2, k2, p2, k to last 2 sts, p2",
        "k2 p2 *k2 p2*",
    ] {
        let text = format!("Cast on 12\nRnd 1: {row}\n");
        assert_eq!(rows(&text), ["ppkkppkkppkk"], "{row}");
    }
}

#[test]
fn rows_may_come_in_any_order_and_in_lists() {
    let text = "Cast on 1\nRow 2: k\nRows 1, 3 and 5-6: k # comment\nRow 4 (WS): p\n";
    assert_eq!(rows(text), ["k", "p", "k", "k", "k", "p"]);
}

#[test]
fn counts_that_do_not_work_out_are_named() {
    let head = "Cast on 10\nRow 1: ";
    let cases = [
        (
            "*k2, p2*",
            "row 1: `*k2, p2*` repeats 4 stitches, but 10 of the 10 stitches are left for it, which is no multiple",
            "*k2, p2*",
        ),
        ("k4, p4, k4, p1", "row 1: up to `k4` the row takes 12 stitches, but there are 10", "k4"),
        ("k4, p4", "row 1: the row ends with `p4` after 8 stitches, but there are 10", "p4"),
        ("*k1*, *p1*", "row 1: `*p1*` stretches to fill the row, which only one part of a row can do here", "*p1*"),
        (
            "k2, (k, yo) in next st, k7",
            "row 1: `(k, yo)` cannot be worked into one stitch: 2 to 9 knits, purls and single yarn-overs between them can",
            "(k, yo)",
        ),
        ("k2, (k, p) in them, k7", "row 1: expected `next st`, found `them`", "them"),
        ("k2, sl1 with yarn up, k7", "row 1: expected `front` or `back`, found `up`", "up"),
        ("*yo*, k10", "row 1: `*yo*` takes no stitch of the row below, so it cannot fill the row", "*yo*"),
        ("k0", "row 1: a count must be from 1 to 16000000, not `0`", "k0"),
        ("[] 3 times", "row 1: there is nothing to repeat", "[]"),
        ("[k1", "row 1: expected the closing bracket, found the end of the line", ""),
        ("[k1)", "row 1: expected a stitch, found `)`", ")"),
        (
            "k to last 11 sts, p11",
            "row 1: up to `k to last 11 sts` the row takes 11 stitches, but there are 10",
            "k to last 11 sts",
        ),
    ];
    for (row, message, underlined) in cases {
        let (found, place) = refused(&format!("{head}{row}\n"));
        assert_eq!((found.as_str(), place.as_str()), (message, underlined));
    }
}

#[test]
fn texts_that_make_no_sense_as_a_whole_are_refused() {
    let cases = [
        ("", "there are no rows"),
        ("Cast on 3\n", "there are no rows"),
        ("Row 1: k3\n", "the number of stitches is unknown: no `Cast on` line, and the scene gives no columns"),
        ("Cast on 3\nCast on 3\n", "the stitches were cast on before"),
        ("Cast on 0\n", "a count must be from 1 to 16000000, not `0`"),
        ("Cast on 3\nRow 2: k3\n", "row 1 is missing"),
        ("Cast on 3\nRow 1: k3\nRow 1: p3\n", "row 1 was given before"),
        ("Cast on 3\nRow 1: k3\nRnd 2: k3\n", "rows (flat) and rounds cannot be mixed"),
        (
            "Cast on 3\nRow 1 (RS): k3\nRow 2 (RS): k3\n",
            "row 2: it cannot be a right-side (RS) row: sides alternate, and row 1 is a right-side (RS) row",
        ),
        (
            "Cast on 3\nRnd 1 (WS): k3\n",
            "row 1: it cannot be a wrong-side (WS) row: sides alternate, and rounds are worked from the right side",
        ),
        ("Cast on 3\nRow 1: rep rows 1-2\n", "row 1: rows 1–2 are not worked before it"),
        (
            "Cast on 3\nRow 1: k\nRow 2: p\nRows 3-5: rep rows 1-2\n",
            "row 3: 3 rows repeat 2 rows, which is no multiple",
        ),
        ("Work even\n", "a line starts with `Cast on`, `Row`, `Rnd`, `Rep rows` or `Bind off`, not with `Work`"),
        (
            "Cast on 16000000\nRow 1: k\nRow 2: k\n",
            "16000000 columns × 2 rows are 32000000 loops, the limit is 16000000",
        ),
        (
            "Cast on 1\nRow 1: k\nRep rows 1-1 16000000 times\nRep rows 1-1 16000000 times",
            "1 columns × 32000001 rows are 32000001 loops, the limit is 16000000",
        ),
    ];
    for (text, message) in cases {
        assert_eq!(refused(text).0, message);
    }
}

#[test]
fn nesting_and_size_are_bounded() {
    let deep = format!("Cast on 3\nRow 1: {}k1{}\n", "[".repeat(9999), "]".repeat(9999));
    assert!(refused(&deep).0.contains("nested deeper than 32"));
    // Thirty doublings of a doubling, and so on: refused by arithmetic, never laid out.
    let bomb = format!("Cast on 3\nRow 1: {}k1{}\n", "[".repeat(30), "] 15000000 times".repeat(30));
    assert!(refused(&bomb).0.contains("a count must be"));
    let long = "#".repeat(LARGEST_TEXT + 1);
    assert!(refused(&long).0.contains("the limit is"));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn written_charts_read_back(
        columns in 1_usize..9,
        stitches in prop::collection::vec(any::<bool>(), 1..60),
        working in prop::sample::select(vec![
            Working::Round,
            Working::Flat { first_row: Side::RightSide },
            Working::Flat { first_row: Side::WrongSide },
        ]),
    ) {
        let stitch = |knit: &bool| if *knit { Stitch::Knit } else { Stitch::Purl };
        let rows: Vec<Vec<Stitch>> = stitches
            .chunks(columns)
            .map(|row| row.iter().map(stitch).cycle().take(columns).collect())
            .collect();
        let chart = Chart::new(rows).unwrap();
        let written = read_instructions(&write_instructions(&chart, working), None).unwrap();
        prop_assert_eq!(&written.chart, &chart);
        prop_assert_eq!(written.working, working);
        prop_assert_eq!(written.cast_on, Some(columns as u64));
    }

    #[test]
    fn any_text_is_read_or_refused(text in ".{0,200}") {
        let _ = read_instructions(&text, Some(8));
    }

    #[test]
    fn almost_right_text_is_read_or_refused(
        words in prop::collection::vec(
            prop::sample::select(vec![
                "Cast on 8", "\nRow 1", "\nRow 2 (WS)", "\nRnds 1-2", ":", "*", "[", "]", "(", ")", ",", ";",
                "k2", "p", "knit", "to end", "to last 2 sts", "rep from *", "3 times", "rep rows 1-2", "x",
                "\nRep rows 1", "twice", "-", "with A", "yo", "kfb", "k2tog", "in next st", "tbl", "psso", "c4f", "2/2 LC", "and all WS rows", "and every alternate row", "for pattern", "sl1", "wyif", "m1", "99999999999999999999", "#", "×",
            ]),
            0..30,
        )
    ) {
        if let Err(error) = read_instructions(&words.join(" "), Some(8)) {
            prop_assert!(words.join(" ").get(error.span.clone()).is_some(), "a span outside the text");
        }
    }
}

#[test]
fn a_stitch_that_is_not_known_is_named_with_those_that_are() {
    let (message, place) = refused("Cast on 10\nRow 1: k2, bobble, k4\n");
    assert!(
        message.starts_with("row 1: `bobble` is no stitch that wale knows; it knows k, p, yo, k2tog, ssk"),
        "{message}"
    );
    assert_eq!(place, "bobble");
}

#[test]
fn cables_and_twisted_stitches_are_refused_as_what_they_are() {
    for (row, place) in [
        ("k2, c4f, k4", "c4f"),
        ("C6B, k4", "C6B"),
        ("k2, 2/2 LC, k4", "2/2 LC"),
        ("k2, 1/2/1 RPC, k4", "1/2/1 RPC"),
        ("k2, t3l, k5", "t3l"),
    ] {
        let (message, underlined) = refused(&format!("Cast on 10\nRow 1: {row}\n"));
        assert!(
            message.starts_with(&format!("row 1: `{place}` is a cable: loops that cross cannot be held")),
            "{message}"
        );
        assert_eq!(underlined, place);
    }
    for (row, place) in [
        ("k2, k1tbl, k7", "k1tbl"),
        ("*ktbl, p1*", "ktbl"),
        ("k2, p1 tbl, k7", "p1 tbl"),
        ("k tbl to end", "k tbl"),
        ("knit 10 sts tbl", "knit 10 sts tbl"),
        ("ssk tbl, k8", "ssk tbl"),
    ] {
        let (message, underlined) = refused(&format!("Cast on 10\nRow 1: {row}\n"));
        assert!(message.starts_with(&format!("row 1: `{place}` is a twisted stitch")), "{message}");
        assert_eq!(underlined, place);
    }
}

#[test]
fn decreases_are_read_by_every_name_that_knitters_give_them() {
    let stitch = |decrease: &str| {
        let row = rows(&format!("Cast on 6\nRow 1: k1, {decrease}, k to end\n")).remove(0);
        row.chars().rev().nth(1).unwrap()
    };
    // Leaning to the left, the first loop over the others.
    for decrease in [
        "ssk",
        "skp",
        "skpo",
        "sl1, k1, psso",
        "sl1-k1-psso",
        "sl 1 knitwise, k1, pass slipped st over",
        "k2tog tbl",
        "k2togtbl",
    ] {
        assert_eq!(stitch(decrease), '\\', "{decrease}");
    }
    for decrease in ["sssk", "sk2p", "sl1-k2tog-psso", "sl1, k2tog, psso", "slip 1, k2tog, psso", "k3tog tbl"] {
        assert_eq!(stitch(decrease), '<', "{decrease}");
    }
    for decrease in ["cdd", "s2kp", "s2kp2", "s2kpo", "sl2-k1-p2sso", "sl 2 tog kwise, k1, p2sso"] {
        assert_eq!(stitch(decrease), '^', "{decrease}");
    }
    for (decrease, symbol) in [
        ("p2tog tbl", 'l'),
        ("ssp", 'l'),
        ("p3tog tbl", 'L'),
        ("sl1, p1, psso", 'r'),
        ("slip 1 purlwise, purl 1, pass slipped st over", 'r'),
        ("sl1-p2tog-psso", 'R'),
    ] {
        assert_eq!(stitch(decrease), symbol, "{decrease}");
    }
    // What only begins like one is slipped, knitted and purled.
    assert_eq!(rows("Cast on 3\nRow 1: sl1, k1, p1\n"), ["pkV"]);
    assert_eq!(rows("Cast on 3\nRow 1: sl1, p1, k1\n"), ["kpV"]);
    assert_eq!(rows("Cast on 4\nRow 1: sl1, p2tog, p1\n"), ["prV"]);
    // On the wrong side it leans to the right as seen from the front, as `p2tog` does.
    assert_eq!(rows("Cast on 2\nRow 1: k\nRow 2: sl1, p1, psso\n"), rows("Cast on 2\nRow 1: k\nRow 2: p2tog\n"));
}

#[test]
fn every_second_row_is_said_once() {
    let seven = "Row 1 (RS): k\nRow 3: k1, p1, k1\nRow 5: k\nRow 7: p\n";
    for second in [
        "Row 2 and all WS rows: purl",
        "Row 2 (WS) and all following WS rows: purl",
        "Row 2 and every alternate row: Purl",
        "Row 2 (and all even-numbered rows): purl to end",
        "Row 2, and every other row: p across",
        "Row 2 and all other wrong-side rows: p3",
        "Row 2 (WS) and every foll alt row: Purl.",
    ] {
        let text = format!("Cast on 3\n{seven}{second}\n");
        assert_eq!(rows(&text), ["kkk", "kkk", "kpk", "kkk", "kkk", "kkk", "ppp", "kkk"], "{second}");
    }
    // Rows that a line says go before; from another row on another one; what is repeated has the last row, too.
    let text =
        "Cast on 1\nRow 2 and all WS rows: p\nRow 1: k\nRow 3: k\nRow 4: k\nRow 5: k\nRow 7: k\nRep rows 7-8 once\n";
    assert_eq!(rows(text), ["k", "k", "k", "p", "k", "k", "k", "k", "k", "k"]);
    let text = "Cast on 1\nRow 2 and all WS rows: p\nRow 1 and all RS rows: k\nRow 6 and all WS rows: k\nRow 9: k\n";
    assert_eq!(refused(text).0, "row 3 is missing", "more than one row between two that are said");
    assert_eq!(rows("Cast on 1\nRow 1 and every alt row: k\nRow 2: p\nRow 4: k\n"), ["k", "k", "k", "p"]);
    let cases = [
        ("Row 2 and all odd rows: p", "row 2: `all odd rows` would leave out row 2 itself", "all odd rows"),
        (
            "Row 2 and all other rows: p",
            "row 2: expected `WS rows`, `even rows` or `alternate rows`, found `rows`",
            "rows",
        ),
        ("Row 2 and all rows: p", "row 2: expected `WS rows`, `even rows` or `alternate rows`, found `rows`", "rows"),
        (
            "Row 2 and all RS rows: p",
            "row 2: it cannot be a right-side (RS) row: sides alternate, and row 1 is a right-side (RS) row",
            "all RS rows",
        ),
    ];
    for (second, message, place) in cases {
        let (found, underlined) = refused(&format!("Cast on 3\n{seven}{second}\n"));
        assert_eq!((found.as_str(), underlined.as_str()), (message, place));
    }
    // The row whose stitches do not work out is told, though no line says it.
    let (message, place) = refused("Cast on 4\nRow 1: k\nRow 2 and all WS rows: p4\nRow 3: k2tog, k2\n");
    assert_eq!(
        (message.as_str(), place.as_str()),
        ("row 4: up to `p4` the row takes 4 stitches, but there are 3", "p4")
    );
}

#[test]
fn lace_of_a_stitch_dictionary_is_read() {
    let text = include_str!("../../../tests/corpus/instructions/lace-of-a-stitch-dictionary.knit");
    let plain = "k".repeat(21);
    let eyelets = "kkkkko\\k\\o".repeat(2) + "k";
    let arrows = "k".to_owned() + &"o<ok".repeat(5);
    let edges = format!("\\o{}o/", "k".repeat(17));
    let fans = "okko<".repeat(4) + "k";
    let expected = [&eyelets, &plain, &arrows, &plain, &edges, &plain, &fans, &plain];
    assert_eq!(rows(text).iter().collect::<Vec<_>>(), expected);
}

#[test]
fn a_repeat_without_a_count_is_of_all_rows() {
    let four = "Cast on 1\nRows 1 and 3: knit\nRows 2, 4: purl\n";
    for repeat in ["Rep rows 1-4", "Rep Rows 1–4 for pattern.", "Repeat rows 1 to 4."] {
        assert_eq!(rows(&format!("{four}{repeat}\n")), rows(four), "{repeat}");
    }
    let (message, place) = refused(&format!("{four}Rep rows 3-4\n"));
    assert_eq!(
        message,
        "how often rows 3–4 are repeated must be said, `3 more times`, as they are not all of the 4 rows"
    );
    assert_eq!(place, "Rep rows 3-4");
}

#[test]
fn rows_are_counted_by_what_the_row_before_leaves() {
    let text = "Cast on 3\nRow 1 (RS): kfb, k1, m1, k1\nRow 2: p\nRow 3: ssk, k1, k2tog\nRow 4: p3tog\n";
    assert_eq!(rows(text), ["kmkf", "kkkkk", "/k\\", ">"]);
    let (message, _) = refused("Cast on 3\nRow 1: k2tog, k1\nRow 2: p3\n");
    assert_eq!(message, "row 2: up to `p3` the row takes 3 stitches, but there are 2");
}

#[test]
fn increases_slips_and_yarns_are_read() {
    let text = "Cast on 4\nRow 1 (RS): with A, k1, (k1, yo, k1) in next st, sl1 purlwise wyif, with B, k1\nRow 2 (WS): with A, sl 2 wyib, k to end\n";
    let written = read_instructions(text, None).unwrap();
    let Stitch::Increase(parts) = written.chart.rows()[0][2] else { panic!("{:?}", written.chart) };
    assert_eq!(parts.to_string(), "(k, yo, k) in 1 st");
    assert_eq!(written.chart.rows()[0][1], Stitch::Slip { in_front: true });
    // From behind, the yarn that is held at the back passes in front.
    assert_eq!(written.chart.rows()[1][0], Stitch::Slip { in_front: true });
    assert_eq!(written.yarns, ["A", "B"]);
    assert_eq!((written.chart.yarn(0, 0), written.chart.yarn(0, 3), written.chart.yarn(1, 0)), (1, 0, 0));
    assert_eq!(
        read_instructions(&write_instructions(&written.chart, written.working), None).unwrap().chart,
        written.chart
    );
}

#[test]
fn lace_is_read_as_knitters_write_it() {
    let text = "Cast on 18\nRow 1 (RS): *k2tog 3 times, [yo, k1] 6 times, k2tog 3 times*\nRow 2 (WS): p7, p2tog, yo, ssp, yo, p7\n";
    let written = read_instructions(text, None).unwrap();
    // Right-side rows are worked from the right, wrong-side rows are turned over.
    let drawn: Vec<String> = write_symbols(&written.chart);
    assert_eq!(drawn, ["kkkkkkk/o\\okkkkkkk", "///kokokokokoko///"]);
    assert_eq!(read_instructions(&write_instructions(&written.chart, written.working), None).unwrap(), written);
}

#[test]
fn changing_yarns_over_and_over_is_nothing_to_repeat() {
    for row in
        ["[with B] 16000000 times, k4", "[[with B, with A] 9999999 times] 9999999 times, k4", "*with B* 3 times, k4"]
    {
        let (message, place) = refused(&format!("Cast on 4\nRow 1: {row}\n"));
        assert_eq!(message, "row 1: there is nothing to repeat", "{row}");
        assert!(place.contains("with B"), "{place}");
    }
    assert!(read_instructions("Cast on 4\nRow 1: [with B, k1, with A, k1] 2 times\n", None).is_ok());
    // Of many yarns the last is knitted with, and the others are no work: a million times 30,000 changes would take minutes.
    let changes = "with A, with B, ".repeat(15_000);
    let read = |changes: &str| {
        let text = format!("Cast on 1000000\nRow 1: [with A, k1, {changes}k1] 500000 times\n");
        read_instructions(&text, None).unwrap()
    };
    assert_eq!(read(&changes), read("with B, "));
}

#[test]
fn yarns_that_are_held_together_are_one() {
    let yarns = |row: &str| {
        let text = format!("Cast on 4\nRow 1: {row}\n");
        read_instructions(&text, None).unwrap_or_else(|error| panic!("{row}: {error}")).yarns
    };
    for row in [
        "with A and B held together, k4",
        "with A and B together, k4",
        "with yarns A, and B held together k",
        "with A + B held together, *k2*",
        "with 1 strand each of A and B held together, k to end",
        "with one strand each of A and B together, k4",
    ] {
        assert_eq!(yarns(row), ["A B"], "{row}");
    }
    assert_eq!(yarns("with MC, C1 & C2 held together, k2, with MC, k2"), ["MC C1 C2", "MC"]);
    for row in ["with A held double, k4", "with two strands of A, k4", "with 2 strands of A held together, k4"] {
        assert_eq!(yarns(row), ["A A"], "{row}");
    }
    // What follows a yarn is no other one.
    assert_eq!(yarns("with A, k2, k2tog"), ["A"]);
    assert_eq!(yarns("with A and k2, then with B, k2"), ["A", "B"]);
    let many: String = (0..17).map(|yarn| format!("y{yarn}, ")).collect();
    assert!(read_instructions(&format!("Cast on 4\nRow 1: with {many}held together, k4\n"), None).is_err());
}
