//! How rows follow each other on the needles.

/// A side of the fabric.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Default)]
pub enum Side {
    /// The front: the side that charts show.
    #[default]
    RightSide,
    /// The back.
    WrongSide,
}

/// How rows follow each other on the needles. It decides the course of the yarn, never the look of the front.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash)]
pub enum Working {
    /// Back and forth: the yarn turns at the selvedges. Right-side rows run right to left as seen from the front,
    /// wrong-side rows left to right.
    Flat {
        /// The side that faces the knitter while the first row above the cast-on is worked.
        first_row: Side,
    },
    /// In the round: a tube; every row runs right to left as seen from its outside, which is the front.
    Round,
}

impl Default for Working {
    fn default() -> Self {
        Self::Flat { first_row: Side::RightSide }
    }
}

impl Working {
    /// The side that faces the knitter in a row (counted from 0, the first row above the cast-on).
    #[must_use]
    pub fn side(self, row: usize) -> Side {
        match self {
            Self::Round => Side::RightSide,
            Self::Flat { first_row } => match (first_row, row.is_multiple_of(2)) {
                (side, true) => side,
                (Side::RightSide, false) => Side::WrongSide,
                (Side::WrongSide, false) => Side::RightSide,
            },
        }
    }

    /// Whether the yarn of a row runs from the left edge to the right edge as seen from the front.
    #[must_use]
    pub fn left_to_right(self, row: usize) -> bool {
        self.side(row) == Side::WrongSide
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_alternate_flat_and_not_in_the_round() {
        let flat = Working::default();
        assert!(!flat.left_to_right(0) && flat.left_to_right(1));
        let from_behind = Working::Flat { first_row: Side::WrongSide };
        assert!(from_behind.left_to_right(0) && !from_behind.left_to_right(1));
        assert!(!Working::Round.left_to_right(1));
    }
}
