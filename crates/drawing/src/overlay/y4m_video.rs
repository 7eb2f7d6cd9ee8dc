use std::io::{self, Write};

use image::{Rgb, RgbImage};

use crate::error::DrawingError;

/// Pictures per second where the input does not tell.
const USUAL_RATE: f64 = 30.0;

/// An uncompressed video (YUV4MPEG2, 4:4:4) of drawn pictures, which ffmpeg and others read.
///
/// ```
/// use freeform_drawing::Y4mVideo;
/// use image::RgbImage;
///
/// let mut video = Y4mVideo::new(Vec::new());
/// video.write(&RgbImage::new(4, 2), Some(0.04))?;
/// let bytes = video.finish().expect("there was a picture");
/// assert!(bytes.starts_with(b"YUV4MPEG2 W4 H2 F25000:1000 "));
/// # Ok::<(), freeform_drawing::DrawingError>(())
/// ```
#[derive(Debug)]
pub struct Y4mVideo<W: Write> {
    sink: W,
    /// Columns and rows, once there is a picture.
    size: Option<(u32, u32)>,
}

impl<W: Write> Y4mVideo<W> {
    /// A video without a picture.
    pub fn new(sink: W) -> Self {
        Self { sink, size: None }
    }

    /// Adds a picture. The seconds that the first one stands for are the time from picture to picture; a thirtieth where that is not known. All
    /// pictures have the size of the first.
    ///
    /// # Errors
    ///
    /// [`DrawingError::Io`] of the sink, [`DrawingError::PictureSize`] if the picture has not the size of the first one, or a side of 0.
    pub fn write(&mut self, picture: &RgbImage, seconds: Option<f64>) -> Result<(), DrawingError> {
        let (width, height) = picture.dimensions();
        if width == 0 || height == 0 || self.size.is_some_and(|size| size != (width, height)) {
            return Err(DrawingError::PictureSize { width, height });
        }
        if self.size.is_none() {
            self.begin(picture, seconds)?;
            self.size = Some((width, height));
        }
        self.sink.write_all(b"FRAME\n")?;
        for plane in 0..3 {
            let values: Vec<u8> = picture.pixels().map(|pixel| luma_and_chroma(pixel)[plane]).collect();
            self.sink.write_all(&values)?;
        }
        Ok(())
    }

    fn begin(&mut self, picture: &RgbImage, seconds: Option<f64>) -> io::Result<()> {
        let rate = seconds.map_or(USUAL_RATE, |seconds| 1.0 / seconds);
        let thousandths = (1000.0 * rate).round().clamp(1.0, 1e9) as u64;
        let (width, height) = picture.dimensions();
        writeln!(self.sink, "YUV4MPEG2 W{width} H{height} F{thousandths}:1000 Ip A1:1 C444")
    }

    /// Hands back the sink; `None` where no picture was written.
    pub fn finish(self) -> Option<W> {
        self.size.map(|_| self.sink)
    }
}

/// Y, Cb and Cr of a colour, in the range of studios (ITU-R BT.601).
fn luma_and_chroma(Rgb(colour): &Rgb<u8>) -> [u8; 3] {
    let [red, green, blue] = colour.map(|value| f64::from(value) / 255.0);
    let y = 0.299 * red + 0.587 * green + 0.114 * blue;
    let chroma = |value: f64, range: f64| (128.0 + 112.0 * (value - y) / range).round() as u8;
    [(16.0 + 219.0 * y).round() as u8, chroma(blue, 0.886), chroma(red, 0.701)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_those_of_the_standard() {
        for (colour, expected) in [
            ([0, 0, 0], [16, 128, 128]),
            ([255, 255, 255], [235, 128, 128]),
            ([255, 0, 0], [81, 90, 240]),
            ([0, 0, 255], [41, 240, 110]),
        ] {
            assert_eq!(luma_and_chroma(&Rgb(colour)), expected, "{colour:?}");
        }
    }
}
