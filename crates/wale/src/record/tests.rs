//! Whole run folders: kills at any moment, two claims, foreign folders, other versions.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use glam::DVec3;
use proptest::prelude::*;
use serde_json::json;

use super::*;
use crate::dynamics::State;
use crate::model::Frame;

const SCENE_TEXT: &str = "schema = 1\nname = \"a scene\"\n";
const STEPS: u64 = 12;
const STEPS_A_FRAME: u64 = 2;

/// A stand-in for a simulation, whose next state depends on all of the present one.
fn advance(state: &mut State) {
    state.step += 1;
    state.time += state.next_step_size;
    state.next_step_size = 1e-3 * (1.0 + (state.time * 50.0).sin() / 2.0);
    for (x, v) in state.coordinates.iter_mut().zip(&mut state.velocities) {
        *v = 0.9 * *v - 3.0 * *x;
        *x += state.next_step_size * *v;
    }
    state.grip_memory[0] += state.velocities[0];
}

fn first_state() -> State {
    State {
        next_step_size: 1e-3,
        coordinates: (0..10).map(|i| 0.1 + f64::from(i) / 7.0).collect(),
        velocities: vec![0.25; 10],
        grip_memory: vec![0.0],
        ..State::default()
    }
}

fn frame(state: &State) -> Frame {
    Frame {
        time: state.time,
        positions: state.coordinates.chunks_exact(5).map(DVec3::from_slice).collect(),
        sliding: state.coordinates.chunks_exact(5).map(|b| b[3]).collect(),
    }
}

fn columns() -> Vec<Column> {
    vec![Column::new("time", "s"), Column::new("work", "J")]
}

fn here() -> Environment {
    Environment::here(2)
}

fn create(folder: &Path, force: bool) -> Result<RunFolder, RecordError> {
    create_from(folder, &[], force)
}

fn create_from(folder: &Path, inputs: &[PathBuf], force: bool) -> Result<RunFolder, RecordError> {
    RunFolder::create(
        folder,
        &RunStart {
            scene: SCENE_TEXT,
            inputs,
            environment: &here(),
            columns: &columns(),
            frame_bytes: 1000,
            checkpoint_bytes: 1000,
        },
        force,
    )
}

fn observe(run: &mut RunFolder, state: &State) -> Result<(), RecordError> {
    run.write_frame(&frame(state))?;
    run.write_metrics(state.step, &[state.time, state.grip_memory[0]])?;
    run.checkpoint(state)
}

/// The loop of the program, up to a step.
fn go_on(run: &mut RunFolder, state: &mut State, last: u64) -> Result<(), RecordError> {
    while state.step < last {
        advance(state);
        run.log(&json!({"step": state.step, "step_size": state.next_step_size}))?;
        if state.step.is_multiple_of(STEPS_A_FRAME) {
            observe(run, state)?;
        }
    }
    Ok(())
}

fn run_to(folder: &Path, last: u64) -> RunFolder {
    let mut run = create(folder, false).unwrap();
    let mut state = first_state();
    observe(&mut run, &state).unwrap();
    go_on(&mut run, &mut state, last).unwrap();
    run
}

fn resume_to_the_end(folder: &Path) -> Result<Vec<String>, RecordError> {
    let interrupted = Interrupted::open(folder, &here(), false)?;
    let saved = interrupted.checkpoint.clone().map(|checkpoint| checkpoint.state);
    let notes = interrupted.notes.clone();
    let mut run = interrupted.resume(&columns())?;
    let mut state = saved.unwrap_or_else(first_state);
    if run.frame_count() == 0 {
        observe(&mut run, &state)?;
    }
    go_on(&mut run, &mut state, STEPS)?;
    run.set_status(Status::Done)?;
    Ok(notes)
}

fn files(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(folder).unwrap().to_path_buf();
                files.push((name, fs::read(&path).unwrap()));
            }
        }
    }
    files.sort();
    files
}

fn whole_run() -> Vec<(PathBuf, Vec<u8>)> {
    static WHOLE: LazyLock<Vec<(PathBuf, Vec<u8>)>> = LazyLock::new(|| {
        let folder = tempfile::tempdir().unwrap();
        run_to(folder.path(), STEPS).set_status(Status::Done).unwrap();
        files(folder.path())
    });
    WHOLE.clone()
}

#[test]
fn a_run_explains_itself() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("deep").join("run");
    let run = run_to(&path, STEPS);
    assert_eq!(run.frame_count(), STEPS / STEPS_A_FRAME + 1);
    let reader = RunReader::open(&path).unwrap();
    assert_eq!(reader.status().unwrap(), Status::Running);
    assert!(reader.is_held());
    assert_eq!(reader.summary().unwrap(), None);
    run.write_summary(&json!({"height_m": 0.5})).unwrap();
    run.set_status(Status::Done).unwrap();
    drop(run);
    assert!(!reader.is_held());
    assert_eq!(reader.status().unwrap(), Status::Done);
    assert_eq!(reader.summary().unwrap(), Some(json!({"height_m": 0.5})));
    assert_eq!(fs::read_to_string(reader.scene_path()).unwrap(), SCENE_TEXT);
    assert_eq!(reader.environment().unwrap(), here());
    assert_eq!(reader.frames().count().unwrap(), 7);
    assert_eq!(reader.checkpoint().unwrap().state.step, STEPS);
    let log = fs::read_to_string(path.join("log.jsonl")).unwrap();
    assert_eq!(log.lines().count() as u64, STEPS);
}

#[test]
fn stopped_at_any_step_and_resumed_gives_the_same_bytes() {
    let whole = whole_run();
    for stop in 0..=STEPS {
        let folder = tempfile::tempdir().unwrap();
        let run = run_to(folder.path(), stop);
        // As a kill leaves it: no status, no checkpoint at the end, half-written leftovers.
        drop(run);
        for leftover in [".STATUS.1.partial", "frames/.frame_00001.wale.1.partial"] {
            fs::write(folder.path().join(leftover), b"half").unwrap();
        }
        resume_to_the_end(folder.path()).unwrap();
        assert_eq!(files(folder.path()), whole, "stopped at step {stop}");
    }
}

#[test]
fn killed_before_the_first_checkpoint_it_begins_at_the_beginning() {
    let whole = whole_run();
    for written in 0..3 {
        let folder = tempfile::tempdir().unwrap();
        let mut run = create(folder.path(), false).unwrap();
        if written > 0 {
            run.write_frame(&frame(&first_state())).unwrap();
        }
        if written > 1 {
            run.write_metrics(0, &[0.0, 0.0]).unwrap();
        }
        drop(run);
        let notes = resume_to_the_end(folder.path()).unwrap();
        assert!(notes[0].contains("at the beginning"), "{notes:?}");
        assert_eq!(files(folder.path()), whole);
    }
}

#[test]
fn a_frame_without_its_row_and_a_row_without_its_checkpoint_are_redone() {
    let whole = whole_run();
    for rows in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        let mut run = run_to(folder.path(), 5);
        let mut state = run_state_after(6);
        run.log(&json!({"step": 6, "step_size": state.next_step_size})).unwrap();
        run.write_frame(&frame(&state)).unwrap();
        if rows {
            run.write_metrics(6, &[1.0, 2.0]).unwrap();
        }
        advance(&mut state);
        run.write_frame(&frame(&state)).unwrap();
        drop(run);
        resume_to_the_end(folder.path()).unwrap();
        assert_eq!(files(folder.path()), whole);
    }
}

fn run_state_after(steps: u64) -> State {
    let mut state = first_state();
    (0..steps).for_each(|_| advance(&mut state));
    state
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    /// Whatever a power cut did to one file's end, the run goes on to the same bytes or says what is damaged.
    #[test]
    fn a_file_cut_anywhere_is_mended_or_told(which in 0usize..100, cut in 0.0f64..1.0, stop in 2u64..STEPS) {
        let folder = tempfile::tempdir().unwrap();
        drop(run_to(folder.path(), stop));
        let before = files(folder.path());
        let (name, bytes) = &before[which % before.len()];
        let length = (cut * bytes.len() as f64) as usize;
        fs::write(folder.path().join(name), &bytes[..length]).unwrap();
        match resume_to_the_end(folder.path()) {
            Ok(_) => {
                // A finished frame is not read again, and the environment not written again.
                let kept = name.starts_with("frames") || name.ends_with("environment.json");
                for (after, whole) in files(folder.path()).iter().zip(&whole_run()) {
                    let same = after == whole || (kept && after.0 == *name);
                    prop_assert!(same, "{} cut at {}: {} differs", name.display(), length, whole.0.display());
                }
            }
            Err(error) => prop_assert!(error.is_bad_content(), "{}: {error:?}", name.display()),
        }
    }
}

#[test]
fn a_damaged_checkpoint_falls_back_and_says_so() {
    let whole = whole_run();
    let folder = tempfile::tempdir().unwrap();
    drop(run_to(folder.path(), 9));
    let latest = folder.path().join("checkpoints/step_00000008.ckpt");
    let mut bytes = fs::read(&latest).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&latest, bytes).unwrap();
    let notes = resume_to_the_end(folder.path()).unwrap();
    assert!(notes[0].contains("step_00000008.ckpt") && notes[0].contains("checksum"));
    assert_eq!(files(folder.path()), whole);
}

#[test]
fn rows_lost_behind_the_last_checkpoint_are_had_from_the_one_before() {
    let whole = whole_run();
    let folder = tempfile::tempdir().unwrap();
    drop(run_to(folder.path(), 8));
    let path = folder.path().join("metrics.csv");
    let text = fs::read(&path).unwrap();
    fs::write(&path, &text[..text.len() - 3]).unwrap();
    let notes = resume_to_the_end(folder.path()).unwrap();
    assert!(notes[0].contains("metrics.csv"), "{notes:?}");
    assert_eq!(files(folder.path()), whole);
}

#[test]
fn two_runs_in_one_folder_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let run = run_to(folder.path(), 3);
    assert!(matches!(create(folder.path(), true), Err(RecordError::InUse { .. })));
    assert!(matches!(Interrupted::open(folder.path(), &here(), false), Err(RecordError::InUse { .. })));
    drop(run);
    resume_to_the_end(folder.path()).unwrap();
}

#[test]
fn folders_with_content_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    drop(run_to(folder.path(), 3));
    let before = files(folder.path());
    let error = create(folder.path(), false).unwrap_err();
    assert!(error.to_string().contains("--force"), "{error}");
    assert_eq!(files(folder.path()), before);
    drop(create(folder.path(), true).unwrap());
    let after = files(folder.path());
    assert!(after.len() < before.len() && !after.iter().any(|f| f.0.starts_with("frames")));

    let foreign = tempfile::tempdir().unwrap();
    fs::create_dir(foreign.path().join("frames")).unwrap();
    fs::write(foreign.path().join("frames/holiday.jpg"), "x").unwrap();
    for force in [false, true] {
        let error = create(foreign.path(), force).unwrap_err();
        assert!(matches!(error, RecordError::NotEmpty { .. }), "{error}");
    }
    assert_eq!(files(foreign.path()).len(), 1, "not even a lock was left");

    let file = foreign.path().join("frames/holiday.jpg");
    assert!(matches!(create(&file, true), Err(RecordError::NotEmpty { .. })));
}

#[test]
fn a_folder_that_is_no_run_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let open = |path: &Path| Interrupted::open(path, &here(), false).unwrap_err();
    assert!(matches!(open(&folder.path().join("nowhere")), RecordError::Missing { .. }));
    assert!(matches!(open(folder.path()), RecordError::NotARun { .. }));
    assert!(matches!(RunReader::open(folder.path()).unwrap_err(), RecordError::NotARun { .. }));
    fs::write(folder.path().join("STATUS"), "\u{1b}[2J").unwrap();
    let error = open(folder.path());
    assert!(matches!(error, RecordError::Damaged { .. }));
    assert!(!error.to_string().contains('\u{1b}'), "no control codes");
}

#[test]
fn another_version_is_refused_unless_allowed() {
    let folder = tempfile::tempdir().unwrap();
    drop(run_to(folder.path(), 3));
    let path = folder.path().join("environment.json");
    let mut old = Environment::read(&path).unwrap();
    old.version = "0.0.9".to_owned();
    old.write(&path).unwrap();
    let error = Interrupted::open(folder.path(), &here(), false).unwrap_err();
    assert!(error.to_string().contains("wale 0.0.9"), "{error}");
    let interrupted = Interrupted::open(folder.path(), &here(), true).unwrap();
    assert!(interrupted.notes[0].contains("0.0.9"));
    drop(interrupted);

    old.format = 2;
    old.write(&path).unwrap();
    for allow_changed in [false, true] {
        assert!(matches!(
            Interrupted::open(folder.path(), &here(), allow_changed),
            Err(RecordError::OtherVersion { .. })
        ));
    }
}

#[test]
fn changed_inputs_are_refused_unless_allowed_and_gone_ones_told() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.toml");
    fs::write(&scene, "as it was").unwrap();
    let path = folder.path().join("run");
    let mut run = create_from(&path, std::slice::from_ref(&scene), false).unwrap();
    observe(&mut run, &first_state()).unwrap();
    drop(run);
    let open = |allow_changed| Interrupted::open(&path, &here(), allow_changed);
    assert!(open(false).unwrap().notes.is_empty());
    fs::write(&scene, "edited").unwrap();
    let error = open(false).unwrap_err();
    assert!(matches!(error, RecordError::InputChanged { .. }));
    assert!(error.to_string().contains("scene.toml"), "{error}");
    assert!(open(true).unwrap().notes[0].contains("changed"));
    fs::remove_file(&scene).unwrap();
    assert!(open(false).unwrap().notes[0].contains("gone"));

    fs::write(path.join("scene.resolved.toml"), "schema = 2\n").unwrap();
    assert!(matches!(open(false), Err(RecordError::InputChanged { .. })));
    assert_eq!(open(true).unwrap().scene, "schema = 2\n");
}

#[test]
fn a_checkpoint_of_another_scene_is_refused() {
    let (one, other) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    drop(run_to(one.path(), 3));
    let mut foreign = first_state();
    foreign.step = 99;
    Checkpoints::new(other.path().to_path_buf()).save(&foreign, &[1; 32], Marks::default()).unwrap();
    fs::copy(other.path().join("step_00000099.ckpt"), one.path().join("checkpoints/step_00000099.ckpt")).unwrap();
    assert!(matches!(Interrupted::open(one.path(), &here(), false), Err(RecordError::OtherScene { .. })));
}

#[test]
fn a_folder_that_cannot_be_made_is_told() {
    // `/proc` refuses new folders to everyone, the superuser included.
    #[cfg(target_os = "linux")]
    assert!(create(Path::new("/proc/wale-run"), false).is_err());
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "x").unwrap();
    assert!(create(&file.join("run"), false).is_err());
}

#[test]
fn too_little_space_is_told_before_anything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let error = RunFolder::create(
        folder.path(),
        &RunStart {
            scene: SCENE_TEXT,
            inputs: &[],
            environment: &here(),
            columns: &columns(),
            frame_bytes: 0,
            checkpoint_bytes: u64::MAX / 4,
        },
        false,
    )
    .unwrap_err();
    assert!(matches!(error, RecordError::TooLittleSpace { .. }), "{error}");
    assert!(!RunReader::is_run(folder.path()));
}
