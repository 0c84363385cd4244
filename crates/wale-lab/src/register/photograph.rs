//! Photographs as they are stored: which kind of file it is and how large, read from its first bytes; nothing is decoded.

use std::io::{self, Write};

use thiserror::Error;
use wale::picture::base64;

/// Largest file \[bytes\].
pub const MOST_BYTES: usize = 64 << 20;
/// Most pixels along a side: what browsers still draw.
pub const LARGEST_SIDE: u32 = 12_000;
/// Fewest pixels along a side.
const SMALLEST_SIDE: u32 = 16;

/// Why a file is no photograph that a page can show.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{file}: {fault}")]
pub struct PhotographError {
    /// The file's name.
    pub file: String,
    /// What is wrong with it.
    pub fault: PhotographFault,
}

/// What is wrong with a photograph.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum PhotographFault {
    /// Neither PNG nor JPEG.
    #[error("neither a PNG nor a JPEG picture; save the photograph as one of them")]
    Kind,
    /// A file that ends too soon.
    #[error("the picture is cut off or damaged; copy it anew")]
    CutOff,
    /// Too many bytes.
    #[error("larger than {} MB; save it as a JPEG, or cut out a few repeats", MOST_BYTES >> 20)]
    Bytes,
    /// Sides that are too short or too long.
    #[error(
        "{width} x {height} pixels, where sides of {SMALLEST_SIDE} to {LARGEST_SIDE} are shown; cut out a few repeats, or scale it"
    )]
    Pixels {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
}

/// A photograph in a file's own bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Photograph {
    mime: &'static str,
    size: [u32; 2],
    bytes: Vec<u8>,
}

impl Photograph {
    /// A photograph from the bytes of a PNG or JPEG file; `file` is its name for errors.
    ///
    /// # Errors
    /// If it is neither, cut off, or of an absurd size.
    pub fn new(file: &str, bytes: Vec<u8>) -> Result<Self, PhotographError> {
        let refused = |fault| PhotographError { file: file.to_owned(), fault };
        if bytes.len() > MOST_BYTES {
            return Err(refused(PhotographFault::Bytes));
        }
        let (mime, size) = if let Some(rest) = bytes.strip_prefix(b"\x89PNG\r\n\x1a\n") {
            ("image/png", png_size(rest))
        } else if let Some(rest) = bytes.strip_prefix(b"\xff\xd8") {
            ("image/jpeg", jpeg_size(rest))
        } else {
            return Err(refused(PhotographFault::Kind));
        };
        let [width, height] = size.ok_or_else(|| refused(PhotographFault::CutOff))?;
        if ![width, height].iter().all(|side| (SMALLEST_SIDE..=LARGEST_SIDE).contains(side)) {
            return Err(refused(PhotographFault::Pixels { width, height }));
        }
        Ok(Self { mime, size: [width, height], bytes })
    }

    /// Pixels across and down, as stored; a camera's note may ask for it to be shown turned.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Writes it as a `data:` address.
    ///
    /// # Errors
    /// If the target cannot be written.
    pub fn write_uri(&self, target: &mut impl Write) -> io::Result<()> {
        write!(target, "data:{};base64,", self.mime)?;
        // A multiple of three bytes, so that pieces join without padding.
        for piece in self.bytes.chunks(3 << 12) {
            target.write_all(base64(piece).as_bytes())?;
        }
        Ok(())
    }
}

/// Sides of a PNG after its signature; its chunks must lead to the last one.
fn png_size(bytes: &[u8]) -> Option<[u32; 2]> {
    let word = |at: usize| Some(u32::from_be_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    if word(0)? != 13 || bytes.get(4..8)? != b"IHDR" {
        return None;
    }
    let size = [word(8)?, word(12)?];
    let mut at = 0;
    while bytes.get(at + 4..at + 8)? != b"IEND" {
        at = at.checked_add(12 + usize::try_from(word(at)?).ok()?)?;
    }
    Some(size)
}

/// Sides of a JPEG after its first marker, from its frame header.
fn jpeg_size(bytes: &[u8]) -> Option<[u32; 2]> {
    let half = |at: usize| Some(u32::from(u16::from_be_bytes(bytes.get(at..at + 2)?.try_into().ok()?)));
    let mut at = 0;
    loop {
        if *bytes.get(at)? != 0xff {
            return None;
        }
        match *bytes.get(at + 1)? {
            // A marker may be preceded by any number of such bytes.
            0xff => at += 1,
            // Markers without a length.
            0x01 | 0xd0..=0xd8 => at += 2,
            // Frame headers; the three left out are tables and an extension.
            0xc0..=0xcf if ![0xc4, 0xc8, 0xcc].contains(bytes.get(at + 1)?) => {
                return Some([half(at + 7)?, half(at + 5)?]);
            }
            // The picture begins, or ends, without a frame header.
            0xd9 | 0xda => return None,
            _ => at += 2 + usize::try_from(half(at + 2)?).ok()?.max(2),
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use wale::picture::{Image, write_png};

    use super::*;

    /// A grey PNG.
    pub fn png(width: usize, height: usize) -> Vec<u8> {
        let mut bytes = Vec::new();
        write_png(&Image::filled(width, height, [90; 3]), &mut bytes).expect("a picture");
        bytes
    }

    /// The first markers of a JPEG of 640 x 480 pixels.
    fn jpeg() -> Vec<u8> {
        let mut bytes = b"\xff\xd8\xff\xe0\x00\x06ab\x00\x01\xff\xff\xc2\x00\x0b\x08".to_vec();
        bytes.extend([0x01, 0xe0, 0x02, 0x80, 1, 1, 0x11, 0, 0xff, 0xda, 0, 0]);
        bytes
    }

    #[test]
    fn sizes_are_read() {
        assert_eq!(Photograph::new("a.png", png(40, 30)).map(|p| p.size()), Ok([40, 30]));
        assert_eq!(Photograph::new("a.jpg", jpeg()).map(|p| p.size()), Ok([640, 480]));
        let mut uri = Vec::new();
        Photograph::new("a.png", png(40, 30)).expect("a photograph").write_uri(&mut uri).expect("memory");
        assert!(uri.starts_with(b"data:image/png;base64,iVBORw0KGgo"));
    }

    #[test]
    fn what_is_no_photograph_is_refused() {
        let fault = |bytes: Vec<u8>| Photograph::new("a.png", bytes).expect_err("no photograph").fault;
        assert_eq!(fault(b"GIF89a".to_vec()), PhotographFault::Kind);
        assert_eq!(fault(Vec::new()), PhotographFault::Kind);
        assert_eq!(fault(png(8, 100)), PhotographFault::Pixels { width: 8, height: 100 });
        let mut wide = png(40, 30);
        wide[16..20].copy_from_slice(&20_000u32.to_be_bytes());
        assert_eq!(fault(wide), PhotographFault::Pixels { width: 20_000, height: 30 });
        assert_eq!(fault(vec![0; MOST_BYTES + 1]), PhotographFault::Bytes);
        let error = Photograph::new("a.png", b"GIF89a".to_vec()).expect_err("no photograph").to_string();
        assert!(error.starts_with("a.png: neither a PNG nor a JPEG"), "{error}");
    }

    #[test]
    fn a_cut_file_is_refused_and_no_byte_panics() {
        let whole = png(40, 30);
        for cut in 8..whole.len() - 8 {
            assert_eq!(Photograph::new("a", whole[..cut].to_vec()).expect_err("cut").fault, PhotographFault::CutOff);
        }
        for bytes in [whole, jpeg()] {
            for at in 0..bytes.len() {
                for value in [0, 1, 0x7f, 0xc0, 0xff] {
                    let mut changed = bytes.clone();
                    changed[at] = value;
                    let _ = Photograph::new("a", changed[..].to_vec());
                    let _ = Photograph::new("a", changed[..at].to_vec());
                }
            }
        }
    }
}
