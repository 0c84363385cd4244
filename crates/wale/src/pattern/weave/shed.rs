//! Sheds: which ends are up at a pick, for drafts of many shafts and many picks.

use std::collections::BTreeMap;

const WORD: usize = u64::BITS as usize;

/// The shafts that every end is on.
pub(super) struct Sheds {
    ends: Vec<On>,
}

/// What is lifted at every pick. A treadle lifts bits and not a list: a long tie-up that is pressed over and over would be long work.
pub(super) struct Lifts {
    /// The shafts, or the treadles that are pressed.
    pressed: BTreeMap<u64, Vec<u64>>,
    /// The shafts that each treadle lifts, if there are treadles.
    tieup: Option<BTreeMap<u64, Vec<u64>>>,
    shafts: usize,
}

impl Lifts {
    /// By pick, and by treadle if there are treadles.
    pub fn new(shafts: usize, pressed: BTreeMap<u64, Vec<u64>>, tieup: Option<BTreeMap<u64, Vec<u64>>>) -> Self {
        let of_treadle = |(treadle, list): (u64, Vec<u64>)| (treadle, bits(shafts, list));
        Self { pressed, tieup: tieup.map(|tieup| tieup.into_iter().map(of_treadle).collect()), shafts }
    }

    /// The shafts that are lifted at a pick.
    pub fn at(&self, pick: u64) -> Vec<u64> {
        let pressed = self.pressed.get(&pick).map_or(&[][..], Vec::as_slice);
        let Some(tieup) = &self.tieup else { return bits(self.shafts, pressed.iter().copied()) };
        let mut lifted = bits(self.shafts, []);
        for shafts in pressed.iter().filter_map(|treadle| tieup.get(treadle)) {
            lifted.iter_mut().zip(shafts).for_each(|(lifted, shafts)| *lifted |= shafts);
        }
        lifted
    }
}

/// Shafts of an end: a list of few, or a bit for each of all. A file of sixteen megabytes can say `on every shaft` for
/// thousands of ends and `lift them all` for a million picks.
enum On {
    Few(Vec<u64>),
    Many(Vec<u64>),
}

impl Sheds {
    /// The threading, by ends from 1; shafts are numbered from 1.
    pub fn new(ends: usize, shafts: usize, threading: &BTreeMap<u64, Vec<u64>>) -> Self {
        let on = |end: usize| {
            let list = threading.get(&(end as u64 + 1)).map_or(&[][..], Vec::as_slice);
            if list.len() <= shafts / WORD {
                On::Few(list.to_vec())
            } else {
                On::Many(bits(shafts, list.iter().copied()))
            }
        };
        Self { ends: (0..ends).map(on).collect() }
    }

    /// Which ends are up when these shafts are lifted, or, of a sinking shed, lowered.
    pub fn warp_up(&self, lifted: &[u64], rising: bool) -> Vec<bool> {
        let is_lifted = |shaft: &u64| lifted[*shaft as usize / WORD] >> (*shaft as usize % WORD) & 1 == 1;
        let up = |on: &On| match on {
            On::Few(list) => list.iter().any(is_lifted),
            On::Many(bits) => bits.iter().zip(lifted).any(|(on, lifted)| on & lifted != 0),
        };
        self.ends.iter().map(|on| up(on) == rising).collect()
    }
}

/// A bit for every shaft from 0.
fn bits(shafts: usize, list: impl IntoIterator<Item = u64>) -> Vec<u64> {
    let mut bits = vec![0; shafts / WORD + 1];
    for shaft in list {
        bits[shaft as usize / WORD] |= 1 << (shaft as usize % WORD);
    }
    bits
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ten_thousand_shafts_lifted_a_million_times_are_no_long_work() {
        // Shaft by shaft it would be 10¹⁰ of them.
        let shafts = 10_000;
        let tieup = BTreeMap::from([(1, (1..=shafts).collect())]);
        let lifts = Lifts::new(shafts as usize, BTreeMap::from([(1, vec![1; 1_000_000])]), Some(tieup));
        assert_eq!(lifts.at(1), bits(shafts as usize, 1..=shafts));
    }

    #[test]
    fn few_shafts_and_many_lift_alike() {
        for shafts in [4, 63, 64, 200] {
            let all: Vec<u64> = (1..=shafts).collect();
            let threading = BTreeMap::from([(1, vec![1]), (2, all.clone()), (3, vec![shafts])]);
            let sheds = Sheds::new(4, shafts as usize, &threading);
            let up = |lifted: &[u64], rising| sheds.warp_up(&bits(shafts as usize, lifted.iter().copied()), rising);
            assert_eq!(up(&[1], true), [true, true, false, false]);
            assert_eq!(up(&[shafts, shafts], true), [false, true, true, false]);
            assert_eq!(up(&[2], false), [true, false, true, true]);
            assert_eq!(up(&all, true), [true, true, true, false]);
            // The same by treadles; one that is tied to nothing lifts nothing.
            let tieup = BTreeMap::from([(1, vec![1]), (2, vec![shafts, shafts]), (3, all.clone())]);
            let pressed = BTreeMap::from([(1, vec![1]), (2, vec![2, 2]), (3, vec![1, 2]), (4, vec![9])]);
            let by_treadles = Lifts::new(shafts as usize, pressed, Some(tieup));
            let plan = BTreeMap::from([(1, vec![1]), (2, vec![shafts]), (3, vec![shafts, 1])]);
            let by_plan = Lifts::new(shafts as usize, plan, None);
            for pick in 1..=5 {
                assert_eq!(by_treadles.at(pick), by_plan.at(pick), "pick {pick} of {shafts} shafts");
            }
        }
    }
}
