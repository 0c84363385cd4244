//! What always holds of a knitted network (`docs/topics/knit-structure.md`).

use std::collections::BTreeMap;

use wale::dynamics::system::System;
use wale::fabric::{Mechanics, TileCoordinates};
use wale::model::{FabricCard, LoopProportions, Network, NodeId, PassKind, SegmentKind, YarnCard, YarnId};
use wale::pattern::{Chart, Side, Working, knit};

const WORKINGS: [Working; 3] =
    [Working::Flat { first_row: Side::RightSide }, Working::Flat { first_row: Side::WrongSide }, Working::Round];

fn cards() -> (YarnCard, FabricCard) {
    let yarn = YarnCard {
        linear_density: 3e-4,
        radius: 5e-4,
        stretch_stiffness: 8.0,
        bending_stiffness: 8e-10,
        friction_coefficient: 0.3,
        mass_damping: 0.0,
        stiffness_damping: 0.0,
        plies: 2,
        twist: 0.0,
    };
    let card = LoopProportions::default().card(&yarn, 9.5e-3);
    (yarn, card)
}

fn charts() -> Vec<Chart> {
    let named = [Chart::stockinette(), Chart::garter(), Chart::seed(), Chart::moss()];
    let sized = [Chart::rib(2, 2), Chart::basket(3, 2), Chart::welting(2, 1)].map(Result::unwrap);
    named.into_iter().chain(sized).collect()
}

/// Every chart as a fabric of 12 × 10 loops, worked in every way.
fn fabrics() -> Vec<Network> {
    let (_, card) = cards();
    let charts: Vec<Chart> = charts().iter().map(|chart| chart.repeat(12, 10).unwrap()).collect();
    charts.iter().flat_map(|chart| WORKINGS.map(|working| knit::fabric(chart, working, &card))).collect()
}

fn tiles() -> Vec<(Chart, Network)> {
    let (_, card) = cards();
    charts().into_iter().map(|chart| (chart.smallest_repeat(), knit::tile(&chart.smallest_repeat(), &card))).collect()
}

#[test]
fn yarn_runs_forward() {
    for network in fabrics().iter().chain(tiles().iter().map(|(_, tile)| tile)) {
        for y in 0..network.yarn_count() {
            let arcs = &network.arc_length[network.yarn_passes(YarnId::new(y))];
            assert!(arcs.windows(2).all(|pair| pair[1] > pair[0]));
        }
    }
}

#[test]
fn four_nodes_a_loop_and_two_passes_a_node() {
    let (_, card) = cards();
    for working in WORKINGS {
        let network = knit::fabric(&Chart::stockinette().repeat(40, 40).unwrap(), working, &card);
        let a_loop = network.node_count() as f64 / network.loops.len() as f64;
        assert!((4.0..4.2).contains(&a_loop), "{a_loop} nodes a loop");
    }
    for (_, tile) in tiles() {
        assert_eq!(tile.node_count(), 4 * tile.loops.len());
    }
    for network in fabrics() {
        assert_eq!(network.stitches.len(), 2 * network.loops.len());
        for node in network.loops.iter().flat_map(|info| &info.nodes) {
            assert_eq!(network.stack(*node).len(), 2);
        }
    }
}

#[test]
fn at_most_eleven_blocks_in_a_row_of_an_interior_node() {
    let (yarn, card) = cards();
    for network in fabrics() {
        let system = System::new(&network, &yarn, &card);
        let [rows, columns] = network.chart_size;
        let inside = network
            .loops
            .iter()
            .filter(|info| (2..rows - 2).contains(&info.row) && (2..columns - 2).contains(&info.column));
        for node in inside.flat_map(|info| &info.nodes) {
            let blocks = system.pattern().row(node.index()).len();
            assert!((8..=11).contains(&blocks), "{blocks} blocks");
        }
    }
}

#[test]
fn elements_of_a_loop() {
    let (yarn, card) = cards();
    for (_, tile) in tiles() {
        let mechanics = Mechanics::new(&tile, &yarn, &card, &mut TileCoordinates::new(&tile));
        let n = tile.loops.len();
        let found = [
            mechanics.stretch.len(),
            mechanics.bending.len(),
            mechanics.wrapping.len(),
            mechanics.stitch_length.len(),
            mechanics.spacing.len(),
        ];
        assert_eq!(found, [8 * n, 8 * n, 4 * n, 4 * n, 4 * n]);
    }
}

#[test]
fn a_row_of_a_tile_holds_the_yarn_of_its_loops() {
    let (_, card) = cards();
    for (chart, tile) in tiles() {
        for (y, row) in chart.rows().iter().enumerate() {
            let changes = (0..row.len()).filter(|&c| row[c] != row[(c + 1) % row.len()]).count();
            let expected = card.loop_length * (row.len() as f64 + card.transition_length * changes as f64);
            let (_, length) = tile.yarn_closure[y].unwrap();
            assert!((length / expected - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn stacks_and_signs_of_knit_and_purl() {
    for network in fabrics() {
        for (info, contacts) in network.loops.iter().zip(network.stitches.chunks(2)) {
            // At the feet the leg passes are the parent's, at the legs the child's own: in a knit both lie in front.
            let order =
                if info.knit { [PassKind::Leg, PassKind::FootHead] } else { [PassKind::FootHead, PassKind::Leg] };
            for node in &info.nodes {
                let kinds: Vec<PassKind> =
                    network.stack(*node).iter().map(|pass| network.pass_kind[pass.index()]).collect();
                assert_eq!(kinds, order);
            }
            let signs: Vec<f64> = contacts.iter().map(|contact| contact.wrap_sign).collect();
            assert_eq!(signs, if info.knit { [1.0, -1.0] } else { [-1.0, 1.0] });
            for (contact, nodes) in contacts.iter().zip([[0, 1], [3, 2]]) {
                assert_eq!(contact.nodes, nodes.map(|corner| info.nodes[corner]));
            }
        }
    }
}

/// Rest lengths of the segments of loops by the nodes that they join.
fn loop_segments(network: &Network) -> BTreeMap<[NodeId; 2], f64> {
    let mut segments = BTreeMap::new();
    for y in 0..network.yarn_count() {
        let passes = network.yarn_passes(YarnId::new(y));
        for p in passes.start..passes.end - 1 {
            if network.segment_kind[p] != SegmentKind::Edge {
                let mut ends = [network.pass_node[p], network.pass_node[p + 1]];
                ends.sort();
                segments.insert(ends, network.arc_length[p + 1] - network.arc_length[p]);
            }
        }
    }
    segments
}

#[test]
fn the_side_of_the_first_row_does_not_change_the_fabric() {
    let (_, card) = cards();
    for chart in charts() {
        let chart = chart.repeat(7, 6).unwrap();
        let [right, wrong] = [WORKINGS[0], WORKINGS[1]].map(|working| knit::fabric(&chart, working, &card));
        let owned = right.loops.iter().flat_map(|info| &info.nodes);
        for node in owned {
            assert_eq!(right.position[node.index()], wrong.position[node.index()]);
            let kinds = |network: &Network| -> Vec<PassKind> {
                network.stack(*node).iter().map(|pass| network.pass_kind[pass.index()]).collect()
            };
            assert_eq!(kinds(&right), kinds(&wrong));
        }
        for (a, b) in right.stitches.iter().zip(&wrong.stitches) {
            assert_eq!((a.nodes, a.wrap_sign, a.pairs.len()), (b.nodes, b.wrap_sign, b.pairs.len()));
            for (a, b) in a.pairs.iter().zip(&b.pairs) {
                assert_eq!(a.pair, b.pair);
            }
        }
        let (a, b) = (loop_segments(&right), loop_segments(&wrong));
        assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>());
        for (ends, length) in &a {
            assert!((length / b[ends] - 1.0).abs() < 1e-9);
        }
    }
}
