//! `wale fit --ablations`: each part of a yarn's fit is taken away once, and the report says what it is for.

mod fits;

use std::fs;

use fits::{fit, half, said, small_fabric};

#[test]
#[ignore = "six fits: minutes, too long for every day"]
fn ablations_are_made_resumed_and_told() {
    let folder = tempfile::tempdir().unwrap();
    let fabric = small_fabric(folder.path(), "jersey", "stockinette", [0.05, 0.15, 0.4]);
    let out = |name: &str| folder.path().join(name);
    let read = |name: &str, file: &str| fs::read_to_string(out(name).join(file)).unwrap();
    let to = |name: &str| out(name).to_str().unwrap().to_owned();
    let whole = fit(&[&fabric], &["--ablations", "--json", "--out", &to("whole")], "");
    assert!(whole.status.success(), "{}", said(&whole));
    let found: serde_json::Value = serde_json::from_slice(&whole.stdout).unwrap();
    let told = found["ablations"].as_array().unwrap();
    let names: Vec<&str> = told.iter().map(|one| one["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["swarm", "local-only", "one-phase", "no-rest-shapes", "nothing-holds"]);
    let (table, report) = (read("whole", "ablations.csv"), read("whole", "report.html"));
    for one in told {
        let name = one["name"].as_str().unwrap();
        // Eight points of one direction.
        assert_eq!(table.lines().filter(|line| line.starts_with(&format!("{name},"))).count(), 8, "{name}");
        // What is concluded stands in the report, and follows from the errors beside it.
        let sentence = one["conclusion"].as_str().unwrap();
        assert!(report.contains(sentence), "{sentence}");
        let comfort = format!("{:.1}", 100.0 * one["error"]["comfort"].as_f64().unwrap());
        assert!(sentence.contains(&comfort), "{comfort}: {sentence}");
        assert_eq!(one["as_the_paper"].is_null(), name == "swarm" || name == "nothing-holds");
    }
    assert!(report.matches("<svg").count() == 2 && report.contains("no bending of this fabric was measured"));

    // Killed in the middle of the last but one, and gone on with on one thread: the same bits.
    let kept = ["problem.json", "answers.jsonl"];
    for name in ["", "ablations/swarm", "ablations/local-only", "ablations/one-phase"] {
        fs::create_dir_all(out("killed").join(name)).unwrap();
        for file in kept {
            fs::copy(out("whole").join(name).join(file), out("killed").join(name).join(file)).unwrap();
        }
    }
    let torn = "ablations/no-rest-shapes/answers.jsonl";
    half(&out("whole").join(torn), &out("killed").join(torn));
    let killed = fit(&[&fabric], &["--ablations", "--threads", "1", "--out", &to("killed")], "");
    assert!(killed.status.success(), "{}", said(&killed));
    for file in ["card.toml", "ablations.csv", "report.html"] {
        assert_eq!(read("killed", file), read("whole", file), "{file}");
    }

    // A finished fit may have its ablations later; with them, nothing is overwritten unasked.
    for file in ["ablations.csv", "ablations.svg"] {
        fs::remove_file(out("killed").join(file)).unwrap();
    }
    let later = fit(&[&fabric], &["--ablations", "--out", &to("killed")], "");
    assert!(later.status.success(), "{}", said(&later));
    assert_eq!(read("killed", "ablations.csv"), table);
    let again = fit(&[&fabric], &["--ablations", "--out", &to("killed")], "");
    assert_eq!(again.status.code(), Some(3));
    assert!(said(&again).contains("--force"), "{}", said(&again));
}

#[test]
fn ablations_are_of_the_whole_and_of_a_yarn() {
    let folder = tempfile::tempdir().unwrap();
    let fabric = small_fabric(folder.path(), "jersey", "stockinette", [0.05, 0.15, 0.4]);
    for part in [&["--without", "phases"][..], &["--with-bending"], &["--ask"], &["--shell-only"]] {
        let refused = fit(&[&fabric], &[&["--ablations"], part].concat(), "");
        assert_eq!(refused.status.code(), Some(2), "{part:?}: {}", said(&refused));
    }
    let text = fs::read_to_string(&fabric).unwrap().replace("[structure]\nscene = \"scene.toml\"\n", "");
    fs::write(&fabric, text).unwrap();
    let no_yarn = fit(&[&fabric], &["--ablations"], "");
    assert_eq!(no_yarn.status.code(), Some(3));
    assert!(said(&no_yarn).contains("add [structure]"), "{}", said(&no_yarn));
}
