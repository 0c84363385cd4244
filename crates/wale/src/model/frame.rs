//! A snapshot of a moving fabric: all that pictures and exports see.

use glam::DVec3;

/// What a fabric looks like at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// Simulated time \[s\].
    pub time: f64,
    /// Position of each node \[m\].
    pub positions: Vec<DVec3>,
    /// Rest arc length of each pass \[m\].
    pub sliding: Vec<f64>,
}
