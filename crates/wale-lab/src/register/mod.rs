//! A page on which yarn curves are laid over photographs of a swatch, and saved as a periodic yarn tile
//! \[Sperl2022, section 4.2\].
//!
//! The work itself is done in the browser; here the page is put together. What belongs to the model and what to the page are
//! files apart: `curve.js`, `crossings.js`, `solve.js`, `work.js`, `tile.js` and `api.js` know no document, and
//! `window.register` is all that `paint.js`, `panel.js`, `interface.js` and `hands.js` use of them, besides what they draw.

mod page;
mod photograph;

pub use page::{RegisterPage, SizeFault};
pub use photograph::{LARGEST_SIDE, MOST_BYTES, Photograph, PhotographError, PhotographFault};
