//! A tube around a curve, as a triangle mesh.

use std::f64::consts::TAU;

use glam::DVec3;

use super::Curve;
use super::parallel_transport::transported_frames;

/// A triangle mesh with a normal at each vertex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TubeMesh {
    /// Vertices \[m\].
    pub vertices: Vec<DVec3>,
    /// Unit normals, outwards, one per vertex.
    pub normals: Vec<DVec3>,
    /// Triangles as indices of vertices, counter-clockwise seen from outside.
    pub faces: Vec<[u32; 3]>,
    /// Point of the curve that each vertex belongs to.
    pub curve_point: Vec<u32>,
}

/// The tube around a curve, `sides` (at least 3) flat sides around, with flat caps at both ends.
///
/// Vertices: one ring of `sides` per curve point, then for each cap a ring with the cap's normal.
/// A curve of less than two points gives an empty mesh.
#[must_use]
pub fn tube(curve: &Curve, sides: usize) -> TubeMesh {
    let sides = sides.max(3);
    let n = curve.points.len();
    let mut mesh = TubeMesh::default();
    if n < 2 {
        return mesh;
    }
    let frames = transported_frames(&curve.points);
    let index = |i: usize| u32::try_from(i).unwrap_or(u32::MAX);
    for (i, (point, (tangent, normal))) in curve.points.iter().zip(&frames).enumerate() {
        let binormal = tangent.cross(*normal);
        for k in 0..sides {
            let (sin, cos) = (TAU * k as f64 / sides as f64).sin_cos();
            let outward = *normal * cos + binormal * sin;
            mesh.vertices.push(*point + outward * curve.radius);
            mesh.normals.push(outward);
            mesh.curve_point.push(index(i));
        }
    }
    for i in 0..n - 1 {
        for k in 0..sides {
            let next = (k + 1) % sides;
            let [a, b] = [i * sides + k, i * sides + next].map(index);
            let [c, d] = [(i + 1) * sides + k, (i + 1) * sides + next].map(index);
            mesh.faces.extend([[a, b, d], [a, d, c]]);
        }
    }
    for (i, normal) in [(0, -frames[0].0), (n - 1, frames[n - 1].0)] {
        let start = mesh.vertices.len();
        for k in 0..sides {
            mesh.vertices.push(mesh.vertices[i * sides + k]);
            mesh.normals.push(normal);
            mesh.curve_point.push(index(i));
        }
        for k in 1..sides - 1 {
            let [a, b, c] = [start, start + k, start + k + 1].map(index);
            mesh.faces.push(if i == 0 { [a, c, b] } else { [a, b, c] });
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    fn volume(mesh: &TubeMesh) -> f64 {
        mesh.faces
            .iter()
            .map(|face| {
                let [a, b, c] = face.map(|i| mesh.vertices[i as usize]);
                a.dot(b.cross(c)) / 6.0
            })
            .sum()
    }

    #[test]
    fn the_tube_of_a_straight_yarn_is_a_closed_prism_facing_outwards() {
        let curve = Curve {
            points: vec![DVec3::ONE, DVec3::new(1.0, 1.0, 2.0), DVec3::new(1.0, 1.0, 4.0)],
            arc_length: vec![0.0, 1.0, 3.0],
            pass: vec![0, 0, 1],
            radius: 0.1,
            color: [0; 3],
        };
        let mesh = tube(&curve, 64);
        let prism = 3.0 * 64.0 / 2.0 * 0.01 * (TAU / 64.0).sin();
        assert!((volume(&mesh) - prism).abs() < 1e-12, "{}", volume(&mesh));
        for face in &mesh.faces {
            let [a, b, c] = face.map(|i| i as usize);
            let flat = (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).normalize();
            assert!(flat.dot(mesh.normals[a]) > 0.9);
        }
    }

    #[test]
    fn a_bent_tube_encloses_its_length_times_its_section() {
        let points: Vec<DVec3> = (0..=400)
            .map(|i| {
                let t = f64::from(i) * 0.02;
                DVec3::new(t.cos(), t.sin(), 0.3 * t)
            })
            .collect();
        let curve = Curve {
            arc_length: vec![0.0; points.len()],
            pass: vec![0; points.len()],
            points,
            radius: 0.05,
            color: [0; 3],
        };
        // Pappus: length of the helix times the section.
        let expected = 8.0 * (1.0f64 + 0.09).sqrt() * std::f64::consts::PI * 0.0025;
        let found = volume(&tube(&curve, 48));
        assert!((found / expected - 1.0).abs() < 5e-3, "{found} {expected}");
    }

    #[test]
    fn too_short_curves_have_no_tube() {
        assert_eq!(tube(&Curve::default(), 8), TubeMesh::default());
    }
}
