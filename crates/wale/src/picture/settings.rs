//! What a picture shows and how.

use glam::DVec3;

use crate::geometry::{Curve, PointScalars, Quantity, Solid};

/// What yarns are coloured by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum ColorMode {
    /// Each yarn's own colour.
    #[default]
    Yarn,
    /// A quantity along the yarn, with a legend.
    By(Quantity),
}

/// A name that is no colouring.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no colouring; write one of yarn, stretch, sliding, curvature")]
pub struct UnknownColorMode(pub String);

impl std::str::FromStr for ColorMode {
    type Err = UnknownColorMode;
    fn from_str(name: &str) -> Result<Self, UnknownColorMode> {
        if name == "yarn" {
            return Ok(Self::Yarn);
        }
        Quantity::ALL
            .into_iter()
            .find(|q| q.name() == name)
            .map(Self::By)
            .ok_or_else(|| UnknownColorMode(name.to_owned()))
    }
}

/// What is before the camera.
#[derive(Clone, Copy, Debug, Default)]
pub struct Subject<'a> {
    /// Yarns.
    pub curves: &'a [Curve],
    /// Numbers along the yarns; only needed to colour by them.
    pub scalars: Option<&'a PointScalars>,
    /// Obstacles.
    pub solids: &'a [Solid],
}

impl Subject<'_> {
    /// Points that a camera should have in view, and the largest yarn radius around them \[m\].
    #[must_use]
    pub fn extent_points(&self) -> (Vec<DVec3>, f64) {
        let yarns = self.curves.iter().flat_map(|c| c.points.iter().copied());
        let solids = self.solids.iter().flat_map(Solid::extent_points);
        let radius = self.curves.iter().map(|c| c.radius).fold(0.0, f64::max);
        (yarns.chain(solids).collect(), radius)
    }
}

/// How a picture is made.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// Rays through each pixel.
    pub samples: u32,
    /// Colour behind everything, sRGB.
    pub background: [u8; 3],
    /// What yarns are coloured by.
    pub color_mode: ColorMode,
    /// Values at both ends of the colours, SI; taken from the subject if absent. Give it for a sequence of pictures.
    pub color_range: Option<[f64; 2]>,
    /// Plies that the yarn is spun from; 0 or 1 is drawn as a smooth yarn.
    pub plies: u32,
    /// Twist of the plies \[turns/m\].
    pub twist: f64,
    /// Hairs per yarn radius of length; 0 for a clean yarn.
    pub hair: f64,
    /// Which way a plane faces that lies under the subject and only catches its shadow; none if absent.
    pub ground: Option<DVec3>,
    /// Rays for the light from all around, for each of the samples.
    pub ambient_rays: u32,
    /// Whether to draw the bar in millimetres.
    pub scale_bar: bool,
    /// A line at the top left.
    pub caption: Option<String>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            width: 1600,
            height: 1200,
            samples: 4,
            background: [243, 242, 239],
            color_mode: ColorMode::Yarn,
            color_range: None,
            plies: 3,
            twist: 150.0,
            hair: 2.5,
            ground: Some(DVec3::Z),
            ambient_rays: 2,
            scale_bar: true,
            caption: None,
        }
    }
}
