//! What can be worked into the loops on the needle.

use std::fmt;

use super::increase::{Part, Parts};

/// Which of the loops that are worked together lies in front, as seen from the front of the fabric: the others lean
/// under it.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, PartialOrd, Ord)]
pub enum Lean {
    /// The rightmost loop in front, the decrease leans to the left: ssk, sssk.
    Left,
    /// The leftmost loop in front, the decrease leans to the right: k2tog, k3tog.
    Right,
    /// The middle loop in front: the centred double decrease.
    Centre,
}

/// A stitch as seen from the front (right side) of the fabric.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Stitch {
    /// The new loop comes through its parent from back to front: legs in front, head behind.
    Knit,
    /// The new loop comes through its parent from front to back: head in front, legs behind.
    Purl,
    /// A loop through nothing: the yarn laid over the needle. It leaves a hole.
    YarnOver,
    /// One loop through several at once, which come to lie on each other [Cirio2017, section 3.2.3].
    Together {
        /// As a knit (`true`) or a purl.
        knit: bool,
        /// Loops that it takes, two or three.
        loops: u8,
        /// Which of them is in front.
        lean: Lean,
    },
    /// Several loops through one.
    Increase(Parts),
    /// A loop through the strand between two loops of the row below (m1). The half turn that knitters give to the
    /// strand is left out.
    Lifted {
        /// As a knit (`true`) or a purl.
        knit: bool,
    },
    /// No loop: the one on the needle is passed on as it is, and the yarn floats past it.
    Slip {
        /// Whether the yarn passes in front, as seen from the front of the fabric.
        in_front: bool,
    },
    /// A loop laid over the needle beside the one that is there, to be worked together with it: a tuck of knitting
    /// machines, `sl1yo` of hand knitters' brioche.
    Tuck,
}

/// Names as knitters write them, seen by whoever works the row, with the symbols of charts.
const NAMES: [(&str, char, Stitch); 35] = {
    use Lean::{Centre, Left, Right};
    use Part::{Knit as K, Purl as P, YarnOver as O};
    use Stitch as S;
    [
        ("k", 'k', S::Knit),
        ("p", 'p', S::Purl),
        ("yo", 'o', S::YarnOver),
        ("k2tog", '/', S::together(true, 2, Right)),
        ("ssk", '\\', S::together(true, 2, Left)),
        ("p2tog", 'r', S::together(false, 2, Right)),
        ("ssp", 'l', S::together(false, 2, Left)),
        ("k3tog", '>', S::together(true, 3, Right)),
        ("sssk", '<', S::together(true, 3, Left)),
        ("cdd", '^', S::together(true, 3, Centre)),
        ("p3tog", 'R', S::together(false, 3, Right)),
        ("sssp", 'L', S::together(false, 3, Left)),
        ("cddp", 'v', S::together(false, 3, Centre)),
        ("kfb", 'f', S::Increase(Parts::of(&[K, P]))),
        ("pfb", 'F', S::Increase(Parts::of(&[P, K]))),
        ("kyok", 'Y', S::Increase(Parts::of(&[K, O, K]))),
        ("kpk", 'Z', S::Increase(Parts::of(&[K, P, K]))),
        ("pkp", 'z', S::Increase(Parts::of(&[P, K, P]))),
        ("m1", 'm', S::Lifted { knit: true }),
        ("m1p", 'M', S::Lifted { knit: false }),
        ("sl", 'V', S::Slip { in_front: false }),
        ("slyf", 'W', S::Slip { in_front: true }),
        ("tuck", 'T', S::Tuck),
        // Other names of the same.
        ("skp", '\\', S::together(true, 2, Left)),
        ("skpo", '\\', S::together(true, 2, Left)),
        // The order of the two loops that lie under the first is not told apart.
        ("sk2p", '<', S::together(true, 3, Left)),
        ("s2kp", '^', S::together(true, 3, Centre)),
        ("s2kpo", '^', S::together(true, 3, Centre)),
        ("s2kp2", '^', S::together(true, 3, Centre)),
        ("slip", 'V', S::Slip { in_front: false }),
        ("m1l", 'm', S::Lifted { knit: true }),
        ("m1r", 'm', S::Lifted { knit: true }),
        ("sl1yo", 'T', S::Tuck),
        ("knit", 'k', S::Knit),
        ("purl", 'p', S::Purl),
    ]
};

/// What knitters work, but contacts between neighbours cannot hold.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum NotHeld {
    /// Loops that cross.
    Cable,
    /// A loop with a half turn.
    Twisted,
}

impl fmt::Display for NotHeld {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Cable => {
                "a cable: loops that cross cannot be held by contacts between neighbours; \
                 work its stitches without crossing them"
            }
            Self::Twisted => {
                "a twisted stitch: the half turn of its loop cannot be held by contacts between neighbours; \
                 work it through the front of the loop"
            }
        })
    }
}

impl NotHeld {
    /// What a knitter's name of a stitch means that is none of [`Stitch::all`]: `c4f`, `t2b`, `rt`, `k1tbl`.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        let name = name.trim().to_lowercase();
        let without_digits = |text: &str| text.trim_start_matches(|c: char| c.is_ascii_digit()).to_owned();
        if let Some(stitch) = name.strip_suffix("tbl").and_then(|stitch| stitch.strip_prefix(['k', 'p'])) {
            return without_digits(stitch).trim().is_empty().then_some(Self::Twisted);
        }
        let crossed = name.strip_prefix(['c', 't']).is_some_and(|rest| {
            let side = without_digits(rest);
            side.len() < rest.len() && ["f", "b", "l", "r", "fp", "bp", "lp", "rp"].contains(&side.as_str())
        });
        (crossed || ["rt", "lt", "rc", "lc", "rpc", "lpc"].contains(&name.as_str())).then_some(Self::Cable)
    }
}

impl Stitch {
    const fn together(knit: bool, loops: u8, lean: Lean) -> Self {
        Self::Together { knit, loops, lean }
    }

    /// The stitch of a name as knitters write it, as [`Stitch::all`] lists them.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        NAMES.iter().find(|(known, ..)| *known == name).map(|(_, _, stitch)| *stitch)
    }

    /// The stitch of a name, or an increase as [`Parts`] writes it: `(k, yo, k) in 1 st`.
    #[must_use]
    pub fn read(text: &str) -> Option<Self> {
        let text = text.trim();
        Self::named(text).or_else(|| Parts::read(text).map(Self::Increase))
    }

    /// All stitches with their names and symbols; other names of the same last.
    pub fn all() -> impl Iterator<Item = (&'static str, char, Self)> {
        NAMES.into_iter()
    }

    /// The names of all stitches, for messages.
    #[must_use]
    pub fn names() -> String {
        NAMES.map(|(name, ..)| name).join(", ")
    }

    /// The same stitch seen from the other side of the fabric. What leans to the right from one side, its left loop in
    /// front, has its left loop in front from the other side too: left and right change, and so do front and back.
    #[must_use]
    pub fn from_behind(self) -> Self {
        match self {
            Self::Knit => Self::Purl,
            Self::Purl => Self::Knit,
            Self::Together { knit, loops, lean } => Self::Together { knit: !knit, loops, lean },
            Self::Increase(parts) => Self::Increase(parts.from_behind()),
            Self::Lifted { knit } => Self::Lifted { knit: !knit },
            Self::Slip { in_front } => Self::Slip { in_front: !in_front },
            Self::YarnOver | Self::Tuck => self,
        }
    }

    /// The same worked through the back of the loops, `tbl`: together they lean to the left. `None` where that twists what it
    /// is drawn through; the half turn that it gives to loops worked together is left out.
    #[must_use]
    pub fn through_back_loops(self) -> Option<Self> {
        match self {
            Self::Together { knit, loops, lean: Lean::Right } => Some(Self::Together { knit, loops, lean: Lean::Left }),
            _ => None,
        }
    }

    /// Places on the needle that it works: those of the row below.
    #[must_use]
    pub fn takes(self) -> usize {
        match self {
            Self::YarnOver | Self::Lifted { .. } => 0,
            Self::Together { loops, .. } => usize::from(loops),
            _ => 1,
        }
    }

    /// Places on the needle that it leaves for the row above.
    #[must_use]
    pub fn leaves(self) -> usize {
        match self {
            Self::Increase(parts) => parts.len(),
            _ => 1,
        }
    }

    /// New loops that it makes.
    #[must_use]
    pub fn makes(self) -> usize {
        match self {
            Self::Slip { .. } => 0,
            _ => self.leaves(),
        }
    }

    /// Whether its loop comes to the front (`true`) or goes to the back; `None` where that is not one of the two.
    #[must_use]
    pub fn is_knit(self) -> Option<bool> {
        match self {
            Self::Knit => Some(true),
            Self::Purl => Some(false),
            Self::Together { knit, .. } | Self::Lifted { knit } => Some(knit),
            Self::YarnOver | Self::Increase(_) | Self::Slip { .. } | Self::Tuck => None,
        }
    }

    /// Whether the yarn passes from one side of the fabric to the other between this stitch and the next.
    #[must_use]
    pub fn turns_to(self, next: Self) -> bool {
        matches!((self.is_knit(), next.is_knit()), (Some(a), Some(b)) if a != b)
    }

    /// The places that it takes, front to back as seen from the front of the fabric, counted from the left.
    #[must_use]
    pub fn front_to_back(self) -> Vec<usize> {
        let count = self.takes();
        match self {
            Self::Together { lean: Lean::Left, .. } => (0..count).rev().collect(),
            Self::Together { lean: Lean::Centre, .. } => {
                let middle = count / 2;
                std::iter::once(middle).chain((0..count).rev().filter(|&k| k != middle)).collect()
            }
            _ => (0..count).collect(),
        }
    }

    /// The symbol that charts and listings of this program print; `?` for an increase without one.
    #[must_use]
    pub fn symbol(self) -> char {
        NAMES.iter().find(|(_, _, stitch)| *stitch == self).map_or('?', |(_, symbol, _)| *symbol)
    }
}

impl fmt::Display for Stitch {
    /// The name that knitters write.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (NAMES.iter().find(|(_, _, stitch)| stitch == self), self) {
            (Some((name, ..)), _) => f.write_str(name),
            (None, Self::Increase(parts)) => parts.fmt(f),
            (None, _) => f.write_str("?"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cables_and_twisted_stitches_are_known_by_name() {
        for name in ["c4f", "C6B", "t3l", "c12r", "c4fp", "RT"] {
            assert_eq!(NotHeld::named(name), Some(NotHeld::Cable), "{name}");
        }
        for name in ["ktbl", "k1tbl", "P1TBL", "k tbl", "k1 tbl"] {
            assert_eq!(NotHeld::named(name), Some(NotHeld::Twisted), "{name}");
        }
        for name in ["", "c", "cf", "c4", "tbl", "k2togtbl", "t4x", "kfb"] {
            assert_eq!(NotHeld::named(name), None, "{name}");
        }
    }

    #[test]
    fn names_and_symbols_are_told_apart() {
        for (name, symbol, stitch) in Stitch::all() {
            assert_eq!(Stitch::named(name), Some(stitch));
            assert_eq!(stitch.symbol(), symbol);
            assert_eq!(stitch.from_behind().from_behind(), stitch);
            assert_eq!(stitch.front_to_back().len(), stitch.takes());
            assert_eq!(Stitch::read(&stitch.to_string()), Some(stitch));
            let same = Stitch::all().filter(|(_, other, _)| *other == symbol);
            assert!(same.into_iter().all(|(_, _, other)| other == stitch), "{symbol} has two meanings");
        }
        assert_eq!(Stitch::named("k2tog").unwrap().front_to_back(), [0, 1]);
        assert_eq!(Stitch::named("sssk").unwrap().front_to_back(), [2, 1, 0]);
        assert_eq!(Stitch::named("cdd").unwrap().front_to_back(), [1, 2, 0]);
        // A purled decrease of the back looks like the knitted one of the front.
        assert_eq!(Stitch::named("p2tog").unwrap().from_behind().to_string(), "k2tog");
        assert_eq!(Stitch::named("ssp").unwrap().from_behind().to_string(), "ssk");
        // So does an increase, worked the other way.
        assert_eq!(Stitch::named("kfb").unwrap().from_behind().to_string(), "kfb");
        assert_eq!(Stitch::named("kpk").unwrap().from_behind().to_string(), "pkp");
        assert_eq!(Stitch::named("slyf").unwrap().from_behind().to_string(), "sl");
    }
}
