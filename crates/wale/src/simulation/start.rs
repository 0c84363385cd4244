//! What a simulation starts from: the network of a chart, with the loop shapes of a relaxed repeat if wanted.

use crate::dynamics::loop_shapes::lay_loop_shapes;
use crate::dynamics::tile_equilibrium::{TileEquilibrium, TileSettings, relax_from_starts};
use crate::model::{FabricCard, KnitCard, Network, Yarns};
use crate::pattern::{Chart, Structure, knit};

/// Most loops of a repeat that is relaxed for its loop shapes.
pub const MOST_TILE_LOOPS: usize = 100;
/// Starts from which a repeat is relaxed; the one of lowest energy is taken, because equilibria are not unique.
const STARTS: usize = 3;
/// Loops of a repeat above which one start must do: it takes seconds, and its patches average over what starts differ in.
const MANY_LOOPS: usize = 40;

/// A fabric before anything happens to it.
#[derive(Clone, Debug)]
pub struct Start {
    /// The network, flat or round, not yet placed in the world.
    pub network: Network,
    /// What the compensation did, if there was one.
    pub compensation: Option<StartReport>,
}

/// What rest-shape compensation did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StartReport {
    /// Relaxed over laid-out wale spacing: how much the width would have changed without compensation \[–\].
    pub width_change: f64,
    /// Relaxed over laid-out course spacing \[–\].
    pub height_change: f64,
    /// Whether the repeat came to rest.
    pub converged: bool,
}

impl Start {
    /// Lays out a fabric; `compensate` gives every loop the shape that it has in the relaxed repeat
    /// [Cirio2017, section 4.1]. A chart whose smallest repeat is too large, or that does not repeat, and a
    /// machine's program keep the plain layout.
    #[must_use]
    pub fn new(structure: &Structure, yarns: impl Into<Yarns>, card: impl Into<FabricCard>, compensate: bool) -> Self {
        let (yarns, card) = (yarns.into(), card.into());
        let mut network = structure.network(&card);
        let repeat = structure.chart().filter(|_| compensate).map(Chart::smallest_repeat);
        let repeat = repeat.filter(|repeat| repeat.loop_count() <= MOST_TILE_LOOPS);
        let tile = card.knit().zip(repeat).and_then(|(card, repeat)| Some((card, knit::tile(&repeat, card).ok()?)));
        let Some((card, tile)) = tile else {
            return Self { network, compensation: None };
        };
        let relaxed = relax_repeat(&tile, &yarns, card);
        lay_loop_shapes(&mut network, &tile, &relaxed, structure.is_round());
        let report = StartReport {
            width_change: relaxed.wale_spacing / card.wale_spacing,
            height_change: relaxed.course_spacing / card.course_spacing,
            converged: relaxed.converged,
        };
        Self { network, compensation: Some(report) }
    }
}

/// Relaxes a repeat from several starts and returns the one of lowest energy.
fn relax_repeat(tile: &Network, yarns: &Yarns, card: &KnitCard) -> TileEquilibrium {
    let starts = if tile.loops.len() > MANY_LOOPS { 1 } else { STARTS };
    relax_from_starts(tile, yarns, card, &TileSettings::of(card), starts).swap_remove(0)
}
