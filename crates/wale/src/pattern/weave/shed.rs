//! Sheds: which ends are up at a pick, for drafts of many shafts and many picks.

use std::collections::BTreeMap;

const WORD: usize = u64::BITS as usize;

/// The shafts that every end is on.
pub(super) struct Sheds {
    ends: Vec<On>,
    shafts: usize,
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
        Self { ends: (0..ends).map(on).collect(), shafts }
    }

    /// Which ends are up when these shafts are lifted, or, of a sinking shed, lowered.
    pub fn warp_up(&self, lifted: impl Iterator<Item = u64>, rising: bool) -> Vec<bool> {
        let lifted = bits(self.shafts, lifted);
        let is_lifted = |shaft: &u64| lifted[*shaft as usize / WORD] >> (*shaft as usize % WORD) & 1 == 1;
        let up = |on: &On| match on {
            On::Few(list) => list.iter().any(is_lifted),
            On::Many(bits) => bits.iter().zip(&lifted).any(|(on, lifted)| on & lifted != 0),
        };
        self.ends.iter().map(|on| up(on) == rising).collect()
    }
}

/// A bit for every shaft from 0.
fn bits(shafts: usize, list: impl Iterator<Item = u64>) -> Vec<u64> {
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
    fn few_shafts_and_many_lift_alike() {
        for shafts in [4, 63, 64, 200] {
            let all: Vec<u64> = (1..=shafts).collect();
            let threading = BTreeMap::from([(1, vec![1]), (2, all.clone()), (3, vec![shafts])]);
            let sheds = Sheds::new(4, shafts as usize, &threading);
            assert_eq!(sheds.warp_up([1].into_iter(), true), [true, true, false, false]);
            assert_eq!(sheds.warp_up([shafts, shafts].into_iter(), true), [false, true, true, false]);
            assert_eq!(sheds.warp_up([2].into_iter(), false), [true, false, true, true]);
            assert_eq!(sheds.warp_up(all.into_iter(), true), [true, true, true, false]);
        }
    }
}
