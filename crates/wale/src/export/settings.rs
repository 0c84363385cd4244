//! Choices common to all formats.

use glam::DVec3;

/// Which axis of a file points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UpAxis {
    /// The y axis: coordinates are turned, `(x, y, z) → (x, z, −y)`.
    Y,
    /// The z axis, as in wale.
    #[default]
    Z,
}

impl UpAxis {
    /// A point of wale in the axes of the file.
    #[must_use]
    pub fn turn(self, p: DVec3) -> DVec3 {
        match self {
            Self::Y => DVec3::new(p.x, p.z, -p.y),
            Self::Z => p,
        }
    }

    /// The letter.
    #[must_use]
    pub fn letter(self) -> &'static str {
        match self {
            Self::Y => "Y",
            Self::Z => "Z",
        }
    }
}

/// How a fabric is written.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// What the files say they are: one line of text.
    pub title: String,
    /// Frames per second of an animation; a frame at `t` seconds is at time code `t ×` this.
    pub frames_per_second: f64,
    /// Axis that points up in the file.
    pub up: UpAxis,
    /// Flat sides of a tube (OBJ, PLY).
    pub sides: usize,
    /// Plies drawn in a tube mesh; one draws the yarn as one tube (OBJ, PLY).
    pub plies: u32,
    /// Twist of the plies \[turns/m\], positive for Z twist.
    pub twist: f64,
}

impl Default for Settings {
    /// 24 frames a second, z up, plain tubes of eight sides.
    fn default() -> Self {
        Self {
            title: "fabric by wale".into(),
            frames_per_second: 24.0,
            up: UpAxis::default(),
            sides: 8,
            plies: 1,
            twist: 0.0,
        }
    }
}

/// A name that programs take for an identifier: other characters become underscores.
pub(super) fn identifier(name: &str) -> String {
    let mut word: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if !word.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') {
        word.insert(0, '_');
    }
    word
}

/// Text on one line, without control characters.
pub(super) fn one_line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}
