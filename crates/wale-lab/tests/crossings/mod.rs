//! Where yarns of a tile cross in the plane, and whether they close: found without any of the code that makes tiles.

use glam::{DVec2, DVec3};
use wale_lab::yarn_tile::{Edge, YarnTile};

/// A crossing of two edges of a tile in the plane: the edges, those images, and heights of both there.
pub struct Crossing {
    pub edges: [usize; 2],
    pub at: DVec2,
    pub directions: [DVec2; 2],
    pub heights: [f64; 2],
}

fn ends(tile: &YarnTile, edge: &Edge, shift: [i32; 2]) -> [DVec3; 2] {
    let at = |vertex: u32, shift: [i32; 2]| {
        let [px, py] = tile.periods();
        DVec3::from(tile.vertices()[vertex as usize])
            + DVec3::new(f64::from(shift[0]) * px, f64::from(shift[1]) * py, 0.0)
    };
    [at(edge.ends[0], shift), at(edge.ends[1], [shift[0] + edge.shift[0], shift[1] + edge.shift[1]])]
}

/// All crossings, each once, found without any of the page's own search.
pub fn crossings(tile: &YarnTile) -> Vec<Crossing> {
    let mut found: Vec<Crossing> = Vec::new();
    let edges = tile.edges();
    for (a, first) in edges.iter().enumerate() {
        let [p, q] = ends(tile, first, [0, 0]);
        for (b, second) in edges.iter().enumerate().skip(a) {
            for shift in (-3..=3).flat_map(|i| (-3..=3).map(move |j| [i, j])) {
                let [r, s] = ends(tile, second, shift);
                let (d, e, f) = ((q - p).truncate(), (s - r).truncate(), (r - p).truncate());
                let turn = d.perp_dot(e);
                let (t, u) = (f.perp_dot(e) / turn, f.perp_dot(d) / turn);
                // Edges that share a vertex meet at an end of both, to within rounding.
                let meet = [q.distance(r), p.distance(s)].iter().any(|distance| *distance < 1e-9);
                let on = |part: f64| (-1e-9..=1.0 + 1e-9).contains(&part);
                if meet || turn == 0.0 || !on(t) || !on(u) {
                    continue;
                }
                let at = p.truncate() + t * d;
                let heights = [p.z + t * (q.z - p.z), r.z + u * (s.z - r.z)];
                // At a vertex it is met on both of its edges.
                let apart = |other: &Crossing| {
                    let off = other.at - at;
                    let [px, py] = tile.periods();
                    DVec2::new(off.x - px * (off.x / px).round(), off.y - py * (off.y / py).round()).length()
                };
                if found.iter().all(|other| apart(other) > 1e-9) {
                    found.push(Crossing { edges: [a, b], at, directions: [d, e], heights });
                }
            }
        }
    }
    found
}

/// Over how many periods each yarn leads before it is itself again.
pub fn closings(tile: &YarnTile) -> Vec<[i32; 2]> {
    let mut left: Vec<Option<&Edge>> = vec![None; tile.vertex_count()];
    tile.edges().iter().for_each(|edge| left[edge.ends[0] as usize] = Some(edge));
    let mut found = Vec::new();
    for first in 0..left.len() {
        let (mut at, mut sum) = (first, [0, 0]);
        let began = left[first].is_some();
        while let Some(edge) = left[at].take() {
            sum = [sum[0] + edge.shift[0], sum[1] + edge.shift[1]];
            at = edge.ends[1] as usize;
        }
        if began {
            assert_eq!(at, first, "a yarn ends elsewhere than it began");
            found.push(sum);
        }
    }
    found
}

/// That yarns touch at every crossing, two radii apart.
pub fn assert_touching(crossings: &[Crossing], radius: f64) {
    for crossing in crossings {
        let gap = (crossing.heights[0] - crossing.heights[1]).abs() / radius;
        assert!((gap - 2.0).abs() < 1e-4, "edges {:?} are {gap} radii apart", crossing.edges);
    }
}
