//! Stanford PLY, binary little-endian: yarns as one tube mesh with colours and numbers at the vertices.
//! Lengths in metres.

use std::io::Write;

use super::obj::strands;
use super::settings::{identifier, one_line};
use super::{ExportError, Settings, Snapshot};
use crate::geometry::tube;

/// Writes one snapshot. Vertices carry normal, colour, yarn, rest arc length and the fields.
///
/// # Errors
/// [`ExportError::TooMany`] beyond 2³² vertices, [`ExportError::NotFinite`], and what the stream returns.
pub fn write_ply(out: &mut impl Write, snapshot: &Snapshot, settings: &Settings) -> Result<(), ExportError> {
    snapshot.check()?;
    // Made twice, counted the first time: the header comes first, and all meshes at once would be far larger.
    let (mut vertices, mut faces) = (0u64, 0u64);
    for (_, curve) in snapshot.drawn() {
        for strand in strands(curve, settings) {
            let mesh = tube(&strand, settings.sides);
            vertices += mesh.vertices.len() as u64;
            faces += mesh.faces.len() as u64;
        }
    }
    if vertices > u64::from(u32::MAX) {
        return Err(ExportError::TooMany { what: "vertices", most: u64::from(u32::MAX) });
    }
    write_header(out, snapshot, settings, vertices, faces)?;
    for (yarn, curve) in snapshot.drawn() {
        for strand in strands(curve, settings) {
            let mesh = tube(&strand, settings.sides);
            for ((v, n), i) in mesh.vertices.iter().zip(&mesh.normals).zip(&mesh.curve_point) {
                let i = *i as usize;
                for x in [settings.up.turn(*v), settings.up.turn(*n)] {
                    singles(out, &x.to_array())?;
                }
                out.write_all(&strand.color)?;
                out.write_all(&yarn.to_le_bytes())?;
                singles(out, &[strand.arc_length[i]])?;
                for field in &snapshot.fields {
                    singles(out, &[field.values[strand.pass[i] as usize]])?;
                }
            }
        }
    }
    let mut base = 0u32;
    for (_, curve) in snapshot.drawn() {
        for strand in strands(curve, settings) {
            let mesh = tube(&strand, settings.sides);
            for face in &mesh.faces {
                out.write_all(&[3])?;
                for i in face {
                    out.write_all(&(base + i).to_le_bytes())?;
                }
            }
            base += u32::try_from(mesh.vertices.len()).unwrap_or(0);
        }
    }
    Ok(())
}

fn write_header(
    out: &mut impl Write,
    snapshot: &Snapshot,
    settings: &Settings,
    vertices: u64,
    faces: u64,
) -> Result<(), ExportError> {
    writeln!(out, "ply\nformat binary_little_endian 1.0")?;
    writeln!(out, "comment {}", one_line(&settings.title))?;
    writeln!(out, "comment metres, {} up, {:?} s", settings.up.letter(), snapshot.time)?;
    writeln!(out, "element vertex {vertices}")?;
    for name in ["x", "y", "z", "nx", "ny", "nz"] {
        writeln!(out, "property float {name}")?;
    }
    for name in ["red", "green", "blue"] {
        writeln!(out, "property uchar {name}")?;
    }
    writeln!(out, "property uint yarn\nproperty float rest_arc_length")?;
    for field in &snapshot.fields {
        writeln!(out, "property float {}", identifier(&field.name))?;
    }
    writeln!(out, "element face {faces}\nproperty list uchar uint vertex_indices\nend_header")?;
    Ok(())
}

fn singles(out: &mut impl Write, values: &[f64]) -> std::io::Result<()> {
    values.iter().try_for_each(|v| out.write_all(&(*v as f32).to_le_bytes()))
}
