//! Invariants of knitted networks, whatever the chart and however it is worked.

mod cards;

use std::collections::BTreeSet;

use cards::cards;
use wale::contact::Compression;
use wale::dynamics::system::System;
use wale::fabric::Coordinates;
use wale::model::{
    FabricCard, KnitCard, LoopProportions, Network, NodeId, PassId, PassKind, WovenCard, YarnCard, YarnId, Yarns,
};
use wale::pattern::symbols::{default_legend, read_symbols};
use wale::pattern::weave::peirce::geometry;
use wale::pattern::weave::{Draft, Woven};
use wale::pattern::{Chart, Side, Stitch, Working, knit};

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

/// Lace of yarn-overs and every decrease, seen from the front; each row takes as many stitches as it makes.
fn lace() -> Chart {
    let rows = [
        "kkkkkkkkkk",
        "/o\\okkrolo",
        "pppppppppp",
        ">ookk<ookk",
        "kkkkkkkkkk",
        "o^okRookkk",
        "kkkkkkkkkk",
        "Lookovokkk",
    ];
    let rows: Vec<String> = rows.iter().rev().map(|row| (*row).to_owned()).collect();
    read_symbols(&rows, &default_legend()).unwrap()
}

#[test]
fn decreases_stack_their_loops_and_yarn_overs_have_no_feet() {
    let (yarn, card) = cards();
    let chart = lace().repeat(20, 16).unwrap();
    for working in workings() {
        let network = knit::fabric(&chart, working, &card);
        assert_eq!(network.loops.len(), chart.loop_count());
        for y in 0..network.yarn_count() {
            let arcs = &network.arc_length[network.yarn_passes(YarnId::new(y))];
            assert!(arcs.windows(2).all(|pair| pair[1] > pair[0]));
        }
        let yarn_of = network.pass_yarn();
        let mut contacts = network.stitches.iter();
        for info in &network.loops {
            let stitch = chart.rows()[info.row as usize][info.column as usize];
            assert_eq!(info.nodes.len(), if stitch.takes() == 0 { 0 } else { 4 });
            for node in &info.nodes {
                assert_eq!(network.stack(*node).len(), 1 + stitch.takes(), "the loop and those that it takes");
            }
            for _ in 0..if stitch.takes() == 0 { 0 } else { 2 } {
                let contact = contacts.next().unwrap();
                assert_eq!(contact.passes.len(), 1 + stitch.takes());
                assert_eq!(contact.pairs.len(), 2 * stitch.takes(), "around each of them, not they around each other");
                for [first, second] in &contact.passes {
                    assert_eq!(yarn_of[first.index()], yarn_of[second.index()]);
                    assert_eq!(first.0.abs_diff(second.0), 1, "a contact is a segment of every yarn in it");
                }
            }
        }
        assert!(contacts.next().is_none());
        // Every loop below is held by exactly one: each of its rows' loops appears in the stacks above it.
        let stacked: usize =
            network.loops.iter().map(|info| info.nodes.first().map_or(0, |node| network.stack(*node).len() - 1)).sum();
        assert_eq!(stacked, chart.loop_count(), "rows take what the rows below them make");
        let system = System::new(&network, &yarn, &card);
        assert!(system.coordinates.block_count() > network.node_count(), "stacks have more than five coordinates");
    }
}

#[test]
fn a_decrease_leans_as_its_name_says() {
    let (_, card) = cards();
    for (symbol, left_in_front) in [('/', true), ('\\', false), ('r', true), ('l', false)] {
        let row = format!("k{symbol}ok");
        let chart = read_symbols(&[row.as_str(), "kkkk"], &default_legend()).unwrap();
        for working in workings() {
            let network = knit::fabric(&chart, working, &card);
            let decrease = network.loops.iter().find(|info| (info.row, info.column) == (1, 1)).unwrap();
            let knit = decrease.knit;
            assert_eq!(knit, matches!(symbol, '/' | '\\'));
            // The middles of the two loops below, along the yarn, tell their passes apart.
            let [left, right] = [1, 2].map(|column| {
                let info = network.loops.iter().find(|info| (info.row, info.column) == (0, column)).unwrap();
                let legs = [1, 2].map(|corner| {
                    let mut own = network.stack(info.nodes[corner]).iter();
                    own.find(|pass| network.pass_kind[pass.index()] == PassKind::Leg).unwrap().index()
                });
                legs[0] + legs[1]
            });
            for (corner, node) in decrease.nodes.iter().enumerate() {
                let stack = network.stack(*node);
                let foot = corner == 0 || corner == 3;
                let near = |pass: &wale::model::PassId| {
                    let to = |other: usize| (2 * pass.index()).abs_diff(other);
                    if to(left) < to(right) { 'l' } else { 'r' }
                };
                let parents: Vec<char> = if foot == knit {
                    stack[..2].iter().map(near).collect()
                } else {
                    stack[1..].iter().map(near).collect()
                };
                assert_eq!(parents, if left_in_front { ['l', 'r'] } else { ['r', 'l'] }, "{symbol} corner {corner}");
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
        check_both_ways(&chart, &card);
    }
    check_both_ways(&lace(), &card);
}

fn check_both_ways(chart: &Chart, card: &KnitCard) {
    let [a, b, _] = workings().map(|working| joined(&knit::fabric(chart, working, card)));
    assert_eq!(a, b);
}

#[test]
fn knits_and_purls_mirror_each_other() {
    let (_, card) = cards();
    let (knits, purls) =
        (knit::tile(&Chart::stockinette(), &card).unwrap(), knit::tile(&Chart::reverse_stockinette(), &card).unwrap());
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
    let (yarn, card) = cards();
    let knitted = knit::fabric(&Chart::seed().repeat(6, 6).unwrap(), Working::default(), &card);
    // What a knit does not have, and what it may have nothing of.
    check_rigid_motion(&knitted, &yarn, &FabricCard::from(&card), &["shear", "stitch length", "leg contact"]);
    let mut thick = LoopProportions::thick().card(&yarn, card.loop_length);
    // Far enough for legs of the layout to touch.
    thick.thickness.as_mut().unwrap().leg_distance = card.wale_spacing;
    let knitted = knit::fabric(&Chart::seed().repeat(6, 6).unwrap(), Working::default(), &thick);
    check_rigid_motion(&knitted, &yarn, &FabricCard::from(&thick), &["shear", "stitch length"]);
    let draft = Draft::twill(2, 1).unwrap().repeat(6, 6).unwrap();
    let spacing = [4.0 * yarn.radius, 5.0 * yarn.radius];
    let woven = WovenCard::new(&yarn, &yarn, &geometry(&draft, [&yarn; 2], spacing).unwrap());
    let network = Woven::new(draft, spacing).network(spacing);
    check_rigid_motion(
        &network,
        &yarn,
        &FabricCard::from(&woven),
        &["wrapping", "stitch length", "spacing", "leg contact"],
    );
}

fn check_rigid_motion(network: &Network, yarn: &YarnCard, card: &FabricCard, absent: &[&str]) {
    use glam::{DQuat, DVec3};
    use wale::fabric::{Coordinates, Mechanics};
    let mut coordinates = Coordinates::new(network);
    let mechanics = Mechanics::new(network, &yarn.into(), card, &mut coordinates);
    // Off the flat layout, where every kind of energy has something to say.
    let bent = |x: DVec3| x + 1e-3 * DVec3::new((900.0 * x.y).sin(), (700.0 * x.x).cos(), (800.0 * (x.x + x.y)).sin());
    let turn = DQuat::from_scaled_axis(DVec3::new(0.4, -1.1, 0.7));
    let here: Vec<DVec3> = network.position.iter().map(|x| bent(*x)).collect();
    let there: Vec<DVec3> = here.iter().map(|x| turn * *x + DVec3::new(0.3, -0.2, 0.1)).collect();
    let shifted: Vec<f64> = network.arc_length.iter().map(|u| u + 0.25).collect();
    let q = coordinates.gather(&here, &network.arc_length);
    for other in [coordinates.gather(&there, &network.arc_length), coordinates.gather(&here, &shifted)] {
        let total = |name: &str, q: &[f64]| -> f64 {
            mechanics.sets().iter().filter(|set| set.name() == name).map(|set| set.total(q)).sum()
        };
        for name in mechanics.sets().map(|set| set.name()) {
            let (a, b) = (total(name, &q), total(name, &other));
            assert!(a > 0.0 || absent.contains(&name), "{name} is zero");
            assert!((a - b).abs() <= 1e-9 * a.abs().max(1e-12), "{name}: {a} {b}");
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

#[test]
fn an_end_that_is_out_is_held_where_the_last_contact_was_that_it_left() {
    let (_, card) = cards();
    let chart = Chart::garter().repeat(6, 6).unwrap();
    let mut network = knit::fabric(&chart, Working::Flat { first_row: Side::RightSide }, &card);
    assert_eq!(network.places_held(), network.position);
    let yarn = (0..network.yarn_count()).map(YarnId::new).max_by_key(|y| network.yarn_passes(*y).len()).unwrap();
    let passes = network.yarn_passes(yarn);
    network.pulled_out = vec![false; network.pass_count()];
    // Three contacts at the beginning and two at the end.
    (1..=3).for_each(|k| network.pulled_out[passes.start + k] = true);
    (2..=3).for_each(|k| network.pulled_out[passes.end - k] = true);
    let node = |pass: usize| network.pass_node[pass].index();
    let mut expected = network.position.clone();
    expected[node(passes.start)] = network.position[node(passes.start + 3)];
    expected[node(passes.end - 1)] = network.position[node(passes.end - 3)];
    assert!(expected != network.position);
    assert_eq!(network.places_held(), expected);
}

#[test]
fn a_stack_is_counted_from_the_loop_that_was_worked_on_whichever_side_it_lies() {
    let (yarn, card) = cards();
    for name in ["k2tog", "p2tog"] {
        let decrease = Stitch::named(name).unwrap();
        let chart = Chart::new(vec![vec![Stitch::Knit; 2], vec![decrease], vec![Stitch::Knit]]).unwrap();
        let network = knit::fabric(&chart, Working::default(), &card);
        let coordinates = Coordinates::new(&network);
        let compression =
            Compression::new(&network, &Yarns::from(&yarn), &FabricCard::Knit(card.clone()), &coordinates);
        let stacks = (0..network.node_count()).map(|node| network.stack(NodeId::new(node)));
        let deep: Vec<&[PassId]> = stacks.filter(|stack| stack.len() == 3).collect();
        assert_eq!(deep.len(), compression.parallel().len(), "{name}");
        let mut behind = 0;
        for (stack, (contact, [nearer, beyond])) in deep.iter().zip(compression.parallel()) {
            // The worked loop differs in kind from the two that it is worked into, which are alike.
            let kind = |pass: PassId| network.pass_kind[pass.index()];
            let at_back = kind(stack[0]) == kind(stack[1]);
            let [worked, last] = if at_back { [stack[2], stack[0]] } else { [stack[0], stack[2]] };
            assert_eq!((*nearer, *beyond), (stack[1], last), "{name}");
            assert_eq!(compression.contact_of(worked), Some(contact - 1), "{name}");
            behind += usize::from(at_back);
        }
        assert!(behind > 0 && behind < deep.len(), "{name}: the worked loop lies in front of some, behind others");
    }
}
