//! Arguments of what is made of a run: `wale render`, `plot`, `view` and `export`.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

/// `wale render`
#[derive(Debug, Args)]
pub struct Render {
    /// Run folder, or a periodic tile of yarns (`.pyp`)
    pub run: PathBuf,
    /// PNG file, or folder for several frames; inside the run folder, or beside the tile, if not given
    #[arg(long, short, value_name = "PATH")]
    pub out: Option<PathBuf>,
    /// Frames to draw: `last`, `all`, a number, or a range such as `10..20`
    #[arg(long, default_value = "last")]
    pub frames: FrameChoice,
    /// Side to look from: front, back, left, right, top, bottom, three-quarter, three-quarter-back
    #[arg(long, default_value = "three-quarter")]
    pub view: wale::picture::View,
    /// What yarns are coloured by: yarn, stretch, sliding, curvature
    #[arg(long, default_value = "yarn")]
    pub color: wale::picture::ColorMode,
    /// Size in pixels, such as `1600x1200`
    #[arg(long, value_name = "WxH", value_parser = parse_picture_size)]
    pub size: Option<[u32; 2]>,
}

impl Render {
    /// The picture that is drawn of a run if nothing else is said.
    #[must_use]
    pub fn of(run: &Path) -> Self {
        Self {
            run: run.to_owned(),
            out: None,
            frames: FrameChoice::Last,
            view: wale::picture::View::ThreeQuarter,
            color: wale::picture::ColorMode::default(),
            size: None,
        }
    }
}

/// `wale plot`
#[derive(Debug, Args)]
pub struct Plot {
    /// Run folder
    pub run: PathBuf,
    /// PNG or SVG file; inside the run folder if not given
    #[arg(long, short, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// `wale view`
#[derive(Debug, Args)]
pub struct View {
    /// Run folder
    pub run: PathBuf,
    /// HTML file; inside the run folder if not given
    #[arg(long, short, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// `wale export`
#[derive(Debug, Args)]
pub struct Export {
    /// Run folder
    pub run: PathBuf,
    /// Format
    #[arg(long, short, value_enum)]
    pub format: Format,
    /// File, or folder for one file a frame; inside the run folder if not given
    #[arg(long, short, value_name = "PATH")]
    pub out: Option<PathBuf>,
    /// Frames to write: `last`, `all`, a number, or a range such as `10..20`
    #[arg(long, default_value = "all")]
    pub frames: FrameChoice,
    /// The world's up axis in the file, where the format can say so
    #[arg(long, value_enum, default_value_t = Up::Z)]
    pub up: Up,
}

/// Formats that other programs read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// USD BasisCurves with time samples, one `.usda` file
    Usd,
    /// VTK polydata for ParaView, a `.vtp` file a frame and their `.pvd`
    Vtk,
    /// Binary curve collection, a `.bcc` file a frame
    Bcc,
    /// Yarns as tubes, an `.obj` file a frame
    Obj,
    /// Yarns as tubes, a `.ply` file a frame
    Ply,
    /// The metrics table
    Csv,
}

/// Which axis of a file points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Up {
    /// As in films
    Y,
    /// As in the simulation
    Z,
}

/// A choice among the frames of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameChoice {
    /// The last.
    Last,
    /// All of them.
    All,
    /// From one up to, not including, another.
    Range(u64, u64),
}

impl FrameChoice {
    /// The chosen range among so many frames; `None` if it is empty or reaches beyond.
    #[must_use]
    pub fn among(self, count: u64) -> Option<std::ops::Range<u64>> {
        let range = match self {
            Self::Last => count.checked_sub(1)?..count,
            Self::All => 0..count,
            Self::Range(first, end) => first..end,
        };
        (!range.is_empty() && range.end <= count).then_some(range)
    }
}

impl std::str::FromStr for FrameChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let bad = || format!("`{text}` is not `last`, `all`, a number, or a range such as `10..20`");
        let number = |text: &str| text.trim().parse::<u64>().map_err(|_| bad());
        match (text, text.split_once("..")) {
            ("last", _) => Ok(Self::Last),
            ("all", _) => Ok(Self::All),
            (_, Some((first, end))) => Ok(Self::Range(number(first)?, number(end)?)),
            (_, None) => {
                let index = number(text)?;
                Ok(Self::Range(index, index.checked_add(1).ok_or_else(bad)?))
            }
        }
    }
}

fn parse_picture_size(text: &str) -> Result<[u32; 2], String> {
    text.split_once('x')
        .and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]))
        .filter(|size| size.iter().all(|side| (16..=16_384).contains(side)))
        .ok_or_else(|| format!("`{text}` is no size such as `1600x1200`, with sides of 16 to 16384"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_chosen() {
        let choose = |text: &str| text.parse::<FrameChoice>().unwrap().among(10);
        assert_eq!(choose("last"), Some(9..10));
        assert_eq!(choose("all"), Some(0..10));
        assert_eq!(choose("3"), Some(3..4));
        assert_eq!(choose("3..5"), Some(3..5));
        assert_eq!(choose("9..11"), None);
        assert_eq!(choose("5..3"), None);
        assert_eq!(FrameChoice::Last.among(0), None);
        for bad in ["", "x", "-1", "1..", "18446744073709551615"] {
            assert!(bad.parse::<FrameChoice>().is_err(), "{bad}");
        }
    }

    #[test]
    fn picture_sizes_are_read() {
        assert_eq!(parse_picture_size("1600x1200"), Ok([1600, 1200]));
        for bad in ["", "1600", "0x100", "99999x100", "axb", "-1x5"] {
            assert!(parse_picture_size(bad).is_err(), "{bad}");
        }
    }
}
