//! Ends of yarns that are pulled out of their contacts.
//!
//! The free end of a yarn that is pulled comes nearer and nearer to the first contact on its way. When almost no yarn is left
//! between them, the end goes through: the contact of two yarns, with five coordinates, becomes two nodes of three, that of the
//! yarn that stays and the end of the other [Cirio2017, section 5.2.4]. The end's own node is taken for the latter, so that
//! no node is made or lost, and the pass that was left keeps the arc length of the end, by which it is known as left:
//! a state says itself which contacts there still are, and so does a frame.

use super::{Simulation, equations};
use crate::fabric::coordinates::BLOCK;
use crate::model::{PassId, YarnId};

/// Length of yarn between an end and a contact at which the end goes through \[radii of the thinnest yarn\].
const SLIPS: f64 = 0.25;

impl Simulation {
    /// Lets ends slip out of the contacts that they have come to; whether any did.
    pub(super) fn let_ends_slip(&mut self) -> bool {
        let limit = SLIPS * self.system.least_radius();
        let mut slipped = false;
        for yarn in (0..self.network.yarn_count()).map(YarnId::new) {
            let passes = self.network.yarn_passes(yarn);
            let card = self.system.yarns.of(self.network.yarn_kind[yarn.index()]);
            let loose = card.can_be_pulled_out(self.network.yarn_role[yarn.index()]);
            if !loose || self.network.yarn_closure[yarn.index()].is_some() || passes.len() < 3 {
                continue;
            }
            for (end, inward) in [(passes.start, 1), (passes.end - 1, -1)] {
                let end = PassId::new(end);
                let Some(next) = self.network.neighbour(yarn, end, inward) else { continue };
                let slots = [end, next.pass].map(|pass| self.system.coordinates.slot(pass));
                let along = |of: &[f64]| f64::from(inward) * (of[slots[1]] - of[slots[0]]);
                let between = along(&self.state.coordinates);
                // No step takes all the yarn that there is between two passes, so the next must not have to.
                let then = between + self.state.next_step_size * along(&self.state.velocities);
                if between.min(then) < limit && self.network.slides(next.pass) {
                    self.leave(slots, end, next.pass);
                    slipped = true;
                }
            }
        }
        slipped
    }

    /// The end is where the contact was, and moves on as it did.
    fn leave(&mut self, slots: [usize; 2], end: PassId, contact: PassId) {
        let state = &mut self.state;
        state.coordinates[slots[1]] = state.coordinates[slots[0]];
        state.velocities[slots[1]] = 0.0;
        state.anchors[contact.index()] = state.coordinates[slots[0]];
        let [from, to] = [contact, end].map(|pass| BLOCK * self.network.pass_node[pass.index()].index());
        for k in 0..3 {
            state.coordinates[to + k] = state.coordinates[from + k];
            state.velocities[to + k] = state.velocities[from + k];
        }
    }

    /// Sets the equations up anew where the state has fewer contacts than they, or more.
    pub(super) fn forget_contacts(&mut self) {
        let sliding: Vec<f64> = (0..self.network.pass_count())
            .map(|pass| self.state.coordinates[self.system.coordinates.slot(PassId::new(pass))])
            .collect();
        let out = self.network.pulled_out_at(&sliding);
        let none = !out.contains(&true);
        let out = if none { Vec::new() } else { out };
        if out == self.network.pulled_out {
            return;
        }
        self.network.pulled_out = out;
        let (yarns, card) = (&self.system.yarns, &self.system.card);
        (self.system, self.newton) = equations(&self.network, yarns, card, &self.plan);
        self.set_up_loads();
    }
}
