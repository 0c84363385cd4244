//! Tiles that tests are made with: a straight yarn, a plain weave, a stockinette loop.

use std::f64::consts::TAU;

use super::tile::{Edge, YarnTile};

/// Yarns given as closed rows of vertices, each with the tile its last edge leads into.
fn of_rows(periods: [f64; 2], radius: f64, rows: &[(Vec<[f64; 3]>, [i32; 2])]) -> YarnTile {
    let (mut vertices, mut edges) = (Vec::new(), Vec::new());
    for (row, last) in rows {
        let (first, n) = (vertices.len() as u32, row.len() as u32);
        vertices.extend(row);
        edges.extend(
            (0..n).map(|k| Edge {
                ends: [first + k, first + (k + 1) % n],
                shift: if k + 1 == n { *last } else { [0, 0] },
            }),
        );
    }
    YarnTile::new(periods, radius, vertices, edges).expect("a tile")
}

/// A straight yarn along the first period, alone.
pub fn straight(n: usize) -> YarnTile {
    let row = (0..n).map(|k| [0.01 * k as f64 / n as f64, 0.003, 0.0]).collect();
    of_rows([0.01, 0.008], 0.001, &[(row, [1, 0])])
}

/// A plain weave of two warp and two weft yarns that lie just on each other, millimetres thick.
pub fn basket() -> YarnTile {
    let (period, radius, n) = (0.0068, 0.001, 12);
    let height = |phase: f64, sign: f64| sign * radius * 0.95 * phase.cos();
    let mut rows = Vec::new();
    for yarn in 0..2 {
        let (across, sign) = (period * (0.25 + 0.5 * f64::from(yarn)), if yarn == 0 { 1.0 } else { -1.0 });
        let at = |k: u32| {
            (period * (0.02 + f64::from(k)) / f64::from(n), TAU * ((0.02 + f64::from(k)) / f64::from(n) - 0.25))
        };
        rows.push(((0..n).map(|k| [at(k).0, across, height(at(k).1, sign)]).collect(), [1, 0]));
        rows.push(((0..n).map(|k| [across, at(k).0, height(at(k).1, -sign)]).collect(), [0, 1]));
    }
    of_rows([period, period], radius, &rows)
}

/// One loop of stockinette, a curve in closed form that interlocks with its images and just touches them.
pub fn stockinette() -> YarnTile {
    let (wale, course, radius, n) = (0.0075, 0.006, 0.0009, 40);
    let point = |k: u32| {
        let t = TAU * (f64::from(k) + 0.3) / f64::from(n);
        let x = wale * (t / TAU + 0.225 * (2.0 * t).sin());
        [x, -0.9 * course * t.cos(), 0.16 * wale * (2.0 * t).cos()]
    };
    of_rows([wale, course], radius, &[((0..n).map(point).collect(), [1, 0])])
}
