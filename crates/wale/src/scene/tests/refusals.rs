//! Bad scenes: the place, the reason and the mend.

use super::*;

#[test]
fn bad_scenes_name_the_place_the_reason_and_the_mend() {
    use ErrorClass::{BadInput as Input, ResourceLimit as Limit};
    let cases: &[Bad] = &[
        ("schema = 1\n[fabrik.chart]\n", "fabrik", "unknown key `fabrik`", "did you mean `fabric`?", Input),
        (
            "schema = 1\n[simulation]\ndurration = 3\n[fabric]",
            "durration",
            "unknown key",
            "did you mean `duration`?",
            Input,
        ),
        ("schema = 1\n[yarn]\ndiameter = \"-1 mm\"\n[fabric]", "\"-1 mm\"", "must be positive", "", Input),
        ("schema = 1\n[yarn]\ndiameter = \"1e30 mm\"\n[fabric]", "\"1e30 mm\"", "absurd", "", Input),
        ("schema = 1\n[yarn]\ndiameter = nan\n[fabric]", "nan", "finite", "\"0.5 mm\"", Input),
        ("schema = 1\n[yarn]\ndiameter = inf\n[fabric]", "inf", "finite", "", Input),
        ("schema = 1\n[yarn]\ndiameter = \"0.5\"\n[fabric]", "\"0.5\"", "has no unit", "\"0.5 mm\"", Input),
        ("schema = 1\n[yarn]\ndiameter = \"0.5 N\"\n[fabric]", "\"0.5 N\"", "`N` is no unit of a length", "", Input),
        ("schema = 1\n[yarn]\ndiameter = true\n[fabric]", "true", "invalid type", "", Input),
        ("schema = 1\n[yarn]\ndiameter = \"30 mm\"\n[fabric]", "\"30 mm\"", "kg/m³", "check the units", Input),
        (
            "schema = 1\n[yarn]\npreset = \"worstd-wool\"\n[fabric]",
            "\"worstd-wool\"",
            "unknown value",
            "did you mean `worsted-wool`?",
            Input,
        ),
        ("schema = 1\n[yarn]\ncolor = \"red\"\n[fabric]", "\"red\"", "no colour", "#8a3324", Input),
        ("schema = 1\n[yarn]\ndiameter = 1e-3\npacking = 0.3\n[fabric]", "0.3", "both given", "keep one", Input),
        ("schema = 2\n[fabric]", "2", "schema 2", "schema = 1", Input),
        ("[fabric]", "", "`schema` is missing", "schema = 1", Input),
        ("schema = 1", "", "`fabric` is missing", "[fabric.chart]", Input),
        ("schema = 1\n[fabric]\n", "fabric", "no chart", "[fabric.chart]", Input),
        ("schema = 1\nschema = 1\n", "schema", "duplicate key", "", Input),
        ("schema = \n", "", "", "", Input),
        (
            "schema = 1\n[yarns.B]\npreset = \"worsted-wool\"\n[fabric.chart]\nsymbols = [\"kk\"]\nstripes = [\"A\", \"B\"]\n",
            "\"worsted-wool\"",
            "preset of one yarn among others",
            "in [yarn]",
            Input,
        ),
        ("schema = 1\n[fabric.weave]\n", "weave", "none of pattern, symbols, file", "", Input),
        ("schema = 1\n[fabric.weave]\npattern = \"plain\"\nends = 9\n", "weave", "needs picks", "picks = 40", Input),
        (
            "schema = 1\n[fabric.weave]\npattern = \"lace\"\nends = 9\npicks = 9\n",
            "\"lace\"",
            "no weave \"lace\"",
            "\"twill 2/1\"",
            Input,
        ),
        (
            "schema = 1\n[fabric.weave]\npattern = \"plain\"\nends = 9\npicks = 9\n",
            "weave",
            "how close the threads lie",
            "end_spacing = \"0.5 mm\"",
            Input,
        ),
        (
            "schema = 1\n[yarn]\ndiameter = \"1 mm\"\n[fabric.weave]\npattern = \"plain\"\nends = 9\npicks = 9\nend_count = \"9 /cm\"\npick_spacing = \"1 mm\"\n",
            "weave",
            "it jams at",
            "further apart",
            Input,
        ),
        (
            "schema = 1\n[fabric]\nloop_length = \"9 mm\"\n[fabric.weave]\npattern = \"plain\"\nends = 9\npicks = 9\nend_count = 200\npick_spacing = \"5 mm\"\n",
            "\"9 mm\"",
            "loop_length beside a weave",
            "leave loop_length out",
            Input,
        ),
        (
            "schema = 1\n[fabric.weave]\nsymbols = [\"x.\", \"k.\"]\nends = 9\npicks = 9\n",
            "[\"x.\", \"k.\"]",
            "line 2 has `k`",
            "",
            Input,
        ),
        (
            "schema = 1\n[fabric.weave]\npattern = \"plain\"\nends = 90000\npicks = 90000\nend_spacing = 1e-3\npick_spacing = 1e-3\n",
            "90000",
            "the limit is 16000000",
            "smaller",
            Limit,
        ),
        ("schema = 1\n[fabric.chart]\n", "chart", "none of pattern, symbols, image, file, knitout", "", Input),
        (
            "schema = 1\n[fabric.chart]\npattern = \"gartr\"\n",
            "\"gartr\"",
            "no pattern",
            "did you mean \"garter\"?",
            Input,
        ),
        (
            "schema = 1\n[fabric.chart]\npattern = \"garter\"\nrows = 3\n",
            "chart",
            "needs columns",
            "columns = 20",
            Input,
        ),
        ("schema = 1\n[fabric.chart]\npattern = \"rib 0x0\"\n", "\"rib 0x0\"", "empty", "", Input),
        ("schema = 1\n[fabric.chart]\npattern = \"garter\"\ncolumns = 0\nrows = 3\n", "0", "at least 1", "", Input),
        ("schema = 1\n[fabric.chart]\npattern = \"garter\"\ncolumns = -3\nrows = 3\n", "-3", "integer", "", Input),
        ("schema = 1\n[fabric.chart]\nsymbols = []\n", "[]", "no rows", "", Input),
        (
            "schema = 1\n[fabric.chart]\nsymbols = [\"kk\", \"\", \"kk\"]\n",
            "\"\"",
            "row 2 of the chart is empty",
            "",
            Input,
        ),
        (
            "schema = 1\n[fabric.chart]\nsymbols = [\"kkk\", \"kk\"]\n",
            "\"kkk\"",
            "row 2 works 3 stitches, but the row below it leaves 2",
            "",
            Input,
        ),
        ("schema = 1\n[fabric.chart]\nsymbols = [\"kxk\"]\n", "x", "`x` in row 1 is not in the legend", "", Input),
        (
            "schema = 1\n[fabric.chart]\nsymbols = [\"kk\"]\nlegend = { kk = \"knit\" }\n",
            "\"knit\"",
            "not one symbol",
            "",
            Input,
        ),
        (
            "schema = 1\n[fabric.chart]\nsymbols = [\"xx\"]\nlegend = { x = \"c4f\" }\n",
            "\"c4f\"",
            "\"c4f\" is a cable",
            "",
            Input,
        ),
        (
            "schema = 1\n[fabric.chart]\nsymbols = [\"xx\"]\nlegend = { x = \"k2to\" }\n",
            "\"k2to\"",
            "no stitch that wale knows",
            "did you mean \"k2tog\"",
            Input,
        ),
        (
            "schema = 1\n[fabric.chart]\nsymbols = [\"kk\"]\nimage = \"a.png\"\n",
            "\"a.png\"",
            "an image without a palette",
            "palette = {",
            Input,
        ),
        (
            "schema = 1\n[fabric.chart]\nsymbols = [\"kk\"]\nstripes = [\"A\"]\nyarns = [\"A\"]\n",
            "[\"A\"]",
            "stripes and yarns both give the yarns",
            "keep one",
            Input,
        ),
        (
            "schema = 1\n[yarns.C]\ncolor = \"#ffffff\"\n[fabric.chart]\nsymbols = [\"kk\"]\nstripes = [\"A\", \"B\"]\n",
            "C",
            "the fabric has no yarn \"C\"",
            "",
            Input,
        ),
        (
            "schema = 1\n[fabric.chart]\npattern = \"seed\"\nsymbols = [\"k\"]\n",
            "[\"k\"]",
            "both given",
            "keep one of pattern, symbols, image, file, knitout",
            Input,
        ),
        (
            "schema = 1\n[fabric.chart]\npattern = \"seed\"\ncolumns = 100000000\nrows = 100000000\n",
            "100000000",
            "100000000 columns × 100000000 rows are 10000000000000000 loops, the limit is 16000000",
            "smaller",
            Limit,
        ),
        (
            "schema = 1\n[fabric.chart]\npattern = \"seed\"\ncolumns = 18446744073709551615\nrows = 3\n",
            "18446744073709551615",
            "",
            "",
            Limit,
        ),
        (
            "schema = 1\n[simulation]\nduration = 1e7\n[fabric.chart]\npattern = \"seed\"\ncolumns = 4\nrows = 4\n",
            "1e7",
            "frames",
            "shorter",
            Limit,
        ),
        (
            "schema = 1\n[simulation]\nlargest_step = 1e-9\n[fabric.chart]\npattern = \"seed\"\ncolumns = 4\nrows = 4\n",
            "1e-9",
            "longer than the largest",
            "",
            Input,
        ),
        (
            "schema = 1\n[fabric]\nloop_length = \"2 mm\"\n[fabric.chart]\npattern = \"seed\"\ncolumns = 4\nrows = 4\n",
            "\"2 mm\"",
            "thick",
            "longer loop",
            Input,
        ),
        (
            "schema = 1\n[fabric]\nstitch_length = \"6 mm\"\n[fabric.chart]\npattern = \"seed\"\ncolumns = 4\nrows = 4\n",
            "\"6 mm\"",
            "leave too little",
            "",
            Input,
        ),
        (
            "schema = 1\n[fabric]\nbend_angle_leg = 90\n[fabric.chart]\npattern = \"seed\"\ncolumns = 4\nrows = 4\n",
            "90",
            "rest angle",
            "\"90 deg\"",
            Input,
        ),
        (
            "schema = 1\n[fabric]\ncontact_distance = \"0.2 mm\"\n[fabric.chart]\npattern = \"seed\"\ncolumns = 4\nrows = 4\n",
            "\"0.2 mm\"",
            "contacts in one point",
            "contacts = \"thick\"",
            Input,
        ),
        (
            "schema = 1\n[fabric]\ncontacts = \"thick\"\ncontact_distance = \"9 mm\"\n[fabric.chart]\npattern = \"seed\"\ncolumns = 4\nrows = 4\n",
            "\"9 mm\"",
            "a contact_distance of",
            "",
            Input,
        ),
        (
            "schema = 1\n[fabric.chart]\nfile = \"../../etc/passwd\"\n",
            "\"../../etc/passwd\"",
            "not a path inside",
            "rib.knit",
            Input,
        ),
        ("schema = 1\n[fabric.chart]\nfile = \"/etc/passwd\"\n", "\"/etc/passwd\"", "not a path inside", "", Input),
        ("schema = 1\n[fabric.chart]\nfile = 'C:\\rib'\n", "'C:\\rib'", "not a path inside", "", Input),
        ("schema = 1\n[fabric.chart]\nfile = \"\"\n", "\"\"", "not a path inside", "", Input),
    ];
    for (text, underlined, what, mend, class) in cases {
        let error = Scene::from_text(text, "scene.toml").expect_err(text);
        assert_eq!(error.underlined().unwrap_or_default(), *underlined, "{text}\n{error}");
        assert!(error.what().contains(what), "{text}\n{error}");
        assert!(error.mend().unwrap_or_default().contains(mend), "{text}\n{error}\n{:?}", error.mend());
        assert_eq!(error.class(), *class, "{text}\n{error}");
        assert!(error.labels().is_some() || error.line_and_column().is_none());
    }
}

#[test]
fn bad_happenings_name_the_place_and_the_reason() {
    let cases = [
        ("[[obstacle]]\n", "obstacle", "none of plane"),
        ("[[obstacle]]\nsphere = { center = [0, 0, 0], radius = 0 }\n", "0", "must be positive"),
        ("[[obstacle]]\nsphere = { center = [0, 0], radius = 1 }\n", "[0, 0]", "invalid length"),
        ("[[obstacle]]\nplane = { point = [0, 0, 0], normal = [0, 0, 0] }\n", "[0, 0, 0]", "cannot be zero"),
        (
            "[[obstacle]]\nname = \"a\"\nplane = { point = [0, 0, 0] }\n[[obstacle]]\nname = \"a\"\nplane = { point = [0, 0, 0] }\n",
            "\"a\"",
            "another obstacle",
        ),
        ("[[obstacle]]\nplane = { point = [0, 0, 0] }\nmotion = {}\n", "motion", "needs velocity"),
        (
            "[[obstacle]]\nplane = { point = [0, 0, 0] }\nmotion = { keys = [{ time = 1 }, { time = 1 }] }\n",
            "1",
            "not in order of time",
        ),
        ("[[obstacle]]\nplane = { point = [0, 0, 0] }\nmotion = { keys = [] }\n", "[]", "at least one key"),
        ("[[grip]]\n", "grip", "`select` is missing"),
        ("[[grip]]\nselect = {}\n", "select", "none of edge"),
        ("[[grip]]\nselect = { edge = \"rigth\" }\n", "\"rigth\"", "unknown value"),
        ("[[grip]]\nselect = { rows = [0, 2] }\n", "[0, 2]", "rows 0 to 2"),
        ("[[grip]]\nselect = { rows = [1, 5] }\n", "[1, 5]", "rows 1 to 5"),
        ("[[grip]]\nselect = { all = true, depth = 2 }\n", "2", "only edges and corners"),
        ("[[grip]]\nselect = { edge = \"top\", depth = 7 }\n", "7", "depth of 7"),
        ("[[grip]]\nselect = { all = true }\naxes = \"xw\"\n", "\"xw\"", "axes are x, y and z"),
        ("[[grip]]\nselect = { all = true }\naxes = \"\"\n", "\"\"", "at least one axis"),
        ("[[grip]]\nselect = { all = true }\nfrom = 2\nuntil = 1\n", "1", "lets go before"),
        (
            "[[grip]]\nselect = { all = true }\naxes = \"x\"\nmotion = { turn = { axis = [1, 0, 0], rate = 1 } }\n",
            "\"x\"",
            "holds all three axes",
        ),
        (
            "[[grip]]\nselect = { all = true }\nmotion = { keys = [{ time = 0, translation = [1, 0, 0] }] }\n",
            "{ time = 0, translation = [1, 0, 0] }",
            "would jump",
        ),
        ("[[grip]]\nselect = { region = { low = [0, 0, 1], high = [1, 1, 0] } }\n", "[1, 1, 0]", "region is empty"),
    ];
    for (rest, underlined, what) in cases {
        let text = format!("schema = 1\n{CHART}{rest}");
        let error = Scene::from_text(&text, "scene.toml").expect_err(rest);
        assert!(error.what().contains(what), "{rest}\n{error}");
        // A table without text of its own is underlined by its key or, by the reader, its header.
        let shown = error.underlined().unwrap_or_default();
        assert!(
            shown.trim_matches(['[', ']', '{', '}']) == underlined.trim_matches(['[', ']', '{', '}']),
            "{error}: {shown}"
        );
    }
}
