//! Grips at work: which slots they hold, where, and with what force.

use glam::DVec3;

use super::state::State;
use crate::fabric::Coordinates;
use crate::fabric::coordinates::BLOCK;
use crate::model::{Drive, Grip, Network, NodeId};

/// What a grip did in a step.
#[derive(Clone, Debug, PartialEq)]
pub struct GripReport {
    /// Name of the grip.
    pub name: String,
    /// Force that the grip exerts on the fabric \[N\].
    pub force: DVec3,
    /// Mean displacement of its nodes since it took hold \[m\].
    pub displacement: DVec3,
    /// Work done on the fabric so far \[J\].
    pub work: f64,
}

/// Grips with the nodes they hold. What they remember lies in [`State::grip_memory`], for each grip in turn: whether
/// it has taken hold, work, last force and displacement, and the places where its nodes were when it took hold.
#[derive(Clone, Debug, Default)]
pub struct Grips {
    grips: Vec<(Grip, Vec<NodeId>)>,
    /// First number of each grip in the memory.
    start: Vec<usize>,
}

/// Numbers a grip remembers besides its nodes' places: taken, work, force, displacement.
const HEAD: usize = 8;

impl Grips {
    /// Finds the nodes of each grip in a fabric at the given initial world positions \[m\].
    #[must_use]
    pub fn new(grips: &[Grip], network: &Network, positions: &[DVec3]) -> Self {
        let grips: Vec<_> = grips.iter().map(|grip| (grip.clone(), grip.nodes.nodes(network, positions))).collect();
        let mut start = vec![0];
        for (_, nodes) in &grips {
            start.push(start[start.len() - 1] + HEAD + 3 * nodes.len());
        }
        Self { grips, start }
    }
    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.grips.is_empty()
    }
    /// Length of the memory.
    #[must_use]
    pub fn memory_len(&self) -> usize {
        self.start.last().copied().unwrap_or(0)
    }
    /// The next time after `time` at which a grip takes hold, lets go, or its motion has a key.
    #[must_use]
    pub fn next_event(&self, time: f64) -> Option<f64> {
        let mut events: Vec<f64> = Vec::new();
        for (grip, _) in &self.grips {
            events.push(grip.from);
            events.extend(grip.until);
            if let Drive::Follow(motion) = &grip.drive {
                events.extend(motion.keys.iter().map(|key| key.time));
            }
        }
        events.into_iter().filter(|event| *event > time + 1e-12).min_by(f64::total_cmp)
    }

    /// Notes where nodes are when grips take hold at the state's time.
    pub fn take_hold(&self, coordinates: &Coordinates, state: &mut State) {
        for (k, (grip, nodes)) in self.grips.iter().enumerate() {
            let memory = &mut state.grip_memory[self.start[k]..self.start[k + 1]];
            if grip.holds(state.time + 1e-12) && memory[0] == 0.0 {
                memory[0] = 1.0;
                for (i, node) in nodes.iter().enumerate() {
                    let x = coordinates.position_of(node.index(), &state.coordinates);
                    memory[HEAD + 3 * i..HEAD + 3 * i + 3].copy_from_slice(&x.to_array());
                }
            }
        }
    }

    /// Marks held slots as not free and moves them in `q` to where they are at the end of a step that starts at the
    /// state's time and ends at `time`.
    pub fn hold(&self, state: &State, time: f64, free: &mut [bool], q: &mut [f64]) {
        for (k, (grip, nodes)) in self.grips.iter().enumerate() {
            if !grip.holds(state.time + 1e-12) {
                continue;
            }
            if let Drive::Follow(motion) = &grip.drive {
                let memory = &state.grip_memory[self.start[k] + HEAD..self.start[k + 1]];
                for (i, node) in nodes.iter().enumerate() {
                    let place = motion.place(DVec3::from_slice(&memory[3 * i..3 * i + 3]), time);
                    for axis in 0..3 {
                        if grip.axes[axis] {
                            free[BLOCK * node.index() + axis] = false;
                            q[BLOCK * node.index() + axis] = place[axis];
                        }
                    }
                }
            }
        }
    }

    /// Adds the forces of pulling grips on each node at a time \[N\].
    pub fn add_forces(&self, state: &State, time: f64, forces: &mut [DVec3]) {
        for (grip, nodes) in &self.grips {
            if let (Drive::Force { force, ramp }, true) = (&grip.drive, grip.holds(state.time + 1e-12)) {
                let share = self::ramped(time - grip.from, *ramp) / nodes.len().max(1) as f64;
                for node in nodes {
                    forces[node.index()] += *force * share;
                }
            }
        }
    }

    /// Whether a grip pulls with a force.
    #[must_use]
    pub fn any_force(&self) -> bool {
        self.grips.iter().any(|(grip, _)| matches!(grip.drive, Drive::Force { .. }))
    }

    /// Measures forces and work after a step that ended with coordinates `q` and the gradient of all energies there;
    /// `before` are the coordinates it started from.
    pub fn measure(&self, before: &State, q: &[f64], time: f64, gradient: &[f64], memory: &mut [f64]) {
        for (k, (grip, nodes)) in self.grips.iter().enumerate() {
            if !grip.holds(before.time + 1e-12) {
                memory[self.start[k] + 2..self.start[k] + 5].fill(0.0);
                continue;
            }
            let (mut force, mut moved, mut work) = (DVec3::ZERO, DVec3::ZERO, 0.0);
            let last = DVec3::from_slice(&memory[self.start[k] + 2..self.start[k] + 5]);
            let count = nodes.len().max(1) as f64;
            for (i, node) in nodes.iter().enumerate() {
                let slot = BLOCK * node.index();
                let x = DVec3::from_slice(&q[slot..slot + 3]);
                let on_node = match &grip.drive {
                    Drive::Follow(_) => DVec3::from_slice(&gradient[slot..slot + 3]),
                    Drive::Force { force, ramp } => *force * (ramped(time - grip.from, *ramp) / count),
                };
                let step = x - DVec3::from_slice(&before.coordinates[slot..slot + 3]);
                let first = self.start[k] + HEAD + 3 * i;
                moved += (x - DVec3::from_slice(&memory[first..first + 3])) / count;
                for axis in 0..3 {
                    if grip.axes[axis] || matches!(grip.drive, Drive::Force { .. }) {
                        force[axis] += on_node[axis];
                        work += on_node[axis] * step[axis];
                    }
                }
            }
            // The trapezium rule for a rigid hold: the mean of the forces before and after, along the mean step.
            let step = moved - DVec3::from_slice(&memory[self.start[k] + 5..self.start[k] + 8]);
            let rigid = matches!(grip.drive, Drive::Follow(_)) && before.step > 0;
            let work = if rigid { work + 0.5 * (last - force).dot(step) } else { work };
            memory[self.start[k] + 1] += work;
            memory[self.start[k] + 2..self.start[k] + 5].copy_from_slice(&force.to_array());
            memory[self.start[k] + 5..self.start[k] + 8].copy_from_slice(&moved.to_array());
        }
    }

    /// What the grips did, from their memory.
    #[must_use]
    pub fn reports(&self, memory: &[f64]) -> Vec<GripReport> {
        self.grips
            .iter()
            .enumerate()
            .map(|(k, (grip, _))| {
                let at = self.start[k];
                GripReport {
                    name: grip.name.clone(),
                    work: memory[at + 1],
                    force: DVec3::from_slice(&memory[at + 2..at + 5]),
                    displacement: DVec3::from_slice(&memory[at + 5..at + 8]),
                }
            })
            .collect()
    }
}

fn ramped(since: f64, ramp: f64) -> f64 {
    if ramp > 0.0 { (since / ramp).clamp(0.0, 1.0) } else { 1.0 }
}
