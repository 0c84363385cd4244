//! The stiffnesses of a knit, of which its energy is a linear function, and the forces that each of them makes.

use super::tile_system::bed;
use crate::energy::Foundation;
use crate::fabric::elements::{ElementSet, Elements};
use crate::fabric::{Mechanics, TileCoordinates};
use crate::model::{KnitCard, Network, Thickness, YarnCard, Yarns};

/// A stiffness of a knit: of its yarns or of its contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TileStiffness {
    /// Stretch of the first yarn `k_s` \[N\]; others keep their proportion to it.
    Stretch,
    /// Bending of the first yarn `k_b` \[N·m²\]; others keep their proportion to it. The bed under a tile is measured in it.
    Bending,
    /// Wrapping of stitch contacts `k_w` \[N\].
    Wrapping,
    /// Yarn length of stitch contacts `k_l` \[N\].
    Length,
    /// Spacing barrier `k_c` \[N\].
    Spacing,
    /// Push of neighbouring legs \[N\]; zero for yarns that meet in one point.
    Legs,
}

impl TileStiffness {
    /// Number of them.
    pub const COUNT: usize = 6;
    /// All, in the order of arrays.
    pub const ALL: [Self; Self::COUNT] =
        [Self::Stretch, Self::Bending, Self::Wrapping, Self::Length, Self::Spacing, Self::Legs];
    /// What they are called, in the same order.
    pub const NAMES: [&'static str; Self::COUNT] = ["stretch", "bending", "wrapping", "length", "spacing", "legs"];

    /// The stiffnesses of a knit in SI units, in the order of [`Self::ALL`].
    #[must_use]
    pub fn of(yarns: &Yarns, card: &KnitCard) -> [f64; Self::COUNT] {
        [
            yarns.first().stretch_stiffness,
            yarns.first().bending_stiffness,
            card.wrapping_stiffness,
            card.length_stiffness,
            card.spacing_stiffness,
            card.thickness.map_or(0.0, |thickness| thickness.leg_stiffness),
        ]
    }

    /// The same knit with other stiffnesses.
    #[must_use]
    pub fn with(yarns: &Yarns, card: &KnitCard, stiffness: [f64; Self::COUNT]) -> (Yarns, KnitCard) {
        let [stretch, bending, wrapping_stiffness, length_stiffness, spacing_stiffness, leg_stiffness] = stiffness;
        let first = yarns.first();
        let changed = |yarn: &YarnCard| YarnCard {
            stretch_stiffness: stretch * share(yarn.stretch_stiffness, first.stretch_stiffness),
            bending_stiffness: bending * share(yarn.bending_stiffness, first.bending_stiffness),
            ..yarn.clone()
        };
        let all: Vec<_> = yarns.cards().iter().map(changed).collect();
        let thickness = card.thickness.map(|thickness| Thickness { leg_stiffness, ..thickness });
        let card = KnitCard { wrapping_stiffness, length_stiffness, spacing_stiffness, thickness, ..card.clone() };
        (Yarns::new(all[0].clone(), all[1..].iter().cloned()), card)
    }
}

/// A yarn's stiffness over that of the first.
fn share(own: f64, first: f64) -> f64 {
    if first > 0.0 { own / first } else { 1.0 }
}

/// The energies of a tile with one stiffness at one and the others at zero, from which the forces of all follow.
#[derive(Debug)]
pub(super) struct UnitEnergies {
    coordinates: TileCoordinates,
    /// All stiffnesses but that of spacing are one.
    most: Mechanics,
    /// That of spacing alone.
    spacing: Mechanics,
    bed: Elements<Foundation, 1>,
}

impl UnitEnergies {
    /// Over given coordinates; `relative_bed` is the bed's stiffness for a bending stiffness of one \[1/m³\].
    pub fn new(
        network: &Network,
        yarns: &Yarns,
        card: &KnitCard,
        relative_bed: f64,
        mut coordinates: TileCoordinates,
    ) -> Self {
        let mut mechanics = |stiffness| {
            let (yarns, card) = TileStiffness::with(yarns, card, stiffness);
            Mechanics::new(network, &yarns, &(&card).into(), &mut coordinates)
        };
        let most = mechanics([1.0, 1.0, 1.0, 1.0, 0.0, 1.0]);
        let spacing = mechanics([0.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        Self { coordinates, most, spacing, bed: bed(network, relative_bed) }
    }

    fn sets(&self, stiffness: TileStiffness) -> Vec<&dyn ElementSet> {
        let (most, thick) = (&self.most, &self.most.thick);
        match stiffness {
            // Where yarns have a thickness, the core of a segment is as stiff as the yarn.
            TileStiffness::Stretch => vec![&most.stretch, &thick.stretch, &most.spacing],
            TileStiffness::Bending => vec![&most.bending, &thick.bending, &self.bed],
            TileStiffness::Wrapping => vec![&most.wrapping],
            TileStiffness::Length => vec![&most.stitch_length],
            TileStiffness::Spacing => vec![&self.spacing.spacing],
            TileStiffness::Legs => vec![&thick.legs, &thick.facing],
        }
    }

    /// Work that the forces of each stiffness at one do along directions of the unknowns: `v · ∂²W/∂y∂p`.
    pub fn work<const K: usize>(&self, unknowns: &[f64], directions: [&[f64]; K]) -> [[f64; K]; TileStiffness::COUNT] {
        let mut world = Vec::new();
        self.coordinates.place(unknowns, &mut world);
        let motions = directions.map(|direction| self.coordinates.moved(direction));
        TileStiffness::ALL.map(|stiffness| {
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
