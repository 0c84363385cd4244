//! Wavefront OBJ: yarns as tubes, one object a yarn, with vertex colours. Lengths in metres.

use std::io::Write;

use super::settings::one_line;
use super::{ExportError, Settings, Snapshot};
use crate::geometry::{Curve, ply_curves, tube};

/// Writes one snapshot.
///
/// # Errors
/// [`ExportError::NotFinite`] and what the stream returns.
pub fn write_obj(out: &mut impl Write, snapshot: &Snapshot, settings: &Settings) -> Result<(), ExportError> {
    snapshot.check()?;
    writeln!(out, "# {}", one_line(&settings.title))?;
    writeln!(out, "# metres, {} up, {:?} s", settings.up.letter(), snapshot.time)?;
    let mut base = 1u64;
    for (yarn, curve) in snapshot.drawn() {
        writeln!(out, "o yarn_{yarn}")?;
        let [r, g, b] = curve.color.map(|c| f32::from(c) / 255.0);
        for strand in strands(curve, settings) {
            let mesh = tube(&strand, settings.sides);
            for v in &mesh.vertices {
                let p = settings.up.turn(*v).as_vec3();
                writeln!(out, "v {:?} {:?} {:?} {r:.4} {g:.4} {b:.4}", p.x, p.y, p.z)?;
            }
            for n in &mesh.normals {
                let n = settings.up.turn(*n);
                writeln!(out, "vn {:.4} {:.4} {:.4}", n.x, n.y, n.z)?;
            }
            for face in &mesh.faces {
                let [a, b, c] = face.map(|i| base + u64::from(i));
                writeln!(out, "f {a}//{a} {b}//{b} {c}//{c}")?;
            }
            base += mesh.vertices.len() as u64;
        }
    }
    Ok(())
}

/// The curves that tubes are drawn around: the yarn, or its plies.
pub(super) fn strands(curve: &Curve, settings: &Settings) -> Vec<Curve> {
    ply_curves(curve, settings.plies, settings.twist)
}
