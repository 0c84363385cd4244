//! What a fabric is like, knitted or woven.

use super::{KnitCard, WovenCard, YarnRole};

/// The card of a fabric.
#[derive(Clone, Debug, PartialEq)]
pub enum FabricCard {
    /// A knitted one.
    Knit(KnitCard),
    /// A woven one.
    Woven(WovenCard),
}

impl FabricCard {
    /// The card of a knitted fabric, if it is one.
    #[must_use]
    pub fn knit(&self) -> Option<&KnitCard> {
        match self {
            Self::Knit(card) => Some(card),
            Self::Woven(_) => None,
        }
    }

    /// The same to change it.
    pub fn knit_mut(&mut self) -> Option<&mut KnitCard> {
        match self {
            Self::Knit(card) => Some(card),
            Self::Woven(_) => None,
        }
    }

    /// The card of a woven fabric, if it is one.
    #[must_use]
    pub fn woven(&self) -> Option<&WovenCard> {
        match self {
            Self::Knit(_) => None,
            Self::Woven(card) => Some(card),
        }
    }

    /// Length along the model's yarn per length of real yarn \[–\]: a metre of the model weighs as much more.
    #[must_use]
    pub fn path_ratio(&self, role: YarnRole) -> f64 {
        match (self, role) {
            (Self::Knit(card), _) => card.path_ratio,
            (Self::Woven(card), YarnRole::Weft) => 1.0 / (1.0 + card.crimp[1]),
            (Self::Woven(card), _) => 1.0 / (1.0 + card.crimp[0]),
        }
    }

    /// Stiffness of the spacing barrier `k_c` \[N\].
    #[must_use]
    pub fn spacing_stiffness(&self) -> f64 {
        match self {
            Self::Knit(card) => card.spacing_stiffness,
            Self::Woven(card) => card.spacing_stiffness,
        }
    }

    /// Stiffness of the friction anchors `k_f` \[N/m\].
    #[must_use]
    pub fn anchor_stiffness(&self) -> f64 {
        match self {
            Self::Knit(card) => card.anchor_stiffness,
            Self::Woven(card) => card.anchor_stiffness,
        }
    }

    /// Smallest compression of a contact `λ_min` \[N\].
    #[must_use]
    pub fn residual_compression(&self) -> f64 {
        match self {
            Self::Knit(card) => card.residual_compression,
            Self::Woven(card) => card.residual_compression,
        }
    }

    /// Length by which what goes on in a tile is measured \[m\]: that of a loop, or the mean distance of a weave's threads.
    #[must_use]
    pub fn unit_length(&self) -> f64 {
        match self {
            Self::Knit(card) => card.loop_length,
            Self::Woven(card) => 0.5 * (card.spacing[0] + card.spacing[1]),
        }
    }

    /// Width and height of a stitch or of a crossing in the layout \[m\].
    #[must_use]
    pub fn cell(&self) -> [f64; 2] {
        match self {
            Self::Knit(card) => [card.wale_spacing, card.course_spacing],
            Self::Woven(card) => card.spacing,
        }
    }
}

impl From<&KnitCard> for FabricCard {
    fn from(card: &KnitCard) -> Self {
        Self::Knit(card.clone())
    }
}

impl From<&WovenCard> for FabricCard {
    fn from(card: &WovenCard) -> Self {
        Self::Woven(card.clone())
    }
}

impl From<&FabricCard> for FabricCard {
    fn from(card: &FabricCard) -> Self {
        card.clone()
    }
}
