//! The stiffnesses of a fabric, of which its energy is a linear function, and the forces that each of them makes.

use super::tile_system::bed;
use crate::energy::Foundation;
use crate::fabric::elements::{ElementSet, Elements};
use crate::fabric::{Mechanics, TileCoordinates};
use crate::model::{FabricCard, KnitCard, Network, Thickness, WovenCard, YarnCard, YarnRole, Yarns};

/// A stiffness of a fabric: of its yarns or of its contacts. Knits have six, and weaves six of theirs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TileStiffness {
    /// Stretch of a knit's first yarn `k_s` \[N\]; others keep their proportion to it.
    Stretch,
    /// Bending of a knit's first yarn `k_b` \[N·m²\]; others keep their proportion to it. The bed under a tile is measured in it.
    Bending,
    /// Wrapping of stitch contacts `k_w` \[N\].
    Wrapping,
    /// Yarn length of stitch contacts `k_l` \[N\].
    Length,
    /// Spacing barrier `k_c` \[N\].
    Spacing,
    /// Push of neighbouring legs \[N\]; none of yarns that meet in one point.
    Legs,
    /// Stretch of the first end `k_s` \[N\]; other yarns of the warp keep their proportion to it.
    WarpStretch,
    /// Stretch of the first pick whose yarn is not in the warp \[N\], and in proportion of the others; none where there is no such.
    WeftStretch,
    /// Bending of the first end `k_b` \[N·m²\], and in proportion of other yarns of the warp. The bed under a tile is measured in it.
    WarpBending,
    /// Bending of the first pick whose yarn is not in the warp \[N·m²\], and in proportion of the others; none where there is no such.
    WeftBending,
    /// Shear of crossings `k_x` \[N\], their jamming included.
    Shear,
}

impl TileStiffness {
    /// Number of those of a fabric.
    pub const COUNT: usize = 6;
    const OF_KNIT: [Self; Self::COUNT] =
        [Self::Stretch, Self::Bending, Self::Wrapping, Self::Length, Self::Spacing, Self::Legs];
    const OF_WEAVE: [Self; Self::COUNT] =
        [Self::WarpStretch, Self::WeftStretch, Self::Shear, Self::WarpBending, Self::WeftBending, Self::Spacing];

    /// Those of a fabric, in the order of arrays.
    #[must_use]
    pub fn all(card: &FabricCard) -> [Self; Self::COUNT] {
        match card {
            FabricCard::Knit(_) => Self::OF_KNIT,
            FabricCard::Woven(_) => Self::OF_WEAVE,
        }
    }

    /// What it is called.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Stretch => "stretch",
            Self::Bending => "bending",
            Self::Wrapping => "wrapping",
            Self::Length => "length",
            Self::Spacing => "spacing",
            Self::Legs => "legs",
            Self::WarpStretch => "warp stretch",
            Self::WeftStretch => "weft stretch",
            Self::WarpBending => "warp bending",
            Self::WeftBending => "weft bending",
            Self::Shear => "shear",
        }
    }

    /// Whether it is a bending stiffness \[N·m²\]; the others are forces \[N\].
    #[must_use]
    pub fn is_bending(self) -> bool {
        matches!(self, Self::Bending | Self::WarpBending | Self::WeftBending)
    }

    /// Whether a fabric has it.
    #[must_use]
    pub fn is_there(self, network: &Network, card: &FabricCard) -> bool {
        match self {
            Self::Legs => card.knit().is_some_and(|card| card.thickness.is_some()),
            Self::WeftStretch | Self::WeftBending => Systems::of(network).weft.is_some(),
            _ => Self::all(card).contains(&self),
        }
    }

    /// The stiffnesses of a fabric in SI units, in the order of [`Self::all`]; zero where it has none.
    #[must_use]
    pub fn of(network: &Network, yarns: &Yarns, card: &FabricCard) -> [f64; Self::COUNT] {
        match card {
            FabricCard::Knit(card) => [
                yarns.first().stretch_stiffness,
                yarns.first().bending_stiffness,
                card.wrapping_stiffness,
                card.length_stiffness,
                card.spacing_stiffness,
                card.thickness.map_or(0.0, |thickness| thickness.leg_stiffness),
            ],
            FabricCard::Woven(card) => {
                let systems = Systems::of(network);
                let [warp, weft] = [systems.warp, systems.weft].map(|kind| kind.map(|kind| yarns.of(kind)));
                let stretch = |yarn: Option<&YarnCard>| yarn.map_or(0.0, |yarn| yarn.stretch_stiffness);
                let bending = |yarn: Option<&YarnCard>| yarn.map_or(0.0, |yarn| yarn.bending_stiffness);
                [
                    stretch(warp),
                    stretch(weft),
                    card.shear_stiffness,
                    bending(warp),
                    bending(weft),
                    card.spacing_stiffness,
                ]
            }
        }
    }

    /// The same fabric with other stiffnesses.
    #[must_use]
    pub fn with(
        network: &Network,
        yarns: &Yarns,
        card: &FabricCard,
        stiffness: [f64; Self::COUNT],
    ) -> (Yarns, FabricCard) {
        match card {
            FabricCard::Knit(card) => knit_with(yarns, card, stiffness),
            FabricCard::Woven(card) => weave_with(&Systems::of(network), yarns, card, stiffness),
        }
    }
}

fn knit_with(yarns: &Yarns, card: &KnitCard, stiffness: [f64; TileStiffness::COUNT]) -> (Yarns, FabricCard) {
    let [stretch, bending, wrapping_stiffness, length_stiffness, spacing_stiffness, leg_stiffness] = stiffness;
    let first = yarns.first();
    let all: Vec<_> = yarns.cards().iter().map(|yarn| in_proportion(yarn, first, stretch, bending)).collect();
    let thickness = card.thickness.map(|thickness| Thickness { leg_stiffness, ..thickness });
    let card = KnitCard { wrapping_stiffness, length_stiffness, spacing_stiffness, thickness, ..card.clone() };
    (Yarns::new(all[0].clone(), all[1..].iter().cloned()), FabricCard::Knit(card))
}

fn weave_with(
    systems: &Systems,
    yarns: &Yarns,
    card: &WovenCard,
    stiffness: [f64; TileStiffness::COUNT],
) -> (Yarns, FabricCard) {
    let [warp_stretch, weft_stretch, shear_stiffness, warp_bending, weft_bending, spacing_stiffness] = stiffness;
    let changed = |kind: usize| {
        let kind = kind as u8;
        let yarn = yarns.of(kind);
        match (systems.warp, systems.weft) {
            (Some(first), _) if systems.in_warp(kind) => {
                in_proportion(yarn, yarns.of(first), warp_stretch, warp_bending)
            }
            (_, Some(first)) if systems.in_weft(kind) => {
                in_proportion(yarn, yarns.of(first), weft_stretch, weft_bending)
            }
            _ => yarn.clone(),
        }
    };
    // A thread of a number that has no card of its own gets one: what is the first yarn's elsewhere need not be so of it.
    let all: Vec<_> = (0..systems.kinds().max(yarns.cards().len())).map(changed).collect();
    let card = WovenCard { shear_stiffness, spacing_stiffness, ..card.clone() };
    (Yarns::new(all[0].clone(), all[1..].iter().cloned()), FabricCard::Woven(card))
}

/// A yarn whose stiffnesses go with those of another, which become these.
fn in_proportion(yarn: &YarnCard, first: &YarnCard, stretch: f64, bending: f64) -> YarnCard {
    YarnCard {
        stretch_stiffness: stretch * share(yarn.stretch_stiffness, first.stretch_stiffness),
        bending_stiffness: bending * share(yarn.bending_stiffness, first.bending_stiffness),
        ..yarn.clone()
    }
}

/// A yarn's stiffness over that of the first.
fn share(own: f64, first: f64) -> f64 {
    if first > 0.0 { own / first } else { 1.0 }
}

/// Which yarns a weave's warp and weft are of.
struct Systems {
    /// Role and yarn of every thread.
    threads: Vec<(YarnRole, u8)>,
    /// The yarn of the first end.
    warp: Option<u8>,
    /// That of the first pick whose yarn is not in the warp.
    weft: Option<u8>,
}

impl Systems {
    fn of(network: &Network) -> Self {
        let threads = network.yarn_role.iter().copied().zip(network.yarn_kind.iter().copied()).collect();
        let mut systems = Self { threads, warp: None, weft: None };
        systems.warp = systems.threads.iter().find(|thread| thread.0 == YarnRole::Warp).map(|thread| thread.1);
        systems.weft = systems.threads.iter().map(|thread| thread.1).find(|&kind| systems.in_weft(kind));
        systems
    }

    fn in_warp(&self, kind: u8) -> bool {
        self.threads.contains(&(YarnRole::Warp, kind))
    }

    /// In the weft, and not in the warp.
    fn in_weft(&self, kind: u8) -> bool {
        self.threads.contains(&(YarnRole::Weft, kind)) && !self.in_warp(kind)
    }

    fn kinds(&self) -> usize {
        self.threads.iter().map(|&(_, kind)| usize::from(kind) + 1).max().unwrap_or(1)
    }
}

/// Bending stiffness `k_b` \[N·m²\] and length `ℓ` \[m\] by which forces in a tile are measured: of its first yarn and of a loop, or of
/// its first end and the mean distance of its threads.
pub(super) fn bending_and_length(network: &Network, yarns: &Yarns, card: &FabricCard) -> (f64, f64) {
    let first = match card {
        FabricCard::Knit(_) => yarns.first(),
        FabricCard::Woven(_) => Systems::of(network).warp.map_or(yarns.first(), |kind| yarns.of(kind)),
    };
    (first.bending_stiffness, card.unit_length())
}

/// The energies of a tile with one stiffness at one and the others at zero, from which the forces of all follow.
#[derive(Debug)]
pub(super) struct UnitEnergies {
    coordinates: TileCoordinates,
    all: [TileStiffness; TileStiffness::COUNT],
    /// All stiffnesses of a knit but that of spacing are one; of a weave those of the warp, and shear.
    first: Mechanics,
    /// The others are.
    second: Mechanics,
    bed: Elements<Foundation, 1>,
}

impl UnitEnergies {
    /// Over given coordinates; `relative_bed` is the bed's stiffness for a bending stiffness of one \[1/m³\].
    pub fn new(
        network: &Network,
        yarns: &Yarns,
        card: &FabricCard,
        relative_bed: f64,
        mut coordinates: TileCoordinates,
    ) -> Self {
        let all = TileStiffness::all(card);
        let mut mechanics = |second: bool| {
            let ones = all.map(|stiffness| if stiffness.is_second() == second { 1.0 } else { 0.0 });
            let (yarns, card) = TileStiffness::with(network, yarns, card, ones);
            Mechanics::new(network, &yarns, &card, &mut coordinates)
        };
        let first = mechanics(false);
        let second = mechanics(true);
        Self { coordinates, all, first, second, bed: bed(network, relative_bed) }
    }

    fn sets(&self, stiffness: TileStiffness) -> Vec<&dyn ElementSet> {
        let (first, second, thick) = (&self.first, &self.second, &self.first.thick);
        match stiffness {
            // Where yarns have a thickness, the core of a segment is as stiff as the yarn.
            TileStiffness::Stretch => vec![&first.stretch, &thick.stretch, &first.spacing],
            TileStiffness::Bending => vec![&first.bending, &thick.bending, &self.bed],
            TileStiffness::Wrapping => vec![&first.wrapping],
            TileStiffness::Length => vec![&first.stitch_length],
            TileStiffness::Spacing => vec![&second.spacing],
            TileStiffness::Legs => vec![&thick.legs, &thick.facing],
            TileStiffness::WarpStretch => vec![&first.stretch],
            TileStiffness::WeftStretch => vec![&second.stretch],
            TileStiffness::WarpBending => vec![&first.bending, &self.bed],
            TileStiffness::WeftBending => vec![&second.bending],
            TileStiffness::Shear => vec![&first.shear],
        }
    }

    /// Work that the forces of each stiffness at one do along directions of the unknowns: `v · ∂²W/∂y∂p`.
    pub fn work<const K: usize>(&self, unknowns: &[f64], directions: [&[f64]; K]) -> [[f64; K]; TileStiffness::COUNT] {
        let mut world = Vec::new();
        self.coordinates.place(unknowns, &mut world);
        let motions = directions.map(|direction| self.coordinates.moved(direction));
        self.all.map(|stiffness| {
            let mut work = [0.0; K];
            for set in self.sets(stiffness) {
                set.visit_gradient(&world, &mut |stencil, gradient| {
                    for (sum, motion) in work.iter_mut().zip(&motions) {
                        *sum += stencil.iter().zip(gradient).map(|(&dof, g)| g * motion[dof as usize]).sum::<f64>();
                    }
                });
            }
            work
        })
    }
}

impl TileStiffness {
    /// Whether it is one in the second of the two mechanics of [`UnitEnergies`].
    fn is_second(self) -> bool {
        matches!(self, Self::Spacing | Self::WeftStretch | Self::WeftBending)
    }
}
