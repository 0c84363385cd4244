//! Which nodes of a fabric have come near each other that are not knitted near each other.

use std::collections::HashMap;

use glam::DVec3;
use rayon::prelude::*;

/// Finds pairs of nodes by cells of a grid; keeps its memory.
///
/// It looks further than it was asked to, and looks again only when nodes have moved against each other by as much; what
/// it finds does not depend on when it looked.
#[derive(Clone, Debug, Default)]
pub struct Nearby {
    /// Where the nodes were when it looked last, how far it looked, and what it found.
    places: Vec<DVec3>,
    looked: f64,
    candidates: Vec<[u32; 2]>,
    /// Cell and node, sorted.
    cells: Vec<(u64, u32)>,
    /// Pairs by parts of the nodes, and the pairs given last.
    parts: Vec<Vec<[u32; 2]>>,
    pairs: Vec<[u32; 2]>,
    /// First of each cell's nodes.
    start: HashMap<u64, u32>,
}

/// How much further than asked it looks.
const FURTHER: f64 = 1.4;
/// Nodes of a part.
const PART: usize = 1024;
/// Bits of a cell's number along one axis.
const BITS: u32 = 21;

impl Nearby {
    /// Pairs of nodes `(a, b)`, `a < b`, nearer than `reach` \[m\] now and at least `apart` \[m\] apart in the layout,
    /// in order of `a`, then `b`.
    pub fn find(
        &mut self,
        now: impl Fn(usize) -> DVec3 + Sync,
        layout: &[DVec3],
        reach: f64,
        apart: f64,
    ) -> &[[u32; 2]] {
        if self.places.len() != layout.len() || reach + 2.0 * self.moved(&now) > self.looked {
            self.looked = FURTHER * reach;
            self.look(&now, layout, apart);
            self.places.clear();
            self.places.extend((0..layout.len()).map(&now));
        }
        self.pairs.clear();
        let near = |pair: &&[u32; 2]| now(pair[0] as usize).distance_squared(now(pair[1] as usize)) < reach * reach;
        self.pairs.extend(self.candidates.iter().filter(near));
        &self.pairs
    }

    /// The furthest that a node has moved since the last look against the mean of all \[m\].
    fn moved(&self, now: &(impl Fn(usize) -> DVec3 + Sync)) -> f64 {
        let count = self.places.len();
        let mean = (0..count).map(|k| now(k) - self.places[k]).sum::<DVec3>() / count.max(1) as f64;
        let squares = self.places.par_iter().with_min_len(4096).enumerate();
        squares.map(|(k, place)| (now(k) - *place - mean).length_squared()).reduce(|| 0.0, f64::max).sqrt()
    }

    /// Finds the candidates.
    fn look(&mut self, now: &(impl Fn(usize) -> DVec3 + Sync), layout: &[DVec3], apart: f64) {
        let reach = self.looked;
        let count = layout.len();
        let origin = (0..count).map(now).fold(DVec3::INFINITY, DVec3::min);
        let cell_of = |x: DVec3| ((x - origin) / reach).floor().as_u64vec3() + 1;
        let key = |x: u64, y: u64, z: u64| {
            let mask = (1 << BITS) - 1;
            (z & mask) << (2 * BITS) | (y & mask) << BITS | (x & mask)
        };
        self.cells.clear();
        self.cells.extend((0..count).map(|node| {
            let cell = cell_of(now(node));
            (key(cell.x, cell.y, cell.z), node as u32)
        }));
        self.cells.par_sort_unstable();
        self.start.clear();
        for (place, &(cell, _)) in self.cells.iter().enumerate() {
            self.start.entry(cell).or_insert(place as u32);
        }
        self.parts.resize_with(count.div_ceil(PART), Vec::new);
        let (cells, start) = (&self.cells, &self.start);
        let (reach2, apart2) = (reach * reach, apart * apart);
        let near = |a: usize, found: &mut Vec<[u32; 2]>| {
            let (before, x) = (found.len(), now(a));
            let cell = cell_of(x);
            for z in cell.z - 1..=cell.z + 1 {
                for y in cell.y - 1..=cell.y + 1 {
                    for x_cell in cell.x - 1..=cell.x + 1 {
                        let there = key(x_cell, y, z);
                        let Some(&first) = start.get(&there) else { continue };
                        let nodes = cells[first as usize..].iter().take_while(|(cell, _)| *cell == there);
                        for &(_, b) in nodes {
                            if b as usize > a
                                && x.distance_squared(now(b as usize)) < reach2
                                && layout[a].distance_squared(layout[b as usize]) >= apart2
                            {
                                found.push([a as u32, b]);
                            }
                        }
                    }
                }
            }
            found[before..].sort_unstable();
        };
        self.parts.par_iter_mut().enumerate().for_each(|(part, found)| {
            found.clear();
            (part * PART..count.min((part + 1) * PART)).for_each(|a| near(a, found));
        });
        self.candidates.clear();
        self.candidates.extend(self.parts.iter().flatten());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_pairs_that_looking_at_all_of_them_finds() {
        // A sheet of 20 × 20 rolled into a tube of two turns.
        let layout: Vec<DVec3> = (0..400).map(|k| DVec3::new(f64::from(k % 20), f64::from(k / 20), 0.0)).collect();
        let rolled: Vec<DVec3> = layout
            .iter()
            .map(|x| {
                let angle = x.y * std::f64::consts::TAU / 9.5;
                let radius = 1.5 - 0.01 * x.y;
                DVec3::new(x.x, radius * angle.cos(), radius * angle.sin())
            })
            .collect();
        let mut all = Vec::new();
        for a in 0..400usize {
            for b in a + 1..400 {
                if rolled[a].distance(rolled[b]) < 0.8 && layout[a].distance(layout[b]) > 3.0 {
                    all.push([a as u32, b as u32]);
                }
            }
        }
        assert!(all.len() > 100);
        let mut nearby = Nearby::default();
        for _ in 0..2 {
            assert_eq!(nearby.find(|k| rolled[k], &layout, 0.8, 3.0), all);
        }
        // Moved as a whole, a little, and far.
        let shift = DVec3::new(5.0, -2.0, 1.0);
        assert_eq!(nearby.find(|k| rolled[k] + shift, &layout, 0.8, 3.0), all);
        let near = |k: usize| rolled[k] * 0.6;
        let mut fresh = Nearby::default();
        assert_eq!(nearby.find(near, &layout, 0.8, 3.0), fresh.find(near, &layout, 0.8, 3.0));
        assert_ne!(fresh.pairs, all);
        assert!(nearby.find(|k| layout[k], &layout, 0.8, 3.0).is_empty());
    }
}
