//! BCC, the binary curve format of Yuksel's yarn models: uniform Catmull–Rom curves, little-endian single precision.
//!
//! A header of 64 bytes: `BCC`, `0x44` (four-byte integers and floats), `C0` (Catmull–Rom), dimensions, up axis
//! (1 = y, 2 = z), curve count, point count, 40 bytes of text. Each curve is a point count, negative for a closed
//! curve, and the points.

use std::io::{Read, Write};

use glam::{DVec3, Vec3};

use super::settings::one_line;
use super::{ExportError, Settings, Snapshot, UpAxis};
use crate::geometry::Curve;

/// Curves read from a BCC file.
#[derive(Clone, Debug, PartialEq)]
pub struct BccFile {
    /// Axis that points up.
    pub up: UpAxis,
    /// The header's text, without padding.
    pub info: String,
    /// The curves.
    pub curves: Vec<BccCurve>,
}

/// One curve of a BCC file.
#[derive(Clone, Debug, PartialEq)]
pub struct BccCurve {
    /// Control points.
    pub points: Vec<Vec3>,
    /// Whether the last point is joined to the first.
    pub closed: bool,
}

/// Writes one snapshot in metres. Yarns that end where they begin become closed curves.
///
/// # Errors
/// [`ExportError::NotFinite`], [`ExportError::TooMany`] beyond 2³¹ points a yarn, and what the stream returns.
pub fn write_bcc(out: &mut impl Write, snapshot: &Snapshot, settings: &Settings) -> Result<(), ExportError> {
    snapshot.check()?;
    let curves: Vec<(&[DVec3], bool)> = snapshot.drawn().map(|(_, c)| control_points(c)).collect();
    let total: usize = curves.iter().map(|(points, _)| points.len()).sum();
    let mut info = [0u8; 40];
    for (to, from) in info.iter_mut().zip(one_line(&settings.title).bytes()) {
        // Only plain characters, so that the cut never falls inside one.
        *to = if from.is_ascii() { from } else { b'?' };
    }
    let up = match settings.up {
        UpAxis::Y => 1,
        UpAxis::Z => 2,
    };
    out.write_all(&[b'B', b'C', b'C', 0x44, b'C', b'0', 3, up])?;
    out.write_all(&(curves.len() as u64).to_le_bytes())?;
    out.write_all(&(total as u64).to_le_bytes())?;
    out.write_all(&info)?;
    for (points, closed) in curves {
        let count = i32::try_from(points.len())
            .map_err(|_| ExportError::TooMany { what: "points of a yarn", most: i32::MAX as u64 })?;
        out.write_all(&(if closed { -count } else { count }).to_le_bytes())?;
        for point in points {
            for x in settings.up.turn(*point).to_array() {
                out.write_all(&(x as f32).to_le_bytes())?;
            }
        }
    }
    Ok(())
}

/// A curve's points; for a ring without the repeated last one.
fn control_points(curve: &Curve) -> (&[DVec3], bool) {
    match curve.points.as_slice() {
        [first, .., last] if first == last && curve.points.len() > 3 => (&curve.points[..curve.points.len() - 1], true),
        points => (points, false),
    }
}

/// Reads a BCC file of Catmull–Rom curves in three dimensions.
///
/// # Errors
/// [`ExportError::Malformed`] for anything else; counts are believed only as far as there are bytes.
pub fn read_bcc(input: &mut impl Read) -> Result<BccFile, ExportError> {
    let bad = |reason: String| ExportError::Malformed { format: "BCC", reason };
    let mut header = [0u8; 64];
    input.read_exact(&mut header).map_err(|e| bad(format!("no header of 64 bytes: {e}")))?;
    if &header[..4] != b"BCC\x44" {
        return Err(bad("it does not begin with `BCC` and 0x44".into()));
    }
    if &header[4..6] != b"C0" || header[6] != 3 {
        return Err(bad("it has no Catmull-Rom curves in three dimensions".into()));
    }
    let up = match header[7] {
        1 => UpAxis::Y,
        2 => UpAxis::Z,
        other => return Err(bad(format!("its up axis is {other}, not 1 or 2"))),
    };
    let number = |at: usize| {
        let mut bytes = [0u8; 8];
        bytes.copy_from_slice(&header[at..at + 8]);
        u64::from_le_bytes(bytes)
    };
    let (curve_count, total) = (number(8), number(16));
    let mut left = total;
    let mut curves = Vec::new();
    for k in 0..curve_count {
        let mut count = [0u8; 4];
        input.read_exact(&mut count).map_err(|e| bad(format!("it ends before curve {k} of {curve_count}: {e}")))?;
        let signed = i32::from_le_bytes(count);
        let count = u64::from(signed.unsigned_abs());
        left = left
            .checked_sub(count)
            .ok_or_else(|| bad(format!("its curves have more than the {total} points declared")))?;
        // The reader grows with the bytes there are, not with what the count claims.
        let mut bytes = Vec::new();
        input.by_ref().take(count * 12).read_to_end(&mut bytes)?;
        if bytes.len() as u64 != count * 12 {
            return Err(bad(format!("it ends within curve {k}")));
        }
        let points: Vec<Vec3> = bytes
            .chunks_exact(12)
            .map(|b| {
                let x = |i: usize| f32::from_le_bytes([b[i], b[i + 1], b[i + 2], b[i + 3]]);
                Vec3::new(x(0), x(4), x(8))
            })
            .collect();
        if let Some(i) = points.iter().position(|p| !p.is_finite()) {
            return Err(bad(format!("point {i} of curve {k} is not finite")));
        }
        curves.push(BccCurve { points, closed: signed < 0 });
    }
    if left != 0 {
        return Err(bad(format!("its curves lack {left} of {total} points")));
    }
    let text = header[24..].split(|b| *b == 0).next().unwrap_or_default();
    Ok(BccFile { up, info: String::from_utf8_lossy(text).into_owned(), curves })
}
