//! The parts of a row, and what they give for a number of stitches.

use std::ops::Range;

use super::{InstructionError, InstructionErrorReason as Reason};
use crate::pattern::chart::Chart;
use crate::pattern::stitch::Stitch;

type Parsed<T> = Result<T, InstructionError>;

/// What a row says: its parts, and the yarn that it begins with.
#[derive(Clone, Debug)]
pub(super) struct Row {
    pub parts: Vec<Part>,
    pub yarn: u8,
}

/// A part of a row as it is worked, and its place in the text.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub kind: PartKind,
    pub place: Range<usize>,
    pub source: String,
}

#[derive(Clone, Debug)]
pub(super) enum PartKind {
    /// `k3`.
    Stitches(Stitch, u64),
    /// `with B`: from here on with this yarn.
    With(u8),
    /// `[…] 3 times`: the parts, the stitches that they take, and how often.
    Repeat(Vec<Part>, u64, u64),
    /// `*…*` and the like: the parts, the stitches that they take, and how many stitches of the row to leave over (what
    /// follows if `None`).
    Fill(Vec<Part>, u64, Option<u64>),
}

impl Part {
    /// The stitches that it takes, unless it stretches. Products were checked when the part was read.
    pub fn fixed(&self) -> Option<u64> {
        match &self.kind {
            PartKind::Stitches(stitch, count) => Some(count * stitch.takes() as u64),
            PartKind::With(_) => Some(0),
            PartKind::Repeat(_, count, times) => Some(count * times),
            PartKind::Fill(..) => None,
        }
    }

    /// The stitches that it leaves when it is worked so often.
    fn leaves(&self, times: u64) -> u64 {
        let sum = |parts: &[Self]| parts.iter().fold(0_u64, |sum, part| sum.saturating_add(part.leaves(1)));
        let once = match &self.kind {
            PartKind::Stitches(stitch, count) => count.saturating_mul(stitch.leaves() as u64),
            PartKind::With(_) => 0,
            PartKind::Repeat(parts, _, times) => sum(parts).saturating_mul(*times),
            PartKind::Fill(parts, ..) => sum(parts),
        };
        once.saturating_mul(times)
    }

    fn work(&self, times: u64, yarn: &mut u8, row: &mut Vec<(Stitch, u8)>) {
        for _ in 0..times {
            match &self.kind {
                PartKind::Stitches(stitch, count) => {
                    row.extend((0..*count).map(|_| (*stitch, *yarn)));
                }
                PartKind::With(other) => *yarn = *other,
                PartKind::Repeat(parts, _, times) => {
                    for _ in 0..*times {
                        parts.iter().for_each(|part| part.work(1, yarn, row));
                    }
                }
                PartKind::Fill(parts, ..) => parts.iter().for_each(|part| part.work(1, yarn, row)),
            }
        }
    }
}

/// Works a row of `total` stitches, in the order and as seen by the knitter.
pub(super) fn work(Row { parts, yarn }: &Row, total: u64, row: u64) -> Parsed<Vec<(Stitch, u8)>> {
    let error = |part: &Part, reason| InstructionError::new(part.place.clone(), Some(row), reason);
    // Count first: nothing is laid out before the counts are known to work out.
    let mut done = 0_u64;
    let mut plan = Vec::with_capacity(parts.len());
    for (i, part) in parts.iter().enumerate() {
        let source = || part.source.clone();
        let times = match &part.kind {
            PartKind::Fill(_, repeat, leave) => {
                let after = match leave {
                    Some(leave) => *leave,
                    None => {
                        let mut sum = 0_u64;
                        for later in &parts[i + 1..] {
                            let count = later.fixed().ok_or_else(|| {
                                let part = later.source.clone();
                                error(later, Reason::SecondFill { part })
                            })?;
                            sum = sum.saturating_add(count);
                        }
                        sum
                    }
                };
                let taken = done.saturating_add(after);
                let room = total.checked_sub(taken).ok_or_else(|| {
                    let part_name = source();
                    let reason = Reason::TooMany { part: part_name, found: taken, total };
                    error(part, reason)
                })?;
                if !room.is_multiple_of(*repeat) {
                    let reason = Reason::NoMultiple { part: source(), repeat: *repeat, room, total };
                    return Err(error(part, reason));
                }
                done += room;
                room / repeat
            }
            _ => {
                done = done.saturating_add(part.fixed().unwrap_or(0));
                1
            }
        };
        if done > total {
            let reason = Reason::TooMany { part: source(), found: done, total };
            return Err(error(part, reason));
        }
        plan.push(times);
    }
    if done < total {
        let last = &parts[parts.len() - 1];
        let reason = Reason::TooFew { part: last.source.clone(), found: done, total };
        return Err(error(last, reason));
    }
    let leaves = parts.iter().zip(&plan).fold(0_u64, |sum, (part, times)| sum.saturating_add(part.leaves(*times)));
    if let Err(size) = Chart::check_size(leaves.max(1), 1) {
        return Err(error(&parts[parts.len() - 1], Reason::Size(size)));
    }
    let mut stitches = Vec::with_capacity(usize::try_from(total).unwrap_or(0));
    let mut yarn = *yarn;
    for (part, times) in parts.iter().zip(plan) {
        part.work(times, &mut yarn, &mut stitches);
    }
    Ok(stitches)
}
