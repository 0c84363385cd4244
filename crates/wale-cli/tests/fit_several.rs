//! `wale fit` of several fabrics: one yarn, a card for each.

mod fits;

use std::fs;

use fits::{fit, half, said, small_fabric};

/// The part of a card that begins with a head.
fn section(card: &str, head: &str) -> String {
    let from = card.find(head).unwrap_or_else(|| panic!("no {head} in {card}"));
    card[from..].split("\n\n").next().unwrap().to_owned()
}

#[test]
fn several_fabrics_have_one_yarn_and_a_card_each() {
    let folder = tempfile::tempdir().unwrap();
    let jersey = small_fabric(folder.path(), "jersey", "stockinette", [0.05, 0.15, 0.4]);
    // Of the same pattern, since a garter of so few yarns takes minutes.
    let softer = small_fabric(folder.path(), "softer", "stockinette", [0.04, 0.1, 0.2]);
    let both = [jersey.as_path(), softer.as_path()];
    let out = |name: &str| folder.path().join(name);
    let to = |name: &str| out(name).to_str().unwrap().to_owned();
    let read = |name: &str, file: &str| fs::read_to_string(out(name).join(file)).unwrap();
    let whole = fit(&both, &["--json", "--out", &to("whole")], "");
    assert!(whole.status.success(), "{}", said(&whole));
    let found: serde_json::Value = serde_json::from_slice(&whole.stdout).unwrap();
    assert_eq!(found[0]["yarn"]["parameters_SI"], found[1]["yarn"]["parameters_SI"]);
    assert!(found[0]["yarn"]["error"] != found[1]["yarn"]["error"]);
    let [of_jersey, of_softer] = ["jersey", "softer"].map(|name| read("whole", &format!("{name}/card.toml")));
    assert_eq!(section(&of_jersey, "[yarn]"), section(&of_softer, "[yarn]"));
    assert!(section(&of_jersey, "[shell]") != section(&of_softer, "[shell]"));
    assert!(read("whole", "softer/report.html").contains("softer"));

    // Answered elsewhere: questions are of both fabrics.
    let asked = fit(&both, &["--ask", "--out", &to("asked")], "");
    assert!(asked.status.success(), "{}", said(&asked));
    let questions = String::from_utf8(asked.stdout).unwrap();
    let of_softer: Vec<&str> = questions.lines().filter(|line| line.contains("\"fabric\":1")).collect();
    assert_eq!(2 * of_softer.len(), questions.lines().count());
    let answers = fit(&both, &["--answer", "--out", &to("asked")], of_softer[0]);
    let answers = String::from_utf8(answers.stdout).unwrap();
    let answer = &answers[answers.find("\"question\"").unwrap()..];
    assert!(read("whole", "answers.jsonl").contains(answer.trim_end()), "{answer}");
    let told = fit(&both, &["--tell", "-", "--out", &to("asked")], &answers);
    assert!(said(&told).contains("1 new answers"), "{}", said(&told));
    // A third fabric is not there.
    for (argument, input) in [("--answer", of_softer[0]), ("--tell=-", answers.as_str())] {
        let other = fit(&both, &[argument, "--out", &to("asked")], &input.replace("\"fabric\":1", "\"fabric\":2"));
        assert_eq!(other.status.code(), Some(3), "{}", said(&other));
    }
}

#[test]
#[ignore = "two fits of two fabrics, one on one thread: minutes, too long for every day"]
fn a_fit_of_several_goes_on_to_the_same_cards() {
    let folder = tempfile::tempdir().unwrap();
    let jersey = small_fabric(folder.path(), "jersey", "stockinette", [0.05, 0.15, 0.4]);
    let garter = small_fabric(folder.path(), "garter", "garter", [0.04, 0.1, 0.2]);
    let both = [jersey.as_path(), garter.as_path()];
    let out = |name: &str| folder.path().join(name);
    let to = |name: &str| out(name).to_str().unwrap().to_owned();
    let read = |name: &str, file: &str| fs::read_to_string(out(name).join(file)).unwrap();
    let whole = fit(&both, &["--out", &to("whole")], "");
    assert!(whole.status.success(), "{}", said(&whole));
    assert!(read("whole", "jersey/tile.pyp") != read("whole", "garter/tile.pyp"));
    // Killed, and gone on with on one thread.
    half(&out("whole").join("answers.jsonl"), &out("killed").join("answers.jsonl"));
    let killed = fit(&both, &["--threads", "1", "--out", &to("killed")], "");
    assert!(killed.status.success(), "{}", said(&killed));
    for name in ["jersey/card.toml", "garter/card.toml", "garter/curves.csv"] {
        assert_eq!(read("killed", name), read("whole", name), "{name}");
    }
}

#[test]
fn what_several_fabrics_need_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let [a, b] = ["a", "b"].map(|name| small_fabric(folder.path(), name, "stockinette", [0.05, 0.15, 0.4]));
    let out = folder.path().join("out");
    let to = ["--out", out.to_str().unwrap()];
    let nowhere = fit(&[&a, &b], &[], "");
    assert_eq!(nowhere.status.code(), Some(2));
    assert!(said(&nowhere).contains("--out FOLDER"), "{}", said(&nowhere));
    let shells = fit(&[&a, &b], &["--shell-only", to[0], to[1]], "");
    assert_eq!(shells.status.code(), Some(2), "{}", said(&shells));
    // One yarn has one stiffness.
    for (path, stiffness) in [(&a, "90 cN"), (&b, "120 cN")] {
        let yarn = format!("[[yarn]]\nname = \"y\"\nlinear_density = \"30 tex\"\nstiffness = \"{stiffness}\"\n");
        let text = fs::read_to_string(path).unwrap();
        fs::write(path, text.replace("[structure]", &format!("{yarn}[structure]"))).unwrap();
    }
    let other = fit(&[&a, &b], &to, "");
    assert_eq!(other.status.code(), Some(3), "{}", said(&other));
    assert!(said(&other).contains("not of one yarn") && said(&other).contains("0.9 N"), "{}", said(&other));
    let text = fs::read_to_string(&b).unwrap().replace("[structure]\nscene = \"scene.toml\"\n", "");
    fs::write(&b, text).unwrap();
    let lies = fit(&[&a, &b], &to, "");
    assert!(said(&lies).contains("b/fabric.toml: nothing says how the yarns lie"), "{}", said(&lies));
    assert!(!out.exists());
    let read = fit(&[&a, &b], &["--read-only", to[0], to[1]], "");
    let text = String::from_utf8(read.stdout).unwrap();
    assert_eq!(text.matches("stretch along the weft: 4 samples").count(), 2, "{text}");
}
