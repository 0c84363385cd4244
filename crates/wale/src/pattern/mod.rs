//! Stitch charts and what is made of them; this room knows no force.

pub mod chart;
