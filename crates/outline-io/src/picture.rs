use std::fs::File;
use std::io::{BufRead, BufReader, Seek, SeekFrom};
use std::path::Path;

use image::codecs::gif::GifDecoder;
use image::{
    AnimationDecoder, DynamicImage, Frames, GrayImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits,
};

use crate::channel::Channel;
use crate::compressed_video::compressed_video;
use crate::gif_interval::constant_interval;
use crate::jpeg_end::reaches_its_end;
use crate::picture_error::{PictureError, PictureErrorKind};

/// Largest number of pixels accepted, 8192 x 8192: tracing then needs less than 1.5 GiB in the worst case.
pub(crate) const PIXEL_LIMIT: u64 = 1 << 26;

/// Most memory that a decoder may take, in bytes: 16 bits in each of 4 channels of the largest picture, twice.
const DECODER_LIMIT: u64 = 1 << 30;

/// Time that a frame of an animation stands where the file says 0, in seconds: what browsers do.
const DEFAULT_DELAY: f64 = 0.1;

/// Reads a picture (PNG, JPEG, TIFF, BMP, or the first frame of a GIF) as grey values. Its content tells the format, not
/// its name.
///
/// Colours become their luminance. Where some pixels are transparent the alpha channel is taken instead, so that the
/// visible part is light on dark.
///
/// # Errors
/// The file cannot be read, is empty, is no picture, has a format that is not supported, has more than 2^26 pixels, or
/// is damaged.
pub fn read_picture(path: impl AsRef<Path>) -> Result<GrayImage, PictureError> {
    read_picture_channel(path, Channel::Luminance)
}

/// Like [`read_picture`], from any source; the name stands in error messages.
///
/// # Errors
/// As [`read_picture`].
pub fn decode_picture(source: impl BufRead + Seek, name: &str) -> Result<GrayImage, PictureError> {
    decode(source, Channel::Luminance).map_err(|kind| PictureError::of_file(name, kind))
}

/// Like [`read_picture`], with what is looked at of a colour picture.
///
/// # Errors
/// As [`read_picture`].
pub fn read_picture_channel(path: impl AsRef<Path>, channel: Channel) -> Result<GrayImage, PictureError> {
    let path = path.as_ref();
    let picture = File::open(path).map_err(PictureErrorKind::Io);
    let picture = picture.and_then(|file| decode(BufReader::new(file), channel));
    picture.map_err(|kind| PictureError::of_file(path.display().to_string(), kind))
}

pub(crate) fn decode(mut source: impl BufRead + Seek, channel: Channel) -> Result<GrayImage, PictureErrorKind> {
    let start = source.fill_buf()?;
    if start.is_empty() {
        return Err(PictureErrorKind::Empty);
    }
    if let Some(format) = compressed_video(start) {
        return Err(PictureErrorKind::CompressedVideo { format });
    }
    let reader = ImageReader::new(source).with_guessed_format()?;
    let Some(format) = reader.format() else { return Err(PictureErrorKind::NotAPicture) };
    if !format.reading_enabled() {
        return Err(PictureErrorKind::Unsupported { format: format.to_mime_type() });
    }
    let mut source = reader.into_inner();
    if format == ImageFormat::Jpeg {
        let start = source.stream_position()?;
        if !reaches_its_end(&mut source)? {
            return Err(PictureErrorKind::CutShort);
        }
        source.seek(SeekFrom::Start(start))?;
    }
    let mut reader = ImageReader::with_format(source, format);
    reader.limits(limits());
    let decoder = reader.into_decoder().map_err(damaged)?;
    // The header has been read, the pixels have not: nothing large is allocated yet.
    let (width, height) = decoder.dimensions();
    check_size(width, height)?;
    Ok(channel.of(DynamicImage::from_decoder(decoder).map_err(damaged)?))
}

fn limits() -> Limits {
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(DECODER_LIMIT);
    limits
}

pub(crate) fn check_size(width: u32, height: u32) -> Result<(), PictureErrorKind> {
    if u64::from(width) * u64::from(height) > PIXEL_LIMIT {
        return Err(PictureErrorKind::TooLarge { width, height, limit: PIXEL_LIMIT });
    }
    Ok(())
}

fn damaged(error: ImageError) -> PictureErrorKind {
    match error {
        ImageError::IoError(error) if error.kind() != std::io::ErrorKind::UnexpectedEof => PictureErrorKind::Io(error),
        error => PictureErrorKind::Damaged(error),
    }
}

enum Source {
    Gif(Frames<'static>),
    One(GrayImage),
    /// All frames have been read, or an error behind which nothing can be trusted.
    Ended,
}

/// The frames of an animated GIF, one in memory at a time, or one picture.
pub(crate) struct Animation {
    frames: Source,
    channel: Channel,
    /// Time of the next frame in seconds.
    time: f64,
    /// Seconds from frame to frame where the delays are those of a constant rate, and frames read.
    constant: Option<(f64, u64)>,
}

impl Animation {
    /// Reads the header.
    pub(crate) fn open(mut source: impl BufRead + Seek + 'static, channel: Channel) -> Result<Self, PictureErrorKind> {
        let interval = constant_interval(&mut source)?;
        let mut decoder = GifDecoder::new(source).map_err(damaged)?;
        let (width, height) = decoder.dimensions();
        check_size(width, height)?;
        decoder.set_limits(limits()).map_err(damaged)?;
        let frames = Source::Gif(decoder.into_frames());
        Ok(Self { frames, channel, time: 0.0, constant: interval.map(|interval| (interval, 0)) })
    }

    pub(crate) fn of_one(picture: GrayImage) -> Self {
        Self { frames: Source::One(picture), channel: Channel::Luminance, time: 0.0, constant: None }
    }
}

impl Iterator for Animation {
    /// A frame and its time in seconds.
    type Item = Result<(GrayImage, f64), PictureErrorKind>;

    fn next(&mut self) -> Option<Self::Item> {
        let frames = match &mut self.frames {
            Source::Gif(frames) => frames,
            Source::One(picture) => {
                let picture = std::mem::take(picture);
                self.frames = Source::Ended;
                return Some(Ok((picture, 0.0)));
            }
            Source::Ended => return None,
        };
        match frames.next()? {
            Ok(frame) => {
                let (numerator, denominator) = frame.delay().numer_denom_ms();
                let delay = f64::from(numerator) / f64::from(denominator) / 1000.0;
                let time = self.time;
                self.time = match &mut self.constant {
                    Some((interval, count)) => {
                        *count += 1;
                        *interval * *count as f64
                    }
                    None => time + if delay > 0.0 { delay } else { DEFAULT_DELAY },
                };
                Some(Ok((self.channel.of(DynamicImage::ImageRgba8(frame.into_buffer())), time)))
            }
            Err(error) => {
                self.frames = Source::Ended;
                Some(Err(damaged(error)))
            }
        }
    }
}

impl std::fmt::Debug for Animation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Animation").field("time", &self.time).finish_non_exhaustive()
    }
}
