use std::fs::File;
use std::io::{BufRead, BufReader, Seek};
use std::path::Path;

use image::{DynamicImage, GrayImage, ImageDecoder, ImageError, ImageReader, Limits};

use crate::error::{PictureError, PictureErrorKind};

/// Largest number of pixels accepted, 8192 x 8192: tracing then needs less than 1.5 GiB in the worst case.
const PIXEL_LIMIT: u64 = 1 << 26;

/// Most memory that a decoder may take, in bytes: 16 bits in each of 4 channels of the largest picture, twice.
const DECODER_LIMIT: u64 = 1 << 30;

/// Reads a picture (PNG) as grey values. Its content tells the format, not its name.
///
/// Colours become their luminance. Where some pixels are transparent the alpha channel is taken instead, so that the
/// visible part is light on dark.
///
/// # Errors
/// The file cannot be read, is empty, is no picture, has a format that is not supported, has more than 2^26 pixels, or
/// is damaged.
pub fn read_picture(path: impl AsRef<Path>) -> Result<GrayImage, PictureError> {
    let name = path.as_ref().display().to_string();
    match File::open(path.as_ref()) {
        Ok(file) => decode_picture(BufReader::new(file), &name),
        Err(error) => Err(PictureError { file: name, kind: PictureErrorKind::Io(error) }),
    }
}

/// Like [`read_picture`], from any source; the name stands in error messages.
///
/// # Errors
/// As [`read_picture`].
pub fn decode_picture(source: impl BufRead + Seek, name: &str) -> Result<GrayImage, PictureError> {
    decode(source).map_err(|kind| PictureError { file: name.to_owned(), kind })
}

fn decode(mut source: impl BufRead + Seek) -> Result<GrayImage, PictureErrorKind> {
    if source.fill_buf()?.is_empty() {
        return Err(PictureErrorKind::Empty);
    }
    let mut reader = ImageReader::new(source).with_guessed_format()?;
    let Some(format) = reader.format() else { return Err(PictureErrorKind::NotAPicture) };
    if !format.reading_enabled() {
        return Err(PictureErrorKind::Unsupported { format: format.to_mime_type() });
    }
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(DECODER_LIMIT);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(damaged)?;
    // The header has been read, the pixels have not: nothing large is allocated yet.
    let (width, height) = decoder.dimensions();
    if u64::from(width) * u64::from(height) > PIXEL_LIMIT {
        return Err(PictureErrorKind::TooLarge { width, height, limit: PIXEL_LIMIT });
    }
    let picture = DynamicImage::from_decoder(decoder).map_err(damaged)?;
    Ok(visible_part(&picture).unwrap_or_else(|| picture.into_luma8()))
}

/// The alpha channel, if any of the pixels is transparent.
fn visible_part(picture: &DynamicImage) -> Option<GrayImage> {
    if !picture.color().has_alpha() {
        return None;
    }
    let alpha: Vec<u8> = picture.to_luma_alpha8().pixels().map(|pixel| pixel.0[1]).collect();
    let transparent = alpha.iter().any(|&value| value < u8::MAX);
    if transparent { GrayImage::from_raw(picture.width(), picture.height(), alpha) } else { None }
}

fn damaged(error: ImageError) -> PictureErrorKind {
    match error {
        ImageError::IoError(error) if error.kind() != std::io::ErrorKind::UnexpectedEof => PictureErrorKind::Io(error),
        error => PictureErrorKind::Damaged(error),
    }
}
