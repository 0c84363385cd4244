//! The elastic elements of a network, made from its yarns, its contacts and the cards.

use super::coordinates::{CoordinateMap, Dof};
use super::elements::{ElementSet, Elements};
use super::thickness::{ThickElements, crosses};
use crate::energy::{Bending, Shear, Spacing, StitchLength, Stretch, Wrapping};
use crate::model::{
    ContactPair, Crossing, FabricCard, KnitCard, Network, NodeId, PassId, PassKind, SegmentKind, StitchContact,
    WovenCard, YarnCard, YarnId, YarnRole, Yarns,
};

/// Part of its spacing that a segment of thick contacts is kept from losing as if the yarn itself were pressed; relaxed fabrics
/// keep more.
const CORE: f64 = 0.25;

/// Elastic elements of a fabric.
#[derive(Clone, Debug, Default)]
pub struct Mechanics {
    /// Stretch of segments, in yarn order.
    pub stretch: Elements<Stretch, 8>,
    /// The pass that each segment follows.
    pub segment_after: Vec<PassId>,
    /// Bending at passes, in yarn order.
    pub bending: Elements<Bending, 12>,
    /// The pass of each bend.
    pub bend_at: Vec<PassId>,
    /// Stretch and bending of yarns with a thickness, in place of those above.
    pub thick: ThickElements,
    /// Wrapping of stitch contacts.
    pub wrapping: Elements<Wrapping, 12>,
    /// Yarn length of stitch contacts.
    pub stitch_length: Elements<StitchLength, 2>,
    /// Spacing of adjacent loops and crossings.
    pub spacing: Elements<Spacing, 2>,
    /// Shear of crossings.
    pub shear: Elements<Shear, 9>,
}

/// Stretch stiffness of a cast-on or bind-off \[N\], a thousand `k_b/ℓ²`: a chain of loops gives as a course of loops
/// does, by bending, where one straight strand would hold the whole edge of the fabric.
#[must_use]
pub fn chain_stiffness(yarn: &YarnCard, card: &KnitCard) -> f64 {
    1000.0 * yarn.bending_stiffness / card.loop_length.powi(2)
}

impl Mechanics {
    /// Makes the elements of a network.
    pub fn new(network: &Network, yarns: &Yarns, card: &FabricCard, map: &mut dyn CoordinateMap) -> Self {
        let mut mechanics = Self::default();
        for y in 0..network.yarn_count() {
            let material = yarns.of(network.yarn_kind[y]);
            for p in network.yarn_passes(YarnId::new(y)) {
                mechanics.add_pass(network, YarnId::new(y), PassId::new(p), material, card, map);
            }
        }
        match card {
            FabricCard::Knit(card) => mechanics.add_contacts(network, card, map),
            FabricCard::Woven(card) => mechanics.add_crossings(network, card, map),
        }
        if let Some((card, thickness)) = card.knit().and_then(|card| Some((card, card.thickness?))) {
            mechanics.thick = ThickElements::take(network, card, &thickness, &mut mechanics, map);
        }
        mechanics
    }

    /// All kinds, for whoever treats them alike.
    #[must_use]
    pub fn sets(&self) -> [&dyn ElementSet; 10] {
        let ThickElements { stretch, bending, legs, facing } = &self.thick;
        [
            &self.stretch,
            &self.bending,
            stretch,
            bending,
            legs,
            facing,
            &self.wrapping,
            &self.stitch_length,
            &self.spacing,
            &self.shear,
        ]
    }

    /// The bend at a pass and the segment after it.
    fn add_pass(
        &mut self,
        network: &Network,
        yarn: YarnId,
        pass: PassId,
        material: &YarnCard,
        card: &FabricCard,
        map: &mut dyn CoordinateMap,
    ) {
        if network.is_out(pass) {
            return;
        }
        let Some(next) = network.neighbour(yarn, pass, 1) else { return };
        let here = point(map, network, pass, [0; 2], 0);
        let there = point(map, network, next.pass, next.image, next.turns);
        let stiffness = match (network.segment_kind[pass.index()], card) {
            (SegmentKind::Chain, FabricCard::Knit(card)) => chain_stiffness(material, card),
            _ => material.stretch_stiffness,
        };
        self.stretch.push(Stretch { stiffness }, join(here, there));
        self.segment_after.push(pass);
        let previous = network.neighbour(yarn, pass, -1);
        if let Some(previous) = previous {
            let before = point(map, network, previous.pass, previous.image, previous.turns);
            let rest_angle = match (network.pass_kind[pass.index()], card) {
                (PassKind::FootHead, FabricCard::Knit(card)) => card.bend_angle_foot_head,
                (PassKind::Leg, FabricCard::Knit(card)) => card.bend_angle_leg,
                _ => 0.0,
            };
            let mut stencil = [0; 12];
            stencil[..4].copy_from_slice(&before);
            stencil[4..8].copy_from_slice(&here);
            stencil[8..].copy_from_slice(&there);
            self.bending.push(Bending { stiffness: material.bending_stiffness, rest_angle }, stencil);
            self.bend_at.push(pass);
        }
        // A loose end may be pulled up to its last contact, and out of it.
        let end = previous.is_none() || network.neighbour(yarn, next.pass, 1).is_none();
        if end && material.can_be_pulled_out(network.yarn_role[yarn.index()]) {
            return;
        }
        let between = [here[3], there[3]];
        let at = |p: PassId| network.arc_length[p.index()];
        // Half of what lies there at first, where the layout is tighter than the card.
        let half = 0.5 * (at(next.pass) - at(pass)).abs();
        let distance = match card {
            FabricCard::Knit(card) => match self.knit_spacing(network, [pass, next.pass], card, half, between) {
                Some(distance) => distance,
                None => return,
            },
            FabricCard::Woven(card) => {
                let system = usize::from(network.yarn_role[yarn.index()] == YarnRole::Weft);
                match network.segment_kind[pass.index()] {
                    SegmentKind::Interlacing => card.interlacing_spacing[system],
                    SegmentKind::Float => card.float_spacing[system],
                    _ => card.interlacing_spacing[system].min(half),
                }
            }
        };
        if distance > 0.0 && (network.slides(pass) || network.slides(next.pass)) {
            self.spacing.push(Spacing { stiffness: card.spacing_stiffness(), distance }, between);
            // Where spacing gives way, something harder must be left of a segment: a fabric that snaps drives it to nothing.
            let core = Spacing { stiffness: material.stretch_stiffness, distance: CORE * distance };
            if card.knit().is_some_and(|card| card.thickness.is_some()) {
                self.spacing.push(core, between);
            }
        }
    }

    /// The spacing distance of a segment of a knit \[m\]; a stitch contact has a length of its own instead.
    fn knit_spacing(
        &mut self,
        network: &Network,
        [pass, next]: [PassId; 2],
        card: &KnitCard,
        half: f64,
        between: [Dof; 2],
    ) -> Option<f64> {
        // Loops that share a strand with others lie as much closer.
        let share = f64::from(network.segment_share[pass.index()]);
        let ratio = match card.thickness {
            Some(thickness) if crosses(network, pass, next) => thickness.crossing_spacing,
            _ => 1.0,
        };
        Some(
            ratio
                * match network.segment_kind[pass.index()] {
                    SegmentKind::Stitch => {
                        let rest_length = card.stitch_length / share;
                        self.stitch_length
                            .push(StitchLength { stiffness: card.length_stiffness, rest_length }, between);
                        return None;
                    }
                    SegmentKind::Leg => card.spacing_leg,
                    SegmentKind::Head | SegmentKind::Sinker => card.spacing_head_sinker / share,
                    _ => card.spacing_head_sinker.min(half),
                },
        )
    }

    fn add_contacts(&mut self, network: &Network, card: &KnitCard, map: &mut dyn CoordinateMap) {
        let whole = |contact: &&StitchContact| !contact.passes.iter().flatten().any(|&pass| network.is_out(pass));
        for contact in network.stitches.iter().filter(whole) {
            let axis = contact.nodes.map(|node| map.position(node, [0; 2]));
            let [first, second] = contact.passes[0];
            let share = f64::from(network.segment_share[first.min(second).index()]);
            for pair in &contact.pairs {
                let side = |map: &mut dyn CoordinateMap, pass: PassId, image| {
                    map.position(network.pass_node[pass.index()], image)
                };
                let x4 = side(map, pair.outward_at_first, pair.image_at_first);
                let x3 = side(map, pair.outward_at_second, pair.image_at_second);
                let rest_angle = match pair.pair {
                    ContactPair::Course => card.wrapping_angle_course,
                    ContactPair::Leg => card.wrapping_angle_leg,
                };
                let element = Wrapping {
                    stiffness: card.wrapping_stiffness * card.stitch_length / share,
                    rest_angle,
                    sign: contact.wrap_sign,
                };
                let mut stencil = [0; 12];
                for (k, x) in [axis[0], axis[1], x3, x4].into_iter().enumerate() {
                    stencil[3 * k..3 * k + 3].copy_from_slice(&x);
                }
                self.wrapping.push(element, stencil);
            }
        }
    }

    /// Every neighbour along the warp against every neighbour along the weft; free ends and turns do not shear.
    fn add_crossings(&mut self, network: &Network, card: &WovenCard, map: &mut dyn CoordinateMap) {
        let yarn_of = network.pass_yarn();
        let mean = 0.5 * (card.spacing[0] + card.spacing[1]);
        let element =
            Shear { stiffness: 0.5 * card.shear_stiffness * mean / 4.0, jamming_angle: card.shear_jamming_angle };
        let whole = |crossing: &&Crossing| !network.is_out(crossing.warp) && !network.is_out(crossing.weft);
        for crossing in network.crossings.iter().filter(whole) {
            let sides = [crossing.warp, crossing.weft].map(|pass| {
                let near = [-1, 1].map(|step| network.neighbour(yarn_of[pass.index()], pass, step));
                near.map(|near| near.filter(|near| network.pass_kind[near.pass.index()] == PassKind::Crossing))
            });
            let middle = map.position(crossing.node, [0; 2]);
            for warp in sides[0].into_iter().flatten() {
                for weft in sides[1].into_iter().flatten() {
                    let [a, b] =
                        [warp, weft].map(|near| map.position(network.pass_node[near.pass.index()], near.image));
                    self.shear.push(element, [a[0], a[1], a[2], middle[0], middle[1], middle[2], b[0], b[1], b[2]]);
                }
            }
        }
    }
}

/// Coordinates `x u` of a pass.
fn point(map: &mut dyn CoordinateMap, network: &Network, pass: PassId, image: [i16; 2], turns: i16) -> [Dof; 4] {
    let node: NodeId = network.pass_node[pass.index()];
    let [x, y, z] = map.position(node, image);
    [x, y, z, map.sliding(pass, turns)]
}

fn join(a: [Dof; 4], b: [Dof; 4]) -> [Dof; 8] {
    [a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3]]
}
