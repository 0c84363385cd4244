//! Charts drawn as small pictures: one pixel a stitch.

use thiserror::Error;

use super::chart::Chart;

/// Most bytes of an image file.
pub const LARGEST_IMAGE: usize = 4 << 20;

/// Why bytes are no image of stitches.
#[derive(Debug, Error)]
pub enum ImageError {
    /// Not a PNG, or a damaged one.
    #[error("this is no PNG that can be read: {0}")]
    Png(#[from] png::DecodingError),
    /// More pixels than a chart may have loops.
    #[error(
        "{width} × {height} pixels are too many: a pixel is a stitch, and at most {} are knitted",
        Chart::MAX_LOOPS
    )]
    Size {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// More than [`LARGEST_IMAGE`].
    #[error("the file has more than {LARGEST_IMAGE} bytes")]
    Bytes,
}

impl ImageError {
    /// Whether the image asks for too much rather than being wrong.
    #[must_use]
    pub fn is_size(&self) -> bool {
        matches!(self, Self::Size { .. } | Self::Bytes)
    }
}

/// The colours of an image, from the top left.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Pixels {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// sRGB, line by line; transparency is left out.
    pub colors: Vec<[u8; 3]>,
}

/// Reads the pixels of a PNG of any kind.
///
/// # Errors
/// If it is none, or has more pixels than [`Chart::MAX_LOOPS`]; that is known before they are read.
pub fn read_pixels(bytes: &[u8]) -> Result<Pixels, ImageError> {
    if bytes.len() > LARGEST_IMAGE {
        return Err(ImageError::Bytes);
    }
    let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let (width, height) = decoder.read_header_info()?.size();
    if Chart::check_size(u64::from(width), u64::from(height)).is_err() {
        return Err(ImageError::Size { width, height });
    }
    let mut reader = decoder.read_info()?;
    let mut data = vec![0; reader.output_buffer_size().unwrap_or(0)];
    let info = reader.next_frame(&mut data)?;
    let samples = info.color_type.samples();
    let color = |pixel: &[u8]| match pixel {
        [gray] | [gray, _] => [*gray; 3],
        [r, g, b, ..] => [*r, *g, *b],
        [] => [0; 3],
    };
    let colors = data[..info.buffer_size()].chunks_exact(samples).map(color).collect();
    Ok(Pixels { width: width as usize, height: height as usize, colors })
}

/// A colour as `#rrggbb`.
#[must_use]
pub fn color(text: &str) -> Option<[u8; 3]> {
    let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6 && digits.is_ascii())?;
    let byte = |at: usize| u8::from_str_radix(&digits[at..at + 2], 16).ok();
    Some([byte(0)?, byte(2)?, byte(4)?])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn png(width: u32, height: u32, color: png::ColorType, depth: png::BitDepth, data: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if color == png::ColorType::Indexed {
            encoder.set_palette(vec![255, 255, 255, 0xc0, 0x30, 0x20]);
        }
        encoder.write_header().unwrap().write_image_data(data).unwrap();
        bytes
    }

    #[test]
    fn pixels_of_every_kind_are_read() {
        let white = [255; 3];
        let red = [0xc0, 0x30, 0x20];
        let rgb = png(2, 1, png::ColorType::Rgb, png::BitDepth::Eight, &[255, 255, 255, 0xc0, 0x30, 0x20]);
        assert_eq!(read_pixels(&rgb).unwrap().colors, [white, red]);
        let indexed = png(2, 1, png::ColorType::Indexed, png::BitDepth::One, &[0b0100_0000]);
        assert_eq!(read_pixels(&indexed).unwrap().colors, [white, red]);
        let gray = png(2, 1, png::ColorType::Grayscale, png::BitDepth::Eight, &[255, 0]);
        assert_eq!(read_pixels(&gray).unwrap().colors, [white, [0; 3]]);
        assert_eq!(
            (color("#c03020"), color("#c0302"), color("c03020"), color("#c030zz")),
            (Some(red), None, None, None)
        );
    }

    #[test]
    fn absurd_sizes_are_refused_before_they_are_read() {
        let mut huge = png(1, 1, png::ColorType::Grayscale, png::BitDepth::Eight, &[0]);
        huge[16..24].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff]);
        // The header's checksum is right again.
        let sum = crc(&huge[12..29]);
        huge[29..33].copy_from_slice(&sum.to_be_bytes());
        let error = read_pixels(&huge).unwrap_err();
        assert!(error.is_size(), "{error}");
        assert!(read_pixels(b"not a picture").is_err());
    }

    fn crc(bytes: &[u8]) -> u32 {
        !bytes.iter().fold(!0_u32, |sum, byte| {
            (0..8).fold(sum ^ u32::from(*byte), |sum, _| (sum >> 1) ^ if sum & 1 == 1 { 0xedb8_8320 } else { 0 })
        })
    }

    proptest! {
        #[test]
        fn damaged_images_are_read_or_refused(at in 8_usize..60, byte in any::<u8>(), cut in 0_usize..80) {
            let mut bytes = png(2, 2, png::ColorType::Grayscale, png::BitDepth::Eight, &[1, 2, 3, 4]);
            bytes.truncate(bytes.len().saturating_sub(cut / 2));
            if let Some(place) = bytes.get_mut(at) {
                *place = byte;
            }
            if let Ok(pixels) = read_pixels(&bytes) {
                prop_assert_eq!(pixels.colors.len(), pixels.width * pixels.height);
            }
        }
    }
}
