//! What is worked into one loop, one after the other.

use std::fmt;

/// One of the loops of an increase.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, PartialOrd, Ord)]
pub enum Part {
    /// Knitted into the loop.
    Knit,
    /// Purled into it.
    Purl,
    /// The yarn laid over the needle between two others.
    YarnOver,
}

/// The loops of an increase in the order in which a right-side row works them: from right to left as seen from the
/// front of the fabric. There are 2 to [`Parts::MOST`], the first and the last are worked into the loop, and no two
/// yarn-overs follow each other.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, PartialOrd, Ord)]
pub struct Parts {
    count: u8,
    /// Two bits a part.
    code: u32,
}

impl Parts {
    /// Most loops that can be worked into one.
    pub const MOST: usize = 9;

    /// Parts in the order of a right-side row, or `None` where no such increase can be worked.
    #[must_use]
    pub fn new(parts: &[Part]) -> Option<Self> {
        let held = |part: Option<&Part>| part.is_some_and(|part| *part != Part::YarnOver);
        let over = |pair: &[Part]| pair.iter().all(|part| *part == Part::YarnOver);
        let sound = (2..=Self::MOST).contains(&parts.len()) && held(parts.first()) && held(parts.last());
        (sound && !parts.windows(2).any(over)).then(|| Self::of(parts))
    }

    /// Parts that are known to be sound.
    pub(super) const fn of(parts: &[Part]) -> Self {
        let (mut code, mut k) = (0, 0);
        while k < parts.len() {
            code |= (parts[k] as u32) << (2 * k);
            k += 1;
        }
        // At most nine.
        Self { count: parts.len() as u8, code }
    }

    /// The parts of a text such as `(k, yo, k) in 1 st`.
    #[must_use]
    pub fn read(text: &str) -> Option<Self> {
        let inner = text.strip_prefix('(')?.strip_suffix(") in 1 st")?;
        let parts: Option<Vec<Part>> = inner
            .split(',')
            .map(|name| match name.trim() {
                "k" => Some(Part::Knit),
                "p" => Some(Part::Purl),
                "yo" => Some(Part::YarnOver),
                _ => None,
            })
            .collect();
        Self::new(&parts?)
    }

    /// How many.
    #[must_use]
    pub fn len(self) -> usize {
        usize::from(self.count)
    }

    /// There are always some.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.count == 0
    }

    /// The parts in the order in which a right-side row works them.
    pub fn iter(self) -> impl DoubleEndedIterator<Item = Part> {
        (0..self.len()).map(move |k| match (self.code >> (2 * k)) & 3 {
            0 => Part::Knit,
            1 => Part::Purl,
            _ => Part::YarnOver,
        })
    }

    /// The same increase as the other side of the fabric shows it.
    #[must_use]
    pub fn from_behind(self) -> Self {
        let turned: Vec<Part> = self
            .iter()
            .rev()
            .map(|part| match part {
                Part::Knit => Part::Purl,
                Part::Purl => Part::Knit,
                Part::YarnOver => Part::YarnOver,
            })
            .collect();
        Self::of(&turned)
    }
}

impl fmt::Display for Parts {
    /// `(k, yo, k) in 1 st`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = |part| match part {
            Part::Knit => "k",
            Part::Purl => "p",
            Part::YarnOver => "yo",
        };
        let names: Vec<&str> = self.iter().map(name).collect();
        write!(f, "({}) in 1 st", names.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::Part::{Knit as K, Purl as P, YarnOver as O};
    use super::*;

    #[test]
    fn parts_keep_their_order_and_turn_over() {
        let parts = Parts::new(&[K, O, P, O, K]).unwrap();
        assert_eq!(parts.iter().collect::<Vec<_>>(), [K, O, P, O, K]);
        assert_eq!(parts.to_string(), "(k, yo, p, yo, k) in 1 st");
        assert_eq!(Parts::read(&parts.to_string()), Some(parts));
        assert_eq!(Parts::read("(k, x) in 1 st"), None);
        let uneven = Parts::new(&[K, K, P]).unwrap();
        assert_eq!(uneven.from_behind().iter().collect::<Vec<_>>(), [K, P, P]);
        assert_eq!(uneven.from_behind().from_behind(), uneven);
    }

    #[test]
    fn what_cannot_be_worked_into_a_loop_is_none() {
        for parts in [&[K][..], &[O, K], &[K, O], &[K, O, O, K], &[K; 10], &[]] {
            assert_eq!(Parts::new(parts), None, "{parts:?}");
        }
    }
}
