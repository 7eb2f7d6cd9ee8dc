//! Uncompressed video as `ffmpeg -f yuv4mpegpipe` and mjpegtools write it (YUV4MPEG2, see the manual page yuv4mpeg(5)).
use std::io::{self, BufRead, Read};

use image::GrayImage;

use crate::picture_file::channel::Channel;
use crate::picture_file::error::PictureErrorKind;
use crate::picture_file::picture::check_size;

/// First word of a file.
pub(crate) const MAGIC: &[u8] = b"YUV4MPEG2";

/// Longest header line accepted, in bytes.
const LINE_LIMIT: u64 = 1 << 12;

/// Most bytes of a line quoted in a message.
const QUOTED: usize = 40;

/// How the samples of one frame are stored: the luma plane, then the two chroma planes, then an alpha plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Layout {
    /// Columns and rows of luma for one sample of chroma; `None` for grey video.
    chroma: Option<(usize, usize)>,
    /// Bits of a sample: 8, or 9 to 16 in two bytes, low byte first.
    bits: u32,
    has_alpha: bool,
}

impl Layout {
    /// Of the value of the `C` parameter.
    fn parse(text: &str) -> Option<Self> {
        let (family, bits) = match text.strip_prefix("mono") {
            Some("") => ("mono", "8"),
            Some(bits) => ("mono", bits),
            None => text.split_once('p').filter(|(_, bits)| bits.parse::<u32>().is_ok()).unwrap_or((text, "8")),
        };
        let bits = bits.parse().ok().filter(|bits| (8..=16).contains(bits))?;
        let (chroma, has_alpha) = match family {
            "mono" => (None, false),
            "420" | "420jpeg" | "420paldv" | "420mpeg2" => (Some((2, 2)), false),
            "411" => (Some((4, 1)), false),
            "422" => (Some((2, 1)), false),
            "444" => (Some((1, 1)), false),
            "444alpha" => (Some((1, 1)), true),
            _ => return None,
        };
        Some(Self { chroma, bits, has_alpha })
    }

    fn bytes_per_sample(self) -> usize {
        if self.bits > 8 { 2 } else { 1 }
    }

    /// Columns and rows of a chroma plane.
    fn chroma_size(self, width: usize, height: usize) -> (usize, usize) {
        self.chroma.map_or((0, 0), |(x, y)| (width.div_ceil(x), height.div_ceil(y)))
    }
}

/// Reads video frame by frame; one frame is in memory at a time.
#[derive(Debug)]
pub(crate) struct VideoReader<R> {
    source: R,
    width: u32,
    height: u32,
    layout: Layout,
    /// Frames per second, if the header states them.
    pub(crate) frame_rate: Option<f64>,
    /// Width of a pixel over its height, if the header states it.
    pub(crate) pixel_aspect: Option<f64>,
    /// Whether the header says that the lines of a frame are of two moments.
    pub(crate) is_interlaced: bool,
    channel: Channel,
    buffer: Vec<u8>,
    ended: bool,
}

impl<R: BufRead> VideoReader<R> {
    /// Reads the header.
    pub(crate) fn open(mut source: R, channel: Channel) -> Result<Self, PictureErrorKind> {
        let line = header_line(&mut source)?.ok_or(PictureErrorKind::Empty)?;
        let mut words = line.split_ascii_whitespace();
        if words.next().is_none_or(|word| word.as_bytes() != MAGIC) {
            return Err(PictureErrorKind::NotAPicture);
        }
        let (mut width, mut height) = (None, None);
        let (mut frame_rate, mut pixel_aspect) = (None, None);
        let mut is_interlaced = false;
        let mut layout = Layout { chroma: Some((2, 2)), bits: 8, has_alpha: false };
        for word in words {
            let mut characters = word.chars();
            let name = characters.next().unwrap_or(' ');
            let value = characters.as_str();
            let wrong = || PictureErrorKind::VideoParameter { name, value: shortened(value) };
            match name {
                'W' => width = Some(value.parse().ok().filter(|w| *w > 0).ok_or_else(wrong)?),
                'H' => height = Some(value.parse().ok().filter(|h| *h > 0).ok_or_else(wrong)?),
                'F' => frame_rate = ratio(value).ok_or_else(wrong)?,
                'I' => is_interlaced = matches!(value, "t" | "b" | "m"),
                'A' => pixel_aspect = ratio(value).ok_or_else(wrong)?,
                'C' => layout = Layout::parse(value).ok_or_else(wrong)?,
                _ => {}
            }
        }
        let (Some(width), Some(height)) = (width, height) else {
            return Err(PictureErrorKind::VideoWithoutSize { header: shortened(&line) });
        };
        check_size(width, height)?;
        let (buffer, ended) = (Vec::new(), false);
        Ok(Self { source, width, height, layout, frame_rate, pixel_aspect, is_interlaced, channel, buffer, ended })
    }

    fn read_frame(&mut self) -> Result<Option<GrayImage>, PictureErrorKind> {
        let Some(line) = header_line(&mut self.source)? else { return Ok(None) };
        if line != "FRAME" && !line.starts_with("FRAME ") {
            return Err(PictureErrorKind::NotAVideoFrame { found: shortened(&line) });
        }
        let (width, height) = (self.width as usize, self.height as usize);
        let (chroma_width, chroma_height) = self.layout.chroma_size(width, height);
        let (luma, chroma) = (width * height, chroma_width * chroma_height);
        let alpha = if self.layout.has_alpha { luma } else { 0 };
        let expected = (luma + 2 * chroma + alpha) * self.layout.bytes_per_sample();
        self.buffer.clear();
        let found = self.source.by_ref().take(expected as u64).read_to_end(&mut self.buffer)?;
        if found < expected {
            return Err(PictureErrorKind::FrameCutShort { found, expected });
        }
        if self.layout.bits > 8 {
            let shift = self.layout.bits - 8;
            for at in 0..expected / 2 {
                let sample = u16::from_le_bytes([self.buffer[2 * at], self.buffer[2 * at + 1]]);
                self.buffer[at] = u8::try_from(sample >> shift).unwrap_or(u8::MAX);
            }
            self.buffer.truncate(expected / 2);
        }
        let grey = match (self.channel, self.layout.chroma) {
            (Channel::Luminance, _) | (_, None) => self.buffer[..luma].to_vec(),
            (channel, Some((x_step, y_step))) => {
                let (luma, rest) = self.buffer.split_at(luma);
                let (blue, rest) = rest.split_at(chroma);
                let mut grey = vec![0; luma.len()];
                let rows = grey.chunks_exact_mut(width).zip(luma.chunks_exact(width));
                for (row, (grey, luma)) in rows.enumerate() {
                    let of_row = row / y_step * chroma_width..(row / y_step + 1) * chroma_width;
                    set_channel(channel, grey, luma, [&blue[of_row.clone()], &rest[of_row]], x_step);
                }
                grey
            }
        };
        Ok(GrayImage::from_raw(self.width, self.height, grey))
    }
}

impl<R: BufRead> Iterator for VideoReader<R> {
    type Item = Result<GrayImage, PictureErrorKind>;

    /// The next frame. After an error there is none: nothing behind it can be trusted.
    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        let frame = self.read_frame().transpose();
        self.ended = !matches!(frame, Some(Ok(_)));
        frame
    }
}

/// A line without its end; `None` where the source ends before it.
fn header_line(source: &mut impl BufRead) -> Result<Option<String>, PictureErrorKind> {
    let mut line = Vec::new();
    source.by_ref().take(LINE_LIMIT).read_until(b'\n', &mut line)?;
    match line.pop() {
        None => Ok(None),
        Some(b'\n') => Ok(Some(String::from_utf8_lossy(&line).into_owned())),
        Some(_) if line.len() as u64 + 1 == LINE_LIMIT => {
            Err(PictureErrorKind::NotAVideoFrame { found: shortened(&String::from_utf8_lossy(&line)) })
        }
        Some(_) => {
            Err(PictureErrorKind::Io(io::Error::new(io::ErrorKind::UnexpectedEof, "the video ends in a header")))
        }
    }
}

/// `numerator:denominator` as a number; the inner `None` for `0:0`, which means unknown.
fn ratio(text: &str) -> Option<Option<f64>> {
    let (numerator, denominator) = text.split_once(':')?;
    let (numerator, denominator): (u32, u32) = (numerator.parse().ok()?, denominator.parse().ok()?);
    match (numerator, denominator) {
        (0, _) => Some(None),
        (_, 0) => None,
        _ => Some(Some(f64::from(numerator) / f64::from(denominator))),
    }
}

/// Products of a factor and the values of a sample less those at which it is nothing: to look them up takes a third of the time.
const fn products(factor: f64, nothing: f64) -> [f64; 256] {
    let (mut products, mut value) = ([0.0; 256], 0);
    while value < 256 {
        products[value] = factor * (value as f64 - nothing);
        value += 1;
    }
    products
}

/// What a sample adds to red, green and blue, for video levels of ITU-R BT.601.
static LUMA: [f64; 256] = products(1.164, 16.0);
static RED_OF_RED: [f64; 256] = products(1.596, 128.0);
static GREEN_OF_BLUE: [f64; 256] = products(0.392, 128.0);
static GREEN_OF_RED: [f64; 256] = products(0.813, 128.0);
static BLUE_OF_BLUE: [f64; 256] = products(2.017, 128.0);

/// A grey value, rounded: cast to a byte it is cut off at 0 and 255.
fn rounded(value: f64) -> u8 {
    (value + 0.5) as u8
}

fn red(luma: u8, red_difference: u8) -> u8 {
    rounded(LUMA[usize::from(luma)] + RED_OF_RED[usize::from(red_difference)])
}

fn green(luma: u8, [blue_difference, red_difference]: [u8; 2]) -> u8 {
    let (blue, red) = (GREEN_OF_BLUE[usize::from(blue_difference)], GREEN_OF_RED[usize::from(red_difference)]);
    rounded(LUMA[usize::from(luma)] - blue - red)
}

fn blue(luma: u8, blue_difference: u8) -> u8 {
    rounded(LUMA[usize::from(luma)] + BLUE_OF_BLUE[usize::from(blue_difference)])
}

/// Sets a row to a channel of its samples: those of luma, and the two differences of colour, each for `x_step` pixels (a power of two).
fn set_channel(channel: Channel, grey: &mut [u8], luma: &[u8], [blues, reds]: [&[u8]; 2], x_step: usize) {
    let shift = x_step.trailing_zeros();
    let pixels = grey.iter_mut().zip(luma).enumerate().map(|(x, (grey, y))| (x >> shift, grey, *y));
    // One loop for each channel: what is done in it is known then.
    match channel {
        Channel::Red => pixels.for_each(|(at, grey, y)| *grey = red(y, reds[at])),
        Channel::Green => pixels.for_each(|(at, grey, y)| *grey = green(y, [blues[at], reds[at]])),
        Channel::Blue => pixels.for_each(|(at, grey, y)| *grey = blue(y, blues[at])),
        channel => pixels.for_each(|(at, grey, y)| {
            let (b, r) = (blues[at], reds[at]);
            *grey = channel.of_colour([red(y, r), green(y, [b, r]), blue(y, b)]);
        }),
    }
}

fn shortened(text: &str) -> String {
    let mut short: String = text.chars().take(QUOTED).collect();
    if short.len() < text.len() {
        short.push_str("...");
    }
    short
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_those_of_bt_601_rounded_to_the_nearest_byte() {
        for (y, u, v) in
            (0..=255).flat_map(|y| (0..=255).step_by(5).flat_map(move |u| (0..=255).map(move |v| (y, u, v))))
        {
            let luma = 1.164 * (f64::from(y) - 16.0);
            let (b, r) = (f64::from(u) - 128.0, f64::from(v) - 128.0);
            let expected = [luma + 1.596 * r, luma - 0.392 * b - 0.813 * r, luma + 2.017 * b];
            let found = [red(y, v), green(y, [u, v]), blue(y, u)];
            assert_eq!(found, expected.map(|value| value.round() as u8), "{y} {u} {v}");
        }
    }
}
