//! Ctrl-C and SIGTERM end a run after the step that is being taken; a second one ends it at once.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use crate::exit::Code;

/// Flags that the operating system's signals raise.
#[derive(Clone, Debug)]
pub struct Signals {
    interrupted: Arc<AtomicBool>,
    terminated: Arc<AtomicBool>,
    checkpoint: Arc<AtomicBool>,
}

impl Signals {
    /// Listens from now on.
    ///
    /// # Errors
    /// When the operating system does not let us.
    pub fn listen() -> io::Result<Self> {
        let raise = |signal| -> io::Result<Arc<AtomicBool>> {
            let raised = Arc::new(AtomicBool::new(false));
            // In this order: the first signal finds the flag down and raises it, the second finds it up.
            flag::register_conditional_default(signal, Arc::clone(&raised))?;
            flag::register(signal, Arc::clone(&raised))?;
            Ok(raised)
        };
        let checkpoint = Arc::new(AtomicBool::new(false));
        #[cfg(unix)]
        flag::register(signal_hook::consts::SIGUSR1, Arc::clone(&checkpoint))?;
        Ok(Self { interrupted: raise(SIGINT)?, terminated: raise(SIGTERM)?, checkpoint })
    }

    /// How to end, once a signal has asked for it.
    #[must_use]
    pub fn stop(&self) -> Option<Code> {
        if self.interrupted.load(Ordering::Relaxed) {
            Some(Code::Interrupted)
        } else if self.terminated.load(Ordering::Relaxed) {
            Some(Code::Terminated)
        } else {
            None
        }
    }

    /// Whether SIGUSR1 has asked for a checkpoint since the last call.
    #[must_use]
    pub fn take_checkpoint_request(&self) -> bool {
        self.checkpoint.swap(false, Ordering::Relaxed)
    }
}
