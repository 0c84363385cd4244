//! A yarn as a smooth curve.

use glam::DVec3;

/// The centre line of one yarn, sampled finely enough to draw as straight pieces.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// Points of the centre line \[m\].
    pub points: Vec<DVec3>,
    /// Rest arc length at each point \[m\].
    pub arc_length: Vec<f64>,
    /// For each point, the pass at or before it (an index into the network's passes).
    pub pass: Vec<u32>,
    /// Radius of the yarn \[m\].
    pub radius: f64,
    /// Colour, sRGB.
    pub color: [u8; 3],
}
