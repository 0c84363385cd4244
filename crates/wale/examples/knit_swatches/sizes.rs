//! Relaxed sizes of patterns relative to stockinette, by periodic tiles without friction.

use rayon::prelude::*;
use wale::dynamics::off_needles::{OffNeedles, off_needles};
use wale::dynamics::tile_equilibrium::{TileEquilibrium, TileSettings, relax_from_starts, relax_tile_from};
use wale::dynamics::tile_shaking::shaken;
use wale::model::{KnitCard, LoopProportions, Network, YarnCard};
use wale::pattern::{Chart, knit};

/// Measured relaxed size of stockinette \[mm\]: the mean of its four swatches, one of them shown from its purl side.
pub const STOCKINETTE: [f64; 2] = [99.25, 81.0];
/// Starts of a repeat of few, some and many loops: the patches of a large one average over what starts differ in.
fn starts(loops: usize) -> usize {
    match loops {
        0..=20 => 4,
        21..=60 => 2,
        _ => 1,
    }
}

/// How often a repeat is shaken, where repeats are: one shake of hundreds of loops moves as many of them up as down.
fn shakes(loops: usize) -> usize {
    match loops {
        0..=20 => 12,
        21..=60 => 6,
        61..=200 => 4,
        _ => 0,
    }
}

/// A card and the bed on which its swatches are measured.
#[derive(Clone)]
pub struct Model {
    pub proportions: LoopProportions,
    pub settings: TileSettings,
    /// Whether repeats at rest are shaken.
    pub shaken: bool,
    /// How repeats come off their needles, where they are not taken as washed.
    pub needles: Option<OffNeedles>,
}

impl Model {
    /// The bed is that of the proportions' contacts.
    pub fn new(proportions: LoopProportions) -> Self {
        let bed = TileSettings::of(&proportions.card(&YarnCard::unit(), 1.0)).bed;
        let settings = TileSettings {
            bed,
            noise: 0.01,
            relief: 0.0,
            shorten: true,
            strand_contact: true,
            seed: 1,
            max_iterations: 1500,
            tolerance: 1e-4,
        };
        Self { proportions, settings, shaken: false, needles: None }
    }

    pub fn card(&self) -> KnitCard {
        self.proportions.card(&YarnCard::unit(), 1.0)
    }

    pub fn tile(&self, chart: &Chart) -> Network {
        knit::tile(chart, &self.card()).expect("a repeat that has been knitted before")
    }

    /// Equilibria of a repeat, the lowest first.
    pub fn relaxed(&self, chart: &Chart) -> Vec<TileEquilibrium> {
        let (tile, card, loops) = (self.tile(chart), self.card(), chart.loop_count());
        if let Some(how) = &self.needles {
            return vec![off_needles(&tile, &YarnCard::unit(), &card, &self.settings, how)];
        }
        let mut found = relax_from_starts(&tile, &YarnCard::unit(), &card, &self.settings, starts(loops));
        if self.shaken {
            found[0] = shaken(&tile, &YarnCard::unit(), &card, &self.settings, found[0].clone(), shakes(loops));
        }
        found
    }

    /// Equilibria found from those of a card that differs a little; from anew if one of them is none any more.
    pub fn relaxed_from(&self, chart: &Chart, near: &[TileEquilibrium]) -> Vec<TileEquilibrium> {
        // What friction holds depends on where it came from.
        if self.needles.is_some() {
            return self.relaxed(chart);
        }
        let (tile, card) = (self.tile(chart), self.card());
        let again = |at: &TileEquilibrium| {
            relax_tile_from(&tile, &YarnCard::unit(), &card, &self.settings, at.coordinates.clone())
        };
        let mut found: Vec<TileEquilibrium> = near.par_iter().map(again).collect();
        if found.iter().any(|at| !at.converged) {
            return self.relaxed(chart);
        }
        found.sort_by(|a, b| a.energy.total_cmp(&b.energy));
        found
    }
}

/// Logarithms of wale and course spacing of the lowest equilibrium. A tile that has folded up has some size too.
pub fn spacing(found: &[TileEquilibrium]) -> [f64; 2] {
    [found[0].wale_spacing, found[0].course_spacing].map(|spacing| spacing.max(0.02).ln())
}
