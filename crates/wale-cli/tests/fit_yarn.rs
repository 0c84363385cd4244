//! The fit of a yarn from the program: killed and gone on with, answered elsewhere, and what it says of bad answers.

mod fits;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use fits::{acrylic, said};
use wale::scene::TextFile;
use wale_lab::card_file::CardFile;
use wale_lab::yarn_tile::RodParameter;

/// `wale fit` of the fabric into a folder, quickly, with a text for its standard input.
fn fit(out: &Path, arguments: &[&str], input: &str) -> Output {
    let fabric = acrylic().join("fabric.toml");
    fits::fit(&[&fabric], &[&["--out", out.to_str().unwrap()], arguments].concat(), input)
}

#[test]
fn a_yarn_is_fitted_the_same_in_one_go_after_a_kill_and_by_answers_from_elsewhere() {
    let folder = tempfile::tempdir().unwrap();
    let out = |name: &str| -> PathBuf { folder.path().join(name) };
    let read = |name: &str, file: &str| fs::read_to_string(out(name).join(file)).unwrap();
    let whole = fit(&out("whole"), &["--json"], "");
    assert!(whole.status.success(), "{}", said(&whole));
    let found: serde_json::Value = serde_json::from_slice(&whole.stdout).unwrap();
    let error = &found["yarn"]["error"];
    assert!(error["comfort"].as_f64().unwrap() < 0.5, "{error}");
    let card = read("whole", "card.toml");
    assert!(card.contains("[yarn]") && read("whole", "tile.pyp").contains("*Q"));
    assert!(read("whole", "report.html").contains("yarn in full contact: mean error"));

    // Killed in the middle of writing an answer, on one thread from there.
    let answers = read("whole", "answers.jsonl");
    let half = answers.len() / 2;
    fs::create_dir(out("killed")).unwrap();
    fs::write(out("killed").join("answers.jsonl"), &answers.as_bytes()[..half]).unwrap();
    let killed = fit(&out("killed"), &["--threads", "1"], "");
    assert!(killed.status.success(), "{}", said(&killed));
    assert!(said(&killed).contains("going on with"), "{}", said(&killed));
    assert_eq!(read("killed", "card.toml"), card);
    let sorted = |text: String| {
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        lines.sort();
        lines
    };
    assert_eq!(sorted(read("killed", "answers.jsonl")), sorted(answers.clone()));

    // Answered elsewhere: all that is asked is among what was answered, and repeated and useless answers do no harm.
    let mut rounds = 0;
    loop {
        let asked = fit(&out("asked"), &["--ask"], "");
        assert!(asked.status.success(), "{}", said(&asked));
        let questions = String::from_utf8(asked.stdout).unwrap();
        if questions.is_empty() {
            break;
        }
        rounds += 1;
        assert!(rounds < 60);
        let problem = asked_problem(&questions);
        let mut lines: Vec<String> = Vec::new();
        for line in questions.lines() {
            let question = &line[line.find("\"question\":").unwrap() + "\"question\":".len()..line.len() - 1];
            let known = answers.lines().find(|answer| answer.contains(question));
            let known = known.unwrap_or_else(|| panic!("{question} was never asked"));
            lines.push(format!("{{\"problem\":\"{problem}\",{}", &known[1..]));
        }
        if rounds == 1 {
            // One of them is really answered, by a worker that has the folder alone.
            let worked = fit(&out("asked"), &["--answer"], questions.lines().next().unwrap());
            let answer = String::from_utf8(worked.stdout).unwrap();
            assert_eq!(answer.trim_end(), lines[0], "{}", String::from_utf8_lossy(&worked.stderr));
        }
        let mut text = lines.join("\n");
        text.push('\n');
        text.push_str(&lines[0]);
        let told = fit(&out("asked"), &["--tell", "-"], &text);
        assert!(told.status.success(), "{}", said(&told));
    }
    let told = fit(&out("asked"), &[], "");
    assert!(told.status.success(), "{}", said(&told));
    assert_eq!(read("asked", "card.toml"), card);

    // What is no answer is refused, with its line, and leaves the journal as it was.
    let before = read("asked", "answers.jsonl");
    let good = format!("{{\"problem\":\"{}\",{}", journal_problem(&before), &before.lines().nth(1).unwrap()[1..]);
    let short = good.replacen("\"samples\":", "\"samples\":1", 1);
    for (bad, says) in [
        ("{\"problem\":", "standard input:2:"),
        (&good.replacen("\"problem\":\"", "\"problem\":\"0", 1)[..], "standard input:2: this is of another problem"),
        (&short[..], "standard input:2: the answer has not as many points"),
    ] {
        let told = fit(&out("asked"), &["--tell", "-"], &format!("{good}\n{bad}\n"));
        assert_eq!(told.status.code(), Some(3), "{}", said(&told));
        assert!(said(&told).contains(says), "{}", said(&told));
    }
    assert_eq!(read("asked", "answers.jsonl"), before);
    // Answers of another problem are not gone on with.
    fs::remove_file(out("asked").join("card.toml")).unwrap();
    for file in ["curves.csv", "curves.svg", "report.html", "tile.pyp", "swatch.toml"] {
        fs::remove_file(out("asked").join(file)).unwrap();
    }
    let other = fit(&out("asked"), &["--without", "phases"], "");
    assert_eq!(other.status.code(), Some(3));
    assert!(said(&other).contains("--force"), "{}", said(&other));
    // A question for more points than there is room for is refused, not tried.
    let question = good.split_once(",\"answer\"").unwrap().0;
    for samples in ["0", "9000000000000000000"] {
        let (before, after) = question.split_once("\"samples\":").unwrap();
        let rest = after.trim_start_matches(|c: char| c.is_ascii_digit());
        let huge = fit(&out("asked"), &["--answer"], &format!("{before}\"samples\":{samples}{rest}}}\n"));
        assert_eq!(huge.status.code(), Some(3), "{}", said(&huge));
        assert!(said(&huge).contains("standard input:1: samples is"), "{}", said(&huge));
    }
    let none = fit(&out("nowhere"), &["--answer"], "");
    assert_eq!(none.status.code(), Some(3));
    assert!(said(&none).contains("--ask"), "{}", said(&none));
}

#[test]
fn a_fit_that_is_killed_goes_on_to_the_same_card_and_keeps_to_what_is_known() {
    let folder = tempfile::tempdir().unwrap();
    let fabric = fits::small_fabric(folder.path(), "jersey", "stockinette", [0.4, 1.2, 3.0]);
    let mut text = fs::read_to_string(&fabric).unwrap();
    text.push_str("[held]\nk_b = \"20 mN mm^2\"\n[within]\nonset = [\"2 %\", \"3 %\"]\n");
    fs::write(&fabric, text).unwrap();
    let out = |name: &str| folder.path().join(name);
    let whole = fits::fit(&[&fabric], &["--out", out("whole").to_str().unwrap()], "");
    assert!(whole.status.success(), "{}", said(&whole));
    let card = fs::read_to_string(out("whole").join("card.toml")).unwrap();
    let read = CardFile::of(&TextFile::new(&card, "card.toml")).unwrap();
    let yarn = read.yarn.unwrap();
    assert!((yarn.material.bending / 2e-8 - 1.0).abs() < 1e-12, "{}", yarn.material.bending);
    assert_eq!(yarn.within[RodParameter::Bending as usize], 1.0, "it was held");
    assert!((0.02..=0.03).contains(&yarn.material.onset), "{}", yarn.material.onset);
    // It was pulled along its courses alone: the rest is its yarn's word.
    assert!(read.membrane.ss > 1.0 && read.bending.is_some_and(|bending| bending.weft > 0.0));
    for word in ["k_ss is not determined by these tests", "N/m as the fitted yarn foretells it along the bias and warp"]
    {
        assert!(read.open.iter().any(|open| open.contains(word)), "{word}: {:?}", read.open);
    }

    // Killed as soon as something is answered.
    let mut child = fits::begun(&fabric, &out("killed"));
    let answers = out("killed").join("answers.jsonl");
    let lines = || fs::read_to_string(&answers).map_or(0, |text| text.lines().count());
    while lines() < 4 && child.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(!out("killed").join("card.toml").exists() && lines() >= 4, "{} lines", lines());
    let again = fits::fit(&[&fabric], &["--out", out("killed").to_str().unwrap()], "");
    assert!(again.status.success() && said(&again).contains("going on with"), "{}", said(&again));
    assert_eq!(fs::read_to_string(out("killed").join("card.toml")).unwrap(), card);
}

#[test]
fn a_tile_from_a_file_is_fitted_as_one_of_a_chart_is() {
    let folder = tempfile::tempdir().unwrap();
    let fabric = fits::small_fabric(folder.path(), "tile", "stockinette", [0.4, 1.2, 3.0]);
    fs::copy(acrylic().join("tile.pyp"), fabric.with_file_name("tile.pyp")).unwrap();
    let text = fs::read_to_string(&fabric).unwrap().replace("scene = \"scene.toml\"", "tile = \"tile.pyp\"");
    fs::write(&fabric, text).unwrap();
    let out = folder.path().join("out");
    let done = fits::fit(&[&fabric], &["--out", out.to_str().unwrap(), "--json"], "");
    assert!(done.status.success(), "{}", said(&done));
    let found: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    assert!(found["yarn"]["error"]["comfort"].as_f64().unwrap() < 0.5, "{}", found["yarn"]["error"]);
    assert!(found["contacts"].is_null() && !out.join("swatch.toml").exists(), "a file of curves is no chart");
    let card = CardFile::of(&TextFile::read(&out.join("card.toml"), "card").unwrap()).unwrap();
    assert!(card.yarn.is_some_and(|yarn| out.join(yarn.tile).is_file()) && card.contacts.is_none());
}

fn asked_problem(questions: &str) -> String {
    let line: serde_json::Value = serde_json::from_str(questions.lines().next().unwrap()).unwrap();
    line["problem"].as_str().unwrap().to_owned()
}

fn journal_problem(journal: &str) -> String {
    asked_problem(journal)
}
