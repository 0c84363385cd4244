//! Where a run stands, as one word in a file.

use std::fmt;
use std::str::FromStr;

/// Content of the file `STATUS`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Being written, or killed while it was.
    Running,
    /// Came to its end.
    Done,
    /// Stopped by a signal, with a checkpoint.
    Stopped,
    /// Ended by an error, with the program's exit code.
    Failed(u8),
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Running => f.write_str("running"),
            Self::Done => f.write_str("done"),
            Self::Stopped => f.write_str("stopped"),
            Self::Failed(code) => write!(f, "failed:{code}"),
        }
    }
}

impl FromStr for Status {
    type Err = ();

    fn from_str(text: &str) -> Result<Self, ()> {
        match text.trim_end() {
            "running" => Ok(Self::Running),
            "done" => Ok(Self::Done),
            "stopped" => Ok(Self::Stopped),
            other => other.strip_prefix("failed:").and_then(|code| code.parse().ok()).map(Self::Failed).ok_or(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_back() {
        for status in [Status::Running, Status::Done, Status::Stopped, Status::Failed(70)] {
            assert_eq!(format!("{status}\n").parse(), Ok(status));
        }
        for bad in ["", "failed:", "failed:300", "Done"] {
            assert_eq!(bad.parse::<Status>(), Err(()));
        }
    }
}
