//! What a machine has made, as the graph of loops and yarns.

use std::collections::{BTreeMap, BTreeSet};

use super::Knitted;
use super::machine::{Machine, Made};
use crate::pattern::loops::{Form2d, Held, Loop, LoopGraph, LoopId, Onward, Stop, Strand};

/// How far in front of the middle a loop of the front bed lies, in columns, and behind it one of the back bed.
const BED: f64 = 0.3;
/// How far beside its last loop a carrier turns, in columns.
const TURN: f64 = 0.85;

impl Machine {
    /// The loops row by row, and the way of every yarn.
    pub fn graph(mut self) -> Knitted {
        // Columns are the places where loops were ever made, so that needles left empty take no room.
        let grain = |x: f64| x.floor() as i64;
        let used: BTreeSet<i64> = self.made.iter().map(|made| grain(made.x)).collect();
        let column: BTreeMap<i64, u32> = used.into_iter().zip(0..).collect();
        let lowest = self.made.iter().map(|made| made.row).min().unwrap_or(0);
        let rows = self.made.iter().map(|made| made.row).max().unwrap_or(0) - lowest + 1;
        let mut order: Vec<usize> = (0..self.made.len()).collect();
        order.sort_by_key(|id| {
            let made = &self.made[*id];
            (made.row, column[&grain(made.x)], made.bed)
        });
        let mut renamed = vec![LoopId(0); order.len()];
        for (at, id) in order.iter().enumerate() {
            renamed[*id] = LoopId::new(at);
        }
        let held = |id: &usize| Held { of: renamed[*id], image: [0; 2] };
        let place_of = |made: &Made| [f64::from(column[&grain(made.x)]) + 0.5, f64::from(made.row - lowest)];
        let loops = order.iter().map(|id| {
            let made = &self.made[*id];
            Loop {
                form: made.form,
                row: made.row - lowest,
                column: column[&grain(made.x)],
                place: place_of(made),
                depth: if made.bed.is_front() { BED } else { -BED },
                parents: made.parents.iter().map(held).collect(),
                children: Vec::new(),
                bound: None,
                source: u32::try_from(made.place.line).unwrap_or(u32::MAX),
            }
        });
        let loops: Vec<Loop> = loops.collect();
        self.done.sort_by_key(|(_, loops)| loops.first().map(|(id, _)| *id));
        let mut carriers: Vec<String> = Vec::new();
        let mut strands = Vec::new();
        for (fed_by, path) in &self.done {
            let name = fed_by.join(" ");
            let known = carriers.iter().position(|known| *known == name);
            if known.is_none() {
                carriers.push(name);
            }
            // There are no more than MOST_YARNS.
            let yarn = known.unwrap_or(carriers.len() - 1) as u8;
            strands.push(self.strand(yarn, path, &renamed, &place_of));
        }
        let columns = u32::try_from(column.len()).unwrap_or(u32::MAX);
        let rows = u32::try_from(rows).unwrap_or(1);
        let row_places = vec![columns; rows as usize];
        let form = Form2d::Sheet;
        let mut graph =
            LoopGraph { form, size: [rows, columns], row_places, loops, strands, bound: Vec::new(), bind_off_yarn: 0 };
        graph.find_children();
        self.remarks.sort_by_key(|remark| remark.line);
        Knitted { graph, carriers, remarks: self.remarks }
    }

    /// The way of one yarn: tail, loops, a turn wherever the carrier comes back on the same bed, tail.
    fn strand(
        &self,
        yarn: u8,
        path: &[(usize, u32)],
        renamed: &[LoopId],
        place_of: &dyn Fn(&Made) -> [f64; 2],
    ) -> Strand {
        let mut stops: Vec<(Stop, Onward)> = Vec::with_capacity(path.len() + 2);
        let beside = |made: &Made, way: f64, up: f64| {
            let [x, y] = place_of(made);
            Stop::At { place: [x + way, y + up], depth: if made.bed.is_front() { BED } else { -BED } }
        };
        for (at, (id, over)) in path.iter().enumerate() {
            let made = &self.made[*id];
            let way = if made.rightward { TURN } else { -TURN };
            match at.checked_sub(1).map(|before| &self.made[path[before].0]) {
                None => stops.push((beside(made, -way, -0.5), Onward::Edge)),
                Some(last) => {
                    let same_bed = last.bed.is_front() == made.bed.is_front();
                    if let Some((_, onward)) = stops.last_mut() {
                        *onward = Onward::Sinker { over: *over };
                        if (last.rightward != made.rightward && same_bed) || last.row.abs_diff(made.row) > 1 {
                            *onward = Onward::Edge;
                            let out = if last.rightward { TURN } else { -TURN };
                            stops.push((beside(last, out, 0.4), Onward::Edge));
                        }
                    }
                }
            }
            stops.push((Stop::Loop { id: renamed[*id], rightward: made.rightward }, Onward::Edge));
        }
        if let Some((id, _)) = path.last() {
            let made = &self.made[*id];
            let way = if made.rightward { TURN } else { -TURN };
            stops.push((beside(made, way, 0.4), Onward::Edge));
        }
        Strand { yarn, stops }
    }
}
