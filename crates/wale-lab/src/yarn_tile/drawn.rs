//! A tile as curves that can be drawn.

use glam::DVec3;
use wale::geometry::Curve;

use super::tile::{MOST_VERTICES, TileFault, YarnTile};

/// Points that the drawn curve has for each of the tile's.
const PIECES: usize = 4;
/// Colours of yarns along the weft, as those of knits are, and along the warp.
const COLORS: [[u8; 3]; 2] = [[217, 201, 168], [63, 111, 143]];

/// Every yarn of so many repeats beside each other, each from where it comes in to where it goes out; warps have a colour of their own.
/// Of a tile of many vertices there are fewer repeats, at least one.
///
/// # Errors
/// As [`YarnTile::repeated`].
pub fn drawn_curves(tile: &YarnTile, mut repeats: [usize; 2]) -> Result<Vec<Curve>, TileFault> {
    while repeats != [1, 1] && tile.vertex_count() * repeats[0] * repeats[1] > MOST_VERTICES {
        let more = usize::from(repeats[1] > repeats[0]);
        repeats[more] -= 1;
    }
    let patch = tile.repeated(repeats)?;
    let n = patch.vertex_count();
    let (mut next, mut shift) = (vec![0usize; n], vec![[0i32; 2]; n]);
    for edge in patch.edges() {
        next[edge.ends[0] as usize] = edge.ends[1] as usize;
        shift[edge.ends[0] as usize] = edge.shift;
    }
    let place = |vertex: usize| DVec3::from_array(patch.vertices()[vertex]);
    let mut drawn = vec![false; n];
    let mut out = Vec::new();
    // Where a yarn comes in from the repeat beside is where it begins; what is left then closes in itself.
    let begins: Vec<usize> = (0..n).filter(|&v| shift[v] != [0, 0]).map(|v| next[v]).collect();
    for start in begins.into_iter().chain(0..n) {
        let mut points = Vec::new();
        let mut at = start;
        while !drawn[at] {
            drawn[at] = true;
            points.push(place(at));
            if shift[at] != [0, 0] {
                break;
            }
            at = next[at];
        }
        // Yarns of a weave by their direction, those of a knit all the same.
        let along = points.last().map_or(DVec3::ZERO, |last| *last - points[0]);
        let color =
            COLORS[usize::from(along.y.abs() > 2.0 * along.x.abs() && along.y.abs() > 0.5 * patch.periods()[1])];
        if points.len() > 1 {
            out.push(smooth(&points, tile.radius(), color));
        }
    }
    Ok(out)
}

/// A curve through points, by cubics whose slopes are those of the points beside.
fn smooth(points: &[DVec3], radius: f64, color: [u8; 3]) -> Curve {
    let slope = |k: usize| 0.5 * (points[(k + 1).min(points.len() - 1)] - points[k.saturating_sub(1)]);
    let mut curve = Curve { radius, color, ..Curve::default() };
    for k in 0..points.len() - 1 {
        for piece in 0..PIECES {
            let t = piece as f64 / PIECES as f64;
            let (a, b) = (points[k], points[k + 1]);
            let (h, m) = (t * t * (3.0 - 2.0 * t), t * (1.0 - t));
            curve.points.push(a * (1.0 - h) + b * h + slope(k) * (m * (1.0 - t)) - slope(k + 1) * (m * t));
        }
    }
    curve.points.push(points[points.len() - 1]);
    let mut along = 0.0;
    for k in 0..curve.points.len() {
        if k > 0 {
            along += curve.points[k].distance(curve.points[k - 1]);
        }
        curve.arc_length.push(along);
        curve.pass.push(0);
    }
    curve
}

#[cfg(test)]
mod tests {
    use super::super::test_tiles::{basket, stockinette};
    use super::*;

    #[test]
    fn every_vertex_is_drawn_once() {
        for tile in [basket(), stockinette()] {
            let curves = drawn_curves(&tile, [3, 2]).unwrap();
            let pieces: usize = curves.iter().map(|curve| (curve.points.len() - 1) / PIECES + 1).sum();
            assert_eq!(pieces, 6 * tile.vertex_count());
            for vertex in tile.repeated([3, 2]).unwrap().vertices() {
                let at = DVec3::from_array(*vertex);
                assert!(curves.iter().any(|curve| curve.points.iter().any(|p| p.distance(at) < 1e-12)), "{at}");
            }
        }
    }
}
