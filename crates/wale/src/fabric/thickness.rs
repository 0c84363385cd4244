//! Elements of yarns with a thickness: stretch and bending of yarns beside their nodes, and legs that touch.

use super::coordinates::CoordinateMap;
use super::elements::Elements;
use super::mechanics::Mechanics;
use super::sides::{Sides, steps_to_front};
use crate::energy::{Bending, LegContact, Stretch, Thick};
use crate::model::{KnitCard, Neighbour, Network, PassId, SegmentKind, Thickness, YarnId};

/// Passes of a loop along its yarn, and how many loops further than the next one a leg may meet another.
const PASSES_OF_LOOP: i32 = 8;
const FACING_LOOPS: i32 = 2;

/// A pass of some periodic image.
pub(crate) type Place = (PassId, [i16; 2], i16);

/// Elements of yarns with a thickness; none for yarns that meet in one point.
#[derive(Clone, Debug, Default)]
pub struct ThickElements {
    /// Stretch of segments, in yarn order.
    pub stretch: Elements<Thick<Stretch, 2>, 26>,
    /// Bending at passes, in yarn order.
    pub bending: Elements<Thick<Bending, 3>, 39>,
    /// Contacts of the legs on both sides of every sinker.
    pub legs: Elements<Thick<LegContact, 4>, 52>,
    /// Contacts of legs that meet where the wales between them fold away, as the purls of a rib do.
    pub facing: Elements<LegContact, 16>,
}

impl ThickElements {
    /// Takes the stiffness of all segments and the bends from `plain`, whose segments stay without stiffness.
    pub(super) fn take(
        network: &Network,
        card: &KnitCard,
        thickness: &Thickness,
        plain: &mut Mechanics,
        map: &mut dyn CoordinateMap,
    ) -> Self {
        let sides = Sides::new(network, thickness.contact_distance);
        let yarn_of = network.pass_yarn();
        let next = |pass: PassId, step| network.neighbour(yarn_of[pass.index()], pass, step);
        let mut thick = Self::default();
        for (stretch, &pass) in plain.stretch.elements.iter_mut().zip(&plain.segment_after) {
            let Some(after) = next(pass, 1) else { continue };
            let inner = Stretch { stiffness: std::mem::take(&mut stretch.stiffness) };
            thick.stretch.push(
                beside(network, &sides, inner, [itself(pass), place(after)]),
                stencil(network, &sides, map, [itself(pass), place(after)]),
            );
        }
        let bends = std::mem::take(&mut plain.bending);
        for (inner, &pass) in bends.elements.into_iter().zip(&plain.bend_at) {
            let (Some(before), Some(after)) = (next(pass, -1), next(pass, 1)) else { continue };
            let three = [place(before), itself(pass), place(after)];
            thick.bending.push(beside(network, &sides, inner, three), stencil(network, &sides, map, three));
        }
        thick.add_legs(network, card, thickness, &sides, map);
        thick
    }

    /// The legs on both sides of every sinker: two passes before it and two behind it along the yarn.
    fn add_legs(
        &mut self,
        network: &Network,
        card: &KnitCard,
        thickness: &Thickness,
        sides: &Sides,
        map: &mut dyn CoordinateMap,
    ) {
        // A leg that is pushed away by more than its length would turn its loop over.
        let distance = thickness.leg_distance.min(card.loop_length);
        if distance <= 0.0 || thickness.leg_stiffness <= 0.0 {
            return;
        }
        let inner = LegContact { stiffness: thickness.leg_stiffness, distance };
        let kind = |pass: PassId| network.segment_kind[pass.index()];
        let loop_of = loop_of_nodes(network);
        // Legs of loops that are worked together go to the same loop, and cross on their way.
        let together = |a: &Neighbour, d: &Neighbour| {
            let [a_at, d_at] = [a, d].map(|at| loop_of[network.pass_node[at.pass.index()].index()]);
            a_at.is_some() && a_at == d_at && a.image == d.image
        };
        for y in 0..network.yarn_count() {
            let yarn = YarnId::new(y);
            for pass in network.yarn_passes(yarn).map(PassId::new) {
                if kind(pass) != SegmentKind::Sinker || network.is_out(pass) {
                    continue;
                }
                let [Some(a), Some(b), Some(c), Some(d)] =
                    [-2, -1, 2, 3].map(|step| network.neighbour(yarn, pass, step))
                else {
                    continue;
                };
                if kind(a.pass) != SegmentKind::Leg || kind(c.pass) != SegmentKind::Leg {
                    continue;
                }
                if !together(&a, &d) {
                    let four = [a, b, c, d].map(place);
                    self.legs.push(beside(network, sides, inner, four), stencil(network, sides, map, four));
                }
                let facing = LegContact { stiffness: thickness.leg_stiffness, distance: thickness.facing_distance };
                for loops in 1..=FACING_LOOPS {
                    let [Some(sinker), Some(c), Some(d)] =
                        [0, 2, 3].map(|step| network.neighbour(yarn, pass, step + PASSES_OF_LOOP * loops))
                    else {
                        break;
                    };
                    if kind(sinker.pass) != SegmentKind::Sinker || kind(c.pass) != SegmentKind::Leg {
                        break;
                    }
                    if facing.distance > 0.0 && !together(&a, &d) {
                        let four = [a, b, c, d].map(place).map(|(pass, image, turns)| {
                            let [x, y, z] = map.position(network.pass_node[pass.index()], image);
                            [x, y, z, map.sliding(pass, turns)]
                        });
                        self.facing.push(facing, std::array::from_fn(|i| four[i / 4][i % 4]));
                    }
                }
            }
        }
    }
}

/// The loop that each node is an own node of.
fn loop_of_nodes(network: &Network) -> Vec<Option<u32>> {
    let mut loops = vec![None; network.node_count()];
    for (of, at) in (0..).zip(&network.loops) {
        at.nodes.iter().for_each(|node| loops[node.index()] = Some(of));
    }
    loops
}

/// Whether two passes lie on different faces of the fabric.
pub(super) fn crosses(network: &Network, a: PassId, b: PassId) -> bool {
    steps_to_front(network, a) * steps_to_front(network, b) < 0.0
}

fn itself(pass: PassId) -> Place {
    (pass, [0; 2], 0)
}

fn place(neighbour: Neighbour) -> Place {
    (neighbour.pass, neighbour.image, neighbour.turns)
}

pub(crate) fn beside<E: Copy, const P: usize>(
    network: &Network,
    sides: &Sides,
    inner: E,
    places: [Place; P],
) -> Thick<E, P> {
    Thick { inner, offset: places.map(|(pass, ..)| sides.offset(network, pass)), softness: sides.softness() }
}

pub(crate) fn stencil<const P: usize, const N: usize>(
    network: &Network,
    sides: &Sides,
    map: &mut dyn CoordinateMap,
    places: [Place; P],
) -> [u32; N] {
    let coordinates = places.map(|place| sides.coordinates(map, network, place));
    std::array::from_fn(|i| coordinates[i / 13][i % 13])
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::fabric::TileCoordinates;
    use crate::pattern::knit;
    use crate::scene::Scene;

    /// The repeat of a chart of thick yarns, and how many pairs of legs beside a sinker touch in it.
    fn repeat(rows: &str) -> (Network, usize) {
        let text = format!("schema = 1\n[fabric]\ncontacts = \"thick\"\n[fabric.chart]\nsymbols = [{rows}]\n");
        let scene = Scene::from_text(&text, "eyelets.toml").unwrap();
        let (chart, card) = (scene.structure.chart().unwrap(), scene.fabric.knit().unwrap());
        let tile = knit::tile(chart, card).unwrap();
        let mut map = TileCoordinates::new(&tile);
        let legs = Mechanics::new(&tile, &scene.yarns, &scene.fabric, &mut map).thick.legs.len();
        (tile, legs)
    }

    const EYELETS: [&str; 3] = [r#""o/kkkk", "kkkkkk""#, r#""/okkkk", "kkkkkk""#, r#""o\\kkkk", "kkkkkk""#];

    #[test]
    fn legs_that_cross_in_a_decrease_do_not_push_each_other() {
        assert_eq!(repeat(r#""kkkkkk", "kkkkkk""#).1, 12);
        for rows in EYELETS {
            // No sinkers beside the yarn-over, and not the two loops below the decrease.
            assert_eq!(repeat(rows).1, 9, "{rows}");
        }
    }

    #[test]
    fn a_decrease_knows_its_front() {
        for rows in EYELETS {
            let (tile, _) = repeat(rows);
            let sides = Sides::new(&tile, 1e-3);
            let periods = tile.periods.unwrap();
            let mut least = f64::INFINITY;
            for (node, corners) in sides.corners().iter().enumerate() {
                let [x, y, z] = corners.unwrap().map(|(node, [i, j])| {
                    tile.position[node.index()] + f64::from(i) * periods[0] + f64::from(j) * periods[1]
                });
                let normal: DVec3 = (y - x).cross(z - x) / ((y - x).length() * (z - x).length());
                least = least.min(normal.dot(tile.front[node]));
            }
            // In plain stitches 0.72.
            assert!(least > 0.25, "{rows}: {least}");
        }
    }
}
