//! Small fabrics made by hand, for the tests of drawing and export.

use glam::DVec3;

use crate::model::{Network, NodeId, PassId, PassKind, SegmentKind, YarnRole};

/// `columns` warps over and under `rows` wefts, `spacing` \[m\] apart, with a free end of half a spacing everywhere.
///
/// Wefts come first. At a crossing whose column and row sum to an even number the weft is in front.
pub(crate) fn plain_weave(columns: usize, rows: usize, spacing: f64) -> Network {
    let mut network = Network { yarn_start: vec![0], ..Network::default() };
    for row in 0..rows {
        for column in 0..columns {
            network.position.push(DVec3::new(column as f64, row as f64, 0.0) * spacing);
        }
    }
    let mut stacks = vec![Vec::new(); rows * columns];
    let mut lay = |crossings: Vec<(usize, bool)>, step: DVec3, color: [u8; 3], role: YarnRole| {
        let first = network.position[crossings[0].0] - step * 0.5;
        let last = network.position[crossings[crossings.len() - 1].0] + step * 0.5;
        let ends = [network.position.len(), network.position.len() + 1];
        network.position.extend([first, last]);
        stacks.extend([Vec::new(), Vec::new()]);
        let mut nodes = vec![(ends[0], false)];
        nodes.extend(&crossings);
        nodes.push((ends[1], false));
        let start = network.position[ends[0]];
        for &(node, in_front) in &nodes {
            let pass = PassId::new(network.pass_node.len());
            if in_front {
                stacks[node].insert(0, pass);
            } else {
                stacks[node].push(pass);
            }
            network.pass_node.push(NodeId::new(node));
            network.pass_image.push([0, 0]);
            network.pass_kind.push(PassKind::Edge);
            network.pass_slides.push(node < rows * columns);
            network.segment_kind.push(SegmentKind::Edge);
            network.segment_share.push(1);
            network.arc_length.push(network.position[node].distance(start));
        }
        network.yarn_start.push(u32::try_from(network.pass_node.len()).unwrap_or(u32::MAX));
        network.yarn_closure.push(None);
        network.yarn_kind.push(0);
        network.yarn_role.push(role);
        network.yarn_color.push(color);
    };
    for row in 0..rows {
        let crossings = (0..columns).map(|c| (row * columns + c, (row + c) % 2 == 0)).collect();
        lay(crossings, DVec3::X * spacing, [220, 200, 160], YarnRole::Weft);
    }
    for column in 0..columns {
        let crossings = (0..rows).map(|r| (r * columns + column, (r + column) % 2 == 1)).collect();
        lay(crossings, DVec3::Y * spacing, [60, 90, 160], YarnRole::Warp);
    }
    network.front = vec![DVec3::Z; network.position.len()];
    network.set_stacks(&stacks);
    network
}
