//! Every scene of the gallery, run to its end: the numbers that its picture stands for.
//!
//! One program, so that the longest scenes of one part are played beside those of others.

mod drapes;
mod knits;
mod play;
mod weaves;
