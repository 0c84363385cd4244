//! Running the program, and looking at what it leaves.

#![allow(dead_code, missing_docs)]

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use tempfile::TempDir;

/// Longest that any single wait may take: a hung program must fail the test, not hang it.
const PATIENCE: Duration = Duration::from_secs(120);

pub fn program() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_wale"));
    command.stdin(Stdio::null());
    command
}

/// Runs to the end.
pub fn wale(arguments: &[&str]) -> Output {
    program().args(arguments).output().unwrap()
}

/// Runs to the end with a text for its standard input.
pub fn wale_given(arguments: &[&str], input: &str) -> Output {
    let mut child =
        program().args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // A program that ends before it reads is no fault of the test.
    let _ = child.stdin.take().unwrap().write_all(input.as_bytes());
    child.wait_with_output().unwrap()
}

pub fn code(output: &Output) -> i32 {
    output.status.code().unwrap_or(-1)
}

pub fn told(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Asserts an exit code and that the message holds all of some words, is short, and is no panic.
#[track_caller]
pub fn assert_fails(output: &Output, expected: i32, words: &[&str]) {
    let message = told(output);
    assert_eq!(code(output), expected, "{message}");
    for word in words {
        assert!(message.contains(word), "`{word}` is not in: {message}");
    }
    assert!(message.lines().count() < 25, "{message}");
    assert!(!message.contains("panicked") && !message.contains("a bug"), "{message}");
}

#[track_caller]
pub fn assert_succeeds(output: &Output) {
    assert_eq!(code(output), 0, "{}", told(output));
}

/// A folder with a small scene: some rows of garter falling on a ball, held at an edge.
pub struct Workshop {
    folder: TempDir,
}

impl Workshop {
    pub fn new() -> Self {
        let workshop = Self { folder: tempfile::tempdir().unwrap() };
        fs::write(workshop.path("scene.toml"), scene(0.08)).unwrap();
        workshop
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn text(&self, name: &str) -> String {
        self.path(name).to_str().unwrap().to_owned()
    }

    /// Writes a scene and runs it into a folder of the same name.
    pub fn run(&self, scene: &str, folder: &str, more: &[&str]) -> Output {
        let (scene, out) = (self.text(scene), self.text(folder));
        let mut arguments = vec!["run", scene.as_str(), "--out", out.as_str(), "--quiet"];
        arguments.extend(more);
        wale(&arguments)
    }

    pub fn start(&self, arguments: &[&str]) -> Child {
        program().args(arguments).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
    }
}

/// A scene of a given duration \[s\] that uses friction, a ball, and a moving grip, so that all of the state matters.
pub fn scene(duration: f64) -> String {
    format!(
        r#"schema = 1
title = "a small garter"
[yarn]
preset = "worsted-wool"
[fabric]
center = [0, 0, "22 mm"]
[fabric.chart]
pattern = "garter"
columns = 6
rows = 6
[simulation]
duration = {duration}
frame_rate = 100
largest_step = "2 ms"
relax_first = false
[[obstacle]]
sphere = {{ center = [0, 0, 0], radius = "18 mm" }}
[[grip]]
name = "edge"
select = {{ edge = "right" }}
motion = {{ velocity = ["30 mm/s", 0, 0] }}
[output]
pictures = "none"
view = false
checkpoint_every = 0.02
"#
    )
}

/// Waits until a condition holds.
#[track_caller]
pub fn wait_for(what: &str, mut holds: impl FnMut() -> bool) {
    let began = Instant::now();
    while !holds() {
        assert!(began.elapsed() < PATIENCE, "waited too long for {what}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

pub fn end_of(child: Child) -> Output {
    let mut child = child;
    wait_for("the program to end", || child.try_wait().unwrap().is_some());
    child.wait_with_output().unwrap()
}

/// Files of a run that must not depend on how often it was interrupted, or on how many threads.
pub fn lasting_files(run: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::new();
    for name in ["metrics.csv", "log.jsonl", "scene.resolved.toml", "STATUS"] {
        files.push((name.to_owned(), fs::read(run.join(name)).unwrap()));
    }
    let mut frames: Vec<PathBuf> = fs::read_dir(run.join("frames")).unwrap().map(|e| e.unwrap().path()).collect();
    frames.sort();
    for path in frames {
        files.push((path.file_name().unwrap().to_str().unwrap().to_owned(), fs::read(&path).unwrap()));
    }
    let latest = fs::read_to_string(run.join("checkpoints/LATEST")).unwrap();
    files.push((latest.clone(), fs::read(run.join("checkpoints").join(latest.trim())).unwrap()));
    files
}

/// Asserts that two runs left the same bits.
#[track_caller]
pub fn assert_same_bits(a: &Path, b: &Path) {
    let (a, b) = (lasting_files(a), lasting_files(b));
    let names = |files: &[(String, Vec<u8>)]| files.iter().map(|file| file.0.clone()).collect::<Vec<_>>();
    assert_eq!(names(&a), names(&b));
    for (a, b) in a.iter().zip(&b) {
        assert!(a.1 == b.1, "{} differs", a.0);
    }
}

pub fn frame_count(run: &Path) -> usize {
    fs::read_dir(run.join("frames")).map_or(0, |entries| {
        entries.filter(|entry| entry.as_ref().is_ok_and(|e| !e.file_name().to_string_lossy().starts_with('.'))).count()
    })
}
