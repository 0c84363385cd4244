//! A repeat as it comes off the needles: stretched to their pitch, pulled, let go, and held by friction from there on.

use super::tile_conditions::{Conditions, Rubbing};
use super::tile_equilibrium::{TileEquilibrium, TileSettings, disturbed, relax_under};
use super::tile_stiffness::bending_and_length;
use crate::fabric::coordinates::BLOCK;
use crate::model::{KnitCard, Network, YarnId, Yarns};

/// What a knit goes through before it is measured, and what holds it back.
///
/// A fabric that is washed and tumbled for long forgets its needles: that is [`relax_tile`](super::tile_equilibrium::relax_tile). One that is laid on a
/// table does not, or in part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OffNeedles {
    /// Distance of neighbouring needles, in loop lengths \[–\].
    pub pitch: f64,
    /// How hard each wale is pulled while it is on the needles, in `k_b/ℓ²` \[–\].
    pub take_down: f64,
    /// What it takes to slide a yarn through a contact afterwards, in `k_b/ℓ²` \[–\]; infinite where it sticks.
    pub friction: f64,
}

impl OffNeedles {
    /// How hard a wale is pulled where nothing else is said, in `k_b/ℓ²` \[–\].
    const TAKE_DOWN: f64 = 30.0;

    /// Needles as far apart as the card lays its wales out, and friction of the card: the mean coefficient of all passes times the
    /// compression that every contact keeps.
    #[must_use]
    pub fn of(network: &Network, yarns: &Yarns, card: &KnitCard) -> Self {
        let of_yarn = |y: usize| {
            let passes = network.yarn_passes(YarnId::new(y)).len() as f64;
            passes * yarns.of(network.yarn_kind[y]).friction_coefficient
        };
        let coefficient = (0..network.yarn_count()).map(of_yarn).sum::<f64>() / network.pass_count().max(1) as f64;
        Self {
            pitch: card.wale_spacing / card.loop_length,
            take_down: Self::TAKE_DOWN,
            friction: coefficient * card.residual_compression / Self::force(yarns, card),
        }
    }

    /// What forces are measured in: `k_b/ℓ²` \[N\].
    #[must_use]
    pub fn force(yarns: &Yarns, card: &KnitCard) -> f64 {
        yarns.first().bending_stiffness / card.loop_length.powi(2)
    }
}

/// Stiffness of a contact that sticks, in `k_b/ℓ³` \[–\]: what it may still slide by changes no size in its third digit.
const STICKS: f64 = 3e4;

/// Brings a repeat to rest on its needles, without friction as on a machine where everything moves, and from there without them, against
/// friction. Its energy has what sliding took in it, too.
///
/// Every contact slides by itself, and friction is as large at each, whatever presses it: the compression of a repeat without load is that
/// which its card leaves to every contact.
///
/// # Panics
/// If the tile is not periodic, or too large for memory.
#[must_use]
pub fn off_needles(
    network: &Network,
    yarns: impl Into<Yarns>,
    card: &KnitCard,
    settings: &TileSettings,
    how: &OffNeedles,
) -> TileEquilibrium {
    let (yarns, fabric) = (yarns.into(), card.into());
    let (bending, length) = bending_and_length(network, &yarns, &fabric);
    let force = bending / (length * length);
    let [_, columns] = network.chart_size.map(f64::from);
    let mut start = disturbed(network, settings, length);
    let n = start.len() - 2;
    let width = how.pitch * length * columns;
    let by = width / start[n];
    start[..BLOCK * network.node_count()].chunks_exact_mut(BLOCK).for_each(|node| node[0] *= by);
    start[n] = width;
    let held = Conditions { width_held: true, pull: how.take_down * force * columns, rubbing: None };
    let on_needles = relax_under(network, &yarns, &fabric, settings, start, &held);
    let rubbing = (how.friction > 0.0).then(|| Rubbing {
        limit: how.friction * force,
        stiffness: STICKS * force / length,
        anchors: on_needles.coordinates.clone(),
    });
    let free = Conditions { width_held: false, pull: 0.0, rubbing };
    let rest = relax_under(network, &yarns, &fabric, settings, on_needles.coordinates, &free);
    TileEquilibrium {
        iterations: on_needles.iterations + rest.iterations,
        residual: on_needles.residual.max(rest.residual),
        converged: on_needles.converged && rest.converged,
        ..rest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::tile_equilibrium::relax_tile;
    use crate::model::{LoopProportions, YarnCard};
    use crate::pattern::{Chart, knit};

    fn at_rest(chart: &Chart, friction: f64) -> (TileEquilibrium, TileEquilibrium) {
        let yarn = YarnCard::unit();
        let card: KnitCard = LoopProportions::thick().card(&yarn, 1.0);
        let tile = knit::tile(chart, &card).unwrap();
        let settings = TileSettings { tolerance: 1e-6, ..TileSettings::of(&card) };
        let how = OffNeedles { pitch: 0.35, take_down: 30.0, friction };
        let (rest, off) =
            (relax_tile(&tile, &yarn, &card, &settings), off_needles(&tile, &yarn, &card, &settings, &how));
        assert!(rest.converged && off.converged, "{} {}", rest.residual, off.residual);
        (rest, off)
    }

    #[test]
    fn without_friction_the_needles_are_forgotten_and_with_it_they_are_not() {
        let size = |at: &TileEquilibrium| [at.wale_spacing, at.course_spacing];
        let near = |a: [f64; 2], b: [f64; 2], by: f64| a.iter().zip(b).all(|(a, b)| (a / b - 1.0).abs() < by);
        // Of rib, whose repeat at rest is one.
        let rib = Chart::rib(1, 1).unwrap();
        let (rest, free) = at_rest(&rib, 0.0);
        assert!(near(size(&rest), size(&free), 1e-5), "{:?} {:?}", size(&rest), size(&free));
        // The more it rubs the more is left of the pitch.
        let widths = [0.0, 10.0, 30.0].map(|friction| at_rest(&rib, friction).1.wale_spacing);
        assert!(widths.is_sorted_by(|a, b| 1.005 * a < *b), "{widths:?}");
        // Friction that nothing overcomes holds every contact where it is: bends alone straighten.
        let [stuck, strong] = [f64::INFINITY, 100.0].map(|friction| size(&at_rest(&rib, friction).1));
        assert!(near(stuck, strong, 1e-6), "{stuck:?} {strong:?}");
    }

    #[test]
    fn what_is_pulled_is_longer_and_as_wide_as_it_is_held() {
        let yarn = YarnCard::unit();
        let card: KnitCard = LoopProportions::thick().card(&yarn, 1.0);
        let tile = knit::tile(&Chart::rib(1, 1).unwrap(), &card).unwrap();
        let settings = TileSettings { tolerance: 1e-6, ..TileSettings::of(&card) };
        let (yarns, fabric) = (Yarns::from(&yarn), (&card).into());
        let start = disturbed(&tile, &settings, 1.0);
        let [rows, columns] = tile.chart_size.map(f64::from);
        let under = |pull: f64| {
            let conditions = Conditions { width_held: true, pull, rubbing: None };
            relax_under(&tile, &yarns, &fabric, &settings, start.clone(), &conditions)
        };
        let pulls = [50.0, 51.0, 52.0];
        let found = pulls.map(under);
        for at in &found {
            assert!(at.converged);
            assert_eq!(at.coordinates[start.len() - 2], start[start.len() - 2]);
            assert_eq!(at.wale_spacing, start[start.len() - 2] / columns);
        }
        // What a pull lengthens it does work on: by the mean of two pulls the energy without them grows from one to the other.
        let height = |at: &TileEquilibrium| at.course_spacing * rows;
        let elastic = |i: usize| found[i].energy * tile.loops.len() as f64 + pulls[i] * height(&found[i]);
        for i in 1..pulls.len() {
            let longer = height(&found[i]) - height(&found[i - 1]);
            let work = 0.5 * (pulls[i] + pulls[i - 1]) * longer;
            assert!(longer > 1e-6 && (elastic(i) - elastic(i - 1) - work).abs() < 0.02 * work, "{longer} {work}");
        }
    }
}
