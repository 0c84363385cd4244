//! The shadow that a fabric casts on the ground: what drape testers measure.

use std::collections::HashSet;

use crate::model::{Frame, Network};

/// Squares of the raster to a disc's radius.
const FINENESS: f64 = 6.0;

/// Area of a frame's shadow under light from straight above \[m²\].
///
/// Every loop or crossing shades a disc of a cell's diagonal, so that the openings between yarns count as fabric, as they do on
/// a drape tester; what is larger, as an eyelet may be, does not. `cell` is the width and height of a loop or crossing in
/// the layout \[m\].
#[must_use]
pub fn shadow_area(network: &Network, frame: &Frame, cell: [f64; 2]) -> f64 {
    let radius = 0.5 * cell[0].hypot(cell[1]);
    let square = radius / FINENESS;
    let reach = FINENESS.ceil() as i64;
    let mut shaded: HashSet<(i64, i64)> = HashSet::new();
    for info in network.loops.iter().filter(|info| !info.nodes.is_empty()) {
        let sum: glam::DVec3 = info.nodes.iter().map(|node| frame.positions[node.index()]).sum();
        let place = sum / info.nodes.len() as f64;
        let [x, y] = [place.x / square, place.y / square];
        let (column, row) = (x.floor() as i64, y.floor() as i64);
        for i in column - reach..=column + reach {
            for j in row - reach..=row + reach {
                let (dx, dy) = (i as f64 + 0.5 - x, j as f64 + 0.5 - y);
                if dx * dx + dy * dy <= FINENESS * FINENESS {
                    shaded.insert((i, j));
                }
            }
        }
    }
    shaded.len() as f64 * square * square
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::weave::{Draft, Woven};

    #[test]
    fn a_flat_sheet_shades_its_own_area_and_a_hanging_one_hardly_any() {
        let cell = [1e-3, 0.8e-3];
        let network = Woven::new(Draft::plain().repeat(60, 50).unwrap(), cell).network(cell);
        let mut frame = Frame { time: 0.0, positions: network.position.clone(), sliding: network.arc_length.clone() };
        let flat = shadow_area(&network, &frame, cell);
        // Discs reach half a diagonal beyond the outer crossings.
        let reach = 1e-3f64.hypot(0.8e-3);
        let expected = (59e-3 + reach) * (49.0 * 0.8e-3 + reach);
        assert!((flat / expected - 1.0).abs() < 0.01, "{flat} {expected}");
        for x in &mut frame.positions {
            *x = glam::DVec3::new(x.x, x.z, x.y);
        }
        assert!(shadow_area(&network, &frame, cell) < 0.05 * flat);
    }
}
