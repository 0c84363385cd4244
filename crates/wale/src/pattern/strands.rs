//! Along which loops each yarn of a chart runs, from its first end to its last.

use super::loops::{Form, LoopGraph, LoopId, Onward, Stop, Strand};
use super::working::Working;

/// Columns from an edge within which a yarn turns there; farther inside it goes straight up to its next row.
const EDGE: i32 = 1;
/// Columns that a yarn is carried inside the fabric, from the last loop of a row to its first of a later row; farther away
/// it is cut, and a new end begins.
const CARRIED_COLUMNS: f64 = 3.0;
/// Rows that a yarn is carried up.
const CARRIED_ROWS: i32 = 6;

/// A loop that a yarn makes in a row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Made {
    pub id: LoopId,
    /// Twice its place on the needle; odd for a strand lifted between two places.
    pub twice_column: i32,
    pub yarn: u8,
}

/// The loops of a row, from the left.
#[derive(Clone, Debug, Default)]
pub(super) struct Course {
    pub stitches: Vec<Made>,
}

impl Course {
    pub fn add(&mut self, id: LoopId, column: usize, yarn: u8) {
        let twice_column = twice(column);
        self.stitches.push(Made { id, twice_column, yarn });
    }

    /// Lifts the strand on the left of a place; it is of the yarn that runs there.
    pub fn lift(&mut self, id: LoopId, column: usize, yarn: u8) {
        let twice_column = twice(column) - 1;
        let at = self.stitches.partition_point(|made| made.twice_column <= twice_column);
        let near = self.stitches.get(at).or(self.stitches.last());
        let yarn = near.map_or(yarn, |made| made.yarn);
        self.stitches.insert(at, Made { id, twice_column, yarn });
    }

    /// The yarns of the row in the order in which they are first used, and the loops of each in the order of work.
    fn by_yarn(&self, rightward: bool) -> Vec<(u8, Vec<Made>)> {
        let mut found: Vec<(u8, Vec<Made>)> = Vec::new();
        let mut take = |made: Made| match found.iter_mut().find(|(yarn, _)| *yarn == made.yarn) {
            Some((_, loops)) => loops.push(made),
            None => found.push((made.yarn, vec![made])),
        };
        if rightward {
            self.stitches.iter().copied().for_each(&mut take);
        } else {
            self.stitches.iter().rev().copied().for_each(&mut take);
        }
        found
    }
}

/// Charts are limited to 16 million loops.
fn twice(column: usize) -> i32 {
    2 * i32::try_from(column).unwrap_or(i32::MAX / 4)
}

/// Places floated over from one loop of a row to the next.
fn over(from: Made, to: Made) -> u32 {
    (from.twice_column.abs_diff(to.twice_column) / 2).saturating_sub(1)
}

/// Every row of every yarn as a strand that closes on its image.
pub(super) fn periodic(courses: &[Course], counts: &[usize]) -> Vec<Strand> {
    let mut strands = Vec::new();
    for (row, course) in courses.iter().enumerate() {
        let around = twice(counts[row + 1]);
        for (yarn, loops) in course.by_yarn(true) {
            let (first, last) = (loops[0], loops[loops.len() - 1]);
            let image = Made { twice_column: first.twice_column + around, ..first };
            let next = loops.iter().copied().skip(1).chain([image]);
            let stops = loops
                .iter()
                .zip(next)
                .map(|(made, next)| {
                    (Stop::Loop { id: made.id, rightward: true }, Onward::Sinker { over: over(*made, next) })
                })
                .collect();
            debug_assert!(last.twice_column < image.twice_column);
            strands.push(Strand { yarn, stops });
        }
    }
    strands
}

/// A yarn that is being worked with.
struct Open {
    strand: Strand,
    /// The row it was last used in, the loop, and the way it ran.
    last: (i32, Made, bool),
}

/// The yarns of a finite fabric; `courses` begin with the cast-on.
pub(super) fn finite(graph: &LoopGraph, courses: &[Course], working: Working, counts: &[usize]) -> Vec<Strand> {
    let round = working == Working::Round;
    let mut open: Vec<Open> = Vec::new();
    let mut done: Vec<Strand> = Vec::new();
    for (index, course) in courses.iter().enumerate() {
        let row = index as i32 - 1;
        // The cast-on runs against the first row, so that the yarn turns once more; in the round it does not turn.
        let rightward = match usize::try_from(row) {
            Ok(row) => working.left_to_right(row),
            Err(_) => !round && !working.left_to_right(0),
        };
        for (yarn, loops) in course.by_yarn(rightward) {
            let first = loops[0];
            let known = open.iter().position(|known| known.strand.yarn == yarn);
            let joined = known
                .and_then(|known| join(graph, &mut open[known], row, first, rightward, round, counts).then_some(known));
            let at = joined.unwrap_or_else(|| {
                if let Some(known) = known {
                    done.push(ended(graph, open.remove(known)));
                }
                let mut strand = Strand { yarn, stops: Vec::new() };
                let tail = if index == 0 {
                    Stop::Beside { row: 0, offset: -1.0, right: !rightward }
                } else if at_edge(first, rightward, counts[index]) || round {
                    Stop::Beside { row, offset: -0.3, right: !rightward }
                } else {
                    behind(graph, first)
                };
                strand.stops.push((tail, Onward::Edge));
                open.push(Open { strand, last: (row, first, rightward) });
                open.len() - 1
            });
            let known = &mut open[at];
            let chain = index == 0;
            for (k, made) in loops.iter().enumerate() {
                let onward = match loops.get(k + 1) {
                    None => Onward::Edge,
                    // A strand lifted out of the cast-on is no chain.
                    Some(next) if chain && (made.twice_column | next.twice_column) & 1 == 0 => Onward::Chain,
                    Some(next) => Onward::Sinker { over: over(*made, *next) },
                };
                known.strand.stops.push((Stop::Loop { id: made.id, rightward }, onward));
            }
            known.last = (row, loops[loops.len() - 1], rightward);
        }
    }
    let rows = courses.len() as i32 - 1;
    for mut known in open {
        let (row, last, rightward) = known.last;
        if row + 1 == rows && (round || ends_at_edge(last, rightward, counts[counts.len() - 1])) {
            let tail = Stop::Beside { row: rows, offset: -0.5, right: rightward };
            known.strand.stops.push((tail, Onward::Edge));
            done.push(known.strand);
        } else {
            done.push(ended(graph, known));
        }
    }
    // The yarn that casts on comes first.
    done.sort_by_key(|strand| !is_cast_on(graph, strand));
    done
}

fn is_cast_on(graph: &LoopGraph, strand: &Strand) -> bool {
    matches!(strand.stops.get(1), Some((Stop::Loop { id, .. }, _)) if graph.of(*id).row < 0)
}

/// Whether a loop is where a row that runs this way begins.
fn at_edge(made: Made, rightward: bool, count: usize) -> bool {
    let last = twice(count) - 2;
    if rightward { made.twice_column <= 2 * EDGE } else { made.twice_column + 2 * EDGE >= last }
}

/// Whether a loop is where a row that runs this way ends.
fn ends_at_edge(made: Made, rightward: bool, count: usize) -> bool {
    at_edge(made, !rightward, count)
}

fn behind(graph: &LoopGraph, made: Made) -> Stop {
    Stop::Behind { place: graph.of(made.id).place }
}

/// Ends a yarn where it was last used.
fn ended(graph: &LoopGraph, mut open: Open) -> Strand {
    open.strand.stops.push((behind(graph, open.last.1), Onward::Edge));
    open.strand
}

/// Leads a yarn from where it was last used to its first loop of a row, if it can be carried there.
fn join(
    graph: &LoopGraph,
    open: &mut Open,
    row: i32,
    first: Made,
    rightward: bool,
    round: bool,
    counts: &[usize],
) -> bool {
    let (last_row, last, last_rightward) = open.last;
    let at = |row: i32| usize::try_from(row + 1).unwrap_or(0);
    let next_row = row == last_row + 1;
    let Some((_, onward)) = open.strand.stops.last_mut() else { return false };
    if round && next_row {
        // From the cast-on the yarn steps up; then every round goes on from the one before, leftward.
        if last_row < 0 {
            return true;
        }
        let places = u32::try_from(counts[at(last_row)]).unwrap_or(u32::MAX);
        let column = |made: Made| u32::try_from(made.twice_column / 2).unwrap_or(0);
        let left = column(last);
        let skipped = (places.saturating_sub(1)).saturating_sub(column(first));
        // Once around to where it was is no float but a new end.
        let carried = left + skipped + 1 < places || places == 1;
        if carried {
            *onward = Onward::Sinker { over: left + skipped };
        }
        return carried;
    }
    let turns = last_rightward != rightward
        && ends_at_edge(last, last_rightward, counts[at(last_row)])
        && at_edge(first, rightward, counts[at(row)]);
    // The last nodes of a yarn-over are its child's: straight back to that child, the yarn would fold in two.
    let over = matches!(graph.of(last.id).form, Form::Open | Form::Lifted);
    if turns {
        if over {
            open.strand.stops.push((Stop::Beside { row: last_row, offset: -0.2, right: last_rightward }, Onward::Edge));
        }
        open.strand.stops.push((Stop::Beside { row, offset: -0.7, right: last_rightward }, Onward::Edge));
        return true;
    }
    let (a, b) = (graph.of(last.id).place, graph.of(first.id).place);
    let columns = f64::from(graph.size[1]);
    let apart = (a[0] - b[0]).abs();
    let apart = if round { apart.min(columns - apart) } else { apart };
    let carried = apart <= CARRIED_COLUMNS && row - last_row <= CARRIED_ROWS;
    if carried {
        if over {
            open.strand.stops.push((Stop::Behind { place: [a[0] + 0.5, a[1]] }, Onward::Edge));
        }
        let way = Stop::Behind { place: [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])] };
        open.strand.stops.push((way, Onward::Edge));
    }
    carried
}
