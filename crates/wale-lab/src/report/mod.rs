//! What a fit is told by: tables of curves and errors, plots beside the data, conclusions of ablations, and a page that needs no other
//! file [after Sperl2022, Figs. 11 and 13 to 18]; and the page of virtual tests.

mod conclusion;
mod curves;
mod document;
mod errors;
mod figures;
mod page;
mod tests_page;

pub use conclusion::{Conclusion, conclusion, sum_of_squares};
pub use curves::{ablations_csv, curves_csv};
pub use errors::{DirectionErrors, ShellErrors, bending_error, shell_errors, yarn_errors};
pub use figures::{ablation_figure, curves_figure};
pub use page::page;
pub use tests_page::{MadeTest, PrintedGroup, is_tests_page, tests_page};

use crate::fabric_file::FabricFile;
use crate::shell::of_fabric::ShellFit;
use crate::yarn_fit::ablation::Ablated;
use crate::yarn_fit::problem::YarnProblem;
use crate::yarn_fit::run::YarnFit;

/// All that is told of one fabric.
#[derive(Clone, Copy, Debug)]
pub struct Told<'a> {
    /// The fabric and its tests.
    pub fabric: &'a FabricFile,
    /// Its shell.
    pub shell: &'a ShellFit,
    /// Its yarn with the problem that it solves, if it was fitted.
    pub yarn: Option<(&'a YarnProblem, &'a YarnFit)>,
    /// The same yarn fitted by less, or otherwise.
    pub ablated: &'a [Ablated],
    /// Why ablations are missing, in words.
    pub missing: &'a [String],
}
