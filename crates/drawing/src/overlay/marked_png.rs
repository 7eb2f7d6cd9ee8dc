use std::io::{BufRead, Seek};

use image::RgbImage;

use crate::error::DrawingError;

/// What stands in every drawing, so that those of an earlier run are known from pictures of the user's.
const MARK: (&str, &str) = ("Software", "freeform overlay");

/// A drawn picture as PNG, with a mark by which [`is_marked_png`] knows it again.
///
/// ```
/// use std::io::Cursor;
///
/// use freeform_drawing::{is_marked_png, marked_png};
/// use image::RgbImage;
///
/// let png = marked_png(&RgbImage::new(4, 3))?;
/// assert!(is_marked_png(Cursor::new(png)));
/// assert!(!is_marked_png(Cursor::new(b"another file")));
/// # Ok::<(), freeform_drawing::DrawingError>(())
/// ```
///
/// # Errors
///
/// [`DrawingError::Png`] if the picture has no pixels.
pub fn marked_png(picture: &RgbImage) -> Result<Vec<u8>, DrawingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, picture.width(), picture.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.add_text_chunk(MARK.0.to_owned(), MARK.1.to_owned())?;
    let mut writer = encoder.write_header()?;
    writer.write_image_data(picture.as_raw())?;
    writer.finish()?;
    Ok(bytes)
}

/// Whether a file is a PNG that bears the mark of [`marked_png`].
pub fn is_marked_png(file: impl BufRead + Seek) -> bool {
    png::Decoder::new(file).read_info().is_ok_and(|reader| {
        let texts = &reader.info().uncompressed_latin1_text;
        texts.iter().any(|text| (text.keyword.as_str(), text.text.as_str()) == MARK)
    })
}
