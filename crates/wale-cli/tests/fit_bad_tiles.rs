//! `wale fit` of tiles that are no fabric ends with one error, before anything is fitted.

mod fits;

use std::fs;

use fits::{fit, said, small_fabric};

/// A weave of a yarn along each period, four vertices each, of which those along the warp lie `height` higher where they cross.
fn tile(height: f64, period: f64) -> String {
    let mut text = format!("*pattern\n{period} 0.004 0.0004 8\n*Q\n");
    for k in 0..4 {
        text += &format!("{} 0.001 0\n", 0.001 * f64::from(k));
    }
    for k in 0..4 {
        text += &format!("0.001 {} {height}\n", 0.001 * f64::from(k));
    }
    text += "*E\n0 1 0 0\n1 2 0 0\n2 3 0 0\n3 0 1 0\n4 5 0 0\n5 6 0 0\n6 7 0 0\n7 4 0 1\n*RL\n";
    text += &"0.001\n".repeat(8);
    text += "*RK\n";
    text + &"0 0\n".repeat(8)
}

#[test]
fn tiles_that_are_no_fabric_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let fabric = small_fabric(folder.path(), "weave", "stockinette", [0.05, 0.15, 0.4]);
    let text = fs::read_to_string(&fabric).unwrap().replace("scene = \"scene.toml\"", "tile = \"tile.pyp\"");
    fs::write(&fabric, text).unwrap();
    let good = tile(0.0008, 0.004);
    for (bad, says) in [
        (tile(0.0, 0.004), "pass through each other near the vertices"),
        (tile(0.0008, 0.006), "do not close: the edge from vertex 3 to vertex 0 is 3.00 times"),
        (good.replace("3 0 1 0\n", ""), "tile.pyp"),
        (good.replace("3 0 1 0\n", "3 1 1 0\n"), "edges end and"),
    ] {
        fs::write(fabric.with_file_name("tile.pyp"), bad).unwrap();
        let refused = fit(&[&fabric], &[], "");
        assert_eq!(refused.status.code(), Some(3), "{says}: {}", said(&refused));
        assert!(said(&refused).contains(says) && said(&refused).lines().count() < 4, "{says}: {}", said(&refused));
        assert!(!fabric.with_extension("fit").exists(), "{says}");
    }
}
