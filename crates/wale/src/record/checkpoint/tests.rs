//! Checkpoints, whole and damaged.

use super::*;

const SCENE: SceneHash = [7; 32];

fn state(step: u64) -> State {
    let value = step as f64;
    State {
        time: value * 1e-3,
        step,
        next_step_size: 1.0 / 3.0,
        coordinates: (0..10).map(|i| value + f64::from(i) / 7.0).collect(),
        velocities: vec![-0.0, 1e-310, f64::MAX, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 0.1],
        anchors: vec![0.1; 4],
        obstacle_anchors: vec![1.0, 2.0, 0.5, 0.25, 0.125],
        grip_memory: vec![3.5],
    }
}

fn checkpoints() -> (tempfile::TempDir, Checkpoints) {
    let folder = tempfile::tempdir().unwrap();
    let checkpoints = Checkpoints::new(folder.path().to_path_buf());
    (folder, checkpoints)
}

fn load(checkpoints: &Checkpoints) -> Result<Found, RecordError> {
    checkpoints.load(Some(&SCENE), |_| Ok(()))
}

#[test]
fn what_is_saved_is_loaded_and_two_are_kept() {
    let (folder, checkpoints) = checkpoints();
    for step in [0, 5, 120, 99_999_999, 123_456_789] {
        let marks = Marks { frames: step, metrics: 2, log: 3 };
        let path = checkpoints.save(&state(step), &SCENE, marks).unwrap();
        assert_eq!(fs::metadata(&path).unwrap().len(), Checkpoints::byte_count(&state(step)));
        let found = load(&checkpoints).unwrap();
        assert_eq!(found.checkpoint.state, state(step));
        assert_eq!(found.checkpoint.marks, marks);
        assert!(found.passed_over.is_empty());
    }
    let steps: Vec<u64> = checkpoints.list().unwrap().iter().map(|c| c.0).collect();
    assert_eq!(steps, [123_456_789, 99_999_999]);
    assert_eq!(fs::read_to_string(folder.path().join("LATEST")).unwrap(), "step_123456789.ckpt\n");
}

#[test]
fn cut_anywhere_the_previous_stands_in_and_is_told() {
    let (_folder, checkpoints) = checkpoints();
    checkpoints.save(&state(1), &SCENE, Marks::default()).unwrap();
    let path = checkpoints.save(&state(2), &SCENE, Marks::default()).unwrap();
    let whole = fs::read(&path).unwrap();
    for length in (0..whole.len()).step_by(13) {
        fs::write(&path, &whole[..length]).unwrap();
        let found = load(&checkpoints).unwrap();
        assert_eq!(found.checkpoint.state, state(1));
        assert!(found.passed_over[0].contains("damaged"), "{:?}", found.passed_over);
    }
    fs::remove_file(&path).unwrap();
    let found = load(&checkpoints).unwrap();
    assert_eq!(found.checkpoint.state, state(1));
    assert!(found.passed_over[0].contains("gone"));
}

#[test]
fn a_checkpoint_that_does_not_fit_is_passed_over() {
    let (_folder, checkpoints) = checkpoints();
    for step in 1..3 {
        checkpoints.save(&state(step), &SCENE, Marks::default()).unwrap();
    }
    let found = checkpoints.load(None, |c| if c.state.step == 2 { Err("no".into()) } else { Ok(()) }).unwrap();
    assert_eq!(found.checkpoint.state.step, 1);
    checkpoints.remove_after(1).unwrap();
    assert_eq!(checkpoints.list().unwrap().len(), 1);
}

#[test]
fn other_scenes_and_versions_are_refused_not_passed_over() {
    let (_folder, checkpoints) = checkpoints();
    checkpoints.save(&state(1), &[8; 32], Marks::default()).unwrap();
    assert!(matches!(load(&checkpoints), Err(RecordError::OtherScene { .. })));
    let path = checkpoints.save(&state(2), &SCENE, Marks::default()).unwrap();
    let mut bytes = fs::read(&path).unwrap();
    bytes[8] = 9;
    fs::write(&path, bytes).unwrap();
    let error = load(&checkpoints).unwrap_err();
    assert!(matches!(error, RecordError::OtherVersion { .. }), "{error:?}");
    assert!(error.to_string().contains("checkpoint format 9"));
}

#[test]
fn none_at_all_is_told_with_a_mend() {
    let (_folder, checkpoints) = checkpoints();
    let error = load(&checkpoints).unwrap_err().to_string();
    assert!(error.contains("no checkpoint") && error.contains("--force"));
}

#[test]
fn a_state_that_contradicts_itself_is_damaged() {
    for bad in [
        State { velocities: vec![0.0; 5], ..state(1) },
        State { anchors: vec![f64::NAN], ..state(1) },
        State { time: f64::INFINITY, ..state(1) },
    ] {
        let mut bytes = Vec::new();
        with_writer(&bad, &SCENE, Marks::default(), |w| w.write_to(&mut bytes)).unwrap();
        assert!(matches!(parse(&bytes), Err(BinaryError::Table(_))));
    }
}

/// Files that once were a danger to readers of such formats; kept under `tests/corpus/checkpoint`.
#[test]
fn the_corpus_is_answered_without_a_panic() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus/checkpoint");
    let mut seen = 0;
    for entry in fs::read_dir(corpus).unwrap() {
        let path = entry.unwrap().path();
        assert!(read(&path).is_err(), "{}", path.display());
        seen += 1;
    }
    assert!(seen >= 8, "only {seen} files");
}

proptest::proptest! {
    #[test]
    fn bytes_after_the_magic_never_panic(bytes in proptest::collection::vec(proptest::num::u8::ANY, 0..400)) {
        let mut hostile = MAGIC.to_vec();
        hostile.extend(VERSION.to_le_bytes());
        hostile.extend(bytes);
        proptest::prop_assert!(parse(&hostile).is_err());
    }
}
