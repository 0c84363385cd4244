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
    /// Most plies that pictures draw.
    pub const MOST_PLIES: u32 = 12;

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

    /// Yarns that run together as one, each its whole length.
    ///
    /// They lie side by side and slide past each other: mass, cross-section, stretch and bending stiffness are sums, as of
    /// springs side by side. A bundle whose yarns could not slide would be stiffer in bending, `n` equal ones up to `n²` times as
    /// one, because the second moment of a cross-section goes as its area squared; yarns that are not twisted together do slide.
    /// Friction is the mean by radius, their share of the surface; damping and twist are those of the first.
    #[must_use]
    pub fn together<'a>(first: &'a Self, others: impl IntoIterator<Item = &'a Self>) -> Self {
        let cards: Vec<&Self> = std::iter::once(first).chain(others).collect();
        let sum = |of: fn(&Self) -> f64| cards.iter().map(|card| of(card)).sum::<f64>();
        Self {
            linear_density: sum(|card| card.linear_density),
            radius: sum(|card| card.radius * card.radius).sqrt(),
            stretch_stiffness: sum(|card| card.stretch_stiffness),
            bending_stiffness: sum(|card| card.bending_stiffness),
            friction_coefficient: sum(|card| card.friction_coefficient * card.radius) / sum(|card| card.radius),
            loose_ends: cards.iter().all(|card| card.loose_ends),
            plies: cards.iter().map(|card| card.plies).sum::<u32>().min(Self::MOST_PLIES),
            ..first.clone()
        }
    }

    /// Whether an end of this yarn can be pulled out of the contacts of a fabric that it is part of so.
    #[must_use]
    pub fn can_be_pulled_out(&self, role: YarnRole) -> bool {
        role != YarnRole::Knitted || self.loose_ends
    }
}

/// One of the yarns that run together as one of a fabric's yarns ([`YarnCard::together`]).
#[derive(Clone, Debug, PartialEq)]
pub struct Member {
    /// Its name.
    pub name: String,
    /// Its colour as sRGB.
    pub color: [u8; 3],
    /// What it is alone.
    pub card: YarnCard,
}

/// The cards of a fabric's yarns, by their numbers ([`super::Network::yarn_kind`]), and what they are called.
#[derive(Clone, Debug, PartialEq)]
pub struct Yarns {
    cards: Vec<YarnCard>,
    /// By number; empty where the yarns have no names.
    names: Vec<String>,
    /// By number: what runs together in each, nothing in a single yarn.
    members: Vec<Vec<Member>>,
}

impl Yarns {
    /// Yarns by their numbers; numbers beyond them are of the first.
    #[must_use]
    pub fn new(first: YarnCard, others: impl IntoIterator<Item = YarnCard>) -> Self {
        let mut cards = vec![first];
        cards.extend(others);
        Self { cards, names: Vec::new(), members: Vec::new() }
    }

    /// The same yarns with their names and their members, both by number.
    #[must_use]
    pub fn named(self, names: Vec<String>, members: Vec<Vec<Member>>) -> Self {
        Self { names, members, ..self }
    }

    /// The name of a yarn by its number, if it has one.
    #[must_use]
    pub fn name(&self, kind: u8) -> Option<&str> {
        self.names.get(usize::from(kind)).map(String::as_str)
    }

    /// The yarns that run together as this one; none in a single yarn.
    #[must_use]
    pub fn members(&self, kind: u8) -> &[Member] {
        self.members.get(usize::from(kind)).map_or(&[], Vec::as_slice)
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
        Self::new(card.clone(), [])
    }
}

impl From<&Yarns> for Yarns {
    fn from(yarns: &Yarns) -> Self {
        yarns.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn yarns_that_run_together_add_up_and_rub_as_their_surfaces_do() {
        let thin = YarnCard { radius: 3e-4, friction_coefficient: 0.2, loose_ends: true, plies: 7, ..YarnCard::unit() };
        let thick = YarnCard { radius: 4e-4, friction_coefficient: 0.55, plies: 8, ..YarnCard::unit() };
        let both = YarnCard::together(&thin, [&thick]);
        assert_eq!((both.linear_density, both.stretch_stiffness, both.bending_stiffness), (2.0, 6e4, 2.0));
        assert!((both.radius - 5e-4).abs() < 1e-18, "cross-sections add, radii do not: {}", both.radius);
        assert!((both.friction_coefficient - (3.0 * 0.2 + 4.0 * 0.55) / 7.0).abs() < 1e-15);
        assert_eq!(
            (both.plies, both.loose_ends),
            (12, false),
            "as many plies as pictures draw; held by the one that is"
        );
        // Held double: of the same packing, and as much to bend as two.
        let double = YarnCard::together(&thin, [&thin]);
        assert!((double.radius / thin.radius - 2f64.sqrt()).abs() < 1e-15);
        assert_eq!(YarnCard::together(&thin, []).linear_density, 1.0);
    }
}
