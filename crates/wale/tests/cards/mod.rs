//! A yarn and a fabric of it, for tests of networks.

use wale::model::{KnitCard, LoopProportions, YarnCard};

/// A yarn of a millimetre, in loops of 9.5 mm.
pub fn cards() -> (YarnCard, KnitCard) {
    let yarn = YarnCard {
        linear_density: 3e-4,
        radius: 5e-4,
        stretch_stiffness: 0.5,
        bending_stiffness: 8e-10,
        friction_coefficient: 0.3,
        mass_damping: 0.0,
        stiffness_damping: 0.05,
        loose_ends: false,
        plies: 2,
        twist: 0.0,
    };
    let card = LoopProportions::default().card(&yarn, 9.5e-3);
    (yarn, card)
}
