//! Meshes of specimens on the bias, whose edges run along both yarns.
//!
//! Stiff yarns that shear easily divide such a specimen into zones with borders along yarns. Triangles that no border runs along
//! cannot follow: with yarns 1500 times stiffer than shear they made the specimen half again as stiff at edges of a tenth of its width.

use crate::shell::error::{ShellError, positive};
use crate::shell::mesh::{Rectangle, TriangleMesh};

/// Most vertices of a mesh.
const MOST_VERTICES: f64 = 2e6;

/// A rectangle of squares that stand on a corner, each cut in two, with sides of about this length \[m\].
///
/// Sides run at 45° where length and width are commensurable, and within a few degrees of it elsewhere.
///
/// # Errors
/// [`ShellError::Number`] if a length is not positive, [`ShellError::Mesh`] if there would be millions of triangles.
pub fn bias_rectangle(length: f64, width: f64, edge: f64) -> Result<Rectangle, ShellError> {
    positive("length of the specimen", length)?;
    positive("width of the specimen", width)?;
    positive("edge length of the mesh", edge)?;
    let least = (width / (2f64.sqrt() * edge)).round().max(2.0);
    if 4.0 * least * least * length / width > MOST_VERTICES {
        return Err(ShellError::Mesh(format!(
            "edges of {edge} m cut {length} m × {width} m into millions of triangles"
        )));
    }
    // Squares across and along; along an even number, so that a row lies at mid-length. Of a few sizes the squarest.
    let along = |across: f64| (2.0 * (0.5 * across * length / width).round()).max(2.0);
    let skew = |across: f64| (along(across) * width / (across * length)).ln().abs();
    let across =
        (0..5).map(|more| least + f64::from(more)).min_by(|a, b| skew(*a).total_cmp(&skew(*b))).unwrap_or(least);
    let (across, along) = (across as usize, along(across) as usize);
    let (mut points, mut rows) = (Vec::new(), Vec::new());
    for row in 0..=2 * along {
        let start = points.len();
        let x = length * (row as f64 / (2 * along) as f64);
        points.extend((row % 2..=2 * across).step_by(2).map(|j| [x, width * (j as f64 / (2 * across) as f64)]));
        rows.push(start..points.len());
    }
    let vertex = |row: usize, j: usize| (rows[row].start + j / 2) as u32;
    let mut triangles = Vec::new();
    for row in 0..=2 * along {
        for j in ((row + 1) % 2..=2 * across).step_by(2) {
            // The middle of a square, or of half a one at the border.
            let left = (row > 0).then(|| vertex(row - 1, j));
            let right = (row < 2 * along).then(|| vertex(row + 1, j));
            let below = (j > 0).then(|| vertex(row, j - 1));
            let above = (j < 2 * across).then(|| vertex(row, j + 1));
            match (left, right, below, above) {
                (Some(l), Some(r), Some(b), Some(a)) => triangles.extend([[b, a, l], [b, r, a]]),
                (None, Some(r), Some(b), Some(a)) => triangles.push([b, r, a]),
                (Some(l), None, Some(b), Some(a)) => triangles.push([b, a, l]),
                (Some(l), Some(r), None, Some(a)) => triangles.push([l, r, a]),
                (Some(l), Some(r), Some(b), None) => triangles.push([l, b, r]),
                _ => {}
            }
        }
    }
    Ok(Rectangle { mesh: TriangleMesh { points, triangles }, rows, length, width })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rectangle_is_covered_once_by_halves_of_squares_along_both_yarns() {
        for (length, width, edge) in [(0.15, 0.05, 0.005), (0.05, 0.2, 0.004), (0.11, 0.047, 0.004)] {
            let rectangle = bias_rectangle(length, width, edge).unwrap();
            let mesh = &rectangle.mesh;
            assert!((mesh.areas().sum::<f64>() / (length * width) - 1.0).abs() < 1e-12);
            assert!(mesh.areas().all(|a| a > 0.0));
            let inner = mesh.inner_edges().unwrap().len();
            assert_eq!(mesh.points.len() + mesh.triangles.len(), 3 * mesh.triangles.len() - inner + 1);
            let middle = rectangle.middle();
            assert_eq!(mesh.points[middle.start][1], 0.0);
            assert!((mesh.points[middle.end - 1][0] - 0.5 * length).abs() < 1e-12);
            assert_eq!(mesh.points[middle.end - 1][1], width);
            // Two sides of each triangle lie within three degrees of a yarn.
            for t in &mesh.triangles {
                let slope = |k: usize| {
                    let [p, q] = [t[k], t[(k + 1) % 3]].map(|v| mesh.points[v as usize]);
                    (q[1] - p[1]).abs().atan2((q[0] - p[0]).abs()).to_degrees()
                };
                assert_eq!((0..3).filter(|&k| (slope(k) - 45.0).abs() < 3.0).count(), 2);
            }
        }
        assert!(bias_rectangle(0.1, 0.05, 1e-7).is_err() && bias_rectangle(0.1, -0.05, 0.01).is_err());
    }
}
