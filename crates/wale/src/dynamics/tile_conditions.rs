//! What acts on a periodic tile while it comes to rest: a width that is held, a pull, friction.

use crate::energy::friction::AnchoredSpring;
use crate::fabric::coordinates::dof;
use crate::fabric::{Elements, TileCoordinates};
use crate::model::{Network, PassId};

/// What acts on a tile besides the forces of its own yarns and its bed; nothing, where it simply comes to rest.
#[derive(Clone, Debug, Default)]
pub(super) struct Conditions {
    /// Whether its width is held.
    pub width_held: bool,
    /// What pulls along the wales \[N\].
    pub pull: f64,
    /// What slides against friction.
    pub rubbing: Option<Rubbing>,
}

/// Friction of every contact.
#[derive(Clone, Debug)]
pub(super) struct Rubbing {
    /// Largest force \[N\], and the stiffness below it \[N/m\].
    pub limit: f64,
    pub stiffness: f64,
    /// Where nothing has slid, by own slots \[m\].
    pub anchors: Vec<f64>,
}

impl Conditions {
    /// Friction as elements of a tile.
    pub fn rubbing(&self, network: &Network, coordinates: &TileCoordinates) -> Elements<AnchoredSpring, 1> {
        let mut springs = Elements::default();
        let Some(Rubbing { limit, stiffness, anchors }) = &self.rubbing else { return springs };
        for pass in (0..network.pass_count()).map(PassId::new) {
            let slot = coordinates.own().slot(pass);
            let spring = AnchoredSpring { stiffness: *stiffness, limit: *limit, anchor: anchors[slot] };
            springs.push(spring, [dof(slot)]);
        }
        springs
    }
}
