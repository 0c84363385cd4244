//! Invariants of networks made of any stitches: increases, decreases, slips, tucks, several yarns, shaping.

mod cards;

use std::collections::BTreeMap;

use cards::cards;
use proptest::prelude::*;
use wale::dynamics::system::System;
use wale::model::{Network, NodeId, SegmentKind, YarnId};
use wale::pattern::loops::{Form, Form2d, LoopGraph, Onward, Stop};
use wale::pattern::symbols::{default_legend, read_symbols};
use wale::pattern::work::{work, work_tile};
use wale::pattern::{Chart, Side, Stitch, Working, knit};

fn workings() -> [Working; 3] {
    [Working::Flat { first_row: Side::RightSide }, Working::Flat { first_row: Side::WrongSide }, Working::Round]
}

fn chart(lines: &[&str]) -> Chart {
    read_symbols(lines, &default_legend()).unwrap()
}

/// Stitches row by row, each row working what the row below leaves.
fn any_chart() -> impl Strategy<Value = Chart> {
    let stitches: Vec<Stitch> = Stitch::all().map(|(_, _, stitch)| stitch).collect();
    let picks = prop::collection::vec(prop::collection::vec((0..stitches.len(), 0_u8..2), 40), 1..7);
    (2_usize..9, picks).prop_map(move |(cast_on, picks)| {
        let mut on_needle = vec![1_usize; cast_on];
        let mut rows = Vec::new();
        let mut yarns = Vec::new();
        for pick in picks {
            let (mut row, mut row_yarns, mut above) = (Vec::new(), Vec::new(), Vec::new());
            let mut below = on_needle.iter().copied().peekable();
            let mut pick = pick.into_iter();
            while below.peek().is_some() {
                let (stitch, yarn) = pick.next().map_or((Stitch::Knit, 0), |(k, yarn)| (stitches[k], yarn));
                let left = below.clone().count();
                let held: usize = below.clone().take(stitch.takes()).sum();
                let grown = above.len() + stitch.leaves() + left > 20;
                let fits = stitch.takes() <= left
                    && held < Chart::MOST_STACKED
                    && !(grown && stitch.leaves() > stitch.takes());
                let stitch = if fits { stitch } else { Stitch::Purl };
                let taken: usize = below.by_ref().take(stitch.takes()).sum();
                match stitch {
                    Stitch::Slip { .. } => above.push(taken),
                    Stitch::Tuck => above.push(taken + 1),
                    _ => above.extend(vec![1; stitch.leaves()]),
                }
                row.push(stitch);
                row_yarns.push(yarn);
            }
            on_needle = above;
            rows.push(row);
            yarns.push(row_yarns);
        }
        Chart::new(rows).unwrap().with_yarns(yarns).unwrap()
    })
}

fn check_graph(graph: &LoopGraph) {
    // Every loop is held, by loops drawn through it or by the bind-off, and knows those that hold it.
    assert_eq!(graph.unsupported().count(), 0);
    let mut held = 0;
    for (at, of) in graph.loops.iter().enumerate() {
        match of.form {
            Form::Worked { .. } => assert!(!of.parents.is_empty()),
            _ => assert!(of.parents.is_empty()),
        }
        for parent in &of.parents {
            let below = &graph.loops[parent.of.index()];
            assert!(
                below.children.iter().any(|child| child.of.index() == at && child.image == parent.image.map(|k| -k))
            );
            held += 1;
        }
    }
    assert_eq!(held, graph.loops.iter().map(|of| of.children.len()).sum::<usize>());
    // Every loop lies on one yarn, once.
    let mut visits = BTreeMap::new();
    for strand in &graph.strands {
        for (stop, onward) in &strand.stops {
            if let Stop::Loop { id, .. } = stop {
                *visits.entry(id.index()).or_insert(0) += 1;
            }
            assert!(!matches!(onward, Onward::Sinker { over } if *over >= 2 * graph.size[1]), "{onward:?}");
        }
    }
    assert!(visits.len() == graph.loops.len() && visits.values().all(|count| *count == 1));
}

fn check_network(graph: &LoopGraph, network: &Network) {
    let (yarn, card) = cards();
    for y in 0..network.yarn_count() {
        let passes = network.yarn_passes(YarnId::new(y));
        for p in passes.start..passes.end - 1 {
            let places = [p, p + 1].map(|p| network.chart_place[network.pass_node[p].index()]);
            let length = network.arc_length[p + 1] - network.arc_length[p];
            assert!(length > 1e-3 * card.wale_spacing, "{length} of {:?} at {places:?}", network.segment_kind[p]);
        }
        let kinds = &network.segment_kind[network.yarn_passes(YarnId::new(y))];
        // A segment of a stitch contact is never next to another of the same contact.
        assert!(!kinds.windows(2).any(|pair| pair == [SegmentKind::Stitch; 2]));
    }
    // Nowhere does a yarn lie folded in two.
    for y in 0..network.yarn_count() {
        let passes = network.yarn_passes(YarnId::new(y));
        for p in passes.start + 1..passes.end - 1 {
            let [a, b, c] = [p - 1, p, p + 1].map(|p| network.pass_node[p]);
            // A tube may come down to a single stitch, which is its own neighbour.
            assert!(a != c || graph.form != Form2d::Sheet, "folded at {:?}", network.chart_place[b.index()]);
        }
    }
    // The nodes of every loop hold it and the loops that it is drawn through, front to back as the graph says.
    let worked: Vec<_> = graph.loops.iter().filter(|of| matches!(of.form, Form::Worked { .. })).collect();
    let own: Vec<_> = network.loops.iter().filter(|info| !info.nodes.is_empty()).collect();
    assert_eq!(worked.len(), own.len());
    for (of, info) in worked.iter().zip(&own) {
        for node in &info.nodes {
            assert_eq!(network.stack(*node).len(), 1 + of.parents.len());
        }
    }
    assert_eq!(network.stitches.len(), 2 * worked.len());
    let yarn_of = network.pass_yarn();
    for contact in &network.stitches {
        let parents = contact.passes.len() - 1;
        assert_eq!(contact.passes.len(), network.stack(contact.nodes[0]).len());
        assert_eq!(contact.pairs.len(), 2 * parents, "around each of them, not they around each other");
        for [first, second] in &contact.passes {
            assert_eq!(yarn_of[first.index()], yarn_of[second.index()]);
            assert_eq!(first.0.abs_diff(second.0), 1, "a contact is a segment of every yarn in it");
        }
    }
    let system = System::new(network, &yarn, &card);
    assert!(system.coordinates.block_count() >= network.node_count());
    assert!(network.position.iter().all(|x| x.is_finite()));
}

/// What is stacked where, by place on the chart, and which places follow each other along a yarn, without direction.
fn joined(network: &Network) -> Vec<String> {
    let own: Vec<bool> = {
        let mut own = vec![false; network.node_count()];
        network.loops.iter().flat_map(|info| &info.nodes).for_each(|node| own[node.index()] = true);
        own
    };
    let name = |node: NodeId| {
        let [column, row] = network.chart_place[node.index()];
        format!("{column:.3},{row:.3}")
    };
    let mut found = Vec::new();
    for p in 0..network.pass_count() {
        let (a, b) = (network.pass_node[p], network.pass_node[(p + 1) % network.pass_count()]);
        // Where yarns are carried from row to row depends on the way that the rows run.
        let within = !matches!(network.segment_kind[p], SegmentKind::Edge | SegmentKind::Chain);
        if within && own[a.index()] && own[b.index()] {
            let (a, b) = (name(a), name(b));
            found.push(if a < b { format!("{a} {b}") } else { format!("{b} {a}") });
        }
    }
    for node in (0..network.node_count()).filter(|node| own[*node]) {
        let kinds: Vec<_> =
            network.stack(NodeId::new(node)).iter().map(|pass| network.pass_kind[pass.index()]).collect();
        found.push(format!("{} {kinds:?}", name(NodeId::new(node))));
    }
    found.sort();
    found
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn any_chart_becomes_a_sound_network(chart in any_chart()) {
        let (_, card) = cards();
        let mut networks = Vec::new();
        for working in workings() {
            let graph = work(&chart, working);
            check_graph(&graph);
            let network = knit::network(&graph, &card);
            check_network(&graph, &network);
            networks.push(network);
        }
        prop_assert_eq!(joined(&networks[0]), joined(&networks[1]), "the way a row is worked does not show");
        if let Ok(tile) = work_tile(&chart) {
            check_graph(&tile);
            check_network(&tile, &knit::network(&tile, &card));
        }
    }
}

#[test]
fn several_loops_into_one_share_its_head() {
    let (_, card) = cards();
    let network = knit::fabric(&chart(&["kkkkk", "kYk", "kkk"]), Working::default(), &card);
    let parent = network.loops.iter().find(|info| (info.row, info.column) == (0, 1)).unwrap();
    // Own four nodes, and four of each of the two loops knitted into it; the yarn-over between them holds nothing.
    let yarn = network.pass_yarn();
    let passes: Vec<usize> = (0..network.pass_count()).filter(|p| yarn[*p].index() == 0).collect();
    let at = |node: NodeId| passes.iter().copied().filter(|p| network.pass_node[*p] == node).collect::<Vec<_>>();
    let feet = [parent.nodes[0], parent.nodes[3]].map(|node| {
        let own = at(node).into_iter().find(|p| network.pass_kind[*p] == wale::model::PassKind::FootHead);
        own.unwrap()
    });
    assert_eq!(feet[0].abs_diff(feet[1]), 2 + 8 + 2 - 1, "nodes along the loop");
    let shared = network.segment_share.iter().filter(|share| **share == 2).count();
    assert_eq!(shared, 2 * 2 + 3 + 2 * 2, "contacts of the parent, its three heads, and contacts of the two");
    let whole = |share: u8| {
        let lengths = (0..network.pass_count() - 1)
            .filter(|p| network.segment_kind[*p] == SegmentKind::Stitch && network.segment_share[*p] == share);
        lengths.map(|p| network.arc_length[p + 1] - network.arc_length[p]).sum::<f64>()
    };
    assert!((whole(2) / 8.0 - 0.5 * card.stitch_length).abs() < 1e-12);
}

#[test]
fn a_tuck_is_worked_together_with_the_loop_beneath_it() {
    let graph = work(&chart(&["kkk", "kTk", "kkk"]), Working::default());
    let child = graph.loops.iter().find(|of| (of.row, of.column) == (2, 1)).unwrap();
    let rows: Vec<i32> = child.parents.iter().map(|held| graph.of(held.of).row).collect();
    assert_eq!(rows, [0, 1], "the held loop in front, the tuck behind");
    let purled = work(&chart(&["kpk", "kTk", "kkk"]), Working::default());
    let child = purled.loops.iter().find(|of| (of.row, of.column) == (2, 1)).unwrap();
    assert_eq!(child.parents.iter().map(|held| purled.of(held.of).row).collect::<Vec<_>>(), [1, 0]);
}

#[test]
fn a_slipped_loop_is_held_a_row_higher_and_its_yarn_floats() {
    let (_, card) = cards();
    let graph = work(&chart(&["kkkk", "kVVk", "kkkk"]), Working::default());
    assert_eq!(graph.longest_float(), 2);
    let child = graph.loops.iter().find(|of| (of.row, of.column) == (2, 1)).unwrap();
    assert_eq!(graph.of(child.parents[0].of).row, 0);
    let network = knit::network(&graph, &card);
    let longest = (0..network.pass_count() - 1)
        .filter(|p| network.segment_kind[*p] == SegmentKind::Sinker)
        .map(|p| network.arc_length[p + 1] - network.arc_length[p])
        .fold(0.0, f64::max);
    assert!(longest > 2.0 * card.wale_spacing && longest < 3.0 * card.wale_spacing, "{longest}");
}

#[test]
fn a_lifted_strand_is_a_loop_of_the_row_below() {
    let graph = work(&chart(&["kkmkk", "kkkk"]), Working::default());
    let lifted = graph.loops.iter().find(|of| of.form == Form::Lifted).unwrap();
    assert!((lifted.place[0] - 2.5).abs() < 0.1, "{:?}", lifted.place);
    assert_eq!((lifted.row, lifted.children.len()), (0, 1));
    let strand = graph.strands.iter().find(|strand| strand.stops.len() > 4).unwrap();
    let ids: Vec<usize> = strand
        .stops
        .iter()
        .filter_map(|(stop, _)| match stop {
            Stop::Loop { id, .. } => Some(id.index()),
            _ => None,
        })
        .filter(|id| graph.loops[*id].row == 0)
        .collect();
    let at = ids.iter().position(|id| graph.loops[*id].form == Form::Lifted).unwrap();
    let columns: Vec<u32> = ids.iter().map(|id| graph.loops[*id].column).collect();
    // The first row runs from the right.
    assert_eq!((columns[at - 1], columns[at + 1]), (2, 1));
}

#[test]
fn stripes_are_carried_up_the_side_or_cut() {
    let plain = Chart::stockinette().repeat(5, 8).unwrap();
    let strands = |stripes: &[u8]| {
        let graph = work(&plain.clone().striped(stripes), Working::default());
        graph.strands.iter().map(|strand| strand.yarn).collect::<Vec<_>>()
    };
    assert_eq!(strands(&[0]), [0]);
    // Two rows each: every yarn comes back to the side where it is wanted.
    assert_eq!(strands(&[0, 0, 1, 1]), [0, 1]);
    // One row each: the yarn lies at the wrong side and is cut every time.
    let single = strands(&[0, 1]);
    assert_eq!((single.iter().filter(|y| **y == 0).count(), single.iter().filter(|y| **y == 1).count()), (4, 4));
}

#[test]
fn stranded_yarns_float_past_each_other() {
    let yarns = vec![vec![0, 0, 1, 1, 1, 0], vec![0, 0, 1, 1, 1, 0]];
    let graph = work(&Chart::stockinette().repeat(6, 2).unwrap().with_yarns(yarns).unwrap(), Working::default());
    check_graph(&graph);
    assert_eq!(graph.longest_float(), 3);
    assert_eq!(graph.strands.len(), 2);
}

#[test]
fn shaped_rows_lie_above_what_they_are_worked_into() {
    let graph = work(&chart(&["/k\\", "kkkkk", "/kkk\\", "kkkkkkk"]), Working::default());
    for of in graph.loops.iter().filter(|of| !of.parents.is_empty()) {
        let below = of.parents.iter().map(|held| graph.of(held.of).place[0]).sum::<f64>() / of.parents.len() as f64;
        assert!((of.place[0] - below).abs() < 0.8, "{of:?} {below}");
    }
    for pair in graph.loops.windows(2).filter(|pair| pair[0].row == pair[1].row) {
        let apart = pair[1].place[0] - pair[0].place[0];
        assert!((0.7..1.3).contains(&apart), "{apart}");
    }
}
