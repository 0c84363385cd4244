//! A round specimen as a mesh that has a ring of vertices where its support ends.

use std::f64::consts::{PI, TAU};

use crate::shell::TriangleMesh;
use crate::shell::error::{ShellError, positive};
use crate::shell::polygon::mesh_polygon_through;

/// Most edges around a specimen.
const MOST_AROUND: f64 = 1e4;

/// A round specimen on a round support.
#[derive(Clone, Debug, PartialEq)]
pub struct RoundSpecimen {
    /// The mesh, about the origin.
    pub mesh: TriangleMesh,
    /// Which vertices the support holds.
    pub held: Vec<bool>,
}

/// Meshes a round specimen whose middle is held between two discs \[m\].
///
/// Vertices lie in a ring half a row of triangles beyond the discs, and are held: the hinges there then bend for half a row to
/// either side, as all others do, so the cloth is free from the discs' border on. The outline is a polygon as large as the circle.
///
/// # Errors
/// [`ShellError::Number`] if a radius or the edge length is not positive or the specimen is not larger than its support.
pub fn round_specimen(radius: f64, support: f64, edge: f64) -> Result<RoundSpecimen, ShellError> {
    positive("radius of the support", support)?;
    positive("edge length of the mesh", edge)?;
    if TAU * radius / edge > MOST_AROUND {
        let must = "long enough that no more than 10,000 of them go around the specimen";
        return Err(ShellError::Number { what: "edge length of the mesh", value: edge, must });
    }
    let row = 0.75f64.sqrt() * edge;
    let ring = support + 0.5 * row;
    if !(radius > ring + row && radius < f64::INFINITY) {
        let must = "larger than that of the support by two edges of the mesh";
        return Err(ShellError::Number { what: "radius of the specimen", value: radius, must });
    }
    let circle = |radius: f64| {
        let count = (TAU * radius / edge).round().max(12.0);
        (0..count as usize).map(move |k| {
            let (sin, cos) = (TAU * k as f64 / count).sin_cos();
            [radius * cos, radius * sin]
        })
    };
    let count = (TAU * radius / edge).round().max(12.0);
    let grown = radius * (2.0 * PI / count / (2.0 * PI / count).sin()).sqrt();
    let corners = (0..count as usize).map(|k| {
        let (sin, cos) = (TAU * k as f64 / count).sin_cos();
        [grown * cos, grown * sin]
    });
    // Sides of the outline are cut where they are longer than an edge, which they must not be.
    let longest = 1.01 * (2.0 * grown * (PI / count).sin()).max(edge);
    let mesh = mesh_polygon_through(&corners.collect::<Vec<_>>(), &circle(ring).collect::<Vec<_>>(), longest)?;
    let held = mesh.points.iter().map(|[x, y]| x.hypot(*y) < ring + 1e-6 * edge).collect();
    Ok(RoundSpecimen { mesh, held })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_specimen_is_as_large_as_its_circle_and_held_to_a_ring() {
        let specimen = round_specimen(0.15, 0.09, 0.008).unwrap();
        let area: f64 = specimen.mesh.areas().sum();
        assert!((area / (PI * 0.15 * 0.15) - 1.0).abs() < 1e-12, "{area}");
        assert!(specimen.mesh.areas().all(|a| a > 0.0));
        let ring = 0.09 + 0.5 * 0.75f64.sqrt() * 0.008;
        let on_it = specimen.mesh.points.iter().filter(|[x, y]| (x.hypot(*y) - ring).abs() < 1e-9).count();
        assert_eq!(on_it, (TAU * ring / 0.008).round() as usize);
        // Triangles lie on one side of the ring or the other.
        let radius = |v: u32| {
            let [x, y] = specimen.mesh.points[v as usize];
            x.hypot(y) - ring
        };
        assert!(specimen.mesh.triangles.iter().all(|t| {
            let far = t.map(radius);
            far.iter().all(|r| *r < 1e-9) || far.iter().all(|r| *r > -1e-9)
        }));
        assert!(round_specimen(0.09, 0.09, 0.008).is_err());
        assert!(round_specimen(0.15, 0.09, f64::NAN).is_err());
        assert!(round_specimen(0.15, 0.09, 1e-300).is_err());
    }
}
