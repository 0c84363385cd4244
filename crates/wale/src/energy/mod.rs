//! Energies: one file each, with value, gradient and Hessian, knowing nothing of the fabric they will be part of.

mod angle;
pub mod bending;
pub mod element;
pub mod foundation;
pub mod friction;
pub mod gravity;
pub mod inertia;
pub mod leg_contact;
pub mod load;
pub mod obstacle_contact;
pub mod rates;
#[cfg(test)]
mod rigid_motion;
pub mod rod_bending;
pub mod rod_contact;
pub mod rod_stretch;
pub mod self_contact;
pub mod shear;
pub mod spacing;
pub mod stitch_length;
pub mod stretch;
pub mod thick;
pub mod wrapping;

pub use bending::Bending;
pub use element::Element;
pub use foundation::Foundation;
pub use friction::{AnchoredSpring, ParallelSpring};
pub use gravity::Gravity;
pub use inertia::Inertia;
pub use leg_contact::LegContact;
pub use load::Load;
pub use obstacle_contact::ObstacleContact;
pub use rates::Rate;
pub use rod_bending::RodBending;
pub use rod_contact::{ContactPhase, ContactReading, RodContact};
pub use rod_stretch::RodStretch;
pub use self_contact::SelfContact;
pub use shear::Shear;
pub use spacing::Spacing;
pub use stitch_length::StitchLength;
pub use stretch::Stretch;
pub use thick::Thick;
pub use wrapping::Wrapping;
