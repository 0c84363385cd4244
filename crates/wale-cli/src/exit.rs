//! How the program ends: one clear error, one exit code for each kind of it, and no panic that looks like one.

use std::fmt;
use std::panic::{self, AssertUnwindSafe};
use std::path::Path;
use std::process::ExitCode;

use wale::record::RecordError;

/// Exit codes, as the manual lists them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Code {
    /// The command line does not make sense.
    Usage = 2,
    /// A scene, a chart or a run folder does not make sense.
    BadInput = 3,
    /// The task is larger than the machine or the limit given.
    ResourceLimit = 4,
    /// The solver did not converge; the last good state is kept.
    NotConverged = 5,
    /// The disk is full, or not to be written or read.
    Io = 6,
    /// A bug in wale.
    Bug = 70,
    /// Stopped by Ctrl-C.
    Interrupted = 130,
    /// Stopped by SIGTERM.
    Terminated = 143,
}

/// Why a command ended without success.
#[derive(Debug)]
pub struct Failure {
    /// The exit code.
    pub code: Code,
    /// What to tell; nothing when it has been told already.
    pub message: Option<String>,
}

impl Failure {
    /// A failure with something to tell.
    pub fn new(code: Code, message: impl fmt::Display) -> Self {
        Self { code, message: Some(format!("error: {message}")) }
    }

    /// A failure whose message is a report with the place underlined.
    pub fn report(code: Code, report: &miette::Report) -> Self {
        Self { code, message: Some(format!("{report:?}").trim_end().to_owned()) }
    }

    /// An end that has been told already.
    pub fn silent(code: Code) -> Self {
        Self { code, message: None }
    }

    /// A failure to read or write a file of the user's.
    pub fn io(path: &Path, doing: &'static str, error: std::io::Error) -> Self {
        RecordError::from_io(path, doing, error).into()
    }
}

impl From<RecordError> for Failure {
    fn from(error: RecordError) -> Self {
        let code = match &error {
            RecordError::Missing { .. } | RecordError::NotEmpty { .. } => Code::BadInput,
            error if error.is_bad_content() => Code::BadInput,
            _ => Code::Io,
        };
        Self::new(code, error)
    }
}

/// Runs the program to its exit code; a panic becomes [`Code::Bug`] and one clear line.
pub fn guard(program: impl FnOnce() -> Result<(), Failure>) -> ExitCode {
    panic::set_hook(Box::new(|panic| {
        let place = panic.location().map_or_else(String::new, |place| format!(" at {place}"));
        let message = panic
            .payload()
            .downcast_ref::<String>()
            .map(String::as_str)
            .or_else(|| panic.payload().downcast_ref::<&str>().copied())
            .unwrap_or("no message");
        crate::output::note(&format!(
            "wale: a bug, not your fault: {message}{place}; please report this line with the scene file. \
             Checkpoints are whole: `wale resume` goes on from the last."
        ));
    }));
    match panic::catch_unwind(AssertUnwindSafe(program)) {
        Ok(Ok(())) => ExitCode::SUCCESS,
        Ok(Err(failure)) => {
            if let Some(message) = failure.message {
                crate::output::note(&message);
            }
            ExitCode::from(failure.code as u8)
        }
        Err(_) => ExitCode::from(Code::Bug as u8),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_end_has_its_code() {
        let ends = |code| guard(move || Err(Failure::silent(code)));
        assert_eq!(guard(|| Ok(())), ExitCode::SUCCESS);
        assert_eq!(ends(Code::NotConverged), ExitCode::from(5));
        assert_eq!(ends(Code::Terminated), ExitCode::from(143));
        assert_eq!(guard(|| panic!("on purpose")), ExitCode::from(70));
        let _ = panic::take_hook();
    }

    #[test]
    fn a_bad_folder_is_input_and_a_full_disk_is_not() {
        let path = Path::new("x").to_path_buf();
        let code = |error: RecordError| Failure::from(error).code;
        assert_eq!(code(RecordError::DiskFull { path: path.clone() }), Code::Io);
        assert_eq!(code(RecordError::Missing { path: path.clone() }), Code::BadInput);
        assert_eq!(code(RecordError::OtherScene { path }), Code::BadInput);
    }
}
