//! What a yarn is made of, in SI units.

use super::YarnRole;

/// A yarn.
#[derive(Clone, Debug, PartialEq)]
pub struct YarnCard {
    /// Linear density \[kg/m\] (1 tex = 1e-6 kg/m).
    pub linear_density: f64,
    /// Radius \[m\].
    pub radius: f64,
    /// Stretch stiffness `k_s = EA` \[N\].
    pub stretch_stiffness: f64,
    /// Bending stiffness `k_b = EI` \[N·m²\].
    pub bending_stiffness: f64,
    /// Coefficient of sliding friction between yarns \[–\].
    pub friction_coefficient: f64,
    /// Mass damping `α` \[1/s\].
    pub mass_damping: f64,
    /// Stiffness damping `β` \[s\], acting on the rates of bend and wrap.
    pub stiffness_damping: f64,
    /// Whether the ends of a knitted yarn are loose, so that it can be pulled out of its fabric; tied to it if not. The
    /// threads of a weave are always loose.
    pub loose_ends: bool,
    /// Ply count drawn in pictures.
    pub plies: u32,
    /// Twist drawn in pictures \[turns/m\].
    pub twist: f64,
}

impl YarnCard {
    /// The yarn in which [`super::LoopProportions`] are given, for loops of length 1: bending stiffness 1, no friction, no damping.
    /// Lengths are then in loops `ℓ` and forces in `k_b/ℓ²`.
    #[must_use]
    pub fn unit() -> Self {
        Self {
            linear_density: 1.0,
            radius: 0.05,
            stretch_stiffness: 3e4,
            bending_stiffness: 1.0,
            friction_coefficient: 0.0,
            mass_damping: 0.0,
            stiffness_damping: 0.0,
            loose_ends: false,
            plies: 2,
            twist: 0.0,
        }
    }

    /// Whether an end of this yarn can be pulled out of the contacts of a fabric that it is part of so.
    #[must_use]
    pub fn can_be_pulled_out(&self, role: YarnRole) -> bool {
        role != YarnRole::Knitted || self.loose_ends
    }
}

/// The cards of a fabric's yarns, by their numbers ([`super::Network::yarn_kind`]).
#[derive(Clone, Debug, PartialEq)]
pub struct Yarns {
    cards: Vec<YarnCard>,
}

impl Yarns {
    /// Yarns by their numbers; numbers beyond them are of the first.
    #[must_use]
    pub fn new(first: YarnCard, others: impl IntoIterator<Item = YarnCard>) -> Self {
        let mut cards = vec![first];
        cards.extend(others);
        Self { cards }
    }

    /// The card of a yarn by its number.
    #[must_use]
    pub fn of(&self, kind: u8) -> &YarnCard {
        self.cards.get(usize::from(kind)).unwrap_or(&self.cards[0])
    }

    /// The first yarn, whose damping is that of the whole fabric.
    #[must_use]
    pub fn first(&self) -> &YarnCard {
        &self.cards[0]
    }

    /// The first yarn, to change it.
    pub fn first_mut(&mut self) -> &mut YarnCard {
        &mut self.cards[0]
    }

    /// All cards, at least one.
    #[must_use]
    pub fn cards(&self) -> &[YarnCard] {
        &self.cards
    }
}

impl From<&YarnCard> for Yarns {
    fn from(card: &YarnCard) -> Self {
        Self { cards: vec![card.clone()] }
    }
}

impl From<&Yarns> for Yarns {
    fn from(yarns: &Yarns) -> Self {
        yarns.clone()
    }
}
