//! Pictures as PNG files.

use std::{io::Write, path::PathBuf};

use super::Image;

/// A picture could not be written or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PngError {
    /// The file system refused.
    #[error("cannot write the picture")]
    Write(#[source] ::png::EncodingError),
    /// Not a PNG of 8-bit colours.
    #[error("cannot read the picture")]
    Read(#[source] ::png::DecodingError),
    /// A PNG of a kind this program does not write.
    #[error("the picture has {0:?} pixels; only 8-bit RGB and RGBA are read")]
    Kind(::png::ColorType),
}

/// Writes a picture as an 8-bit sRGB PNG.
///
/// # Errors
/// If the target cannot be written.
pub fn write_png(image: &Image, target: impl Write) -> Result<(), PngError> {
    let (width, height) = (image.width as u32, image.height as u32);
    let mut encoder = ::png::Encoder::new(target, width, height);
    encoder.set_color(::png::ColorType::Rgb);
    encoder.set_depth(::png::BitDepth::Eight);
    encoder.set_source_srgb(::png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header().map_err(PngError::Write)?;
    writer.write_image_data(image.pixels.as_flattened()).map_err(PngError::Write)?;
    writer.finish().map_err(PngError::Write)
}

/// Reads an 8-bit RGB or RGBA PNG; transparency is dropped.
///
/// # Errors
/// If the bytes are no such PNG.
pub fn read_png(bytes: &[u8]) -> Result<Image, PngError> {
    let mut reader = ::png::Decoder::new(std::io::Cursor::new(bytes)).read_info().map_err(PngError::Read)?;
    let size = reader.output_buffer_size().unwrap_or(0);
    let mut data = vec![0; size];
    let info = reader.next_frame(&mut data).map_err(PngError::Read)?;
    let step = match info.color_type {
        ::png::ColorType::Rgb => 3,
        ::png::ColorType::Rgba => 4,
        other => return Err(PngError::Kind(other)),
    };
    Ok(Image {
        width: info.width as usize,
        height: info.height as usize,
        pixels: data[..info.buffer_size()].chunks_exact(step).map(|p| [p[0], p[1], p[2]]).collect(),
    })
}

/// File name of one picture of a sequence: `frame_0001.png` for index 0.
#[must_use]
pub fn sequence_name(index: usize) -> PathBuf {
    PathBuf::from(format!("frame_{:04}.png", index + 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_comes_back_as_it_was() {
        let mut image = Image::filled(7, 3, [250, 128, 3]);
        image.pixels[9] = [1, 2, 3];
        let mut bytes = Vec::new();
        write_png(&image, &mut bytes).unwrap();
        assert_eq!(read_png(&bytes).unwrap(), image);
        assert!(read_png(&bytes[..40]).is_err());
        assert_eq!(sequence_name(0).to_str(), Some("frame_0001.png"));
    }
}
