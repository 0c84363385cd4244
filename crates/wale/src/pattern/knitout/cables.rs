//! Cables: loops of a course that lie the other way round than the loops that they are drawn through.
//!
//! Which loops are of one course is not said by their needles alone, since the two sides of a tube may slide past each other and
//! cross nothing. Loops are of one course where a yarn has made them on its way in one direction, where they are drawn through
//! loops that were so made, and, of several yarns, where they lie in one row: on one bed, or on both if no yarn of the row passes
//! over what another has made, as yarns do in a tube. Places are compared at one racking: a bed that is racked as a whole leaves its
//! loops on their needles, as in a racked rib, whereas a cable transfers them.

use std::collections::BTreeMap;

use super::machine::{Machine, Made};
use super::{KnitoutError, KnitoutErrorReason as Reason};
use crate::pattern::loops::Form;

/// Places nearer than this are one place, in needles.
const ONE_PLACE: f64 = 1e-9;

/// What makes loops to be of one course.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Course {
    /// The way of a yarn in one direction.
    Worked { way: usize },
    /// What is drawn through the loops of a way.
    Through { way: usize, row: i32 },
    /// A row, or what of it is on one bed and drawn through loops of that bed.
    Row { row: i32, front: Option<bool> },
}

impl Machine {
    /// Refuses loops of a course that lie the other way round than the loops that they are drawn through.
    pub fn check_cables(&self) -> Result<(), KnitoutError> {
        let crossed = self.courses().into_values().filter_map(|course| self.crossed(course));
        match crossed.min() {
            Some([second, first]) => {
                Err(self.made[second].place.error(Reason::Cable { other: self.made[first].place.line }))
            }
            None => Ok(()),
        }
    }

    /// All courses, the loops of each in the order in which they were made.
    fn courses(&self) -> BTreeMap<Course, Vec<usize>> {
        let ways = self.ways();
        let layered = self.rows_of_layers(&ways);
        let is_layered = |row: i32| layered.get(&row).copied().unwrap_or(false);
        let mut courses: BTreeMap<Course, Vec<usize>> = BTreeMap::new();
        for (id, made) in self.made.iter().enumerate().filter(|(_, made)| !made.parents.is_empty()) {
            let row = made.row;
            let (way, front) = (ways[made.parents[0]], made.bed.is_front());
            let mut add = |course| courses.entry(course).or_default().push(id);
            add(Course::Worked { way: ways[id] });
            if made.parents.iter().all(|parent| ways[*parent] == way) {
                add(Course::Through { way, row });
            }
            if !(is_layered(row) && is_layered(row - 1)) {
                add(Course::Row { row, front: None });
            } else if made.parents.iter().all(|parent| self.made[*parent].bed.is_front() == front) {
                add(Course::Row { row, front: Some(front) });
            }
        }
        courses
    }

    /// Of every loop, on which way of its yarn it was made: a way ends where the yarn turns.
    fn ways(&self) -> Vec<usize> {
        let mut ways = vec![0; self.made.len()];
        let mut way = 0;
        for (_, path) in &self.done {
            let mut last = None;
            for (id, _) in path {
                let rightward = self.made[*id].rightward;
                way += usize::from(last != Some(rightward));
                last = Some(rightward);
                ways[*id] = way;
            }
        }
        ways
    }

    /// Rows in which a way passes over loops that another has made.
    fn rows_of_layers(&self, ways: &[usize]) -> BTreeMap<i32, bool> {
        let mut reach: BTreeMap<(i32, usize), [f64; 2]> = BTreeMap::new();
        for (made, way) in self.made.iter().zip(ways) {
            let [left, right] = reach.entry((made.row, *way)).or_insert([made.x; 2]);
            (*left, *right) = (left.min(made.x), right.max(made.x));
        }
        let mut rows: BTreeMap<i32, Vec<[f64; 2]>> = BTreeMap::new();
        for ((row, _), reach) in reach {
            rows.entry(row).or_default().push(reach);
        }
        let overlap = |mut reaches: Vec<[f64; 2]>| {
            reaches.sort_by(|a, b| a[0].total_cmp(&b[0]));
            let mut right = f64::NEG_INFINITY;
            reaches.into_iter().any(|reach| {
                let under = reach[0] < right + ONE_PLACE;
                right = right.max(reach[1]);
                under
            })
        };
        rows.into_iter().map(|(row, reaches)| (row, overlap(reaches))).collect()
    }

    /// Two loops of a course that are crossed, the later one first.
    fn crossed(&self, course: Vec<usize>) -> Option<[usize; 2]> {
        // Loops that are worked again before others of their course are made may have been moved since, all together.
        let mut end = usize::MAX;
        let at_one_time = course.chunk_by(|one, next| {
            end = end.min(self.made[*one].child);
            let goes_on = *next < end;
            if !goes_on {
                end = usize::MAX;
            }
            goes_on
        });
        at_one_time.filter_map(|course| self.crossed_at_one_time(course)).min()
    }

    fn crossed_at_one_time(&self, course: &[usize]) -> Option<[usize; 2]> {
        let rack = self.made[*course.first()?].rack;
        let place = |made: &Made| made.x + if made.bed.is_front() { 0.0 } else { rack - made.rack };
        // A tuck lies where the loop beside it lies by now.
        let through = |made: &Made| {
            let parents = || made.parents.iter().map(|parent| &self.made[*parent]);
            let drawn = parents().any(|parent| parent.form != Form::Open);
            let places = parents().filter(|parent| !drawn || parent.form != Form::Open).map(place);
            places.fold([f64::INFINITY, f64::NEG_INFINITY], |[left, right], x| [left.min(x), right.max(x)])
        };
        let mut loops: Vec<(f64, [f64; 2], usize)> =
            course.iter().map(|id| (place(&self.made[*id]), through(&self.made[*id]), *id)).collect();
        loops.sort_by(|a, b| a.0.total_cmp(&b.0));
        // From left to right: of the loops so far, the one whose parents lie farthest right, even the leftmost of them.
        let mut farthest: Option<(f64, usize)> = None;
        let mut found: Option<[usize; 2]> = None;
        for here in loops.chunk_by(|a, b| b.0 - a.0 < ONE_PLACE) {
            for (_, [_, right], id) in here {
                // Decreases and lace lay loops on one needle; crossed for certain are those of which all parents are.
                if let Some((_, other)) = farthest.filter(|(left, _)| *left > right + ONE_PLACE) {
                    let pair = [other.max(*id), other.min(*id)];
                    found = Some(found.map_or(pair, |found| found.min(pair)));
                }
            }
            for (_, [left, _], id) in here {
                if farthest.is_none_or(|(farthest, _)| *left > farthest) {
                    farthest = Some((*left, *id));
                }
            }
        }
        found
    }
}
