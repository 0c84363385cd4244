//! What acts on a fabric from outside besides gravity: a bed, and loads.

use super::system::System;
use crate::energy::{Foundation, Load};
use crate::fabric::coordinates::{BLOCK, dof};
use crate::fabric::elements::Elements;

impl System {
    /// Lays the fabric on an elastic bed at a height \[m\] of stiffness \[N/m\] a node; zero takes it away.
    pub fn set_bed(&mut self, stiffness: f64, height: f64) {
        self.bed.set = Elements::default();
        if stiffness > 0.0 {
            for node in 0..self.coordinates.node_count() {
                self.bed.set.push(Foundation { stiffness, place: height }, [dof(BLOCK * node + 2)]);
            }
        }
        self.bed.plan(&self.chunks);
        self.bed.locate(&self.pattern);
    }

    /// Adds a load; [`System::plan_loads`] must follow the last.
    pub fn push_load(&mut self, load: Load, stencil: [u32; 3]) {
        self.loads.set.push(load, stencil);
    }

    /// Plans the loads that were added.
    pub fn plan_loads(&mut self) {
        self.loads.plan(&self.chunks);
        self.loads.locate(&self.pattern);
    }

    /// Number of loads.
    #[must_use]
    pub fn load_count(&self) -> usize {
        self.loads.set.len()
    }

    /// Sets every load from its node and the length of yarn there \[m\].
    pub fn renew_loads(&mut self, load: impl Fn(usize, f64) -> Load) {
        for (element, stencil) in self.loads.set.elements.iter_mut().zip(&self.loads.set.stencils) {
            let node = stencil[0] as usize / BLOCK;
            *element = load(node, self.yarn_at_node[node]);
        }
    }
}
