//! Measured curves: tables as instruments and spreadsheets write them, read into SI numbers.
//!
//! ```
//! use wale_lab::curve::{Request, Specimen, StretchCurve, Table, TableFormat};
//!
//! let text = "Extension (mm);Load (cN)\n0;0\n10;12,5\n20;40\n";
//! let table = Table::from_text(text, "weft.csv", TableFormat::default())?;
//! let specimen = Specimen { length: 0.1, width: 0.06 };
//! let curve = StretchCurve::of(&table, &Request::default(), specimen)?;
//! assert!((curve.stretch[1] - 0.1).abs() < 1e-12);
//! assert!((curve.force[1] - 0.125).abs() < 1e-12);
//! assert_eq!(curve.read_as[1], "force: column 2, \"Load (cN)\", in cN");
//! assert_eq!(curve.table_read_as, "table: semicolon between cells, decimal comma, 1 line before the numbers, 3 rows");
//! # Ok::<(), wale_lab::curve::CurveError>(())
//! ```

mod bending;
mod columns;
mod error;
mod find;
mod layout;
mod stretch;
mod table;
mod units;

pub use bending::LoopCurve;
pub use columns::{ColumnName, Meaning, Request};
pub use error::CurveError;
pub use layout::{Decimal, Delimiter, TableFormat};
pub use stretch::{Specimen, StretchCurve};
pub use table::Table;
