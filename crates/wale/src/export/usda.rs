//! USD text: all yarns as one `BasisCurves` prim, with a time sample per frame.
//!
//! The file is written as it is made: each attribute that changes with time asks for all frames once more, so a run
//! of any length needs the memory of one frame. Lengths are in metres, widths are diameters.

use std::io::Write;

use glam::Vec3;

use super::settings::{identifier, one_line};
use super::snapshot::checked;
use super::{ExportError, Settings, Snapshot, Snapshots};

/// Writes USD text (`.usda`).
///
/// One frame is written without time samples. Points are those of the curves, joined by Catmull–Rom splines.
///
/// # Errors
/// [`ExportError::NoFrames`], [`ExportError::Order`], [`ExportError::Changed`] if yarns or point counts differ
/// between frames, [`ExportError::NotFinite`], and what snapshots and the stream return.
pub fn write_usda(out: &mut impl Write, snapshots: &mut dyn Snapshots, settings: &Settings) -> Result<(), ExportError> {
    let count = snapshots.count();
    if count == 0 {
        return Err(ExportError::NoFrames);
    }
    let rate = settings.frames_per_second;
    if !(rate.is_finite() && rate > 0.0) {
        return Err(ExportError::Inconsistent(format!("{rate} frames per second: it must be a positive number")));
    }
    let first = checked(snapshots, 0)?;
    let last_time = checked(snapshots, count - 1)?.time;
    write_header(out, settings, first.time * rate, last_time * rate)?;
    write_constants(out, &first)?;

    let mut animation = Animation {
        snapshots,
        settings,
        layout: layout(&first),
        fields: first.fields.iter().map(|f| f.name.clone()).collect(),
    };
    let mut extents = Vec::with_capacity(count);
    animation.attribute(out, "point3f[] points", "", &mut |out, snapshot| {
        let points: Vec<Vec3> = all_points(snapshot, settings);
        extents.push((snapshot.time, extent(&points, snapshot)));
        list(out, points.iter(), |out, p| write!(out, "({:?}, {:?}, {:?})", p.x, p.y, p.z))
    })?;
    write_extents(out, &extents, rate)?;
    let vertex = "\n            interpolation = \"vertex\"";
    animation.attribute(
        out,
        "float[] primvars:rest_arc_length",
        &format!("{vertex}\n            doc = \"Rest arc length along the yarn [m]\""),
        &mut |out, snapshot| {
            let lengths = snapshot.drawn().flat_map(|(_, curve)| &curve.arc_length);
            list(out, lengths, |out, u| write!(out, "{:?}", *u as f32))
        },
    )?;
    for (k, field) in first.fields.iter().enumerate() {
        let unit = if field.unit.is_empty() { "-" } else { &field.unit };
        animation.attribute(
            out,
            &format!("float[] primvars:{}", identifier(&field.name)),
            &format!("{vertex}\n            doc = \"{} [{}]\"", quoted(&field.name), quoted(unit)),
            &mut |out, snapshot| {
                let values = snapshot
                    .drawn()
                    .flat_map(|(_, curve)| &curve.pass)
                    .map(|pass| snapshot.fields[k].values[*pass as usize]);
                list(out, values, |out, v| write!(out, "{:?}", v as f32))
            },
        )?;
    }
    writeln!(out, "    }}\n}}")?;
    Ok(())
}

fn write_header(out: &mut impl Write, settings: &Settings, start: f64, end: f64) -> Result<(), ExportError> {
    write!(
        out,
        "#usda 1.0
(
    defaultPrim = \"Fabric\"
    doc = \"{}\"
    endTimeCode = {end}
    framesPerSecond = {rate}
    metersPerUnit = 1
    startTimeCode = {start}
    timeCodesPerSecond = {rate}
    upAxis = \"{up}\"
)

def Xform \"Fabric\" (
    kind = \"component\"
)
{{
    def BasisCurves \"Yarns\"
    {{
        uniform token basis = \"catmullRom\"
        uniform token type = \"cubic\"
        uniform token wrap = \"pinned\"
",
        quoted(&settings.title),
        rate = settings.frames_per_second,
        up = settings.up.letter(),
    )?;
    Ok(())
}

/// What does not change with time: counts, widths, colours and yarn numbers.
fn write_constants(out: &mut impl Write, first: &Snapshot) -> Result<(), ExportError> {
    write!(out, "        int[] curveVertexCounts = ")?;
    list(out, first.drawn(), |out, (_, curve)| write!(out, "{}", curve.points.len()))?;
    let mut radii: Vec<f64> = first.drawn().map(|(_, curve)| curve.radius).collect();
    radii.dedup();
    write!(out, "\n        float[] widths = ")?;
    // Renderers refuse widths of kind `vertex` on cubic curves; pinned splines have as many `varying` values.
    let interpolation = if radii.len() <= 1 {
        list(out, radii.iter(), |out, r| write!(out, "{:?}", (2.0 * r) as f32))?;
        "constant"
    } else {
        let widths = first.drawn().flat_map(|(_, c)| std::iter::repeat_n(c.radius, c.points.len()));
        list(out, widths, |out, r| write!(out, "{:?}", (2.0 * r) as f32))?;
        "varying"
    };
    write!(out, " (\n            interpolation = \"{interpolation}\"\n        )\n")?;
    write!(out, "        color3f[] primvars:displayColor = ")?;
    list(out, first.drawn(), |out, (_, curve)| {
        let [r, g, b] = curve.color.map(linear);
        write!(out, "({r:?}, {g:?}, {b:?})")
    })?;
    write!(out, " (\n            interpolation = \"uniform\"\n        )\n")?;
    write!(out, "        int[] primvars:yarn = ")?;
    list(out, first.drawn(), |out, (yarn, _)| write!(out, "{yarn}"))?;
    write!(out, " (\n            interpolation = \"uniform\"\n        )\n")?;
    Ok(())
}

fn write_extents(out: &mut impl Write, extents: &[(f64, [Vec3; 2])], rate: f64) -> Result<(), ExportError> {
    let text = |[a, b]: [Vec3; 2]| format!("[({:?}, {:?}, {:?}), ({:?}, {:?}, {:?})]", a.x, a.y, a.z, b.x, b.y, b.z);
    if let [(_, extent)] = extents {
        writeln!(out, "        float3[] extent = {}", text(*extent))?;
        return Ok(());
    }
    writeln!(out, "        float3[] extent.timeSamples = {{")?;
    for (time, extent) in extents {
        writeln!(out, "            {}: {},", time * rate, text(*extent))?;
    }
    writeln!(out, "        }}")?;
    Ok(())
}

/// The frames of a file, asked for once per attribute.
struct Animation<'a> {
    snapshots: &'a mut dyn Snapshots,
    settings: &'a Settings,
    layout: Vec<(u32, usize)>,
    fields: Vec<String>,
}

impl Animation<'_> {
    /// Writes an attribute with its value in every frame.
    fn attribute<W: Write>(
        &mut self,
        out: &mut W,
        declaration: &str,
        metadata: &str,
        value: &mut dyn FnMut(&mut W, &Snapshot) -> std::io::Result<()>,
    ) -> Result<(), ExportError> {
        let count = self.snapshots.count();
        let metadata = if metadata.is_empty() { String::new() } else { format!(" ({metadata}\n        )") };
        if count == 1 {
            let snapshot = checked(self.snapshots, 0)?;
            write!(out, "        {declaration} = ")?;
            value(out, &snapshot)?;
            writeln!(out, "{metadata}")?;
            return Ok(());
        }
        // Metadata belong to the declaration; samples are a statement of their own.
        if !metadata.is_empty() {
            writeln!(out, "        {declaration}{metadata}")?;
        }
        writeln!(out, "        {declaration}.timeSamples = {{")?;
        let mut last = f64::NEG_INFINITY;
        for index in 0..count {
            let snapshot = checked(self.snapshots, index)?;
            let names = snapshot.fields.iter().map(|f| &f.name);
            if layout(&snapshot) != self.layout || !names.eq(&self.fields) {
                return Err(ExportError::Changed { index });
            }
            if snapshot.time <= last {
                return Err(ExportError::Order { index });
            }
            last = snapshot.time;
            write!(out, "            {}: ", snapshot.time * self.settings.frames_per_second)?;
            value(out, &snapshot)?;
            writeln!(out, ",")?;
        }
        writeln!(out, "        }}")?;
        Ok(())
    }
}

/// The drawn yarns with their point counts: what must not change.
fn layout(snapshot: &Snapshot) -> Vec<(u32, usize)> {
    snapshot.drawn().map(|(yarn, curve)| (yarn, curve.points.len())).collect()
}

fn all_points(snapshot: &Snapshot, settings: &Settings) -> Vec<Vec3> {
    snapshot.drawn().flat_map(|(_, curve)| &curve.points).map(|p| settings.up.turn(*p).as_vec3()).collect()
}

/// The box around the points, wider by half the greatest width, as USD computes it.
fn extent(points: &[Vec3], snapshot: &Snapshot) -> [Vec3; 2] {
    let radius = snapshot.drawn().map(|(_, curve)| (2.0 * curve.radius) as f32 / 2.0).fold(0.0, f32::max);
    let Some(first) = points.first() else {
        return [Vec3::ZERO; 2];
    };
    let (low, high) = points.iter().fold((*first, *first), |(low, high), p| (low.min(*p), high.max(*p)));
    [low - radius, high + radius]
}

/// `[a, b, …]`
fn list<W: Write, T>(
    out: &mut W,
    items: impl Iterator<Item = T>,
    mut one: impl FnMut(&mut W, T) -> std::io::Result<()>,
) -> std::io::Result<()> {
    write!(out, "[")?;
    for (i, item) in items.enumerate() {
        if i > 0 {
            write!(out, ", ")?;
        }
        one(out, item)?;
    }
    write!(out, "]")
}

/// Text for a quoted string of one line.
fn quoted(text: &str) -> String {
    one_line(text).replace('\\', "\\\\").replace('"', "\\\"")
}

/// An sRGB byte as the linear light that `displayColor` is read as.
fn linear(byte: u8) -> f32 {
    let c = f32::from(byte) / 255.0;
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}
