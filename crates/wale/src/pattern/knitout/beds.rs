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
        (index.abs() <= FARTHEST_NEEDLE).then_some(Self { bed, index })
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

/// The loops on every needle, the first that was laid on it first.
pub(super) type Needles = BTreeMap<Needle, Vec<usize>>;
