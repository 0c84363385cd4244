//! Meshes of any outline, by constrained Delaunay triangulation with refinement.

use spade::{AngleLimit, ConstrainedDelaunayTriangulation, Point2, RefinementParameters, Triangulation};

use super::error::{ShellError, positive};
use super::mesh::TriangleMesh;

/// Smallest angle that refinement asks for \[°\]; it ends for certain up to about 30°.
const SMALLEST_ANGLE: f64 = 28.0;
/// Most vertices of a mesh: beyond them a mistyped unit is likelier than a large cloth.
const MOST_VERTICES: f64 = 2e6;

/// Meshes the inside of a polygon, whose corners come in order either way round \[m\], with edges of about this length \[m\].
///
/// Its triangles are not all equilateral, so a hinge stores a curved patch's energy within a tenth or so where
/// [`Rectangle`](super::mesh::Rectangle) does within two per cent.
///
/// # Errors
/// [`ShellError::Mesh`] if the outline has less than three corners, crosses itself, or bounds nothing;
/// [`ShellError::Number`] if the edge length is not positive.
pub fn mesh_polygon(outline: &[[f64; 2]], edge: f64) -> Result<TriangleMesh, ShellError> {
    positive("edge length of the mesh", edge)?;
    let area = enclosed_area(outline).abs();
    let equilateral = 0.25 * 3f64.sqrt() * edge * edge;
    // Written so that a NaN fails.
    if outline.len() < 3 || !(area > 0.0 && area < f64::INFINITY) {
        return Err(ShellError::Mesh("the outline bounds no area".into()));
    }
    if area / equilateral > MOST_VERTICES {
        return Err(ShellError::Mesh(format!("edges of {edge} m cut {area} m² into millions of triangles")));
    }
    let failed = |error: &dyn std::fmt::Display| ShellError::Mesh(format!("the outline cannot be meshed: {error}"));
    let mut triangulation = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    let mut corners = Vec::with_capacity(outline.len());
    for &[x, y] in outline {
        corners.push(triangulation.insert(Point2::new(x, y)).map_err(|e| failed(&e))?);
    }
    for k in 0..corners.len() {
        let (from, to) = (corners[k], corners[(k + 1) % corners.len()]);
        if from == to {
            return Err(ShellError::Mesh(format!("corner {k} of the outline lies on another")));
        }
        if !triangulation.can_add_constraint(from, to) {
            return Err(ShellError::Mesh(format!("the outline crosses itself at its side {k}")));
        }
        triangulation.add_constraint(from, to);
    }
    let settings = RefinementParameters::new()
        .exclude_outer_faces(true)
        .with_angle_limit(AngleLimit::from_deg(SMALLEST_ANGLE))
        .with_max_allowed_area(1.3 * equilateral)
        .with_max_additional_vertices((20.0 * area / equilateral) as usize + 1000);
    let mut outside = triangulation.refine(settings).excluded_faces;
    outside.sort_unstable();
    let mut names = vec![u32::MAX; triangulation.num_vertices()];
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for face in triangulation.inner_faces() {
        if outside.binary_search(&face.fix()).is_ok() {
            continue;
        }
        triangles.push(face.vertices().map(|vertex| {
            let name = &mut names[vertex.fix().index()];
            if *name == u32::MAX {
                *name = points.len() as u32;
                points.push([vertex.position().x, vertex.position().y]);
            }
            *name
        }));
    }
    if triangles.is_empty() {
        return Err(ShellError::Mesh("the outline bounds no area".into()));
    }
    Ok(TriangleMesh { points, triangles })
}

/// Area that an outline runs around counter-clockwise \[m²\].
fn enclosed_area(outline: &[[f64; 2]]) -> f64 {
    let next = outline.iter().cycle().skip(1);
    outline.iter().zip(next).map(|(a, b)| 0.5 * (a[0] * b[1] - a[1] * b[0])).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_outline_with_a_bay_is_covered_once() {
        let outline = [[0.0, 0.0], [0.2, 0.0], [0.2, 0.1], [0.1, 0.03], [0.0, 0.1]];
        for turned in [false, true] {
            let mut outline = outline;
            if turned {
                outline.reverse();
            }
            let mesh = mesh_polygon(&outline, 0.006).unwrap();
            assert!((mesh.areas().sum::<f64>() - enclosed_area(&outline).abs()).abs() < 1e-12);
            assert!(mesh.areas().all(|a| a > 0.0 && a < 1.31 * 0.25 * 3f64.sqrt() * 0.006 * 0.006));
            let inner = mesh.inner_edges().unwrap().len();
            assert_eq!(mesh.points.len() + mesh.triangles.len(), 3 * mesh.triangles.len() - inner + 1);
        }
    }

    #[test]
    fn outlines_that_are_none_are_errors() {
        let bow = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.5]];
        assert!(mesh_polygon(&bow, 0.1).unwrap_err().to_string().contains("crosses itself"));
        assert!(mesh_polygon(&[[0.0, 0.0], [1.0, 0.0]], 0.1).is_err());
        assert!(mesh_polygon(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]], 0.1).is_err());
        assert!(mesh_polygon(&[[0.0, 0.0], [1.0, 0.0], [f64::NAN, 1.0]], 0.1).is_err());
        assert!(mesh_polygon(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], 0.0).is_err());
        assert!(mesh_polygon(&[[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 1.0]], 0.1).is_err());
    }
}
