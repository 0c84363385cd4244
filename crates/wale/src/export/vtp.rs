//! VTK PolyData (`.vtp`): one frame's yarns as polylines, for ParaView.
//!
//! Arrays follow the XML as raw little-endian bytes. The Tube filter reads the point array `radius`.

use std::io::Write;

use super::settings::{identifier, one_line};
use super::{ExportError, Settings, Snapshot};

/// One array of the file.
struct Array {
    section: Section,
    name: String,
    unit: String,
    kind: &'static str,
    components: usize,
    bytes: Vec<u8>,
}

#[derive(Clone, Copy, PartialEq)]
enum Section {
    PointData,
    CellData,
    Points,
    Lines,
}

/// Writes one snapshot. Point data: radius, rest arc length, pass and the fields; cell data: yarn and colour.
///
/// # Errors
/// [`ExportError::NotFinite`] and what the stream returns.
pub fn write_vtp(out: &mut impl Write, snapshot: &Snapshot, settings: &Settings) -> Result<(), ExportError> {
    snapshot.check()?;
    let arrays = arrays(snapshot, settings);
    let points: usize = snapshot.drawn().map(|(_, c)| c.points.len()).sum();
    writeln!(
        out,
        "<?xml version=\"1.0\"?>
<!-- {} -->
<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">
  <PolyData>
    <FieldData>
      <DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">{:?}</DataArray>
    </FieldData>
    <Piece NumberOfPoints=\"{points}\" NumberOfVerts=\"0\" NumberOfLines=\"{}\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">",
        // Two hyphens would end the comment.
        one_line(&settings.title).replace("--", "- -").trim_end_matches('-'),
        snapshot.time,
        snapshot.drawn().count(),
    )?;
    let mut offset = 0;
    for (section, tag) in [
        (Section::PointData, "PointData"),
        (Section::CellData, "CellData"),
        (Section::Points, "Points"),
        (Section::Lines, "Lines"),
    ] {
        writeln!(out, "      <{tag}>")?;
        for array in arrays.iter().filter(|a| a.section == section) {
            write!(
                out,
                "        <DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{offset}\"",
                array.kind, array.name, array.components
            )?;
            if array.unit.is_empty() {
                writeln!(out, "/>")?;
            } else {
                writeln!(
                    out,
                    ">\n          <InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">{}</InformationKey>\n        </DataArray>",
                    escaped(&array.unit)
                )?;
            }
            offset += 8 + array.bytes.len();
        }
        writeln!(out, "      </{tag}>")?;
    }
    write!(out, "    </Piece>\n  </PolyData>\n  <AppendedData encoding=\"raw\">\n_")?;
    for array in &arrays {
        out.write_all(&(array.bytes.len() as u64).to_le_bytes())?;
        out.write_all(&array.bytes)?;
    }
    writeln!(out, "\n  </AppendedData>\n</VTKFile>")?;
    Ok(())
}

/// All arrays, in the order of the file.
fn arrays(snapshot: &Snapshot, settings: &Settings) -> Vec<Array> {
    let array = |section, name: &str, unit: &str, kind, components, bytes| Array {
        section,
        name: identifier(name),
        unit: unit.to_owned(),
        kind,
        components,
        bytes,
    };
    let curves = || snapshot.drawn().map(|(_, curve)| curve);
    let passes = || curves().flat_map(|c| &c.pass);
    let radii = curves().flat_map(|c| std::iter::repeat_n(c.radius, c.points.len()));
    let lengths = curves().flat_map(|c| c.arc_length.iter().copied());
    let pass_bytes = passes().flat_map(|p| p.to_le_bytes()).collect();
    let point = Section::PointData;
    let mut arrays = vec![
        array(point, "radius", "m", "Float32", 1, singles(radii)),
        array(point, "rest_arc_length", "m", "Float32", 1, singles(lengths)),
        array(point, "pass", "", "UInt32", 1, pass_bytes),
    ];
    for field in &snapshot.fields {
        let values = passes().map(|p| field.values[*p as usize]);
        let bytes = singles(values);
        arrays.push(array(point, &field.name, &field.unit, "Float32", 1, bytes));
    }
    let yarns = snapshot.drawn().flat_map(|(yarn, _)| yarn.to_le_bytes());
    let colors = curves().flat_map(|c| c.color);
    let places = curves().flat_map(|c| &c.points).flat_map(|p| settings.up.turn(*p).to_array());
    let count: usize = curves().map(|c| c.points.len()).sum();
    let connectivity = (0..count as u64).flat_map(u64::to_le_bytes).collect();
    let mut end = 0u64;
    let offsets = curves()
        .flat_map(|c| {
            end += c.points.len() as u64;
            end.to_le_bytes()
        })
        .collect();
    arrays.extend([
        array(Section::CellData, "yarn", "", "UInt32", 1, yarns.collect()),
        array(Section::CellData, "color", "", "UInt8", 3, colors.collect()),
        array(Section::Points, "Points", "m", "Float32", 3, singles(places)),
        array(Section::Lines, "connectivity", "", "Int64", 1, connectivity),
        array(Section::Lines, "offsets", "", "Int64", 1, offsets),
    ]);
    arrays
}

/// Numbers as single-precision little-endian bytes.
fn singles(values: impl Iterator<Item = f64>) -> Vec<u8> {
    values.flat_map(|v| (v as f32).to_le_bytes()).collect()
}

/// Text for XML.
pub(super) fn escaped(text: &str) -> String {
    one_line(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
