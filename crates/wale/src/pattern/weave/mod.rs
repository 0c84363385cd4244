//! Drafts of woven fabrics, WIF, the format in which weavers keep them, and the network that is woven from them.

pub mod cloth;
pub mod draft;
mod ini;
pub mod named;
pub mod peirce;
mod shed;
mod symbols;
mod tile;
pub mod wif;
#[cfg(test)]
mod wif_tests;

pub use cloth::{BiasCut, Selvedge, Woven};
pub use draft::{Draft, DraftError, Thread};
pub use named::named_weave;
pub use peirce::{Jammed, Sett};
pub use symbols::{DraftSymbolError, read_draft};
pub use tile::tile;
pub use wif::{WifError, WifErrorReason, read_wif};
