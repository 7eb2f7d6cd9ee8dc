//! Uncompressed video as `ffmpeg -f yuv4mpegpipe` and mjpegtools write it (YUV4MPEG2, see the manual page yuv4mpeg(5)).
use std::io::{self, BufRead, Read};

use image::GrayImage;

use crate::channel::Channel;
use crate::picture::check_size;
use crate::picture_error::PictureErrorKind;

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
                let at = |index: usize| index / width / y_step * chroma_width + index % width / x_step;
                let colours = luma.iter().enumerate().map(|(i, &y)| colour(y, blue[at(i)], rest[at(i)]));
                colours.map(|colour| channel.of_colour(colour)).collect()
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

/// Red, green and blue of one pixel, for video levels of ITU-R BT.601.
fn colour(luma: u8, blue_difference: u8, red_difference: u8) -> [u8; 3] {
    let y = 1.164 * (f64::from(luma) - 16.0);
    let (u, v) = (f64::from(blue_difference) - 128.0, f64::from(red_difference) - 128.0);
    [y + 1.596 * v, y - 0.392 * u - 0.813 * v, y + 2.017 * u].map(|value| value.round() as u8)
}

fn shortened(text: &str) -> String {
    let mut short: String = text.chars().take(QUOTED).collect();
    if short.len() < text.len() {
        short.push_str("...");
    }
    short
}
