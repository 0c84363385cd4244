//! Needles and where they stand against each other.

use std::collections::BTreeMap;
use std::fmt;

/// Needles farther out are no needles of any machine.
pub(super) const FARTHEST_NEEDLE: i32 = 100_000;
/// Needles that the back bed may be shifted by.
pub(super) const FARTHEST_RACK: f64 = 12.0;

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, Hash)]
pub(super) enum Bed {
    Front,
    Back,
    FrontSlider,
    BackSlider,
}

impl Bed {
    pub fn is_front(self) -> bool {
        matches!(self, Self::Front | Self::FrontSlider)
    }
    pub fn is_slider(self) -> bool {
        matches!(self, Self::FrontSlider | Self::BackSlider)
    }
}

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, Hash)]
pub(super) struct Needle {
    pub bed: Bed,
    pub index: i32,
}

impl Needle {
    /// `f3`, `bs-2`.
    pub fn read(text: &str) -> Option<Self> {
        let digits = text.find(|c: char| c == '-' || c.is_ascii_digit())?;
        let (bed, index) = text.split_at(digits);
        let bed = match bed {
            "f" => Bed::Front,
            "b" => Bed::Back,
            "fs" => Bed::FrontSlider,
            "bs" => Bed::BackSlider,
            _ => return None,
        };
        let index: i32 = index.parse().ok()?;
        (-FARTHEST_NEEDLE..=FARTHEST_NEEDLE).contains(&index).then_some(Self { bed, index })
    }

    /// Where it stands, in needles of the front bed.
    pub fn place(self, rack: f64) -> f64 {
        f64::from(self.index) + if self.bed.is_front() { 0.0 } else { rack }
    }
}

impl fmt::Display for Needle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bed = match self.bed {
            Bed::Front => "f",
            Bed::Back => "b",
            Bed::FrontSlider => "fs",
            Bed::BackSlider => "bs",
        };
        write!(f, "{bed}{}", self.index)
    }
}

/// Loops that a needle can hold at most; far fewer can be knitted together, so that no honest program comes near.
const MOST_HELD: usize = 64;

/// The loops on every needle, the first that was laid on it first.
#[derive(Default)]
pub(super) struct Needles {
    held: BTreeMap<Needle, Vec<usize>>,
    /// How many needles of the front and of the back bed hold loops.
    front: Count,
    back: Count,
}

impl Needles {
    /// The loops on a needle.
    pub fn on(&self, needle: Needle) -> &[usize] {
        self.held.get(&needle).map_or(&[], Vec::as_slice)
    }

    /// Takes all loops off a needle.
    pub fn take(&mut self, needle: Needle) -> Vec<usize> {
        let held = self.held.remove(&needle);
        if held.is_some()
            && let Some(count) = self.count(needle.bed)
        {
            count.add(needle.index, -1);
        }
        held.unwrap_or_default()
    }

    /// Lays loops on a needle.
    ///
    /// # Errors
    /// How many it would hold, if these are too many.
    pub fn lay(&mut self, needle: Needle, loops: impl IntoIterator<Item = usize>) -> Result<(), usize> {
        let mut loops = loops.into_iter().peekable();
        if loops.peek().is_none() {
            return Ok(());
        }
        let held = self.held.entry(needle).or_default();
        let was_empty = held.is_empty();
        held.extend(loops);
        let count = held.len();
        if was_empty && let Some(beside) = self.count(needle.bed) {
            beside.add(needle.index, 1);
        }
        if count > MOST_HELD { Err(count) } else { Ok(()) }
    }

    /// Needles of a bed that hold loops between two places, which are given in needles of the front bed.
    pub fn between(&self, low: f64, high: f64, bed: Bed, rack: f64) -> u32 {
        let (count, shift) = match bed {
            Bed::Front => (&self.front, 0.0),
            Bed::Back => (&self.back, rack),
            Bed::FrontSlider | Bed::BackSlider => return 0,
        };
        let (first, last) = ((low + 1e-9 - shift).floor() as i32 + 1, (high - 1e-9 - shift).ceil() as i32 - 1);
        if first > last { 0 } else { count.up_to(last) - count.up_to(first - 1) }
    }

    fn count(&mut self, bed: Bed) -> Option<&mut Count> {
        match bed {
            Bed::Front => Some(&mut self.front),
            Bed::Back => Some(&mut self.back),
            Bed::FrontSlider | Bed::BackSlider => None,
        }
    }
}

/// Counts of needles as a binary indexed tree: a float may pass a hundred thousand needles, and so may the
/// next one.
#[derive(Default)]
struct Count {
    sums: Vec<u32>,
}

impl Count {
    const SIZE: usize = 2 * FARTHEST_NEEDLE as usize + 1;

    fn add(&mut self, index: i32, by: i32) {
        self.sums.resize(Self::SIZE + 1, 0);
        let mut at = Self::at(index);
        while at <= Self::SIZE {
            self.sums[at] = self.sums[at].wrapping_add_signed(by);
            at += at & at.wrapping_neg();
        }
    }

    /// Needles up to this one.
    fn up_to(&self, index: i32) -> u32 {
        let (mut at, mut sum) = (Self::at(index), 0);
        while at > 0 {
            sum += self.sums.get(at).copied().unwrap_or(0);
            at &= at - 1;
        }
        sum
    }

    /// Places in the tree are counted from 1; what lies before all needles is place 0.
    fn at(index: i32) -> usize {
        usize::try_from(index + FARTHEST_NEEDLE + 1).unwrap_or(0).min(Self::SIZE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn needles_between_two_places_are_counted(
            needles in prop::collection::btree_set(-30_i32..30, 0..20),
            ends in (-80_i32..80, -80_i32..80),
            rack in prop::sample::select(vec![0.0, 0.5, -3.0, 12.0]),
        ) {
            let mut held = Needles::default();
            for index in &needles {
                for bed in [Bed::Front, Bed::Back] {
                    held.lay(Needle { bed, index: *index }, [0]).unwrap();
                }
            }
            let (low, high) = (0.5 * f64::from(ends.0.min(ends.1)), 0.5 * f64::from(ends.0.max(ends.1)));
            for bed in [Bed::Front, Bed::Back] {
                let inside = |index: &&i32| {
                    let x = Needle { bed, index: **index }.place(rack);
                    x > low && x < high
                };
                prop_assert_eq!(held.between(low, high, bed, rack) as usize, needles.iter().filter(inside).count());
            }
            for index in &needles {
                held.take(Needle { bed: Bed::Front, index: *index });
            }
            prop_assert_eq!(held.between(-200.0, 200.0, Bed::Front, rack), 0);
        }
    }
}
