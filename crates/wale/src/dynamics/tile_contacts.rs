//! Contacts of the segments of a periodic tile that share no contact of its network.
//!
//! In plain stitches contacts of the network hold the yarns apart. A yarn-over has nothing at its feet, and loops that are worked together
//! or pulled aside come to lie on others: without these contacts a repeat of lace falls through itself.

use glam::DVec3;

use crate::contact::strands::{BEGINS, holds_off_below};
use crate::energy::Thick;
use crate::energy::segment_contact::SegmentContact;
use crate::energy::strand_contact::closest;
use crate::fabric::coordinates::BLOCK;
use crate::fabric::sides::Sides;
use crate::fabric::thickness::{Place, beside, stencil};
use crate::fabric::{Elements, TileCoordinates};
use crate::model::{FabricCard, Network, NodeId, PassId};

/// How much further than they touch segments are looked for, in loop lengths.
const MARGIN: f64 = 0.2;

/// Contacts of segments, as a tile has them.
pub(super) type Contacts = Elements<Thick<SegmentContact, 4>, 52>;

/// Two segments of a tile that may meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NearSegments {
    ends: [Place; 4],
    distance: f64,
}

/// Two segments, and the image of the second.
type Key = (usize, usize, [i16; 2]);

/// A segment from the tile itself, and the contacts at its ends with their images.
struct Segment {
    ends: [Place; 2],
    contacts: [(u32, [i16; 2]); 2],
}

/// The segments of a tile of thick yarns.
pub(super) struct TileContacts<'a> {
    network: &'a Network,
    sides: Sides,
    segments: Vec<Segment>,
    layout: Vec<[DVec3; 2]>,
    layout_periods: [DVec3; 2],
    touching: f64,
    stiffness: f64,
    margin: f64,
    reach: f64,
}

/// Whether any loops are worked together: where none are, contacts of the network do.
fn has_stacks(network: &Network) -> bool {
    network.stitches.iter().any(|stitch| stitch.passes.len() > 2)
}

fn shifted((pass, image, turns): Place, by: [i16; 2]) -> Place {
    (pass, [image[0] + by[0], image[1] + by[1]], turns)
}

impl<'a> TileContacts<'a> {
    /// Those of a tile of lace whose yarns have a thickness; `None` of another.
    pub fn of(network: &'a Network, card: &FabricCard) -> Option<Self> {
        let card = card.knit()?;
        let thickness = card.thickness?;
        let periods = network.periods?;
        if !has_stacks(network) || thickness.contact_distance <= 0.0 || thickness.leg_stiffness <= 0.0 {
            return None;
        }
        let contact = network.contact_of_nodes();
        let yarn_of = network.pass_yarn();
        let mut segments = Vec::new();
        for pass in (0..network.pass_count()).map(PassId::new) {
            let Some(next) = network.neighbour(yarn_of[pass.index()], pass, 1) else { continue };
            let ends = [(pass, [0; 2], 0), (next.pass, next.image, next.turns)];
            let contacts = ends.map(|(pass, image, _)| (contact[network.pass_node[pass.index()].index()], image));
            segments.push(Segment { ends, contacts });
        }
        let mut contacts = Self {
            network,
            sides: Sides::new(network, thickness.contact_distance),
            segments,
            layout: Vec::new(),
            layout_periods: periods,
            touching: thickness.contact_distance,
            stiffness: thickness.leg_stiffness,
            margin: MARGIN * card.loop_length,
            reach: BEGINS * thickness.contact_distance + MARGIN * card.loop_length,
        };
        contacts.layout = contacts.drawn(&network.position, periods);
        Some(contacts)
    }

    /// How far coordinates may move before others than the segments that were near can meet \[m\].
    pub fn leash(&self) -> f64 {
        0.25 * self.margin
    }

    /// Where the ends of all segments lie.
    fn drawn(&self, nodes: &[DVec3], periods: [DVec3; 2]) -> Vec<[DVec3; 2]> {
        let at = |node: NodeId, image: [i16; 2]| {
            nodes[node.index()] + f64::from(image[0]) * periods[0] + f64::from(image[1]) * periods[1]
        };
        let end = |(pass, image, _): Place| self.sides.place(self.network, (pass, image), at);
        self.segments.iter().map(|segment| segment.ends.map(end)).collect()
    }

    /// The segments that may soon meet, in a fixed order, of a tile whose world coordinates and periods \[m\] are these.
    pub fn near(&self, world: &[f64], periods: [f64; 2]) -> Vec<NearSegments> {
        let nodes: Vec<DVec3> =
            (0..self.network.node_count()).map(|node| DVec3::from_slice(&world[BLOCK * node..])).collect();
        let periods = [DVec3::X * periods[0], DVec3::Y * periods[1]];
        let drawn = self.drawn(&nodes, periods);
        let low = |i: usize| drawn[i][0].min(drawn[i][1]);
        let high = |i: usize| drawn[i][0].max(drawn[i][1]);
        let mut least = DVec3::INFINITY;
        let mut most = DVec3::NEG_INFINITY;
        for i in 0..drawn.len() {
            (least, most) = (least.min(low(i)), most.max(high(i)));
        }
        let images =
            |axis: usize| ((most - least + self.reach)[axis] / periods[axis][axis]).ceil().clamp(1.0, 30.0) as i16;
        let [across, up] = [images(0), images(1)];
        // By where they begin along the wale, of all images.
        let longest = (0..drawn.len()).map(|i| high(i).y - low(i).y).fold(0.0, f64::max);
        let mut order: Vec<(f64, usize, i16)> = (-up..=up)
            .flat_map(|b| (0..drawn.len()).map(move |j| (j, b)))
            .map(|(j, b)| (low(j).y + f64::from(b) * periods[1].y, j, b))
            .collect();
        order.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        let mut found = Vec::new();
        for i in 0..drawn.len() {
            let from = order.partition_point(|at| at.0 < low(i).y - longest - self.reach);
            let to = order.partition_point(|at| at.0 <= high(i).y + self.reach);
            for &(_, j, b) in &order[from..to] {
                for a in -across..=across {
                    // Every pair once.
                    if i < j || i == j && [b, a] > [0, 0] {
                        found.extend(self.pair(&drawn, periods, i, j, [a, b]));
                    }
                }
            }
        }
        found.sort_by_key(|(key, _)| *key);
        found.into_iter().map(|(_, near)| near).collect()
    }

    fn pair(
        &self,
        drawn: &[[DVec3; 2]],
        periods: [DVec3; 2],
        i: usize,
        j: usize,
        image: [i16; 2],
    ) -> Option<(Key, NearSegments)> {
        let ends = |drawn: &[[DVec3; 2]], periods: [DVec3; 2]| {
            let shift = f64::from(image[0]) * periods[0] + f64::from(image[1]) * periods[1];
            [drawn[i][0], drawn[i][1], drawn[j][0] + shift, drawn[j][1] + shift]
        };
        let now = ends(drawn, periods);
        let (low, high) = (now[0].min(now[1]) - self.reach, now[0].max(now[1]) + self.reach);
        if now[2].min(now[3]).cmpgt(high).any() || now[2].max(now[3]).cmplt(low).any() {
            return None;
        }
        let [one, other] = [&self.segments[i], &self.segments[j]];
        let joined = other
            .contacts
            .iter()
            .any(|&(contact, at)| one.contacts.contains(&(contact, [at[0] + image[0], at[1] + image[1]])));
        if joined || closest(&now.map(|x| x.to_array())).distance > self.reach {
            return None;
        }
        let layout = closest(&ends(&self.layout, self.layout_periods).map(|x| x.to_array())).distance;
        let distance = holds_off_below(self.touching, layout)?;
        let ends = [one.ends[0], one.ends[1], shifted(other.ends[0], image), shifted(other.ends[1], image)];
        Some(((i, j, image), NearSegments { ends, distance }))
    }

    /// The elements of segments that may meet.
    pub fn elements(&self, near: &[NearSegments], coordinates: &mut TileCoordinates) -> Contacts {
        let mut elements = Elements::default();
        for &NearSegments { ends, distance } in near {
            let inner = SegmentContact { stiffness: self.stiffness, distance };
            elements.push(
                beside(self.network, &self.sides, inner, ends),
                stencil(self.network, &self.sides, coordinates, ends),
            );
        }
        elements
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::tile_conditions::Conditions;
    use crate::dynamics::tile_equilibrium::{TileSettings, relax_tile};
    use crate::dynamics::tile_system::TileSystem;
    use crate::pattern::knit;
    use crate::scene::Scene;

    /// Distances of all segments that are near each other in a repeat at rest, over those at which they begin to touch.
    fn distances(rows: &str, strand_contact: bool) -> Vec<f64> {
        let text = format!(
            "schema = 1\n[fabric]\ncontacts = \"thick\"\n[fabric.chart]\nsymbols = [{rows}]\ncolumns = 10\nrows = 8\n"
        );
        let scene = Scene::from_text(&text, "lace.toml").unwrap();
        let (chart, card) = (scene.structure.chart().unwrap(), scene.fabric.knit().unwrap());
        let tile = knit::tile(&chart.smallest_repeat(), card).unwrap();
        let settings = TileSettings { strand_contact, ..TileSettings::of(card) };
        let rest = relax_tile(&tile, &scene.yarns, card, &settings);
        assert!(rest.converged, "{} left after {}", rest.residual, rest.iterations);
        let contacts = TileContacts::of(&tile, &scene.fabric).unwrap();
        let [.., w, h] = rest.coordinates[..] else { unreachable!() };
        let at = |node: NodeId, [a, b]: [i16; 2]| {
            let shift = DVec3::new(f64::from(a) * w, f64::from(b) * h, 0.0);
            DVec3::from_slice(&rest.coordinates[BLOCK * node.index()..]) + shift
        };
        let near = contacts.near(&rest.coordinates, [w, h]);
        let apart = |near: &NearSegments| {
            let ends = near.ends.map(|(pass, image, _)| contacts.sides.place(&tile, (pass, image), at).to_array());
            closest(&ends).distance / near.distance
        };
        near.iter().map(apart).collect()
    }

    #[test]
    fn segments_of_lace_do_not_fall_through_each_other() {
        let lace = r#""kkkkk", "ko^ok""#;
        let least = |all: &[f64]| all.iter().copied().fold(f64::INFINITY, f64::min);
        let [with, without] = [true, false].map(|contact| distances(lace, contact));
        // Yarns press each other by less than half of their thickness.
        assert!(with.len() > 50 && least(&with) > 0.5, "{} of {}", least(&with), with.len());
        // Without, several lie in each other.
        assert!(without.iter().filter(|&&apart| apart < 0.3).count() > 5, "{}", least(&without));
    }

    #[test]
    fn a_step_stops_before_segments_pass_through_each_other() {
        let text =
            "schema = 1\n[fabric]\ncontacts = \"thick\"\n[fabric.chart]\npattern = \"mesh\"\ncolumns = 8\nrows = 8\n";
        let scene = Scene::from_text(text, "mesh.toml").unwrap();
        let (chart, card) = (scene.structure.chart().unwrap(), scene.fabric.knit().unwrap());
        let tile = knit::tile(&chart.smallest_repeat(), card).unwrap();
        let contacts = TileContacts::of(&tile, &scene.fabric).unwrap();
        let (periods, world) = (tile.periods.unwrap(), TileCoordinates::new(&tile).initial(&tile));
        let all = contacts.near(&world, [periods[0].x, periods[1].y]);
        let node = |end: usize, near: &NearSegments| tile.pass_node[near.ends[end].0.index()];
        let place = |end: usize, near: &NearSegments| {
            let at = |node: NodeId, [a, b]: [i16; 2]| {
                tile.position[node.index()] + f64::from(a) * periods[0] + f64::from(b) * periods[1]
            };
            contacts.sides.place(&tile, (near.ends[end].0, near.ends[end].1), at).to_array()
        };
        let part = |of: &[NearSegments], direction: &dyn Fn(&mut [f64])| {
            let settings = TileSettings::of(&scene.fabric);
            let elements = |map: &mut TileCoordinates| contacts.elements(of, map);
            let mut system =
                TileSystem::touching(&tile, &scene.yarns, &scene.fabric, &settings, &Conditions::default(), elements);
            let unknowns = system.coordinates.unknowns(world.clone());
            let mut step = vec![0.0; unknowns.len()];
            direction(&mut step);
            system.longest_step(&unknowns, &step, f64::INFINITY)
        };
        let (mut crossing, mut stopped) = (0, 0);
        for near in &all {
            // The first segment goes to where the second is, and as far beyond.
            let found = closest(&std::array::from_fn(|end| place(end, near)));
            // Only two that cross each other in the air meet wherever they go.
            if found.weights.iter().any(|weight| weight.abs() < 0.1) {
                continue;
            }
            crossing += 1;
            let way = DVec3::from_array(found.normal) * (2.0 * found.distance);
            let direction = |step: &mut [f64]| {
                for end in [0, 1] {
                    step[BLOCK * node(end, near).index()..][..3].copy_from_slice(&way.to_array());
                }
            };
            assert_eq!(part(&[], &direction), 1.0, "nothing is in the way");
            stopped += usize::from(part(&[*near], &direction) < 0.5);
        }
        assert!(crossing > 0 && 2 * stopped > crossing, "{stopped} of {crossing}");
    }

    #[test]
    fn pairs_are_found_once_whatever_tile_they_are_seen_from() {
        let text =
            "schema = 1\n[fabric]\ncontacts = \"thick\"\n[fabric.chart]\npattern = \"mesh\"\ncolumns = 8\nrows = 8\n";
        let scene = Scene::from_text(text, "mesh.toml").unwrap();
        let (chart, card) = (scene.structure.chart().unwrap(), scene.fabric.knit().unwrap());
        let count = |columns: usize, rows: usize| {
            let repeat = chart.smallest_repeat();
            let tile = knit::tile(&repeat.repeat(columns, rows).unwrap(), card).unwrap();
            let periods = tile.periods.unwrap();
            let world = crate::fabric::Coordinates::new(&tile).initial(&tile);
            TileContacts::of(&tile, &scene.fabric).unwrap().near(&world, [periods[0].x, periods[1].y]).len()
        };
        // The layout repeats: a tile twice as wide and high has four times the pairs.
        assert!(count(2, 4) > 0);
        assert_eq!(count(4, 8), 4 * count(2, 4));
    }
}
