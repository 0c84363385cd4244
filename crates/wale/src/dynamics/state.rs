//! The state of a simulation: everything the next step depends on, and nothing else.

/// All that changes while a fabric moves. A clone of it is a checkpoint.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Simulated time \[s\].
    pub time: f64,
    /// Steps taken so far.
    pub step: u64,
    /// Length of the next step that the controller would try \[s\].
    pub next_step_size: f64,
    /// Coordinates, five slots a block: a node's position \[m\] and the sliding coordinates of its passes \[m\].
    pub coordinates: Vec<f64>,
    /// Velocities of the coordinates \[m/s\].
    pub velocities: Vec<f64>,
    /// Friction anchor of each pass \[m\].
    pub anchors: Vec<f64>,
    /// Contact points that obstacles hold by friction, five numbers a held node: node, obstacle, and the place in
    /// the obstacle's own frame \[m\].
    pub obstacle_anchors: Vec<f64>,
    /// Numbers that grips remember (for instance the work done so far \[J\]), in the order of the grips.
    pub grip_memory: Vec<f64>,
}
