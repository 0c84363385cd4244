//! Equilibrium of a periodic tile by Newton's method: of a knit with both periods unknown, of a weave at its sett.

use rayon::prelude::*;
use wale_numerics::trust::Trust;

use super::tile_conditions::Conditions;
use super::tile_contacts::TileContacts;
use super::tile_descent::{Descent, FIRST_SHIFT, RULE};
use super::tile_stiffness::bending_and_length;
use super::tile_system::TileSystem;
use crate::fabric::TileCoordinates;
use crate::fabric::coordinates::BLOCK;
use crate::model::{FabricCard, Network, Yarns};

/// How a tile is brought to rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TileSettings {
    /// Stiffness of the bed under every node, in `k_b/ℓ³` \[–\].
    ///
    /// Real swatches are measured lying flat; without a bed, bands of four equal wales and more roll into tubes.
    pub bed: f64,
    /// Size of the random displacement that breaks the flat layout's symmetry, in loop lengths \[–\].
    pub noise: f64,
    /// How far knit loops are laid in front of purl loops at first, in loop lengths \[–\]: a rib folds, and may lie flat too.
    pub relief: f64,
    /// Whether a step that goes too far is shortened before the second derivatives are shifted: large repeats need half the iterations
    /// so, and small ones with several equilibria may find another.
    pub shorten: bool,
    /// Whether segments of thick yarns that share no contact hold each other off where loops are worked together, as in lace. Stretched
    /// tiles and slopes of sizes know nothing of it.
    pub strand_contact: bool,
    /// Seed of that displacement.
    pub seed: u64,
    /// Most Newton iterations.
    pub max_iterations: usize,
    /// Residual at which the tile is at rest, in `k_b/ℓ²` a coordinate \[–\].
    pub tolerance: f64,
}

impl TileSettings {
    /// Those of a card: on a bed as its proportions were fitted with. A weave is straight and flat by itself: it has no bed, and
    /// begins undisturbed.
    #[must_use]
    pub fn of(card: impl Into<FabricCard>) -> Self {
        let (bed, noise) = match card.into() {
            FabricCard::Knit(card) if card.thickness.is_some() => (Self::THICK_BED, Self::NOISE),
            FabricCard::Knit(_) => (Self::POINT_BED, Self::NOISE),
            FabricCard::Woven(_) => (0.0, 0.0),
        };
        Self { bed, noise, strand_contact: true, ..Self::default() }
    }

    /// How far nodes of a network may be displaced at random along each axis, in loop lengths \[–\]: what is displaced more than yarns are
    /// thick has passed through itself, where segments hold each other off.
    pub(super) fn most_displacement(&self, network: &Network, card: &FabricCard) -> f64 {
        let held_off = self.strand_contact && TileContacts::of(network, card).is_some();
        if held_off { self.noise } else { f64::INFINITY }
    }

    /// Bed of fabrics whose yarns meet in one point, and of those whose yarns lie beside each other.
    const POINT_BED: f64 = 10.0;
    const THICK_BED: f64 = 20.0;
    const NOISE: f64 = 0.01;
}

impl Default for TileSettings {
    fn default() -> Self {
        Self {
            bed: Self::POINT_BED,
            noise: Self::NOISE,
            relief: 0.0,
            shorten: false,
            strand_contact: false,
            seed: 1,
            max_iterations: 300,
            tolerance: 1e-7,
        }
    }
}

/// A tile at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct TileEquilibrium {
    /// Coordinates of the own slots, then the two periods \[m\].
    pub coordinates: Vec<f64>,
    /// Period along the course, over the tile's columns: the relaxed wale spacing `W` \[m\].
    pub wale_spacing: f64,
    /// Period along the wale, over the tile's rows: the relaxed course spacing `C` \[m\].
    pub course_spacing: f64,
    /// Elastic energy a loop, the bed's included \[J\].
    pub energy: f64,
    /// Iterations used.
    pub iterations: usize,
    /// Largest component of the gradient left, in `k_b/ℓ²` \[–\].
    pub residual: f64,
    /// Whether the residual reached the tolerance.
    pub converged: bool,
}

/// Relaxes a periodic tile without friction from a slightly disturbed start.
///
/// Unknowns are all positions, all sliding coordinates and both periods; one node's place in the plane and one sliding
/// coordinate of each yarn are held, which fixes the rigid motions and nothing else.
///
/// A weave keeps the periods of its sett, and its yarns do not slide at their crossings, where friction holds them. It is at rest as it
/// is laid out: straight, and nowhere sheared.
#[must_use]
pub fn relax_tile(
    network: &Network,
    yarns: impl Into<Yarns>,
    card: impl Into<FabricCard>,
    settings: &TileSettings,
) -> TileEquilibrium {
    let card = card.into();
    let start = disturbed(network, settings, card.unit_length());
    relax_tile_from(network, yarns, card, settings, start)
}

/// How much more the layout is disturbed at each start, and with which relief.
const DISTURBED: [(f64, f64); 4] = [(1.0, 0.0), (1.0, 0.25), (5.0, 0.0), (10.0, 0.0)];

/// Relaxes a periodic tile from several starts, that of lowest energy first: equilibria are not unique, and the lowest is the
/// one that a swatch shaken long enough would find. Those that did not come to rest come last.
#[must_use]
pub fn relax_from_starts(
    network: &Network,
    yarns: impl Into<Yarns>,
    card: impl Into<FabricCard>,
    settings: &TileSettings,
    starts: usize,
) -> Vec<TileEquilibrium> {
    let (yarns, card) = (yarns.into(), &card.into());
    let most = settings.most_displacement(network, card);
    let run = |start: usize| {
        let (more, relief) = DISTURBED[start % DISTURBED.len()];
        let (seed, noise) = (settings.seed + start as u64, most.min(settings.noise * more));
        relax_tile(network, &yarns, card, &TileSettings { seed, noise, relief, ..*settings })
    };
    let mut found: Vec<TileEquilibrium> = (0..starts).into_par_iter().map(run).collect();
    found.sort_by(|a, b| (!a.converged).cmp(&!b.converged).then(a.energy.total_cmp(&b.energy)));
    found
}

/// Relaxes a periodic tile from given coordinates: own slots, then the two periods \[m\], as [`TileEquilibrium::coordinates`]
/// of a tile of the same network and another card has them.
///
/// # Panics
/// If there are not as many as the tile has, or the tile is too large for memory.
#[must_use]
pub fn relax_tile_from(
    network: &Network,
    yarns: impl Into<Yarns>,
    card: impl Into<FabricCard>,
    settings: &TileSettings,
    start: Vec<f64>,
) -> TileEquilibrium {
    relax_under(network, &yarns.into(), &card.into(), settings, start, &Conditions::default())
}

/// The same under other conditions than a fabric at rest is in.
///
/// # Panics
/// As there.
pub(super) fn relax_under(
    network: &Network,
    yarns: &Yarns,
    card: &FabricCard,
    settings: &TileSettings,
    start: Vec<f64>,
    conditions: &Conditions,
) -> TileEquilibrium {
    let (bending, length) = bending_and_length(network, yarns, card);
    let force = bending / (length * length);
    let mut system = TileSystem::touching(network, yarns, card, settings, conditions, |_| Default::default());
    assert_eq!(start.len(), system.coordinates.unknown_len());
    let n = system.coordinates.own().len();
    let mut unknowns = system.coordinates.unknowns(start);
    let mut trust = Trust::new(RULE, FIRST_SHIFT, 1.0);
    let contacts = settings.strand_contact.then(|| TileContacts::of(network, card)).flatten();
    let (mut iterations, mut world) = (0, Vec::new());
    let (energy, residual) = loop {
        let mut leash = f64::INFINITY;
        if let Some(contacts) = &contacts {
            system.coordinates.place(&unknowns, &mut world);
            let near = contacts.near(&world, [unknowns[n], unknowns[n + 1]]);
            let elements = |map: &mut TileCoordinates| contacts.elements(&near, map);
            system = TileSystem::touching(network, yarns, card, settings, conditions, elements);
            leash = contacts.leash();
        }
        let left = TileSettings { max_iterations: settings.max_iterations - iterations, ..*settings };
        let mut descent = Descent::new(&mut system, unknowns, force, length, left, trust);
        descent.leash = leash;
        let goes_on = descent.run();
        iterations += descent.iterations;
        trust = descent.trust;
        let at = (descent.energy, descent.residual);
        unknowns = descent.unknowns;
        if !goes_on {
            break at;
        }
    };
    let mut coordinates = Vec::new();
    system.coordinates.place(&unknowns, &mut coordinates);
    coordinates.truncate(n);
    coordinates.extend(&unknowns[n..]);
    TileEquilibrium {
        coordinates,
        wale_spacing: unknowns[n] / f64::from(network.chart_size[1]),
        course_spacing: unknowns[n + 1] / f64::from(network.chart_size[0]),
        energy: energy / network.loops.len() as f64,
        iterations,
        residual,
        converged: residual <= settings.tolerance,
    }
}

/// The layout, disturbed a little.
pub(super) fn disturbed(network: &Network, settings: &TileSettings, length: f64) -> Vec<f64> {
    let mut start = TileCoordinates::new(network).initial(network);
    displace(&mut start[..BLOCK * network.node_count()], settings.noise * length, settings.seed);
    for of_loop in &network.loops {
        let side = if of_loop.knit { 0.5 } else { -0.5 };
        for node in &of_loop.nodes {
            start[BLOCK * node.index() + 2] += side * settings.relief * length;
        }
    }
    start
}

/// Moves nodes, given with their own slots, at random by up to an amplitude \[m\] along each axis.
pub(super) fn displace(nodes: &mut [f64], amplitude: f64, seed: u64) {
    let mut random = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    for node in nodes.chunks_exact_mut(BLOCK) {
        for x in &mut node[..3] {
            random ^= random << 13;
            random ^= random >> 7;
            random ^= random << 17;
            let unit = (random >> 11) as f64 / (1u64 << 52) as f64 - 1.0;
            *x += amplitude * unit;
        }
    }
}
