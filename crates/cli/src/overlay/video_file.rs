use std::io::{self, Write};
use std::path::Path;

use image::{Rgb, RgbImage};

use crate::failure::Failure;
use crate::output::WholeFile;
use crate::picture_input::ASSUMED_RATE;

/// Uncompressed video (y4m), which is put in its place when it is whole.
pub(super) struct VideoFile {
    file: WholeFile,
    is_begun: bool,
}

impl VideoFile {
    pub(super) fn open(path: &Path) -> Result<Self, Failure> {
        Ok(Self { file: WholeFile::create(path)?, is_begun: false })
    }

    /// Adds a picture; that of the first one, so many seconds, is the time from picture to picture.
    pub(super) fn write(&mut self, picture: &RgbImage, seconds: Option<f64>) -> Result<(), Failure> {
        self.try_write(picture, seconds).map_err(|error| self.file.failure(&error))
    }

    fn try_write(&mut self, picture: &RgbImage, seconds: Option<f64>) -> io::Result<()> {
        if !self.is_begun {
            let rate = seconds.map_or(f64::from(ASSUMED_RATE), |seconds| 1.0 / seconds);
            let thousandths = (1000.0 * rate).round().clamp(1.0, 1e9) as u64;
            let (width, height) = picture.dimensions();
            writeln!(self.file, "YUV4MPEG2 W{width} H{height} F{thousandths}:1000 Ip A1:1 C444")?;
            self.is_begun = true;
        }
        self.file.write_all(b"FRAME\n")?;
        for plane in 0..3 {
            let values: Vec<u8> = picture.pixels().map(|pixel| luma_and_chroma(pixel)[plane]).collect();
            self.file.write_all(&values)?;
        }
        Ok(())
    }

    /// Nothing is left where there was no picture.
    pub(super) fn finish(self) -> Result<(), Failure> {
        if self.is_begun { self.file.finish() } else { Ok(()) }
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
