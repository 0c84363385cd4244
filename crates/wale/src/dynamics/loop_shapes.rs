//! Rest-shape compensation: the loop shapes of a relaxed tile laid out over a whole fabric [Cirio2017, section 4.1].

use std::collections::HashMap;
use std::f64::consts::TAU;

use glam::DVec3;

use super::tile_equilibrium::TileEquilibrium;
use crate::fabric::Coordinates;
use crate::model::{LoopInfo, Network, PassId, SegmentKind, YarnId};

/// Gives every loop of a fabric the shape and the yarn of its loop in a relaxed tile; `round` rolls the sheet up.
///
/// The tile is of the smallest repeat of the fabric's chart. Nodes that no loop owns (ties, turns, tails, bind-off) go
/// where the mean stitch density puts them.
pub fn lay_loop_shapes(network: &mut Network, tile: &Network, relaxed: &TileEquilibrium, round: bool) {
    let coordinates = Coordinates::new(tile);
    let (wale, course) = (relaxed.wale_spacing, relaxed.course_spacing);
    let period = [f64::from(tile.chart_size[1]) * wale, f64::from(tile.chart_size[0]) * course];
    let known = TileLoops::new(tile);
    // Where the tile lies against its own chart, so that nodes without a loop follow.
    let count = tile.loops.iter().map(|info| info.nodes.len()).sum::<usize>().max(1) as f64;
    let offset = tile
        .loops
        .iter()
        .flat_map(|info| &info.nodes)
        .map(|node| {
            let [column, row] = tile.chart_place[node.index()];
            coordinates.position_of(node.index(), &relaxed.coordinates) - DVec3::new(column * wale, row * course, 0.0)
        })
        .sum::<DVec3>()
        / count;
    let mut flat: Vec<DVec3> =
        network.chart_place.iter().map(|[column, row]| offset + DVec3::new(column * wale, row * course, 0.0)).collect();
    for info in &network.loops {
        let Some((like, image)) = known.like(info) else { continue };
        let shift = DVec3::new(image[0] * period[0], image[1] * period[1], 0.0);
        for (node, like) in info.nodes.iter().zip(&like.nodes) {
            flat[node.index()] = coordinates.position_of(like.index(), &relaxed.coordinates) + shift;
        }
    }
    lay_arc_lengths(network, tile, relaxed, &coordinates, &flat);
    let radius = f64::from(network.chart_size[1]) * wale / TAU;
    for (node, x) in flat.iter().enumerate() {
        (network.position[node], network.front[node]) = if round {
            let (sin, cos) = (x.x / radius).sin_cos();
            let out = DVec3::new(sin, 0.0, cos);
            (out * (radius + x.z) + DVec3::Y * x.y, out)
        } else {
            (*x, DVec3::Z)
        };
    }
}

/// The loops of a tile, to be found by those of a fabric that repeats it.
struct TileLoops<'a> {
    tile: &'a Network,
    at: HashMap<(u32, u32), &'a LoopInfo>,
}

impl<'a> TileLoops<'a> {
    fn new(tile: &'a Network) -> Self {
        Self { tile, at: tile.loops.iter().map(|info| ((info.row, info.column), info)).collect() }
    }

    /// The loop of the tile that a fabric's loop is like, and how many periods apart they lie.
    fn like(&self, info: &LoopInfo) -> Option<(&'a LoopInfo, [f64; 2])> {
        let rows = self.tile.chart_size[0];
        let row = info.row % rows;
        let columns = self.tile.row_places[row as usize];
        let like = self.at.get(&(row, info.column % columns))?;
        Some((like, [f64::from(info.column / columns), f64::from(info.row / rows)]))
    }
}

/// Gives every segment the rest length of its like in the tile; a segment without one keeps the length it is laid at.
fn lay_arc_lengths(
    network: &mut Network,
    tile: &Network,
    relaxed: &TileEquilibrium,
    coordinates: &Coordinates,
    flat: &[DVec3],
) {
    let likes = likes(network, tile);
    let tile_yarns = tile.pass_yarn();
    let arc = |pass: PassId| relaxed.coordinates[coordinates.slot(pass)];
    let rest_between = |a: PassId, b: PassId| -> Option<f64> {
        let yarn = tile_yarns[a.index()];
        let (_, closure) = tile.yarn_closure[yarn.index()]?;
        [1, -1].into_iter().find_map(|step| {
            let neighbour = tile.neighbour(yarn, a, step)?;
            (neighbour.pass == b).then(|| (arc(b) + f64::from(neighbour.turns) * closure - arc(a)).abs())
        })
    };
    for y in 0..network.yarn_count() {
        let passes = network.yarn_passes(YarnId::new(y));
        let mut length = 0.0;
        for p in passes.clone() {
            let next = p + 1;
            network.arc_length[p] = length;
            if next == passes.end {
                break;
            }
            let like = match (likes[p], likes[next], network.segment_kind[p]) {
                (_, _, SegmentKind::Edge | SegmentKind::Chain) => None,
                (Some(a), Some(b), _) => rest_between(a, b),
                _ => None,
            };
            let laid = flat[network.pass_node[p].index()].distance(flat[network.pass_node[next].index()]);
            length += like.unwrap_or(laid);
        }
    }
}

/// For each pass of the fabric the tile's pass at the same corner of the same loop.
fn likes(network: &Network, tile: &Network) -> Vec<Option<PassId>> {
    let known = TileLoops::new(tile);
    let mut likes = vec![None; network.pass_count()];
    for info in &network.loops {
        let Some((like, _)) = known.like(info) else { continue };
        for (node, tile_node) in info.nodes.iter().zip(&like.nodes) {
            // Stacks are in the same order; where the bind-off takes the place of a loop, the kinds differ.
            for (pass, like) in network.stack(*node).iter().zip(tile.stack(*tile_node)) {
                let alike = network.pass_kind[pass.index()] == tile.pass_kind[like.index()];
                likes[pass.index()] = alike.then_some(*like);
            }
        }
    }
    likes
}

#[cfg(test)]
mod tests {
    use super::super::tile_equilibrium::{TileSettings, relax_tile};
    use super::*;
    use crate::model::{LoopProportions, YarnCard};
    use crate::pattern::{Chart, Working, knit};

    #[test]
    fn loops_keep_the_tile_s_yarn_and_spacing() {
        let yarn = YarnCard {
            linear_density: 3e-4,
            radius: 5e-4,
            stretch_stiffness: 1.0,
            bending_stiffness: 8e-10,
            friction_coefficient: 0.3,
            mass_damping: 0.0,
            stiffness_damping: 0.0,
            loose_ends: false,
            plies: 2,
            twist: 0.0,
        };
        let card = LoopProportions::default().card(&yarn, 9.5e-3);
        let chart = Chart::rib(2, 2).unwrap();
        let tile = knit::tile(&chart, &card).unwrap();
        let relaxed = relax_tile(&tile, &yarn, &card, &TileSettings::default());
        assert!(relaxed.converged, "residual {:e}", relaxed.residual);
        for working in [Working::default(), Working::Round] {
            let mut network = knit::fabric(&chart.repeat(12, 6).unwrap(), working, &card);
            lay_loop_shapes(&mut network, &tile, &relaxed, working == Working::Round);
            for y in 0..network.yarn_count() {
                let arcs = &network.arc_length[network.yarn_passes(YarnId::new(y))];
                assert!(arcs.windows(2).all(|pair| pair[1] > pair[0]));
            }
            // The same corner of the same loop one repeat to the right lies one period further.
            if working != Working::Round {
                let (a, b) = (network.loops[12 + 1].nodes[2], network.loops[12 + 5].nodes[2]);
                let step = network.position[b.index()] - network.position[a.index()];
                let off = step - DVec3::X * 4.0 * relaxed.wale_spacing;
                assert!(off.length() < 1e-12, "{off}");
            }
            // A loop of an inner row holds as much yarn as the tile's loops do on the average.
            let row: Vec<&crate::model::LoopInfo> = network.loops.iter().filter(|info| info.row == 2).collect();
            let (first, last) = (row[0].nodes[0], row[row.len() - 1].nodes[3]);
            let own = |node| {
                let pass = network.stack(node).iter().copied();
                pass.map(|p| network.arc_length[p.index()]).fold(0.0f64, f64::max)
            };
            let expected = tile.yarn_length() * 3.0;
            let found = (own(last) - own(first)).abs();
            assert!((found / expected - 1.0).abs() < 0.05, "{working:?}: {found} {expected}");
        }
    }
}
