//! ParaView collection (`.pvd`): which file shows which physical time.

use std::io::Write;

use super::ExportError;
use super::vtp::escaped;

/// Writes a collection of files, each with its time \[s\]; file names are relative to the collection's folder.
///
/// # Errors
/// What the stream returns.
pub fn write_pvd(out: &mut impl Write, files: &[(f64, String)]) -> Result<(), ExportError> {
    writeln!(
        out,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n  <Collection>"
    )?;
    for (time, file) in files {
        writeln!(out, "    <DataSet timestep=\"{time:?}\" group=\"\" part=\"0\" file=\"{}\"/>", escaped(file))?;
    }
    writeln!(out, "  </Collection>\n</VTKFile>")?;
    Ok(())
}
