//! Works a chart, stitch by stitch, to the graph of its loops.

use super::chart::{Chart, ChartError};
use super::increase::Part;
use super::loops::{Bound, Form, Form2d, Held, Loop, LoopGraph, LoopId};
use super::places;
use super::stitch::Stitch;
use super::strands::{self, Course};
use super::working::Working;

/// Works a finite fabric: cast-on, the rows of the chart, bind-off.
#[must_use]
pub fn work(chart: &Chart, working: Working) -> LoopGraph {
    let form = if working == Working::Round { Form2d::Tube } else { Form2d::Sheet };
    let mut worker = Worker::new(chart, form);
    let columns = chart.cast_on();
    let mut needle = Vec::with_capacity(columns);
    let mut cast_on = Course::default();
    let yarn = chart.yarn(0, if working.left_to_right(0) { 0 } else { chart.rows()[0].len() - 1 });
    for column in 0..columns {
        let id = worker.add(Form::CastOn, -1, column, Vec::new());
        cast_on.add(id, column, yarn);
        needle.push(vec![Held { of: id, image: [0; 2] }]);
    }
    worker.courses.push(cast_on);
    for row in 0..chart.row_count() {
        needle = worker.row(row, needle);
    }
    let mut graph = worker.graph;
    for (column, loops) in needle.iter().enumerate() {
        let loops: Vec<LoopId> = loops.iter().map(|held| held.of).collect();
        for id in &loops {
            graph.loops[id.index()].bound = u32::try_from(graph.bound.len()).ok();
        }
        graph.bound.push(Bound { loops, place: [column as f64 + 0.5, chart.row_count() as f64] });
    }
    graph.find_children();
    places::lay_out(&mut graph, &worker.counts);
    graph.strands = strands::finite(&graph, &worker.courses, working, &worker.counts);
    let last = worker.courses.last().and_then(|course| course.stitches.last());
    graph.bind_off_yarn = last.map_or(0, |stitch| stitch.yarn);
    graph
}

/// Works the chart as a tile that repeats in both directions; every row is a yarn of its own that closes on its image.
///
/// # Errors
/// If the chart cannot be repeated without end.
pub fn work_tile(chart: &Chart) -> Result<LoopGraph, ChartError> {
    chart.check_repeats()?;
    let mut worker = Worker::new(chart, Form2d::Tile);
    let columns = chart.cast_on();
    // Before the last row is worked its loops have no names yet: loops past the end stand for them.
    let unnamed = chart.loop_count() + 2 * chart.rows().iter().map(Vec::len).sum::<usize>();
    let start = |column: usize| vec![Held { of: LoopId::new(unnamed + column), image: [0; 2] }];
    let mut needle: Vec<Vec<Held>> = (0..columns).map(start).collect();
    worker.courses.push(Course::default());
    for row in 0..chart.row_count() {
        needle = worker.row(row, needle);
    }
    let Worker { mut graph, mut courses, counts, .. } = worker;
    // What was lifted from below the first row lies in the last row, one image down.
    let below = courses.remove(0);
    let lifted: Vec<LoopId> = below.stitches.iter().map(|stitch| stitch.id).collect();
    if let Some(last) = courses.last_mut() {
        last.stitches.extend(below.stitches);
        last.stitches.sort_by_key(|stitch| stitch.twice_column);
    }
    let down = |held: Held| Held { image: [held.image[0], held.image[1] - 1], ..held };
    let name = |held: Held| -> Vec<Held> {
        let mut found = Vec::new();
        let mut open = vec![held];
        while let Some(held) = open.pop() {
            match held.of.index().checked_sub(unnamed) {
                Some(column) => {
                    let at = |inner: &Held| down(Held { image: held.image, ..*inner });
                    open.extend(needle[column].iter().rev().map(at));
                }
                None if lifted.contains(&held.of) => found.push(down(held)),
                None => found.push(held),
            }
        }
        found
    };
    for at in 0..graph.loops.len() {
        let parents = std::mem::take(&mut graph.loops[at].parents);
        graph.loops[at].parents = parents.into_iter().flat_map(&name).collect();
    }
    for id in lifted {
        graph.loops[id.index()].row = graph.size[0] as i32 - 1;
    }
    graph.find_children();
    places::lay_out(&mut graph, &counts);
    graph.strands = strands::periodic(&courses, &counts);
    Ok(graph)
}

struct Worker<'a> {
    chart: &'a Chart,
    graph: LoopGraph,
    /// The cast-on and the rows, with what each yarn makes in them.
    courses: Vec<Course>,
    /// Places on the needle: of the cast-on, and after each row.
    counts: Vec<usize>,
}

impl<'a> Worker<'a> {
    fn new(chart: &'a Chart, form: Form2d) -> Self {
        // Charts are limited to 16 million loops.
        let size = [chart.row_count(), chart.column_count()].map(|n| u32::try_from(n).unwrap_or(u32::MAX));
        let loops = Vec::with_capacity(chart.loop_count() + chart.cast_on());
        let row_places = Vec::with_capacity(chart.row_count());
        let graph =
            LoopGraph { form, size, row_places, loops, strands: Vec::new(), bound: Vec::new(), bind_off_yarn: 0 };
        Self { chart, graph, courses: Vec::new(), counts: vec![chart.cast_on()] }
    }

    fn add(&mut self, form: Form, row: i32, column: usize, parents: Vec<Held>) -> LoopId {
        let id = LoopId::new(self.graph.loops.len());
        let column = u32::try_from(column).unwrap_or(u32::MAX);
        let place = [f64::from(column) + 0.5, f64::from(row)];
        self.graph.loops.push(Loop {
            form,
            row,
            column,
            place,
            depth: 0.0,
            parents,
            children: Vec::new(),
            bound: None,
            source: 0,
        });
        id
    }

    /// Works a row into what is on the needle, and returns what is on it then.
    fn row(&mut self, row: usize, needle: Vec<Vec<Held>>) -> Vec<Vec<Held>> {
        let stitches = &self.chart.rows()[row];
        let index = row as i32;
        let mut above = Vec::with_capacity(needle.len());
        let mut below = needle.into_iter();
        let mut worked = 0;
        let mut course = Course::default();
        for (at, stitch) in stitches.iter().enumerate() {
            let yarn = self.chart.yarn(row, at);
            let taken: Vec<Vec<Held>> = below.by_ref().take(stitch.takes()).collect();
            worked += taken.len();
            let new = |id| Held { of: id, image: [0; 2] };
            let column = above.len();
            match *stitch {
                Stitch::Knit | Stitch::Purl | Stitch::Together { .. } => {
                    let knit = stitch.is_knit().unwrap_or(true);
                    let order = stitch.front_to_back();
                    let parents = order.into_iter().flat_map(|k| front_to_back(&taken[k], knit)).collect();
                    let id = self.add(Form::Worked { knit }, index, column, parents);
                    course.add(id, column, yarn);
                    above.push(vec![new(id)]);
                }
                Stitch::YarnOver => {
                    let id = self.add(Form::Open, index, column, Vec::new());
                    course.add(id, column, yarn);
                    above.push(vec![new(id)]);
                }
                Stitch::Increase(parts) => {
                    // A right-side row works from the right.
                    for part in parts.iter().rev() {
                        let column = above.len();
                        let knit = part == Part::Knit;
                        let (form, parents) = match part {
                            Part::YarnOver => (Form::Open, Vec::new()),
                            _ => (Form::Worked { knit }, front_to_back(&taken[0], knit)),
                        };
                        let id = self.add(form, index, column, parents);
                        course.add(id, column, yarn);
                        above.push(vec![new(id)]);
                    }
                }
                Stitch::Lifted { knit } => {
                    let bar = self.add(Form::Lifted, index - 1, worked, Vec::new());
                    if let Some(below) = self.courses.last_mut() {
                        below.lift(bar, worked, yarn);
                    }
                    let id = self.add(Form::Worked { knit }, index, column, vec![new(bar)]);
                    course.add(id, column, yarn);
                    above.push(vec![new(id)]);
                }
                Stitch::Slip { .. } => above.extend(taken),
                Stitch::Tuck => {
                    let id = self.add(Form::Open, index, column, Vec::new());
                    course.add(id, column, yarn);
                    let mut held = taken.into_iter().flatten().collect::<Vec<_>>();
                    held.push(new(id));
                    above.push(held);
                }
            }
        }
        self.counts.push(above.len());
        self.graph.row_places.push(u32::try_from(above.len()).unwrap_or(u32::MAX));
        self.courses.push(course);
        above
    }
}

/// The loops of a place of the needle, front to back: what was laid on later lies behind where it is knitted, in front
/// where it is purled.
fn front_to_back(place: &[Held], knit: bool) -> Vec<Held> {
    let mut order = place.to_vec();
    if !knit {
        order.reverse();
    }
    order
}
