//! A page to turn the fabric in the hand: one HTML file that needs nothing else.
//!
//! [`write_html`] packs frames into a few megabytes and writes them into a page with a small WebGL2 viewer of our own.
//! The page plays, scrubs, turns, and colours yarns by stretch, sliding or curvature. Its address can ask for a state:
//! `page.html#frame=12&color=stretch&view=front`.

mod html;
mod pack;

use crate::geometry::{Curve, PointScalars, Solid};

pub use html::write_html;

/// One moment of the fabric.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ViewFrame {
    /// Simulated time \[s\].
    pub time: f64,
    /// Yarns, the same number in each frame; the number of their points may change.
    pub curves: Vec<Curve>,
    /// Numbers at each point of each curve, to colour by.
    pub scalars: PointScalars,
    /// Obstacles.
    pub solids: Vec<Solid>,
}

/// What the page shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ViewData {
    /// Title of the page.
    pub title: String,
    /// Moments in order of time.
    pub frames: Vec<ViewFrame>,
    /// Plies that the yarn is spun from.
    pub plies: u32,
    /// Twist of the plies \[turns/m\].
    pub twist: f64,
}

/// Limits of a page.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewSettings {
    /// Bytes of numbers, before they are compressed, above which frames are left out.
    pub budget: usize,
    /// Stored points lie this many yarn radii apart; a cubic runs between them.
    pub spacing: f64,
    /// Colour behind everything, sRGB.
    pub background: [u8; 3],
}

impl Default for ViewSettings {
    fn default() -> Self {
        Self { budget: 24 << 20, spacing: 1.7, background: [243, 242, 239] }
    }
}

/// A page could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// There is no frame, or no yarn in it.
    #[error("there is nothing to show: no frame has a yarn of two points or more")]
    Nothing,
    /// Yarns come or go between frames.
    #[error("frame {frame} has {found} yarns and the first frame {expected}")]
    YarnCount {
        /// Index of the frame.
        frame: usize,
        /// Its yarns.
        found: usize,
        /// Yarns of the first frame.
        expected: usize,
    },
    /// A place that is not a number.
    #[error("yarn {yarn} of frame {frame} has a point that is not a finite place")]
    NotFinite {
        /// Index of the frame.
        frame: usize,
        /// Index of the yarn.
        yarn: usize,
    },
    /// Lists of one yarn differ in length, or its arc length does not rise.
    #[error("yarn {yarn} of frame {frame} is not a curve: {reason}")]
    Curve {
        /// Index of the frame.
        frame: usize,
        /// Index of the yarn.
        yarn: usize,
        /// What is wrong.
        reason: &'static str,
    },
    /// The page could not be written.
    #[error("cannot write the page")]
    Write(#[from] std::io::Error),
}
