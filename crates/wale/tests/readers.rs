//! No text makes a reader panic: the kept corpus, cut short at every byte and spoilt in many ways.

use std::path::{Path, PathBuf};

use wale::pattern::instructions::read_instructions;
use wale::pattern::symbols::{default_legend, read_symbols};
use wale::scene::Scene;

fn corpus(kind: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus").join(kind);
    let files: Vec<_> = std::fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .map(|path| (path.clone(), std::fs::read(path).unwrap()))
        .collect();
    assert!(files.len() >= 3, "the corpus of {kind} is gone");
    files
}

/// The text itself, its beginnings, and texts with bytes exchanged for others of the same text or of a few signs.
fn spoilt(bytes: &[u8]) -> Vec<String> {
    let mut texts = vec![String::from_utf8_lossy(bytes).into_owned()];
    let stride = bytes.len() / 200 + 1;
    for end in (0..bytes.len()).step_by(stride) {
        texts.push(String::from_utf8_lossy(&bytes[..end]).into_owned());
    }
    // A small generator of our own keeps every run the same [Knuth, MMIX].
    let mut state = 1_u64;
    let mut random = |limit: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % limit.max(1)
    };
    let signs = b"*[](),;:#\"'{}=.-9kp\n\0\xff";
    for _ in 0..300 {
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
        texts.push(String::from_utf8_lossy(&copy).into_owned());
    }
    texts
}

#[test]
fn scenes_are_read_or_refused_with_a_place_inside_the_text() {
    let (mut read, mut refused) = (0, 0);
    for (path, bytes) in corpus("scene") {
        for text in spoilt(&bytes) {
            match Scene::from_text(&text, "scene.toml") {
                Ok(_) => read += 1,
                Err(error) => {
                    assert!(!error.what().is_empty(), "{}", path.display());
                    if let Some((line, _)) = error.line_and_column() {
                        assert!(line <= text.matches('\n').count() + 1);
                    }
                    refused += 1;
                }
            }
        }
        // Files that are not text are refused, too.
        let _ = Scene::read(&path);
    }
    assert!(read > 100 && refused > 100, "{read} read, {refused} refused");
}

#[test]
fn instructions_are_read_or_refused_with_a_place_inside_the_text() {
    let (mut read, mut refused) = (0, 0);
    for (path, bytes) in corpus("instructions") {
        for text in spoilt(&bytes) {
            match read_instructions(&text, Some(8)) {
                Ok(_) => read += 1,
                Err(error) => {
                    assert!(text.get(error.span.clone()).is_some(), "{}: {error}", path.display());
                    refused += 1;
                }
            }
        }
    }
    assert!(read > 20 && refused > 100, "{read} read, {refused} refused");
}

#[test]
fn symbols_are_read_or_refused_with_a_place_inside_the_line() {
    let (mut read, mut refused) = (0, 0);
    for (_, bytes) in corpus("symbols") {
        for text in spoilt(&bytes) {
            let lines: Vec<&str> = text.lines().collect();
            match read_symbols(&lines, &default_legend()) {
                Ok(_) => read += 1,
                Err(error) => {
                    if let Some(bytes) = error.bytes {
                        assert!(lines[error.line].get(bytes).is_some());
                    }
                    refused += 1;
                }
            }
        }
    }
    assert!(read > 10 && refused > 100, "{read} read, {refused} refused");
}
