//! What can go wrong when a shell is tested.

use thiserror::Error;
use wale_numerics::sparse_cholesky::CholeskyError;

/// Why a shell was not tested.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ShellError {
    /// A number on the card or of the test is not what it can be.
    #[error("{what} is {value}, and must be {must}")]
    Number {
        /// Which number.
        what: &'static str,
        /// What it is.
        value: f64,
        /// What it must be.
        must: &'static str,
    },
    /// The outline or the mesh bounds no fabric.
    #[error("the mesh is of no use: {0}")]
    Mesh(String),
    /// The shell did not come to rest; smaller load steps, a coarser mesh or stiffer bending may mend it.
    #[error(
        "the shell did not come to rest at {load}: after {iterations} iterations {residual:.1e} of its forces are left"
    )]
    NotAtRest {
        /// How far the test had come, in words.
        load: String,
        /// Newton iterations of the last try.
        iterations: usize,
        /// Largest force left, over the largest that an element exerts \[–\].
        residual: f64,
    },
    /// All forces balance, but the least push would make the shell leave: a loop that stands too tall, a sheet that sags evenly.
    #[error("{0} is at rest but would not stay so: the least push makes it fall or fold")]
    Unstable(String),
    /// No deformation has zero stress across the strip: it collapses to no width.
    #[error("a strip stretched by {stretch} collapses: without k_n2 nothing keeps its width")]
    Collapsed {
        /// Stretch \[–\].
        stretch: f64,
    },
    /// The linear system is too large, or holds something that is not finite.
    #[error(transparent)]
    Cholesky(#[from] CholeskyError),
    /// There is nothing to fit, or no start led to a model whose tests could be done.
    #[error("nothing was fitted: {0}")]
    Fit(String),
}

/// That a number is positive and finite.
///
/// # Errors
/// [`ShellError::Number`] if not.
pub(crate) fn positive(what: &'static str, value: f64) -> Result<(), ShellError> {
    if value > 0.0 && value < f64::INFINITY {
        return Ok(());
    }
    Err(ShellError::Number { what, value, must: "positive and finite" })
}

/// That a number is not negative, and finite.
///
/// # Errors
/// [`ShellError::Number`] if not.
pub(crate) fn not_negative(what: &'static str, value: f64) -> Result<(), ShellError> {
    if (0.0..f64::INFINITY).contains(&value) {
        return Ok(());
    }
    Err(ShellError::Number { what, value, must: "zero or positive, and finite" })
}
