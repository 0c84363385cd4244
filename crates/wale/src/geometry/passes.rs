//! Where each pass lies in space, and which passes come before and after it on its yarn, across periods too.

use glam::DVec3;

use crate::model::{Network, PassId, YarnId};

/// A pass seen from another one: the pass and the periodic image it is met in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Neighbour {
    /// The pass.
    pub pass: usize,
    /// Periods (course, wale) to add to the pass's own image.
    pub shift: [i32; 2],
    /// Periods of the yarn's closure to add to the pass's arc length: −1, 0 or 1.
    pub turns: i8,
}

/// The yarns of a network as runs of passes with neighbours.
pub(super) struct Passes<'a> {
    network: &'a Network,
    before: Vec<Option<Neighbour>>,
    after: Vec<Option<Neighbour>>,
}

impl<'a> Passes<'a> {
    /// Finds the neighbours of every pass.
    pub fn new(network: &'a Network) -> Self {
        let mut before = vec![None; network.pass_count()];
        let mut after = vec![None; network.pass_count()];
        for y in 0..network.yarn_count() {
            let range = network.yarn_passes(YarnId::new(y));
            let near = |pass| Neighbour { pass, shift: [0, 0], turns: 0 };
            for p in range.clone() {
                before[p] = (p > range.start).then(|| near(p - 1));
                after[p] = (p + 1 < range.end).then(|| near(p + 1));
            }
            if let (Some((image, _)), false) = (network.yarn_closure[y], range.is_empty()) {
                let shift = image.map(i32::from);
                before[range.start] = Some(Neighbour { pass: range.end - 1, shift: shift.map(|s| -s), turns: -1 });
                after[range.end - 1] = Some(Neighbour { pass: range.start, shift, turns: 1 });
            }
        }
        Self { network, before, after }
    }

    /// The pass before `pass` on its yarn, if any.
    pub fn before(&self, pass: usize) -> Option<Neighbour> {
        self.before[pass]
    }

    /// The pass after `pass` on its yarn, if any.
    pub fn after(&self, pass: usize) -> Option<Neighbour> {
        self.after[pass]
    }

    /// Position \[m\] of the node image that a pass goes through.
    pub fn place(&self, positions: &[DVec3], periods: [DVec3; 2], pass: usize) -> DVec3 {
        let image = self.network.pass_image.get(pass).map_or([0, 0], |i| i.map(i32::from));
        positions[self.network.pass_node[pass].index()] + translation(periods, image)
    }

    /// Position \[m\] of a neighbour, in the copy that adjoins the pass it was asked from.
    pub fn neighbour_place(&self, positions: &[DVec3], periods: [DVec3; 2], neighbour: Neighbour) -> DVec3 {
        self.place(positions, periods, neighbour.pass) + translation(periods, neighbour.shift)
    }

    /// For two passes that are neighbours on their yarn, the one that comes first.
    pub fn earlier(&self, a: PassId, b: PassId) -> Option<usize> {
        let follows = |p: PassId, q: PassId| self.after[p.index()].is_some_and(|n| n.pass == q.index());
        if follows(a, b) {
            Some(a.index())
        } else if follows(b, a) {
            Some(b.index())
        } else {
            None
        }
    }
}

/// The translation \[m\] of a periodic image.
pub(super) fn translation(periods: [DVec3; 2], image: [i32; 2]) -> DVec3 {
    periods[0] * f64::from(image[0]) + periods[1] * f64::from(image[1])
}
