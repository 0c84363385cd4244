//! Tests of stretched tiles and of fits to them.

mod fits;
mod known;
mod slopes;
mod stress;
mod weaves;

use wale::dynamics::stretched_tile::{StretchedTile, TileReference};
use wale::dynamics::tile_equilibrium::{TileSettings, relax_tile};
use wale::model::{KnitCard, LoopProportions, Network, YarnCard, Yarns};
use wale::pattern::{Chart, Stitch, knit};

/// Acrylic yarn, and a loop of it.
pub(super) fn yarn() -> YarnCard {
    YarnCard {
        linear_density: 500e-6,
        radius: 0.74e-3,
        stretch_stiffness: 20.0,
        bending_stiffness: 45e-9,
        friction_coefficient: 0.3,
        mass_damping: 0.5,
        stiffness_damping: 0.05,
        loose_ends: false,
        plies: 4,
        twist: 100.0,
    }
}

pub(super) const LOOP_LENGTH: f64 = 0.0169;

/// A knit of knit loops, its yarn and its card.
pub(super) fn knit_of(columns: usize, rows: usize, thick: bool) -> (Network, Yarns, KnitCard) {
    let proportions = if thick { LoopProportions::thick() } else { LoopProportions::default() };
    let card = proportions.card(&yarn(), LOOP_LENGTH);
    let network = knit::tile(&Chart::new(vec![vec![Stitch::Knit; columns]; rows]).unwrap(), &card).unwrap();
    (network, (&yarn()).into(), card)
}

/// Settings so tight that differences can be taken.
pub(super) fn tight(card: &KnitCard) -> TileSettings {
    TileSettings { tolerance: 2e-9, ..TileSettings::of(card) }
}

pub(super) fn relaxed(columns: usize, rows: usize, thick: bool) -> TileReference {
    let (network, yarns, card) = knit_of(columns, rows, thick);
    let rest = relax_tile(&network, &yarns, &card, &tight(&card));
    TileReference::new(&network, &yarns, &card, &tight(&card), rest).unwrap()
}

/// Pulls in steps with the compression free or, as a multiple of the stretch, given.
pub(super) fn pulled(
    reference: &TileReference,
    angle: f64,
    stretch: f64,
    across: Option<f64>,
) -> (StretchedTile, wale::dynamics::stretched_tile::StretchedEquilibrium) {
    let mut tile = StretchedTile::new(reference, angle, across.is_none()).unwrap();
    let mut found = tile.solve(0.0, 0.0).unwrap();
    let steps = (stretch.abs() / 0.02).ceil() as u32;
    for step in 1..=steps {
        let s = stretch * f64::from(step) / f64::from(steps);
        found = tile.solve(s, across.unwrap_or(0.0) * s).unwrap();
    }
    (tile, found)
}
