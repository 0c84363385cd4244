//! Invariants of knitted networks, whatever the chart and however it is worked.

use std::collections::BTreeSet;

use wale::dynamics::system::System;
use wale::model::{FabricCard, LoopProportions, Network, NodeId, YarnCard, YarnId};
use wale::pattern::{Chart, Side, Working, knit};

fn cards() -> (YarnCard, FabricCard) {
    let yarn = YarnCard {
        linear_density: 3e-4,
        radius: 5e-4,
        stretch_stiffness: 0.5,
        bending_stiffness: 8e-10,
        friction_coefficient: 0.3,
        mass_damping: 0.0,
        stiffness_damping: 0.05,
        plies: 2,
        twist: 0.0,
    };
    let card = LoopProportions::default().card(&yarn, 9.5e-3);
    (yarn, card)
}

fn charts() -> Vec<Chart> {
    vec![
        Chart::stockinette(),
        Chart::reverse_stockinette(),
        Chart::garter(),
        Chart::rib(1, 1).unwrap(),
        Chart::rib(2, 3).unwrap(),
        Chart::seed(),
        Chart::moss(),
        Chart::basket(2, 3).unwrap(),
        Chart::welting(2, 2).unwrap(),
    ]
}

fn workings() -> [Working; 3] {
    [Working::Flat { first_row: Side::RightSide }, Working::Flat { first_row: Side::WrongSide }, Working::Round]
}

#[test]
fn nodes_blocks_and_arc_lengths() {
    let (yarn, card) = cards();
    for chart in charts() {
        let chart = chart.repeat(12, 24).unwrap();
        for working in workings() {
            let network = knit::fabric(&chart, working, &card);
            let loops = network.loops.len();
            assert_eq!(loops, chart.loop_count());
            // Four nodes a loop, and along the edges three a column and two a row at most.
            let edges = 3 * chart.column_count() + 2 * chart.row_count() + 8;
            assert!(network.node_count() >= 4 * loops && network.node_count() <= 4 * loops + edges);
            for y in 0..network.yarn_count() {
                let arcs = &network.arc_length[network.yarn_passes(YarnId::new(y))];
                assert!(arcs.windows(2).all(|pair| pair[1] > pair[0]));
            }
            for info in &network.loops {
                for node in &info.nodes {
                    assert_eq!(network.stack(*node).len(), 2, "every own node holds the loop and its parent");
                }
            }
            assert_eq!(network.stitches.len(), 2 * loops);
            assert!(network.stitches.iter().all(|contact| contact.pairs.len() == 2 && contact.wrap_sign.abs() == 1.0));
            let pattern = System::new(&network, &yarn, &card).pattern().clone();
            let inner = |node: &NodeId| {
                let [column, row] = network.chart_place[node.index()];
                let far = |x: f64, n: usize| x > 2.0 && x < n as f64 - 2.0;
                far(column, chart.column_count()) && far(row, chart.row_count())
            };
            for node in network.loops.iter().flat_map(|info| &info.nodes).filter(|node| inner(node)) {
                assert!(pattern.row(node.index()).len() <= 11, "{} blocks", pattern.row(node.index()).len());
            }
        }
    }
}

/// Which nodes meet along yarns and in which order they are stacked, by place on the chart; without direction.
fn joined(network: &Network) -> (BTreeSet<String>, BTreeSet<String>) {
    let own: BTreeSet<usize> = network.loops.iter().flat_map(|info| &info.nodes).map(|n| n.index()).collect();
    let name = |node: NodeId| {
        let [column, row] = network.chart_place[node.index()];
        format!("{column:.3},{row:.3}")
    };
    let mut segments = BTreeSet::new();
    for y in 0..network.yarn_count() {
        let passes = network.yarn_passes(YarnId::new(y));
        for p in passes.start..passes.end - 1 {
            let (a, b) = (network.pass_node[p], network.pass_node[p + 1]);
            if own.contains(&a.index()) && own.contains(&b.index()) {
                let (a, b) = (name(a), name(b));
                segments.insert(if a < b { format!("{a} {b}") } else { format!("{b} {a}") });
            }
        }
    }
    let mut stacks = BTreeSet::new();
    for node in own {
        let kinds: Vec<_> = network
            .stack(NodeId::new(node))
            .iter()
            .map(|pass| format!("{:?}", network.pass_kind[pass.index()]))
            .collect();
        stacks.insert(format!("{} {kinds:?}", name(NodeId::new(node))));
    }
    for contact in &network.stitches {
        stacks.insert(format!("{} sign {}", name(contact.nodes[0]), contact.wrap_sign));
    }
    (segments, stacks)
}

#[test]
fn the_way_a_row_is_worked_does_not_show() {
    let (_, card) = cards();
    for chart in charts() {
        let chart = chart.repeat(6, 6).unwrap();
        let [a, b, _] = workings().map(|working| joined(&knit::fabric(&chart, working, &card)));
        assert_eq!(a, b);
    }
}

#[test]
fn knits_and_purls_mirror_each_other() {
    let (_, card) = cards();
    let (knits, purls) = (knit::tile(&Chart::stockinette(), &card), knit::tile(&Chart::reverse_stockinette(), &card));
    for (a, b) in knits.stitches.iter().zip(&purls.stitches) {
        assert_eq!(a.wrap_sign, -b.wrap_sign);
    }
    for node in 0..4 {
        let (a, b) = (knits.stack(NodeId::new(node)), purls.stack(NodeId::new(node)));
        assert_eq!(a.iter().rev().collect::<Vec<_>>(), b.iter().collect::<Vec<_>>());
    }
}

#[test]
fn energies_do_not_notice_rigid_motion() {
    use glam::{DQuat, DVec3};
    use wale::fabric::{Coordinates, Mechanics};
    let (yarn, card) = cards();
    let network = knit::fabric(&Chart::seed().repeat(6, 6).unwrap(), Working::default(), &card);
    let mut coordinates = Coordinates::new(&network);
    let mechanics = Mechanics::new(&network, &yarn, &card, &mut coordinates);
    // Off the flat layout, where every kind of energy has something to say.
    let bent = |x: DVec3| x + 1e-3 * DVec3::new((900.0 * x.y).sin(), (700.0 * x.x).cos(), (800.0 * (x.x + x.y)).sin());
    let turn = DQuat::from_scaled_axis(DVec3::new(0.4, -1.1, 0.7));
    let here: Vec<DVec3> = network.position.iter().map(|x| bent(*x)).collect();
    let there: Vec<DVec3> = here.iter().map(|x| turn * *x + DVec3::new(0.3, -0.2, 0.1)).collect();
    let shifted: Vec<f64> = network.arc_length.iter().map(|u| u + 0.25).collect();
    let q = coordinates.gather(&here, &network.arc_length);
    for other in [coordinates.gather(&there, &network.arc_length), coordinates.gather(&here, &shifted)] {
        for set in mechanics.sets() {
            let (a, b) = (set.total(&q), set.total(&other));
            assert!(a > 0.0 || set.name() == "stitch length", "{} is zero", set.name());
            assert!((a - b).abs() <= 1e-9 * a.abs().max(1e-12), "{}: {a} {b}", set.name());
        }
    }
    // Action and reaction: forces sum to zero.
    for set in mechanics.sets() {
        let (mut sum, mut size) = ([0.0; 3], 0.0f64);
        set.visit_gradient(&q, &mut |stencil, gradient| {
            for (dof, g) in stencil.iter().zip(gradient) {
                if let k @ 0..3 = *dof as usize % 5 {
                    sum[k] += g;
                    size = size.max(g.abs());
                }
            }
        });
        assert!(sum.iter().all(|s| s.abs() <= 1e-9 * size.max(1e-12)), "{}: {sum:?}", set.name());
    }
}
