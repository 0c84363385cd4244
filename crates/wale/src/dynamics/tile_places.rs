//! Where in a block-sparse matrix the second derivatives of elements go.

use std::sync::Arc;

use wale_numerics::block_pattern::BlockPattern;

use crate::fabric::coordinates::{BLOCK, Dof};
use crate::fabric::elements::ElementSet;

/// Values of a block.
const BLOCK_VALUES: usize = BLOCK * BLOCK;

/// The pattern of all blocks that elements couple, and the place in its values of every second derivative: element by element, column
/// by column. `own` is the slot that a coordinate follows.
pub(super) fn places_of(
    sets: &[&dyn ElementSet],
    block_count: usize,
    own: impl Fn(Dof) -> usize,
) -> (Arc<BlockPattern>, Vec<u32>) {
    let mut blocks = Vec::new();
    let blocks_of = |stencil: &[Dof], blocks: &mut Vec<usize>| {
        blocks.clear();
        blocks.extend(stencil.iter().map(|&dof| own(dof) / BLOCK));
        blocks.sort_unstable();
        blocks.dedup();
    };
    let mut pairs = Vec::new();
    for_each_stencil(sets, |stencil| {
        blocks_of(stencil, &mut blocks);
        pairs.extend(blocks.iter().flat_map(|&a| blocks.iter().map(move |&b| (a as u32, b as u32))));
    });
    let pattern = Arc::new(BlockPattern::from_pairs(block_count, pairs));
    let mut places = Vec::new();
    let (mut positions, mut slots) = (Vec::new(), Vec::new());
    for_each_stencil(sets, |stencil| {
        blocks_of(stencil, &mut blocks);
        let position = |a: usize, b: usize| pattern.position(a, b).expect("what an element couples meets");
        positions.clear();
        positions.extend(blocks.iter().flat_map(|&a| blocks.iter().map(move |&b| position(a, b))));
        let within = |slot: usize| blocks.binary_search(&(slot / BLOCK)).expect("a block of the stencil");
        slots.clear();
        slots.extend(stencil.iter().map(|&dof| [own(dof) % BLOCK, within(own(dof))]));
        for &[column, b] in &slots {
            for &[row, a] in &slots {
                places.push((BLOCK_VALUES * positions[a * blocks.len() + b] + BLOCK * column + row) as u32);
            }
        }
    });
    (pattern, places)
}

fn for_each_stencil(sets: &[&dyn ElementSet], mut visit: impl FnMut(&[Dof])) {
    for set in sets {
        set.stencils(&mut visit);
    }
}
