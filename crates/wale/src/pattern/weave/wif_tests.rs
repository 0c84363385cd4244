//! Drafts that are read, dialects that are understood, and files that are refused with the place.

use super::*;
use crate::pattern::Remark;
use proptest::prelude::*;

const TWILL: &str = "[WIF]\nVersion=1.1\n[WEAVING]\nShafts=4\nTreadles=4\n[WARP]\nThreads=4\nUnits=centimeters\nSpacing=0.1\nColor=1\n\
    [WEFT]\nThreads=4\nColor=2\n[COLOR PALETTE]\nRange=0,999\n[COLOR TABLE]\n1=999,0,0\n2=0,0,999\n\
    [THREADING]\n1=1\n2=2\n3=3\n4=4\n[TIEUP]\n1=1,2\n2=2,3\n3=3,4\n4=1,4\n[TREADLING]\n1=1\n2=2\n3=3\n4=4\n";

fn drawn(text: &str) -> String {
    format!("{:?}", read_wif(text.as_bytes()).unwrap_or_else(|error| panic!("{error}")).draft)
}

fn refused(text: &str) -> (String, String) {
    let error = read_wif(text.as_bytes()).unwrap_err();
    (error.to_string(), text[error.span.clone()].to_owned())
}

#[test]
fn a_twill_is_read_with_its_threads() {
    let wif = read_wif(TWILL.as_bytes()).unwrap();
    assert_eq!(format!("{:?}", wif.draft), "\nx..x\n..xx\n.xx.\nxx..");
    assert_eq!((wif.draft.warp[0].color, wif.draft.weft[3].color), (Some([255, 0, 0]), Some([0, 0, 255])));
    assert_eq!((wif.draft.warp[2].spacing, wif.draft.weft[0].spacing), (Some(0.001), None));
    assert!(wif.remarks.is_empty());
}

#[test]
fn lift_plans_sinking_sheds_and_counting_from_zero() {
    let sinking = TWILL.replace("Treadles=4\n", "Treadles=4\nRising Shed=no\n");
    assert_eq!(drawn(&sinking), "\n.xx.\nxx..\nx..x\n..xx");
    let plan = format!("{TWILL}[LIFTPLAN]\n1=1\n2=2,4\n3=\n4=0\n");
    assert_eq!(drawn(&plan), "\n....\n....\n.x.x\nx...");
    assert!(
        read_wif(plan.as_bytes()).unwrap().remarks.iter().any(|remark| remark.what.contains("the lift plan counts"))
    );
    let from_zero = TWILL.replace("[THREADING]\n1=1\n2=2\n3=3\n4=4\n", "[THREADING]\n0=1\n1=2\n2=3\n3=4\n");
    assert_eq!(drawn(&from_zero), drawn(TWILL));
}

#[test]
fn liberties_of_programs_are_taken_with_a_remark() {
    let text = format!(
        "rubbish\n\u{feff}{TWILL}[contents]\nTIEUP=true\ntieup=yes\n[PRIVATE X]\n1=1\n1=2\n[NOTES]\n1=a\n1=b\n"
    );
    let wif = read_wif(text.replace('\n', "\r\n").as_bytes()).unwrap();
    assert_eq!(format!("{:?}", wif.draft), drawn(TWILL));
    let before = "text before the first section is passed over";
    assert!(wif.remarks.contains(&Remark { line: 1, what: before.to_owned() }), "{:?}", wif.remarks);
}

#[test]
fn lengths_that_a_fabric_does_not_take_are_remarked_once_with_their_line() {
    let remarks = |text: &str| {
        let remarks = read_wif(text.as_bytes()).unwrap_or_else(|error| panic!("{error}")).remarks;
        remarks.into_iter().map(|Remark { line, what }| (line, what)).collect::<Vec<_>>()
    };
    let no_units = TWILL.replace("Units=centimeters\n", "");
    assert_eq!(remarks(&no_units), [(8, "[WARP] has no Units, so that its spacing is passed over".to_owned())]);
    let mean = "the threads of [WARP] are not evenly spaced: a fabric has their mean everywhere, or the scene's sett";
    assert_eq!(remarks(&format!("{TWILL}[WARP SPACING]\n2=0.2\n3=0.2\n")), [(9, mean.to_owned())]);
    // Said for each thread, but evenly.
    assert_eq!(remarks(&format!("{TWILL}[WARP SPACING]\n2=0.1\n")), []);
    let thick = "thickness of [WEFT] is passed over: the yarns say how thick they are";
    assert_eq!(remarks(&format!("{TWILL}[WEFT THICKNESS]\n1=\n2=0.2\n3=0.2\n")), [(36, thick.to_owned())]);
    assert_eq!(remarks(&TWILL.replace("Color=2", "Units=cm\nThickness=0.02")), [(14, thick.to_owned())]);
}

#[test]
fn a_missing_section_is_told_where_the_contents_promise_it() {
    let promised = TWILL.replace("[WIF]\n", "[WIF]\n[CONTENTS]\nTieup=yes\n").replace("[TIEUP]", "[OTHER]");
    assert_eq!(
        refused(&promised),
        (
            "line 3: there is no section [TIEUP], which says which shafts each treadle lifts".to_owned(),
            "Tieup=yes".to_owned()
        )
    );
    assert_eq!(refused(&TWILL.replace("[TIEUP]", "[OTHER]")).1, "[WIF]");
    assert_eq!(
        refused(&TWILL.replace("[WIF]", "[WIG]")),
        ("line 1: this is no WIF: there is no section [WIF]".to_owned(), "[WIG]".to_owned())
    );
}

#[test]
fn bad_files_name_the_line_and_the_reason() {
    let cases = [
        ("2=0,0,999", "2=0,0,1000", "`0,0,1000` is no colour within the palette's Range", "2=0,0,1000"),
        ("Color=2", "Color=3", "colour 3 is not in [COLOR TABLE]", "Color=3"),
        (
            "4=4\n[TIEUP]",
            "4=4\n4=3\n[TIEUP]",
            "[THREADING] 4 was given as `4` at line 23 and is given as `3` here",
            "4=3",
        ),
        ("4=4\n[TIEUP]", "4=4\n5=1\n[TIEUP]", "end 5 does not exist: there are 4", "5=1"),
        ("4=1,4", "4=1,9", "shaft 9 does not exist: there are 4", "4=1,9"),
        ("[TREADLING]\n1=1", "[TREADLING]\n1=5", "treadle 5 does not exist: there are 4", "1=5"),
        (
            "Threads=4\nColor=2",
            "Threads=4000000000\nColor=2",
            "4 ends × 4000000000 picks are 16000000000 crossings, the limit is 16000000",
            "Threads=4000000000",
        ),
        ("Threads=4\nColor=2", "Threads=-1\nColor=2", "`-1` is no whole number", "Threads=-1"),
        ("Threads=4\nColor=2", "Color=2", "section [WEFT] does not say Threads", "[WEFT]"),
        (
            "centimeters",
            "furlongs",
            "`furlongs` is no unit; WIF has centimeters, inches and decipoints",
            "Units=furlongs",
        ),
        ("Spacing=0.1", "Spacing=nan", "`nan` is no length", "Spacing=nan"),
        ("Shafts=4", "Shafts=99999999", "99999999 shafts are more than 10000", "[WEAVING]"),
    ];
    for (from, to, reason, place) in cases {
        let (message, underlined) = refused(&TWILL.replace(from, to));
        assert_eq!((message.split_once(": ").unwrap().1, underlined.as_str()), (reason, place));
    }
    for (section, says) in
        [("[WARP]", "[WARP]"), ("[TIEUP]", "[TIEUP]"), ("[TREADLING]", "[TREADLING]"), ("[WIF]", "no WIF")]
    {
        let (message, _) = refused(&TWILL.replace(section, "[OTHER]"));
        assert!(message.contains(says), "{message}");
    }
    assert!(refused("").0.contains("no WIF"));
    let utf16: Vec<u8> = [0xff, 0xfe].into_iter().chain(TWILL.encode_utf16().flat_map(u16::to_le_bytes)).collect();
    assert_eq!(*read_wif(&utf16).unwrap_err().reason, WifErrorReason::Utf16);
    assert_eq!(*read_wif(&utf16[2..]).unwrap_err().reason, WifErrorReason::Utf16);
}

/// Files of some hundred kilobytes that once asked for hours or for gigabytes.
#[test]
fn small_files_ask_for_little_time_and_memory() {
    let began = std::time::Instant::now();
    let listed = |count: usize| (1..=count).map(|n| n.to_string()).collect::<Vec<_>>().join(",");
    let head = "[WIF]\n[WEAVING]\nShafts=10000\nTreadles=2\n[WARP]\nThreads=16\n[WEFT]\nThreads=20000\n";
    let all = listed(10_000);
    let picks: String = (1..=20_000).map(|pick| format!("{pick}={}\n", pick % 2 + 1)).collect();
    let text = format!("{head}[THREADING]\n1={all}\n2=7\n[TIEUP]\n1={all}\n2=8\n[TREADLING]\n{picks}");
    let draft = read_wif(text.as_bytes()).unwrap().draft;
    assert_eq!([0, 1, 2].map(|end| draft.warp_up(end, 1)), [true, true, false]);
    assert_eq!([0, 1, 2].map(|end| draft.warp_up(end, 0)), [true, false, false]);
    // One shaft said over and over is one.
    let again = "1,".repeat(100_000);
    let text = format!("{head}[THREADING]\n1={again}\n[LIFTPLAN]\n{}", picks.replace("=2", "=1"));
    assert!(read_wif(text.as_bytes()).unwrap().draft.warp_up(0, 0));
    // What is unusual everywhere is told a hundred times.
    let text = format!("{TWILL}[X]\n{}", "a\n".repeat(100_000));
    assert_eq!(read_wif(text.as_bytes()).unwrap().remarks.len(), 100);
    let (message, _) = refused(&TWILL.replace("[WARP]\nThreads=4", "[WARP]\nThreads=3000000"));
    assert!(message.contains("3000000 threads, the limit is 1000000 of warp and of weft each"), "{message}");
    assert!(began.elapsed().as_secs() < 20, "{:?}", began.elapsed());
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = read_wif(&bytes);
    }

    #[test]
    fn spoilt_drafts_are_read_or_refused(cuts in prop::collection::vec((0_usize..400, 0_usize..12, ".{0,6}"), 0..4)) {
        let mut text = TWILL.to_owned();
        for (at, length, put) in cuts {
            let at = at.min(text.len());
            let end = (at + length).min(text.len());
            if text.is_char_boundary(at) && text.is_char_boundary(end) {
                text.replace_range(at..end, &put);
            }
        }
        if let Err(error) = read_wif(text.as_bytes()) {
            prop_assert!(error.line >= 1 && error.line <= text.split('\n').count());
        }
    }
}
