//! Why a test was not made, in a form that travels.

use std::fmt::Display;
use std::path::Path;

use serde::{Deserialize, Serialize};
use wale_lab::network_fit::SceneFitError;
use wale_lab::shell::ShellError;
use wale_lab::swatch_test::SwatchTestError;
use wale_lab::uniform_test::UniformTestError;

use crate::exit::{Code, Failure};

/// What kind of failure it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// The fabric or a number of the test is not what it can be.
    BadInput,
    /// The test is larger than is done.
    ResourceLimit,
    /// The specimen did not come to rest.
    NotConverged,
}

/// Why a test was not made.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TestFailure {
    kind: Kind,
    message: String,
}

impl TestFailure {
    /// One that a person can mend.
    pub fn bad_input(message: impl Display) -> Self {
        Self { kind: Kind::BadInput, message: message.to_string() }
    }

    /// Numbers that are none.
    pub fn not_converged(message: impl Display) -> Self {
        Self { kind: Kind::NotConverged, message: message.to_string() }
    }

    /// As the program ends with it, of a fabric.
    pub fn of(self, fabric: &Path) -> Failure {
        let code = match self.kind {
            Kind::BadInput => Code::BadInput,
            Kind::ResourceLimit => Code::ResourceLimit,
            Kind::NotConverged => Code::NotConverged,
        };
        Failure::new(code, format_args!("{}: {}", fabric.display(), self.message))
    }
}

impl From<ShellError> for TestFailure {
    fn from(error: ShellError) -> Self {
        match error {
            ShellError::Number { .. } | ShellError::Mesh(_) => Self::bad_input(error),
            _ => Self::not_converged(error),
        }
    }
}

impl From<UniformTestError> for TestFailure {
    fn from(error: UniformTestError) -> Self {
        match error {
            UniformTestError::Number { .. } => Self::bad_input(error),
            _ => Self::not_converged(error),
        }
    }
}

impl From<SceneFitError> for TestFailure {
    fn from(error: SceneFitError) -> Self {
        match error {
            SceneFitError::Pull(_) | SceneFitError::Fit(_) => Self::not_converged(error),
            _ => Self::bad_input(error),
        }
    }
}

impl From<SwatchTestError> for TestFailure {
    fn from(error: SwatchTestError) -> Self {
        let kind = match error {
            SwatchTestError::Number { .. }
            | SwatchTestError::NoChart
            | SwatchTestError::Sett
            | SwatchTestError::Chart(_) => Kind::BadInput,
            SwatchTestError::TooLarge { .. } => Kind::ResourceLimit,
            _ => Kind::NotConverged,
        };
        Self { kind, message: error.to_string() }
    }
}
