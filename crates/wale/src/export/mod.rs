//! Fabrics for other tools: yarns as USD, VTK, BCC, OBJ and PLY, tables as CSV. It sees drawn frames, never the solver.

pub mod bcc;
pub mod csv;
pub mod error;
pub mod file;
pub mod format;
pub mod obj;
pub mod ply;
pub mod pvd;
pub mod settings;
pub mod snapshot;
pub mod usda;
pub mod vtp;

pub use bcc::{BccCurve, BccFile, read_bcc, write_bcc};
pub use csv::{Column, Table, write_csv};
pub use error::ExportError;
pub use file::export_file;
pub use format::{Format, UnknownFormat, write};
pub use obj::write_obj;
pub use ply::write_ply;
pub use pvd::write_pvd;
pub use settings::{Settings, UpAxis};
pub use snapshot::{Field, FrameSnapshots, Snapshot, Snapshots};
pub use usda::write_usda;
pub use vtp::write_vtp;

#[cfg(test)]
mod tests;
