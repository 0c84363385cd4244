//! Yarns that run together as one: how they are named, what follows, and what is refused.

use super::*;
use crate::model::YarnCard;

const TWO: &str = "[yarns.A]\ncolor = \"#101010\"\n[yarns.B]\ncolor = \"#f0f0f0\"\nlinear_density = \"250 tex\"\n\
    friction = 0.1\nloose_ends = true\n";
const STRIPED: &str = "[fabric.chart]\npattern = \"garter\"\ncolumns = 6\nrows = 4\nstripes = [\"A\", \"P\"]\n";

fn read_file(name: &str, content: &str, yarns: &str) -> Scene {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(name), content).unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, format!("schema = 1\n{yarns}[fabric.chart]\nfile = \"{name}\"\n")).unwrap();
    Scene::read(&path).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn two_yarns_in_one_pass_have_the_card_of_both() {
    let scene = read(&format!("{TWO}[yarns.P]\ntogether = [\"A\", \"B\"]\n{STRIPED}"));
    let [single, both] = [0, 1].map(|kind| scene.yarns.of(kind).clone());
    let [a, b] = scene.yarns.members(1) else { panic!("two members") };
    assert_eq!((a.name.as_str(), b.name.as_str(), a.color, b.color), ("A", "B", [0x10; 3], [0xf0; 3]));
    assert_eq!((&a.card, both.clone()), (&single, YarnCard::together(&a.card, [&b.card])));
    assert!((both.linear_density - 750e-6).abs() < 1e-18);
    assert_eq!(scene.yarn_colors, [[0x10; 3], [0x10; 3]], "the first is the one that is seen");
    assert!(scene.yarns.members(0).is_empty());
    assert_eq!(resolved_again(&scene), scene);
}

#[test]
fn what_a_yarn_of_several_says_itself_goes_before_what_follows() {
    let own = "together = [\"A\", \"B\"]\nbending_stiffness = \"400 mN mm^2\"\ncolor = \"#00ff00\"\nname = \"marl\"\n";
    let scene = read(&format!("{TWO}[yarns.P]\n{own}{STRIPED}"));
    assert!((scene.yarns.of(1).bending_stiffness - 400e-9).abs() < 1e-20);
    assert!((scene.yarns.of(1).linear_density - 750e-6).abs() < 1e-18);
    assert_eq!((scene.yarn_colors[1], scene.yarns.name(1)), ([0, 0xff, 0], Some("marl")));
    assert_eq!(resolved_again(&scene), scene);
}

#[test]
fn a_whole_fabric_may_be_of_one_yarn_of_several() {
    let chart = STRIPED.replace("[\"A\", \"P\"]", "[\"P\"]");
    let scene = read(&format!("{TWO}[yarns.P]\ntogether = [\"A\", \"B\"]\n{chart}"));
    assert_eq!((scene.yarn_colors.len(), scene.yarns.members(0).len()), (1, 2));
    assert!((scene.yarns.first().linear_density - 750e-6).abs() < 1e-18);
    assert_eq!(resolved_again(&scene), scene);
}

#[test]
fn carriers_that_feed_together_are_the_yarns_of_both() {
    let program = include_str!("../../../tests/corpus/knitout/plated.k");
    let yarns = "[yarns.2]\nlinear_density = \"200 tex\"\ncolor = \"#ffffff\"\n";
    let scene = read_file("plated.k", program, yarns);
    assert_eq!([0, 1].map(|kind| scene.yarns.name(kind)), [Some("1"), Some("1 2")]);
    assert!((scene.yarns.of(1).linear_density - 700e-6).abs() < 1e-18);
    let members: Vec<_> = scene.yarns.members(1).iter().map(|of| (of.name.as_str(), of.color)).collect();
    assert_eq!(members, [("1", scene.yarn_colors[0]), ("2", [255; 3])]);
    assert_eq!(resolved_again(&scene), scene, "the members go along");
    // A table of their own goes before.
    let own = read_file("plated.k", program, "[yarns.\"1 2\"]\nlinear_density = \"900 tex\"\n");
    assert!((own.yarns.of(1).linear_density - 900e-6).abs() < 1e-18);
    assert_eq!(own.yarns.members(1).len(), 2);
}

#[test]
fn instructions_hold_yarns_together() {
    let text = include_str!("../../../tests/corpus/instructions/held-together.knit");
    let scene = read_file("held.knit", text, "[yarns.CC]\nlinear_density = \"100 tex\"\n");
    let names: Vec<_> = (0..5).map(|kind| scene.yarns.name(kind).unwrap()).collect();
    assert_eq!(names, ["MC CC", "MC", "MC MC", "MC CC D", "CC CC"]);
    let tex = [0, 1, 2, 3, 4].map(|kind| (1e6 * scene.yarns.of(kind).linear_density).round());
    assert_eq!(tex, [600.0, 500.0, 1000.0, 1100.0, 200.0]);
    assert_eq!(resolved_again(&scene), scene);
}

#[test]
fn what_cannot_run_together_is_refused_with_its_mend() {
    let cases = [
        ("together = [\"A\"]", "[\"A\"]", "is together with nothing", "held double"),
        ("together = []", "[]", "is together with nothing", "two yarns or more"),
        ("together = [\"A\", \"P\"]", "[\"A\", \"P\"]", "\"P\" cannot be a part of itself", "name the yarns"),
        ("together = [\"A\", \"Q\"]", "[\"A\", \"Q\"]", "\"Q\" is several yarns itself", "name those in its place"),
        ("together = [\"A\", \"C\"]", "[\"A\", \"C\"]", "there is no yarn \"C\"", "add a table [yarns.C]"),
        ("together = [\"A\", \"B\"]\npreset = \"worsted-wool\"", "\"worsted-wool\"", "preset of one yarn", "[yarn]"),
        ("together = [\"A\", \"B\"]\ndiameter = \"9 cm\"", "\"9 cm\"", "kg/m³", "check the units"),
    ];
    for (own, underlined, what, mend) in cases {
        let text = format!("schema = 1\n{TWO}[yarns.P]\n{own}\n[yarns.Q]\ntogether = [\"A\", \"A\"]\n{STRIPED}");
        let text = text.replace("stripes = [\"A\", \"P\"]", "stripes = [\"A\", \"B\", \"P\", \"Q\"]");
        let error = Scene::from_text(&text, "bad.toml").unwrap_err();
        assert_eq!(error.underlined(), Some(underlined), "{error}");
        assert!(error.what().contains(what), "{error}");
        assert!(error.mend().is_some_and(|said| said.contains(mend)), "{:?}", error.mend());
    }
    let error = Scene::from_text(&format!("schema = 1\n[yarn]\ntogether = [\"A\", \"B\"]\n{STRIPED}"), "bad.toml");
    let error = error.unwrap_err();
    assert!(error.what().contains("together of the scene's own yarn") && error.mend().unwrap().contains("[yarns.P]"));
    let unused = Scene::from_text(&format!("schema = 1\n{TWO}{STRIPED}"), "bad.toml").unwrap_err();
    assert!(unused.what().contains("the fabric has no yarn \"B\""), "{unused}");
}
