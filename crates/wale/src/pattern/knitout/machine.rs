//! A machine that works a program: which loop is drawn through which, and where each carrier went.

use std::collections::{BTreeMap, BTreeSet};

use super::beds::{Bed, Needle, Needles};
use super::program::{Operation, Place, Program};
use super::{KnitoutError, KnitoutErrorReason as Reason, Knitted, MOST_YARNS, Remark};
use crate::pattern::chart::Chart;
use crate::pattern::loops::Form;

/// A loop as the machine makes it.
pub(super) struct Made {
    pub form: Form,
    pub bed: Bed,
    /// In needles of the front bed.
    pub x: f64,
    /// How far the back bed was racked.
    pub rack: f64,
    pub row: i32,
    /// The loops that it is drawn through, front to back.
    pub parents: Vec<usize>,
    /// The first loop that is drawn through it; beyond all where there is none.
    pub child: usize,
    pub rightward: bool,
    pub place: Place,
}

/// A yarn that is in.
#[derive(Default)]
struct Fed {
    loops: Path,
    /// Whether one of its loops was drawn through another: before, it casts on.
    worked: bool,
}

/// Loops of a yarn in the order in which they were made, and how many places of needles that hold loops lay between each
/// and the one before.
pub(super) type Path = Vec<(usize, u32)>;

pub(super) struct Machine {
    rack: f64,
    needles: Needles,
    pub made: Vec<Made>,
    /// Carriers that are in, and the line that brought them.
    carriers: BTreeMap<String, usize>,
    hook: Option<(Vec<String>, usize)>,
    /// Yarns in work, by the carriers that feed them together.
    fed: BTreeMap<Vec<String>, Fed>,
    /// Yarns that are done, with their carriers.
    pub done: Vec<(Vec<String>, Path)>,
    /// The carriers of every yarn that has made a loop.
    known: BTreeSet<Vec<String>>,
    pub remarks: Vec<Remark>,
    /// How many needles were empty when they were knitted, after their yarn had made stitches, and the first of them.
    empty: usize,
    first_empty: Option<(Needle, usize)>,
}

pub(super) fn knit(program: &Program) -> Result<Knitted, KnitoutError> {
    let mut machine = Machine {
        rack: 0.0,
        needles: Needles::default(),
        made: Vec::new(),
        carriers: BTreeMap::new(),
        hook: None,
        fed: BTreeMap::new(),
        done: Vec::new(),
        known: BTreeSet::new(),
        remarks: program.remarks.clone(),
        empty: 0,
        first_empty: None,
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
    if let Some((needle, line)) = machine.first_empty {
        let others = match machine.empty - 1 {
            0 => String::new(),
            others => format!(", as were {others} after it"),
        };
        let what =
            format!("{needle} was empty when it was knitted{others}: the yarn is laid over it, as a tuck lays it");
        machine.remarks.push(Remark { line, what });
    }
    machine.check_cables()?;
    Ok(machine.graph())
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
            Some(carrier) => Err(place.error(Reason::Carrier { carrier: carrier.clone(), known: known.join(" ") })),
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
                let held = self.needles.take(*needle);
                let id = self.draw(*needle, &held, *rightward, carriers, place)?;
                self.lay(*needle, [id], place)
            }
            Operation::Tuck { rightward, needle, carriers } => {
                let id = self.make(*needle, Form::Open, Vec::new(), *rightward, carriers, place)?;
                self.lay(*needle, [id], place)
            }
            Operation::Split { rightward, needle, to, carriers } => {
                self.check_facing(*needle, *to, place)?;
                let held = self.needles.take(*needle);
                let id = self.draw(*needle, &held, *rightward, carriers, place)?;
                self.lay(*needle, [id], place)?;
                self.lay(*to, held, place)
            }
            Operation::Miss { carriers } => self.check_in(carriers, place),
            Operation::Transfer { from, to } => {
                self.check_facing(*from, *to, place)?;
                let held = self.needles.take(*from);
                self.lay(*to, held, place)
            }
            Operation::Drop { needle } => {
                self.needles.take(*needle);
                Ok(())
            }
        }
    }

    fn lay(
        &mut self,
        needle: Needle,
        loops: impl IntoIterator<Item = usize>,
        place: &Place,
    ) -> Result<(), KnitoutError> {
        let laid = self.needles.lay(needle, loops);
        laid.map_err(|loops| place.error(Reason::Stacked { needle: needle.to_string(), loops }))
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
            if self.fed.get(carriers).is_some_and(|fed| fed.worked) {
                self.empty += 1;
                self.first_empty.get_or_insert((needle, place.line));
            }
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
        let below = parents.iter().chain(self.needles.on(needle));
        let row = below.map(|id| self.made[*id].row + 1).max();
        let row = row.or(last.map(|last| last.row)).unwrap_or(0);
        // The yarn floats past what hangs between its last loop and this one.
        let over = last.map_or(0, |last| self.needles.between(last.x.min(x), last.x.max(x), needle.bed, self.rack));
        let id = self.made.len();
        for parent in &parents {
            let made = &mut self.made[*parent];
            made.child = made.child.min(id);
        }
        let (bed, rack, child) = (needle.bed, self.rack, usize::MAX);
        self.made.push(Made { form, bed, x, rack, row, parents, child, rightward, place: place.clone() });
        if !self.fed.contains_key(carriers) && self.known.insert(carriers.to_vec()) && self.known.len() > MOST_YARNS {
            return Err(place.error(Reason::TooManyYarns));
        }
        let fed = self.fed.entry(carriers.to_vec()).or_default();
        fed.loops.push((id, over));
        fed.worked |= form != Form::Open;
        Ok(id)
    }
}
