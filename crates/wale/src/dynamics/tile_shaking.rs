//! A tile at rest that is shaken gently until nothing lower is found, as a swatch is that is washed and tumbled.

use super::tile_equilibrium::{TileEquilibrium, TileSettings, displace, relax_tile_from};
use crate::fabric::coordinates::BLOCK;
use crate::model::{FabricCard, Network, Yarns};

/// How far a shake moves a node along each axis at most, in loop lengths \[–\]: about half of what yarns of knits are apart at a contact, so
/// that loops are moved past what holds them up and not through each other. Twice as much may end in repeats that have folded up.
const AMPLITUDE: f64 = 0.03;
/// Part of its energy by which another equilibrium is lower, and not the same one rounded otherwise.
const SAME: f64 = 1e-9;
/// Iterations after which a shake has led nowhere.
const GIVES_UP: usize = 200;

/// Shakes a tile at rest a number of times: every node is moved at random, and the tile relaxed again. What is at rest with less energy than
/// before is kept; the next shake begins there.
///
/// Equilibria of one repeat are many, and those that are found from the layout are hardly ever the lowest: a flat layout has symmetries that
/// its repeat at rest has not. The first shake finds most of what there is to find. What is shaken decreases in energy only.
///
/// # Panics
/// If the tile is too large for memory, or `rest` is another tile's.
#[must_use]
pub fn shaken(
    network: &Network,
    yarns: impl Into<Yarns>,
    card: impl Into<FabricCard>,
    settings: &TileSettings,
    rest: TileEquilibrium,
    shakes: usize,
) -> TileEquilibrium {
    let (yarns, card) = (yarns.into(), card.into());
    let amplitude = settings.most_displacement(network, &card).min(AMPLITUDE) * card.unit_length();
    let settings = TileSettings { max_iterations: settings.max_iterations.min(GIVES_UP), ..*settings };
    let mut lowest = rest;
    for shake in 0..shakes as u64 {
        let mut start = lowest.coordinates.clone();
        let nodes = &mut start[..BLOCK * network.node_count()];
        displace(nodes, amplitude, settings.seed.wrapping_add(shake));
        let found = relax_tile_from(network, &yarns, &card, &settings, start);
        if found.converged && (!lowest.converged || found.energy < lowest.energy * (1.0 - SAME)) {
            lowest = found;
        }
    }
    lowest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::tile_equilibrium::relax_tile;
    use crate::model::{KnitCard, LoopProportions, YarnCard};
    use crate::pattern::{Chart, knit};

    /// A repeat of thick yarns at rest and shaken.
    fn at_rest(chart: &Chart, shakes: usize) -> [TileEquilibrium; 2] {
        let yarn = YarnCard::unit();
        let card: KnitCard = LoopProportions::thick().card(&yarn, 1.0);
        let tile = knit::tile(chart, &card).unwrap();
        let settings = TileSettings::of(&card);
        let rest = relax_tile(&tile, &yarn, &card, &settings);
        let shaken = shaken(&tile, &yarn, &card, &settings, rest.clone(), shakes);
        assert!(rest.converged && shaken.converged);
        [rest, shaken]
    }

    #[test]
    fn seed_is_held_up_in_its_layout_and_stockinette_is_not() {
        let [rest, shaken] = at_rest(&Chart::seed(), 4);
        assert!(shaken.energy < 0.93 * rest.energy, "{} {}", rest.energy, shaken.energy);
        // Measured it is a fifth wider than stockinette and a twenty-fifth higher.
        let [plain, same] = at_rest(&Chart::stockinette(), 4);
        assert_eq!(plain, same);
        let height = |at: &TileEquilibrium| at.course_spacing / plain.course_spacing;
        assert!((1.03..1.09).contains(&height(&shaken)) && height(&rest) > 1.10);
        // The same shakes lead to the same place.
        assert_eq!(at_rest(&Chart::seed(), 4)[1], shaken);
    }
}
