//! Which nodes of a fabric a grip holds.

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::ops::Range;

use super::{Network, NodeId, YarnId};

/// A part of a fabric, independent of how many nodes it has.
#[derive(Clone, Debug, PartialEq)]
pub enum Selection {
    /// Every node.
    All,
    /// The outermost loops along an edge, and the cast-on, bind-off or selvedge nodes that hang on them.
    Edge {
        /// Which edge, seen from the front.
        edge: Edge,
        /// How many loops deep, at least 1.
        depth: u32,
    },
    /// The loops where a horizontal and a vertical edge meet, and the edge nodes that hang on them.
    Corner {
        /// `Bottom` or `Top`.
        horizontal: Edge,
        /// `Left` or `Right`.
        vertical: Edge,
        /// How many loops deep along both edges, at least 1.
        depth: u32,
    },
    /// A range of loops, and the edge nodes that hang on them.
    Loops {
        /// Rows of the chart from 0 at the cast-on; `None` for all.
        rows: Option<Range<u32>>,
        /// Columns of the chart from 0 at the left; `None` for all.
        columns: Option<Range<u32>>,
    },
    /// The first or last nodes of the lengths of a yarn.
    YarnEnd {
        /// The yarn by its number.
        yarn: u8,
        /// Which length of it, counted from 0; all if `None`.
        length: Option<u32>,
        /// Which of its ends.
        end: WhichEnd,
    },
    /// The nodes whose initial world position lies in a box.
    Region {
        /// Smallest corner \[m\].
        low: DVec3,
        /// Largest corner \[m\].
        high: DVec3,
    },
}

/// Ends of a yarn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum WhichEnd {
    /// Where it was begun.
    First,
    /// Where it was cut off.
    Last,
    /// Both of these.
    Both,
}

/// An edge of a fabric as seen from the front.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Edge {
    /// The first column.
    Left,
    /// The last column.
    Right,
    /// The cast-on edge.
    Bottom,
    /// The bind-off edge.
    Top,
}

impl Selection {
    /// The selected nodes in ascending order.
    ///
    /// `positions` are the initial world positions \[m\], one per node of the network; only [`Selection::Region`]
    /// reads them.
    #[must_use]
    pub fn nodes(&self, network: &Network, positions: &[DVec3]) -> Vec<NodeId> {
        let [row_count, column_count] = network.chart_size;
        match self {
            Self::All => (0..network.node_count()).map(NodeId::new).collect(),
            Self::Region { low, high } => (0..network.node_count())
                .filter(|&i| positions[i].cmpge(*low).all() && positions[i].cmple(*high).all())
                .map(NodeId::new)
                .collect(),
            Self::YarnEnd { yarn, length, end } => {
                let of_kind = (0..network.yarn_count()).filter(|&y| network.yarn_kind[y] == *yarn);
                let chosen = of_kind.enumerate().filter(|(k, _)| length.is_none_or(|length| length as usize == *k));
                let passes =
                    chosen.map(|(_, y)| network.yarn_passes(YarnId::new(y))).filter(|passes| !passes.is_empty());
                let places = passes.flat_map(|passes| match end {
                    WhichEnd::First => vec![passes.start],
                    WhichEnd::Last => vec![passes.end - 1],
                    WhichEnd::Both => vec![passes.start, passes.end - 1],
                });
                let ends: BTreeSet<NodeId> = places.map(|pass| network.pass_node[pass]).collect();
                ends.into_iter().collect()
            }
            Self::Edge { edge, depth } => {
                loops_and_edges(network, |row, column| edge.reaches(*depth, row, column, row_count, column_count))
            }
            Self::Corner { horizontal, vertical, depth } => loops_and_edges(network, |row, column| {
                [horizontal, vertical].iter().all(|edge| edge.reaches(*depth, row, column, row_count, column_count))
            }),
            Self::Loops { rows, columns } => loops_and_edges(network, |row, column| {
                rows.as_ref().is_none_or(|range| range.contains(&row))
                    && columns.as_ref().is_none_or(|range| range.contains(&column))
            }),
        }
    }
}

impl Edge {
    /// Whether a loop is among the `depth` outermost of this edge.
    fn reaches(self, depth: u32, row: u32, column: u32, rows: u32, columns: u32) -> bool {
        match self {
            Self::Left => column < depth,
            Self::Right => column.saturating_add(depth) >= columns,
            Self::Bottom => row < depth,
            Self::Top => row.saturating_add(depth) >= rows,
        }
    }
}

/// Nodes of the chosen loops, and the nodes of no loop that are next to them along a yarn.
fn loops_and_edges(network: &Network, chosen: impl Fn(u32, u32) -> bool) -> Vec<NodeId> {
    let mut in_loop = vec![false; network.node_count()];
    let mut selected = BTreeSet::new();
    for info in &network.loops {
        for node in &info.nodes {
            in_loop[node.index()] = true;
        }
        if chosen(info.row, info.column) {
            selected.extend(info.nodes.iter().copied());
        }
    }
    let mut hanging = BTreeSet::new();
    for yarn in network.yarn_start.windows(2) {
        let passes = &network.pass_node[yarn[0] as usize..yarn[1] as usize];
        for pair in passes.windows(2) {
            for (a, b) in [(pair[0], pair[1]), (pair[1], pair[0])] {
                if selected.contains(&a) && !in_loop[b.index()] {
                    hanging.insert(b);
                }
            }
        }
    }
    selected.extend(hanging);
    selected.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::LoopInfo;

    /// Two rows of two loops of one node each, between a cast-on node (0) and an end node (5).
    fn small() -> Network {
        let node = |n: usize| NodeId::new(n);
        let stitch = |n: usize, row, column| LoopInfo { row, column, nodes: vec![node(n)], knit: true, held: true };
        Network {
            pass_node: [0, 2, 1, 3, 4, 5].map(node).to_vec(),
            yarn_start: vec![0, 6],
            yarn_kind: vec![0],
            position: (0..6).map(|i| DVec3::new(f64::from(i), 0.0, 0.0)).collect(),
            loops: vec![stitch(1, 0, 0), stitch(2, 0, 1), stitch(3, 1, 0), stitch(4, 1, 1)],
            chart_size: [2, 2],
            ..Network::default()
        }
    }

    fn picked(selection: &Selection) -> Vec<usize> {
        let network = small();
        let nodes = selection.nodes(&network, &network.position);
        nodes.into_iter().map(NodeId::index).collect()
    }

    #[test]
    fn selections_pick_loops_and_what_hangs_on_them() {
        let edge = |edge| picked(&Selection::Edge { edge, depth: 1 });
        assert_eq!(edge(Edge::Left), [1, 3]);
        assert_eq!(edge(Edge::Right), [0, 2, 4, 5]);
        assert_eq!(edge(Edge::Bottom), [0, 1, 2]);
        assert_eq!(edge(Edge::Top), [3, 4, 5]);
        let corner = Selection::Corner { horizontal: Edge::Top, vertical: Edge::Right, depth: 1 };
        assert_eq!(picked(&corner), [4, 5]);
        let loops = Selection::Loops { rows: Some(0..1), columns: Some(0..1) };
        assert_eq!(picked(&loops), [1]);
        let deep = Selection::Edge { edge: Edge::Top, depth: 9 };
        assert_eq!(picked(&deep), [0, 1, 2, 3, 4, 5]);
        let region = Selection::Region { low: DVec3::new(0.5, -1.0, -1.0), high: DVec3::new(2.5, 1.0, 1.0) };
        assert_eq!(picked(&region), [1, 2]);
        assert_eq!(picked(&Selection::All).len(), 6);
        assert_eq!(picked(&Selection::YarnEnd { yarn: 0, length: None, end: WhichEnd::First }), [0]);
        assert_eq!(picked(&Selection::YarnEnd { yarn: 0, length: Some(0), end: WhichEnd::Last }), [5]);
        assert_eq!(picked(&Selection::YarnEnd { yarn: 0, length: None, end: WhichEnd::Both }), [0, 5]);
        assert!(picked(&Selection::YarnEnd { yarn: 1, length: None, end: WhichEnd::Last }).is_empty());
    }
}
