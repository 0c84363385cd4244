//! Programs of knitting machines: every loop that they make is found again.

mod cards;
mod shared;

use std::path::Path;

use cards::cards;
use shared::shared;
use wale::pattern::knit;
use wale::pattern::knitout::read_knitout;

/// Loops that a program makes, counted from its words alone.
fn loops_written(text: &str) -> usize {
    let makes = |line: &&str| {
        let words: Vec<&str> = line.split(';').next().unwrap_or_default().split_ascii_whitespace().collect();
        match words.as_slice() {
            ["knit" | "tuck", _, _, _, ..] => true,
            ["split", _, _, _, carriers @ ..] => !carriers.is_empty(),
            _ => false,
        }
    };
    text.lines().filter(makes).count()
}

fn check(path: &Path) {
    let text = std::fs::read_to_string(path).unwrap();
    let (_, card) = cards();
    let knitted = read_knitout(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    assert_eq!(knitted.graph.loops.len(), loops_written(&text), "{}", path.display());
    let network = knit::network(&knitted.graph, &card);
    assert_eq!(network.loops.len(), knitted.graph.loops.len());
    assert!(network.position.iter().all(|x| x.is_finite()));
    let rising = |y: usize| {
        let passes = network.yarn_passes(wale::model::YarnId::new(y));
        network.arc_length[passes].windows(2).all(|pair| pair[1] > pair[0])
    };
    assert!((0..network.yarn_count()).all(rising), "{}", path.display());
    println!("{}: {} loops", path.display(), knitted.graph.loops.len());
}

#[test]
fn our_own_sampler_is_knitted_whole() {
    check(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/patterns/sampler.k"));
}

#[test]
fn collected_programs_are_knitted_whole() {
    let Some(folder) = shared("knitout") else { return };
    let mut count = 0;
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|kind| kind == "k" || kind == "knitout") {
            check(&path);
            count += 1;
        }
    }
    assert!(count > 0, "{} has no programs", folder.display());
}
