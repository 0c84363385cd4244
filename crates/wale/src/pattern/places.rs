//! Where the loops of a graph lie in the plain layout.

use super::loops::{Form, Form2d, LoopGraph};

/// Rounds in which rows of unequal counts find their places.
const ROUNDS: usize = 60;

/// Least distance of two bound-off loops, in columns.
const BOUND: f64 = 0.6;

/// Gives every loop its place, in columns and rows. `counts` are the places on the needle of the cast-on and after
/// each row.
///
/// Where all counts are alike, places are those of the needle. Otherwise a tube or a tile spreads each row over its
/// whole width, and in a sheet loops lie one column apart and above their parents as well as both can be had.
pub(super) fn lay_out(graph: &mut LoopGraph, counts: &[usize]) {
    let columns = f64::from(graph.size[1]);
    let count = |row: i32| counts[usize::try_from(row + 1).unwrap_or(0)] as f64;
    for at in &mut graph.loops {
        let middle = if at.form == Form::Lifted { 0.0 } else { 0.5 };
        let count = count(at.row);
        let column = f64::from(at.column) + middle;
        at.place = match graph.form {
            Form2d::Sheet => [column + 0.5 * (columns - count), f64::from(at.row)],
            _ => [column * columns / count, f64::from(at.row)],
        };
    }
    if graph.form == Form2d::Sheet && counts.iter().any(|count| *count != counts[0]) {
        settle(graph);
    }
    let mut least = f64::NEG_INFINITY;
    for bound in &mut graph.bound {
        let xs = bound.loops.iter().map(|id| graph.loops[id.index()].place[0]);
        // What was slipped up to here may come from another place of its row.
        bound.place[0] = (xs.sum::<f64>() / bound.loops.len().max(1) as f64).max(least);
        least = bound.place[0] + BOUND;
    }
}

/// Gauss–Seidel over `Σ (x_right − x_left − 1)² + ½ Σ (x_child − x_parent)²`.
fn settle(graph: &mut LoopGraph) {
    // The next loop of the row on either side, with its distance; loops of a row follow each other in the list.
    let n = graph.loops.len();
    let mut left: Vec<Option<(usize, f64)>> = vec![None; n];
    let mut right = left.clone();
    let mut last: Option<usize> = None;
    for at in (0..n).filter(|at| graph.loops[*at].form != Form::Lifted) {
        if let Some(before) = last.filter(|before| graph.loops[*before].row == graph.loops[at].row) {
            let apart = f64::from(graph.loops[at].column) - f64::from(graph.loops[before].column);
            left[at] = Some((before, apart));
            right[before] = Some((at, apart));
        }
        last = Some(at);
    }
    for _ in 0..ROUNDS {
        for at in 0..n {
            let mut sum = 0.0;
            let mut weight = 0.0;
            let mut pull = |x: f64, w: f64| {
                sum += w * x;
                weight += w;
            };
            if let Some((before, apart)) = left[at] {
                pull(graph.loops[before].place[0] + apart, 1.0);
            }
            if let Some((after, apart)) = right[at] {
                pull(graph.loops[after].place[0] - apart, 1.0);
            }
            let of = &graph.loops[at];
            for held in of.parents.iter().chain(&of.children) {
                pull(graph.loops[held.of.index()].place[0], 0.5);
            }
            if weight > 0.0 {
                graph.loops[at].place[0] = sum / weight;
            }
        }
    }
}
