//! A machine that works a program: which loop is drawn through which, and where each carrier went.

use std::collections::{BTreeMap, BTreeSet};

use super::beds::{Bed, Needle, Needles};
use super::program::{Operation, Place, Program};
use super::{KnitoutError, KnitoutErrorReason as Reason, Knitted, Remark};
use crate::pattern::chart::Chart;
use crate::pattern::loops::{Form, Form2d, Held, Loop, LoopGraph, LoopId, Onward, Stop, Strand};

/// How far in front of the middle a loop of the front bed lies, in columns, and behind it one of the back bed.
const BED: f64 = 0.3;
/// How far beside its last loop a carrier turns, in columns.
const TURN: f64 = 0.85;

/// A loop as the machine makes it.
struct Made {
    form: Form,
    bed: Bed,
    /// In needles of the front bed.
    x: f64,
    row: i32,
    /// The loops that it is drawn through, front to back.
    parents: Vec<usize>,
    rightward: bool,
    place: Place,
}

/// A yarn that is in.
struct Fed {
    loops: Path,
}

/// Loops of a yarn in the order in which they were made, and how many places of needles that hold loops lay between each
/// and the one before.
type Path = Vec<(usize, u32)>;

struct Machine {
    rack: f64,
    needles: Needles,
    made: Vec<Made>,
    /// Carriers that are in, and the line that brought them.
    carriers: BTreeMap<String, usize>,
    hook: Option<(Vec<String>, usize)>,
    /// Yarns in work, by the carriers that feed them together.
    fed: BTreeMap<Vec<String>, Fed>,
    /// Yarns that are done, with their carriers.
    done: Vec<(Vec<String>, Path)>,
    remarks: Vec<Remark>,
    /// Needles that were empty when they were knitted, after loops had been there or beside them.
    empty: usize,
}

pub(super) fn knit(program: &Program) -> Result<Knitted, KnitoutError> {
    let mut machine = Machine {
        rack: 0.0,
        needles: Needles::new(),
        made: Vec::new(),
        carriers: BTreeMap::new(),
        hook: None,
        fed: BTreeMap::new(),
        done: Vec::new(),
        remarks: program.remarks.clone(),
        empty: 0,
    };
    for line in &program.lines {
        machine.check_carriers(&line.operation, program.carriers.as_deref(), &line.place)?;
        machine.work(&line.operation, &line.place)?;
    }
    let end = program.lines.last().map_or(Place { line: 1, span: 0..0, source_note: None }, |line| line.place.clone());
    if let Some((carriers, since)) = machine.hook.take() {
        let place = program.lines.iter().find(|line| line.place.line == since).map_or(&end, |line| &line.place);
        return Err(place.error(Reason::NeverReleased { carrier: carriers.join(" ") }));
    }
    if machine.made.is_empty() {
        return Err(end.error(Reason::NoLoops));
    }
    for (carriers, fed) in std::mem::take(&mut machine.fed) {
        let what = format!("carrier {} is never taken out; its end hangs free", carriers.join(" "));
        machine.remarks.push(Remark { line: end.line, what });
        machine.done.push((carriers, fed.loops));
    }
    if machine.empty > 0 {
        let what = format!(
            "{} needles were empty when they were knitted: the yarn is laid over them, as a tuck lays it",
            machine.empty
        );
        machine.remarks.push(Remark { line: 1, what });
    }
    machine.check_cables()?;
    machine.graph()
}

impl Machine {
    fn check_carriers(
        &self,
        operation: &Operation,
        known: Option<&[String]>,
        place: &Place,
    ) -> Result<(), KnitoutError> {
        let named = match operation {
            Operation::In { carriers, .. }
            | Operation::Out { carriers, .. }
            | Operation::Release { carriers }
            | Operation::Knit { carriers, .. }
            | Operation::Tuck { carriers, .. }
            | Operation::Split { carriers, .. }
            | Operation::Miss { carriers } => carriers,
            _ => return Ok(()),
        };
        let Some(known) = known else { return Ok(()) };
        match named.iter().find(|carrier| !known.contains(carrier)) {
            None => Ok(()),
            Some(carrier) => {
                let carrier = crate::pattern::instructions::shortened(carrier);
                Err(place.error(Reason::Carrier { carrier, known: known.join(" ") }))
            }
        }
    }

    fn work(&mut self, operation: &Operation, place: &Place) -> Result<(), KnitoutError> {
        match operation {
            Operation::In { carriers, hook } => {
                if *hook && let Some((held, since)) = &self.hook {
                    let (carrier, since) = (held.join(" "), *since);
                    return Err(place.error(Reason::HookBusy { carrier, since }));
                }
                for carrier in carriers {
                    if let Some(since) = self.carriers.insert(carrier.clone(), place.line) {
                        return Err(place.error(Reason::AlreadyIn { carrier: carrier.clone(), since }));
                    }
                }
                if *hook {
                    self.hook = Some((carriers.clone(), place.line));
                }
                Ok(())
            }
            Operation::Release { carriers } => match self.hook.take() {
                Some((held, _)) if held == *carriers => Ok(()),
                _ => Err(place.error(Reason::NotHooked { carrier: carriers.join(" ") })),
            },
            Operation::Out { carriers, hook } => self.out(carriers, *hook, place),
            Operation::Rack(by) => {
                self.rack = *by;
                Ok(())
            }
            Operation::Knit { rightward, needle, carriers } => {
                let held = self.needles.remove(needle).unwrap_or_default();
                let id = self.draw(*needle, &held, *rightward, carriers, place)?;
                self.needles.insert(*needle, vec![id]);
                Ok(())
            }
            Operation::Tuck { rightward, needle, carriers } => {
                let id = self.make(*needle, Form::Open, Vec::new(), *rightward, carriers, place)?;
                self.needles.entry(*needle).or_default().push(id);
                Ok(())
            }
            Operation::Split { rightward, needle, to, carriers } => {
                self.check_facing(*needle, *to, place)?;
                let held = self.needles.remove(needle).unwrap_or_default();
                let id = self.draw(*needle, &held, *rightward, carriers, place)?;
                self.needles.insert(*needle, vec![id]);
                self.needles.entry(*to).or_default().extend(held);
                Ok(())
            }
            Operation::Miss { carriers } => self.check_in(carriers, place),
            Operation::Transfer { from, to } => {
                self.check_facing(*from, *to, place)?;
                if let Some(held) = self.needles.remove(from) {
                    self.needles.entry(*to).or_default().extend(held);
                }
                Ok(())
            }
            Operation::Drop { needle } => {
                self.needles.remove(needle);
                Ok(())
            }
        }
    }

    fn out(&mut self, carriers: &[String], hook: bool, place: &Place) -> Result<(), KnitoutError> {
        for carrier in carriers {
            if self.carriers.remove(carrier).is_none() {
                return Err(place.error(Reason::OutTwice { carrier: carrier.clone() }));
            }
        }
        if let Some((held, since)) = &self.hook {
            let (carrier, since) = (held.join(" "), *since);
            if hook {
                return Err(place.error(Reason::HookBusy { carrier, since }));
            }
            if held.iter().any(|held| carriers.contains(held)) {
                return Err(place.error(Reason::NeverReleased { carrier }));
            }
        }
        let ended: Vec<Vec<String>> =
            self.fed.keys().filter(|fed| fed.iter().any(|one| carriers.contains(one))).cloned().collect();
        for key in ended {
            if let Some(fed) = self.fed.remove(&key) {
                self.done.push((key, fed.loops));
            }
        }
        Ok(())
    }

    fn check_in(&self, carriers: &[String], place: &Place) -> Result<(), KnitoutError> {
        match carriers.iter().find(|carrier| !self.carriers.contains_key(*carrier)) {
            None => Ok(()),
            Some(carrier) => Err(place.error(Reason::NotIn { carrier: carrier.clone() })),
        }
    }

    /// Whether two needles face each other, so that one can give its loops to the other.
    fn check_facing(&self, from: Needle, to: Needle, place: &Place) -> Result<(), KnitoutError> {
        let across = from.bed.is_front() != to.bed.is_front();
        let beside = from.bed.is_slider() != to.bed.is_slider() && !across && from.index == to.index;
        if beside || (across && (from.place(self.rack) - to.place(self.rack)).abs() < 1e-9) {
            return Ok(());
        }
        let bed = match from.bed {
            Bed::Front | Bed::FrontSlider => Bed::Back,
            Bed::Back | Bed::BackSlider => Bed::Front,
        };
        let index = if from.bed.is_front() { from.place(0.0) - self.rack } else { from.place(self.rack) };
        let faces = if index.fract() == 0.0 {
            Needle { bed, index: index as i32 }.to_string()
        } else {
            "the gap between two needles".to_owned()
        };
        Err(place.error(Reason::Facing {
            from: from.to_string(),
            to: to.to_string(),
            rack: self.rack.to_string(),
            faces,
        }))
    }

    /// Draws a loop through those that a needle holds; where there are none, it is laid over the needle.
    fn draw(
        &mut self,
        needle: Needle,
        held: &[usize],
        rightward: bool,
        carriers: &[String],
        place: &Place,
    ) -> Result<usize, KnitoutError> {
        let knit = needle.bed.is_front();
        if held.is_empty() {
            // The first loops of a carrier are a cast-on; later ones are yarn-overs or slips of the program.
            let cast_on = self
                .fed
                .get(carriers)
                .is_none_or(|fed| fed.loops.iter().all(|(id, _)| self.made[*id].form == Form::Open));
            self.empty += usize::from(!cast_on);
            return self.make(needle, Form::Open, Vec::new(), rightward, carriers, place);
        }
        if held.len() > Chart::MOST_STACKED {
            let (needle, loops) = (needle.to_string(), held.len());
            return Err(place.error(Reason::Stacked { needle, loops }));
        }
        // What was laid on later is nearer to the gap between the beds: behind on the front bed, in front on the back bed.
        let mut parents = held.to_vec();
        if !knit {
            parents.reverse();
        }
        self.make(needle, Form::Worked { knit }, parents, rightward, carriers, place)
    }

    fn make(
        &mut self,
        needle: Needle,
        form: Form,
        parents: Vec<usize>,
        rightward: bool,
        carriers: &[String],
        place: &Place,
    ) -> Result<usize, KnitoutError> {
        if needle.bed.is_slider() {
            return Err(place.error(Reason::Slider { needle: needle.to_string() }));
        }
        self.check_in(carriers, place)?;
        if self.made.len() as u64 >= Chart::MAX_LOOPS {
            return Err(place.error(Reason::TooManyLoops));
        }
        let x = needle.place(self.rack);
        let last = self.fed.get(carriers).and_then(|fed| fed.loops.last()).map(|(id, _)| &self.made[*id]);
        // A loop lies a row above what it is drawn through or laid beside; one over an empty needle lies in the row of the
        // loop before it.
        let below = parents.iter().chain(self.needles.get(&needle).into_iter().flatten());
        let row = below.map(|id| self.made[*id].row + 1).max();
        let row = row.or(last.map(|last| last.row)).unwrap_or(0);
        let over = last.map_or(0, |last| self.between(last.x, x, needle.bed));
        let id = self.made.len();
        self.made.push(Made { form, bed: needle.bed, x, row, parents, rightward, place: place.clone() });
        let fed = self.fed.entry(carriers.to_vec()).or_insert_with(|| Fed { loops: Vec::new() });
        fed.loops.push((id, over));
        Ok(id)
    }

    /// Needles of a bed that hold loops between two places: the yarn floats past them.
    fn between(&self, a: f64, b: f64, bed: Bed) -> u32 {
        let (low, high) = (a.min(b), a.max(b));
        let from = Needle { bed, index: low.floor() as i32 - 16 };
        let to = Needle { bed, index: high.ceil() as i32 + 16 };
        let inside = |needle: &&Needle| {
            let x = needle.place(self.rack);
            x > low + 1e-9 && x < high - 1e-9
        };
        let count = self.needles.range(from..=to).map(|(needle, _)| needle).filter(inside).count();
        u32::try_from(count).unwrap_or(u32::MAX)
    }

    /// Refuses neighbours of a bed that lie the other way round than the loops that they are drawn through.
    fn check_cables(&self) -> Result<(), KnitoutError> {
        for (_, path) in &self.done {
            let drawn: Vec<&Made> =
                path.iter().map(|(id, _)| &self.made[*id]).filter(|made| !made.parents.is_empty()).collect();
            for pair in drawn.windows(2) {
                let (first, second) = (pair[0], pair[1]);
                if first.rightward != second.rightward || first.bed != second.bed {
                    continue;
                }
                let (left, right) = if first.x <= second.x { (first, second) } else { (second, first) };
                let xs = |made: &Made| made.parents.iter().map(|id| self.made[*id].x).collect::<Vec<_>>();
                let of_left = xs(left).into_iter().fold(f64::INFINITY, f64::min);
                let of_right = xs(right).into_iter().fold(f64::NEG_INFINITY, f64::max);
                // Crossed for certain where even the leftmost of the left lies right of the rightmost of the right.
                if left.x + 1e-9 < right.x && of_left > of_right + 1e-9 {
                    return Err(second.place.error(Reason::Cable { other: first.place.line }));
                }
            }
        }
        Ok(())
    }

    fn graph(mut self) -> Result<Knitted, KnitoutError> {
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
            let yarn = u8::try_from(known.unwrap_or(carriers.len() - 1)).ok().filter(|yarn| *yarn < 250);
            let first = path.first().map_or(0, |(id, _)| *id);
            let yarn = yarn.ok_or_else(|| self.made[first].place.error(Reason::TooManyYarns))?;
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
        Ok(Knitted { graph, carriers, remarks: self.remarks })
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
