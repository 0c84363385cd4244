//! A run that is interrupted in any way goes on to the same bits, on any number of threads.

mod common;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use common::{
    Workshop, assert_fails, assert_same_bits, assert_succeeds, code, end_of, frame_count, lasting_files, scene, told,
    wait_for, wale,
};

/// The run of the scene without interruption, on one thread.
fn whole() -> PathBuf {
    static WHOLE: LazyLock<Workshop> = LazyLock::new(|| {
        let workshop = Workshop::new();
        assert_succeeds(&workshop.run("scene.toml", "whole.run", &["-j", "1"]));
        workshop
    });
    WHOLE.path("whole.run")
}

fn status(run: &Path) -> String {
    fs::read_to_string(run.join("STATUS")).unwrap_or_default().trim().to_owned()
}

/// Starts a run and waits until it has written so many frames.
fn started(workshop: &Workshop, name: &str, frames: usize) -> std::process::Child {
    let (scene, out) = (workshop.text("scene.toml"), workshop.text(name));
    let child = workshop.start(&["run", &scene, "--out", &out, "-j", "2"]);
    wait_for("frames", || frame_count(&workshop.path(name)) >= frames);
    child
}

fn signal(child: &std::process::Child, name: &str) {
    let sent = std::process::Command::new("kill").args([name, &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
}

/// Sums are cut into chunks of some hundred nodes: only a fabric of several chunks can tell.
#[test]
fn threads_do_not_change_a_bit() {
    let workshop = Workshop::new();
    let large = scene(0.006).replace("columns = 6", "columns = 26").replace("rows = 6", "rows = 24");
    fs::write(workshop.path("scene.toml"), large).unwrap();
    assert_succeeds(&workshop.run("scene.toml", "1.run", &["-j", "1"]));
    for threads in ["2", "4"] {
        let name = format!("{threads}.run");
        assert_succeeds(&workshop.run("scene.toml", &name, &["-j", threads]));
        assert_same_bits(&workshop.path("1.run"), &workshop.path(&name));
    }
}

#[test]
fn killed_at_any_moment_and_resumed_gives_the_same_bits() {
    let workshop = Workshop::new();
    let whole = whole();
    let frames = frame_count(&whole);
    let mut killed = 0;
    for (attempt, share) in [0.0, 0.3, 0.7].into_iter().enumerate() {
        let name = format!("killed{attempt}.run");
        let mut child = started(&workshop, &name, 1 + (share * frames as f64) as usize);
        child.kill().unwrap();
        child.wait().unwrap();
        let run = workshop.path(&name);
        if status(&run) == "done" {
            continue;
        }
        killed += 1;
        if status(&run).is_empty() {
            // Killed before it was a run: begun anew.
            assert_succeeds(&workshop.run("scene.toml", &name, &["--force"]));
        } else {
            // Killed once more on the way, and then to the end, on another number of threads.
            let again = workshop.start(&["resume", &workshop.text(&name)]);
            let before = frame_count(&run);
            let mut again = again;
            wait_for("more frames", || frame_count(&run) > before || again.try_wait().unwrap().is_some());
            let _ = again.kill();
            again.wait().unwrap();
            assert_succeeds(&wale(&["resume", &workshop.text(&name), "-j", "4"]));
        }
        assert_same_bits(&whole, &run);
    }
    assert!(killed >= 2, "only {killed} runs were still going when they were killed");
}

/// What the relaxation before the first frame leaves is in the checkpoint, all of it.
#[test]
fn a_run_that_relaxes_first_is_resumed_to_the_same_bits() {
    let workshop = Workshop::new();
    let relaxing = scene(0.03).replace("relax_first = false", "relax_first = true");
    fs::write(workshop.path("scene.toml"), relaxing).unwrap();
    assert_succeeds(&workshop.run("scene.toml", "whole.run", &["-j", "1"]));
    for frames in [0, 1] {
        let name = format!("{frames}.run");
        let run = workshop.path(&name);
        let (scene, out) = (workshop.text("scene.toml"), workshop.text(&name));
        let mut child = workshop.start(&["run", &scene, "--out", &out]);
        wait_for("the run", || !status(&run).is_empty() && frame_count(&run) >= frames);
        child.kill().unwrap();
        child.wait().unwrap();
        assert_eq!(status(&run), "running");
        assert_succeeds(&wale(&["resume", &out]));
        assert_same_bits(&workshop.path("whole.run"), &run);
    }
}

#[cfg(unix)]
#[test]
fn signals_stop_after_a_checkpoint_and_tell_how_to_go_on() {
    let workshop = Workshop::new();
    let whole = whole();
    for (name, signal_name, expected) in [("int.run", "-INT", 130), ("term.run", "-TERM", 143)] {
        let child = started(&workshop, name, 2);
        signal(&child, signal_name);
        let output = end_of(child);
        assert_eq!(code(&output), expected, "{}", told(&output));
        assert!(told(&output).contains("wale resume"), "{}", told(&output));
        assert_eq!(status(&workshop.path(name)), "stopped");
        assert_succeeds(&wale(&["resume", &workshop.text(name)]));
        assert_same_bits(&whole, &workshop.path(name));
    }
}

#[cfg(unix)]
#[test]
fn sigusr1_takes_a_checkpoint_and_goes_on() {
    let workshop = Workshop::new();
    let child = started(&workshop, "usr.run", 2);
    signal(&child, "-USR1");
    assert_succeeds(&end_of(child));
    assert_eq!(status(&workshop.path("usr.run")), "done");
}

#[cfg(unix)]
#[test]
fn two_runs_in_one_folder_are_refused() {
    let workshop = Workshop::new();
    let child = started(&workshop, "a.run", 1);
    let output = workshop.run("scene.toml", "a.run", &["--force"]);
    assert_fails(&output, 6, &["in use by process", &child.id().to_string()]);
    assert_fails(&wale(&["resume", &workshop.text("a.run")]), 6, &["in use"]);
    signal(&child, "-INT");
    assert_eq!(code(&end_of(child)), 130);
}

#[test]
fn a_run_is_not_overwritten_and_a_finished_one_not_resumed() {
    let workshop = Workshop::new();
    fs::write(workshop.path("scene.toml"), scene(0.01)).unwrap();
    assert_succeeds(&workshop.run("scene.toml", "a.run", &[]));
    let run = workshop.path("a.run");
    let before = lasting_files(&run);
    assert_fails(&workshop.run("scene.toml", "a.run", &[]), 3, &["--force", "wale resume"]);
    let output = wale(&["resume", &workshop.text("a.run")]);
    assert_succeeds(&output);
    assert!(told(&output).contains("done already"), "{}", told(&output));
    assert!(before == lasting_files(&run));
    assert_succeeds(&workshop.run("scene.toml", "a.run", &["--force"]));
    assert!(before == lasting_files(&run));
}

#[cfg(unix)]
#[test]
fn damage_changes_and_other_versions_are_told() {
    let workshop = Workshop::new();
    let child = started(&workshop, "a.run", 4);
    signal(&child, "-TERM");
    assert_eq!(code(&end_of(child)), 143);
    let (run, name) = (workshop.path("a.run"), workshop.text("a.run"));

    let environment = fs::read_to_string(run.join("environment.json")).unwrap();
    fs::write(run.join("environment.json"), environment.replace("\"version\": \"", "\"version\": \"9.")).unwrap();
    assert_fails(&wale(&["resume", &name]), 3, &["written by wale 9."]);
    fs::write(run.join("environment.json"), environment.replace("\"format\": 1", "\"format\": 2")).unwrap();
    assert_fails(&wale(&["resume", &name]), 3, &["format 2"]);
    assert_fails(&wale(&["render", &name]), 3, &["format 2"]);
    fs::write(run.join("environment.json"), environment).unwrap();

    let scene = fs::read_to_string(workshop.path("scene.toml")).unwrap();
    fs::write(workshop.path("scene.toml"), scene.replace("duration = 0.08", "duration = 0.2")).unwrap();
    assert_fails(&wale(&["resume", &name]), 3, &["scene.toml", "changed since"]);
    fs::write(workshop.path("scene.toml"), scene).unwrap();

    // The latest checkpoint is damaged: the one before stands in, and it is told.
    let latest = fs::read_to_string(run.join("checkpoints/LATEST")).unwrap();
    let latest = run.join("checkpoints").join(latest.trim());
    let bytes = fs::read(&latest).unwrap();
    fs::write(&latest, &bytes[..bytes.len() / 2]).unwrap();
    let output = wale(&["resume", &name]);
    assert_succeeds(&output);
    assert!(told(&output).contains("damaged"), "{}", told(&output));
    assert_same_bits(&whole(), &run);

    // Both are.
    fs::write(run.join("STATUS"), "running\n").unwrap();
    for entry in fs::read_dir(run.join("checkpoints")).unwrap() {
        fs::write(entry.unwrap().path(), "rubbish").unwrap();
    }
    assert_fails(&wale(&["resume", &name]), 3, &["no checkpoint that can be read"]);
}

#[test]
fn a_run_can_be_cut_short() {
    let workshop = Workshop::new();
    assert_succeeds(&workshop.run("scene.toml", "short.run", &["--duration", "0.01"]));
    let resolved = fs::read_to_string(workshop.path("short.run").join("scene.resolved.toml")).unwrap();
    assert!(resolved.contains("duration = \"0.01 s\""), "{resolved}");
    assert!(frame_count(&workshop.path("short.run")) < frame_count(&whole()));
}
