//! No bytes make a reader panic: the kept corpus, cut short in many places and spoilt in many ways.
//!
//! What broke a reader once, or its fuzz target (`tools/fuzz`), lies in the corpus.

mod reading;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Longest that one file may take to be read; most of them are small, and the slowest ask for the largest charts.
const PATIENCE: Duration = Duration::from_secs(20);
/// Most memory that the reading of one file may hold at a time \[bytes\]: the largest chart and its yarns.
const MOST_MEMORY: u64 = 2 << 30;

fn corpus(kind: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus").join(kind);
    let mut files: Vec<_> = std::fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .map(|path| (path.clone(), std::fs::read(path).unwrap()))
        .collect();
    assert!(files.len() >= 3, "the corpus of {kind} is gone");
    files.sort();
    files
}

/// The beginnings of some bytes, and the bytes with some exchanged for others of the same file or of a few signs.
fn spoilt(bytes: &[u8]) -> impl Iterator<Item = Vec<u8>> + '_ {
    let stride = bytes.len() / 200 + 1;
    let beginnings = (0..bytes.len()).step_by(stride).map(|end| bytes[..end].to_vec());
    // A small generator of our own keeps every run the same [Knuth, MMIX].
    let mut state = 1_u64;
    let mut random = move |limit: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % limit.max(1)
    };
    let signs = b"*[](),;:#\"'{}=.-9kp\n\0\xff";
    let exchanged = (0..300).map(move |_| {
        let mut copy = bytes.to_vec();
        for _ in 0..=random(4) {
            let (at, from) = (random(copy.len()), random(copy.len()));
            match random(4) {
                0 if !copy.is_empty() => copy[at] = signs[random(signs.len())],
                1 if !copy.is_empty() => copy[at] = copy[from],
                2 if !copy.is_empty() => drop(copy.remove(at)),
                _ => copy.insert(at, signs[random(signs.len())]),
            }
        }
        copy
    });
    beginnings.chain(exchanged)
}

/// Reads a corpus and what becomes of it; at least so many are read, and so many refused.
fn check(kind: &str, reader: fn(&[u8]) -> bool, [least_read, least_refused]: [usize; 2]) {
    let (mut read, mut refused) = (0, 0);
    for (path, bytes) in corpus(kind) {
        let began = Instant::now();
        let memory = allocation_counter::measure(|| {
            reader(&bytes);
        });
        assert!(began.elapsed() < PATIENCE, "{} took {:?}", path.display(), began.elapsed());
        assert!(memory.bytes_max < MOST_MEMORY, "{} took {} bytes", path.display(), memory.bytes_max);
        for bytes in std::iter::once(bytes.clone()).chain(spoilt(&bytes)) {
            let answer = std::panic::catch_unwind(|| reader(&bytes));
            let answer = answer.unwrap_or_else(|_| panic!("{}: {}", path.display(), String::from_utf8_lossy(&bytes)));
            *if answer { &mut read } else { &mut refused } += 1;
        }
    }
    assert!(read >= least_read && refused >= least_refused, "{kind}: {read} read, {refused} refused");
}

#[test]
fn scenes_are_read_or_refused_with_a_place_inside_the_text() {
    check("scene", reading::scene, [100, 100]);
    // Files that are not text are refused, too.
    for (path, _) in corpus("scene") {
        let _ = wale::scene::Scene::read(&path);
    }
}

#[test]
fn instructions_are_read_or_refused_with_a_place_inside_the_text() {
    check("instructions", reading::instructions, [20, 100]);
}

#[test]
fn symbols_are_read_or_refused_with_a_place_inside_the_line() {
    check("symbols", reading::symbols, [10, 100]);
}

#[test]
fn programs_of_machines_are_read_or_refused_with_a_place_inside_the_text() {
    check("knitout", reading::knitout, [100, 100]);
}

#[test]
fn drafts_are_read_or_refused_with_a_place_inside_the_text() {
    check("wif", reading::wif, [100, 100]);
}

#[test]
fn images_are_read_or_refused() {
    check("image", reading::image, [20, 100]);
}

#[test]
fn checkpoints_and_frames_are_read_or_refused() {
    check("checkpoint", reading::saved, [1, 100]);
    check("saved", reading::saved, [10, 100]);
}
