//! How far a run has come: a bar with the time left on a terminal, a plain line every few seconds elsewhere.

use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::output::{note, span};

/// Between two plain lines.
const LINE_INTERVAL: Duration = Duration::from_secs(5);
/// Positions of the bar.
const BAR_LENGTH: u64 = 10_000;

/// Progress of one run, told on standard error.
#[derive(Debug)]
pub struct Progress {
    voice: Voice,
    began: Instant,
    /// Simulated time at the beginning and at the end \[s\].
    span: [f64; 2],
    steps: u64,
}

#[derive(Debug)]
enum Voice {
    Silent,
    Bar(ProgressBar),
    Lines { last: Instant },
}

impl Progress {
    /// Begins at a simulated time, towards another \[s\].
    #[must_use]
    pub fn new(from: f64, to: f64, quiet: bool) -> Self {
        let voice = if quiet {
            Voice::Silent
        } else if io::stderr().is_terminal() {
            let bar = ProgressBar::with_draw_target(Some(BAR_LENGTH), ProgressDrawTarget::stderr());
            if let Ok(style) = ProgressStyle::with_template("{bar:30} {percent:>3} %  {msg}") {
                bar.set_style(style);
            }
            Voice::Bar(bar)
        } else {
            Voice::Lines { last: Instant::now() }
        };
        Self { voice, began: Instant::now(), span: [from, to], steps: 0 }
    }

    /// A step has been taken, and the simulated time is now `time` \[s\].
    pub fn step(&mut self, time: f64, detail: &str) {
        self.steps += 1;
        let elapsed = self.began.elapsed().as_secs_f64();
        let [from, to] = self.span;
        let left = time_left(elapsed, (time - from) / (to - from));
        let text = || {
            format!(
                "{time:.3} of {to:.3} s simulated, {} left, {:.1} steps/s, {detail}",
                span(left),
                self.steps as f64 / elapsed.max(1e-9),
            )
        };
        match &mut self.voice {
            Voice::Silent => {}
            Voice::Bar(bar) => {
                let share = if to > 0.0 { (time / to).clamp(0.0, 1.0) } else { 1.0 };
                bar.set_position((share * BAR_LENGTH as f64) as u64);
                bar.set_message(text());
            }
            Voice::Lines { last } => {
                if last.elapsed() >= LINE_INTERVAL {
                    note(&text());
                    *last = Instant::now();
                }
            }
        }
    }

    /// Takes the bar away.
    pub fn end(&self) {
        if let Voice::Bar(bar) = &self.voice {
            bar.finish_and_clear();
        }
    }

    /// Wall time since the beginning \[s\], and the steps taken in it.
    #[must_use]
    pub fn spent(&self) -> (f64, u64) {
        (self.began.elapsed().as_secs_f64(), self.steps)
    }
}

/// Wall time left \[s\] when a share of the simulated time took `elapsed` seconds.
fn time_left(elapsed: f64, share: f64) -> f64 {
    if share > 0.0 { (elapsed / share - elapsed).max(0.0) } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_left_is_in_proportion() {
        assert!((time_left(10.0, 0.25) - 30.0).abs() < 1e-12);
        assert_eq!(time_left(10.0, 0.0), f64::INFINITY);
        assert_eq!(time_left(10.0, f64::NAN), f64::INFINITY);
        assert_eq!(time_left(10.0, 1.5), 0.0);
    }
}
