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
/// Inside it is a lattice of equilateral triangles, refined towards the border where that asks for it: rolled up it stores what a
/// cylinder does within six per cent. Test: `a_rolled_up_mesh_stores_what_a_cylinder_does`.
///
/// # Errors
/// [`ShellError::Mesh`] if the outline has less than three corners, crosses itself, or bounds nothing;
/// [`ShellError::Number`] if the edge length is not positive.
pub fn mesh_polygon(outline: &[[f64; 2]], edge: f64) -> Result<TriangleMesh, ShellError> {
    mesh_polygon_through(outline, &[], edge)
}

/// The same with vertices at given places inside \[m\], which lie about an edge apart: a line along which the piece is held.
///
/// # Errors
/// As [`mesh_polygon`].
pub fn mesh_polygon_through(outline: &[[f64; 2]], through: &[[f64; 2]], edge: f64) -> Result<TriangleMesh, ShellError> {
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
    let border = subdivided(outline, edge);
    let mut vertices = Vec::with_capacity(border.len());
    for &[x, y] in &border {
        vertices.push(triangulation.insert(Point2::new(x, y)).map_err(|e| failed(&e))?);
    }
    for k in 0..vertices.len() {
        let (from, to) = (vertices[k], vertices[(k + 1) % vertices.len()]);
        let [x, y] = border[k];
        if from == to {
            return Err(ShellError::Mesh(format!("two corners of the outline lie on each other at {x}, {y}")));
        }
        if !triangulation.can_add_constraint(from, to) {
            return Err(ShellError::Mesh(format!("the outline crosses itself near {x}, {y}")));
        }
        triangulation.add_constraint(from, to);
    }
    for [x, y] in through.iter().copied().chain(lattice_inside(&border, through, edge)) {
        triangulation.insert(Point2::new(x, y)).map_err(|e| failed(&e))?;
    }
    let settings = RefinementParameters::new()
        .exclude_outer_faces(true)
        .with_angle_limit(AngleLimit::from_deg(SMALLEST_ANGLE))
        .with_max_allowed_area(1.5 * equilateral)
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

/// The outline with its sides cut into pieces of at most this length.
fn subdivided(outline: &[[f64; 2]], edge: f64) -> Vec<[f64; 2]> {
    let next = outline.iter().cycle().skip(1);
    outline
        .iter()
        .zip(next)
        .flat_map(|(&[ax, ay], &[bx, by])| {
            let pieces = ((bx - ax).hypot(by - ay) / edge).ceil().max(1.0);
            (0..pieces as usize).map(move |k| {
                let part = k as f64 / pieces;
                [ax + part * (bx - ax), ay + part * (by - ay)]
            })
        })
        .collect()
}

/// Points of a lattice of equilateral triangles inside an outline, those near it or near other points left out.
fn lattice_inside(border: &[[f64; 2]], others: &[[f64; 2]], edge: f64) -> Vec<[f64; 2]> {
    let bound = |axis: usize, of: fn(f64, f64) -> f64, start: f64| border.iter().fold(start, |m, p| of(m, p[axis]));
    let (left, right) = (bound(0, f64::min, f64::INFINITY), bound(0, f64::max, f64::NEG_INFINITY));
    let (bottom, top) = (bound(1, f64::min, f64::INFINITY), bound(1, f64::max, f64::NEG_INFINITY));
    let altitude = 0.75f64.sqrt() * edge;
    let (rows, columns) = (((top - bottom) / altitude) as usize, ((right - left) / edge) as usize + 1);
    let mut points = Vec::new();
    for row in 1..=rows {
        let y = bottom + row as f64 * altitude;
        // Where the outline crosses this height; inside lies between every other two.
        let next = border.iter().cycle().skip(1);
        let mut crossings: Vec<f64> = border
            .iter()
            .zip(next)
            .filter(|(a, b)| (a[1] <= y) != (b[1] <= y))
            .map(|(a, b)| a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
            .collect();
        crossings.sort_by(f64::total_cmp);
        let near: Vec<&[f64; 2]> = border.iter().chain(others).filter(|p| (p[1] - y).abs() < edge).collect();
        for column in 0..=columns {
            let x = left + (column as f64 + 0.5 * (row % 2) as f64) * edge;
            let inside = crossings.partition_point(|&crossing| crossing < x) % 2 == 1;
            // Pieces of the border are no longer than an edge, so their ends are never far.
            if inside && near.iter().all(|p| (p[0] - x).hypot(p[1] - y) > 0.7 * edge) {
                points.push([x, y]);
            }
        }
    }
    points
}

/// Area that an outline runs around counter-clockwise \[m²\].
fn enclosed_area(outline: &[[f64; 2]]) -> f64 {
    let next = outline.iter().cycle().skip(1);
    outline.iter().zip(next).map(|(a, b)| 0.5 * (a[0] * b[1] - a[1] * b[0])).sum()
}

#[cfg(test)]
mod tests {
    use super::super::mesh::Rectangle;
    use super::*;
    use wale::energy::{BendingStiffness, Element, Hinge};

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
            assert!(mesh.areas().all(|a| a > 0.0 && a < 1.51 * 0.25 * 3f64.sqrt() * 0.006 * 0.006));
            let inner = mesh.inner_edges().unwrap().len();
            assert_eq!(mesh.points.len() + mesh.triangles.len(), 3 * mesh.triangles.len() - inner + 1);
        }
    }

    /// Energy of a mesh rolled up about an axis at an angle to its first coordinate, over `k_θ A/R²`, away from
    /// its border. Each edge shares out a third of its triangles.
    fn rolled(mesh: &TriangleMesh, degrees: f64) -> f64 {
        let (radius, (sin, cos)) = (0.2, degrees.to_radians().sin_cos());
        let point = |v: u32| mesh.points[v as usize];
        let place = |[x, y]: [f64; 2]| {
            let across = (cos * y - sin * x) / radius;
            [cos * x + sin * y, radius * across.sin(), radius * across.cos()]
        };
        let (mut energy, mut area) = (0.0, 0.0);
        for edge in mesh.inner_edges().unwrap() {
            let middle = [0, 1].map(|k| 0.5 * (point(edge[0])[k] + point(edge[1])[k]));
            if !((0.01..0.09).contains(&middle[0]) && (0.01..0.05).contains(&middle[1])) {
                continue;
            }
            let hinge = Hinge::new(&BendingStiffness::isotropic(1.0), edge.map(point)).unwrap();
            energy += hinge.energy(&std::array::from_fn(|k| place(point(edge[k / 3]))[k % 3]));
            let triangles = vec![[edge[0], edge[1], edge[2]], [edge[1], edge[0], edge[3]]];
            area += TriangleMesh { points: mesh.points.clone(), triangles }.areas().sum::<f64>() / 3.0;
        }
        energy * radius * radius / area
    }

    #[test]
    fn a_rolled_up_mesh_stores_what_a_cylinder_does() {
        let polygon = mesh_polygon(&[[0.0, 0.0], [0.1, 0.0], [0.1, 0.06], [0.0, 0.06]], 0.003).unwrap();
        let rectangle = Rectangle::new(0.1, 0.06, 0.003).unwrap().mesh;
        for degrees in [0.0, 20.0, 45.0, 70.0, 90.0] {
            let (polygon, rectangle) = (rolled(&polygon, degrees), rolled(&rectangle, degrees));
            assert!((polygon - 1.0).abs() < 0.06, "{degrees}: {polygon}");
            assert!((rectangle - 1.0).abs() < 0.05, "{degrees}: {rectangle}");
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
