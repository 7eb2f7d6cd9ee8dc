//! The frames of an animated GIF.
use std::io::{BufRead, Read, Seek, SeekFrom};
use std::num::NonZero;
use std::sync::Arc;

use gif::{DecodeOptions, Decoder, DecodingError, DisposalMethod, MemoryLimit};
use image::error::{DecodingError as FormatError, ImageFormatHint};
use image::{DynamicImage, GrayImage, ImageError, ImageFormat, RgbImage};

use crate::picture_file::channel::Channel;
use crate::picture_file::error::PictureErrorKind;
use crate::picture_file::gif_interval::constant_interval;
use crate::picture_file::picture::{DECODER_LIMIT, PIXEL_LIMIT, check_size, damaged};

/// Time that a frame stands where the file says 0, in seconds: what browsers do.
const DEFAULT_DELAY: f64 = 0.1;

/// Pixels that an animation may unpack to, however short it is: four of the largest pictures. Where a way of tracing is chosen each is
/// traced several times.
const FREE_PIXELS: u64 = 1 << 28;

/// Pixels more for every byte of it. Pictures of one colour pack about 1300 pixels to a byte, masks some hundreds.
const PIXELS_PER_BYTE: u64 = 512;

/// The frames of an animated GIF as grey values, one in memory at a time. A frame that shows nothing new is the picture before it.
///
/// Frames are put together as browsers do: over each other, on a transparent ground, without the background colour of the file.
pub(crate) struct GifAnimation {
    decoder: Decoder<Box<dyn Read>>,
    canvas: Canvas,
    /// The latest picture.
    shown: Option<Arc<GrayImage>>,
    /// What becomes of the latest frame before the next one is drawn.
    disposal: Option<(Rect, Disposal)>,
    /// Colour indices of a frame.
    indices: Vec<u8>,
    work: Work,
    clock: Clock,
}

enum Disposal {
    Clear,
    Restore(Vec<Pixel>),
}

/// Pixels unpacked so far, and how many may be.
struct Work {
    done: u64,
    limit: u64,
}

impl Work {
    fn add(&mut self, pixels: u64) -> Result<(), PictureErrorKind> {
        self.done += pixels;
        if self.done > self.limit { Err(PictureErrorKind::TooMuchWork { limit: self.limit }) } else { Ok(()) }
    }
}

/// Times of the frames.
struct Clock {
    /// Time of the next frame in seconds.
    time: f64,
    /// Seconds from frame to frame where the delays are those of a constant rate, and frames read.
    constant: Option<(f64, u64)>,
}

impl Clock {
    /// The time of a frame that stands for so many hundredths of a second.
    fn next(&mut self, delay: u16) -> f64 {
        let time = self.time;
        let delay = f64::from(u32::from(delay) * 10) / 1000.0;
        self.time = match &mut self.constant {
            Some((interval, count)) => {
                *count += 1;
                *interval * *count as f64
            }
            None => time + if delay > 0.0 { delay } else { DEFAULT_DELAY },
        };
        time
    }
}

/// What is known of a frame before its pixels are.
struct FrameHead {
    area: Rect,
    size: [usize; 2],
    dispose: DisposalMethod,
    delay: u16,
    transparent: Option<u8>,
}

impl GifAnimation {
    /// Reads the header.
    pub(crate) fn open(mut source: impl BufRead + Seek + 'static, channel: Channel) -> Result<Self, PictureErrorKind> {
        let interval = constant_interval(&mut source)?;
        let bytes = source.seek(SeekFrom::End(0))?;
        source.rewind()?;
        let mut options = DecodeOptions::new();
        options.set_memory_limit(MemoryLimit::Bytes(NonZero::new(DECODER_LIMIT).unwrap_or(NonZero::<u64>::MIN)));
        let decoder = options.read_info(Box::new(source) as Box<dyn Read>).map_err(unreadable)?;
        let (width, height) = (u32::from(decoder.width()), u32::from(decoder.height()));
        check_size(width, height)?;
        Ok(Self {
            decoder,
            canvas: Canvas::new(width, height, channel),
            shown: None,
            disposal: None,
            indices: Vec::new(),
            work: Work { done: 0, limit: FREE_PIXELS + PIXELS_PER_BYTE.saturating_mul(bytes) },
            clock: Clock { time: 0.0, constant: interval.map(|interval| (interval, 0)) },
        })
    }

    /// The next picture and its time in seconds; `None` at the end.
    pub(crate) fn next(&mut self) -> Result<Option<(Arc<GrayImage>, f64)>, PictureErrorKind> {
        let Some(head) = self.next_head()? else { return Ok(None) };
        let pixels = head.size[0] as u64 * head.size[1] as u64;
        if pixels > PIXEL_LIMIT {
            let [width, height] = head.size.map(|length| length as u32);
            return Err(PictureErrorKind::TooLarge { width, height, limit: PIXEL_LIMIT });
        }
        self.work.add(pixels)?;
        self.indices.resize(head.size[0] * head.size[1], 0);
        self.decoder.read_into_buffer(&mut self.indices).map_err(unreadable)?;
        let palette = self.canvas.palette(self.decoder.palette().map_err(unreadable)?, head.transparent);

        let disposal = self.disposal.take();
        let touched = [disposal.as_ref().map(|(area, _)| *area), Some(head.area)];
        let before: Vec<(Rect, Vec<Pixel>)> =
            touched.into_iter().flatten().map(|area| (area, self.canvas.copy(area))).collect();
        match disposal {
            Some((area, Disposal::Clear)) => self.canvas.fill(area, |_, _| Some(Pixel::TRANSPARENT)),
            Some((area, Disposal::Restore(old))) => self.canvas.fill(area, |x, y| old.get(y * area.width + x).copied()),
            None => {}
        }
        self.disposal = match head.dispose {
            DisposalMethod::Any | DisposalMethod::Keep => None,
            DisposalMethod::Background => Some((head.area, Disposal::Clear)),
            DisposalMethod::Previous => Some((head.area, Disposal::Restore(self.canvas.copy(head.area)))),
        };
        let (indices, stride) = (&self.indices, head.size[0]);
        self.canvas.fill(head.area, |x, y| palette[usize::from(indices[y * stride + x])]);

        let is_as_before = before.iter().all(|(area, pixels)| self.canvas.is_as(*area, pixels));
        let picture = match &self.shown {
            Some(shown) if is_as_before => Arc::clone(shown),
            _ => {
                self.work.add(self.canvas.pixels.len() as u64)?;
                // The old one goes before the new one comes.
                self.shown = None;
                Arc::new(self.canvas.picture())
            }
        };
        self.shown = Some(Arc::clone(&picture));
        Ok(Some((picture, self.clock.next(head.delay))))
    }

    fn next_head(&mut self) -> Result<Option<FrameHead>, PictureErrorKind> {
        let (columns, rows) = (self.canvas.width, self.canvas.height);
        let Some(frame) = self.decoder.next_frame_info().map_err(unreadable)? else { return Ok(None) };
        let [left, top, width, height] = [frame.left, frame.top, frame.width, frame.height].map(usize::from);
        let area = Rect {
            left: left.min(columns),
            top: top.min(rows),
            width: width.min(columns.saturating_sub(left)),
            height: height.min(rows.saturating_sub(top)),
        };
        let (dispose, delay, transparent) = (frame.dispose, frame.delay, frame.transparent);
        Ok(Some(FrameHead { area, size: [width, height], dispose, delay, transparent }))
    }
}

/// The part of a frame within the canvas.
#[derive(Debug, Clone, Copy)]
struct Rect {
    left: usize,
    top: usize,
    width: usize,
    height: usize,
}

/// What is looked at of a colour, and whether there is one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Pixel {
    value: u8,
    is_visible: bool,
}

impl Pixel {
    const TRANSPARENT: Self = Self { value: 0, is_visible: false };
}

/// What is seen.
struct Canvas {
    width: usize,
    height: usize,
    channel: Channel,
    pixels: Vec<Pixel>,
    /// Pixels that are not visible.
    hidden: usize,
}

impl Canvas {
    fn new(width: u32, height: u32, channel: Channel) -> Self {
        let (width, height) = (width as usize, height as usize);
        let hidden = width * height;
        Self { width, height, channel, pixels: vec![Pixel::TRANSPARENT; hidden], hidden }
    }

    /// What a colour index draws, nothing where it is transparent or has no colour.
    fn palette(&self, colours: &[u8], transparent: Option<u8>) -> [Option<Pixel>; 256] {
        let count = (colours.len() / 3).min(256);
        let known = RgbImage::from_raw(count as u32, 1, colours[..3 * count].to_vec()).unwrap_or_default();
        let values = self.channel.of(DynamicImage::ImageRgb8(known));
        let mut palette = [None; 256];
        for (pixel, &value) in palette.iter_mut().zip(values.as_raw()) {
            *pixel = Some(Pixel { value, is_visible: true });
        }
        if let Some(transparent) = transparent {
            palette[usize::from(transparent)] = None;
        }
        palette
    }

    fn rows(&self, area: Rect) -> impl Iterator<Item = &[Pixel]> {
        let starts = (area.top..area.top + area.height).map(move |row| row * self.width + area.left);
        starts.map(move |from| &self.pixels[from..from + area.width])
    }

    fn copy(&self, area: Rect) -> Vec<Pixel> {
        let mut copy = Vec::with_capacity(area.width * area.height);
        self.rows(area).for_each(|row| copy.extend_from_slice(row));
        copy
    }

    fn is_as(&self, area: Rect, pixels: &[Pixel]) -> bool {
        area.width == 0 || self.rows(area).zip(pixels.chunks_exact(area.width)).all(|(row, other)| row == other)
    }

    /// Draws what there is for a column and row of an area.
    fn fill(&mut self, area: Rect, new: impl Fn(usize, usize) -> Option<Pixel>) {
        for y in 0..area.height {
            let from = (area.top + y) * self.width + area.left;
            for (x, pixel) in self.pixels[from..from + area.width].iter_mut().enumerate() {
                let Some(new) = new(x, y) else { continue };
                self.hidden += usize::from(!new.is_visible);
                self.hidden -= usize::from(!pixel.is_visible);
                *pixel = new;
            }
        }
    }

    fn picture(&self) -> GrayImage {
        let shows_alpha = self.channel == Channel::Luminance && self.hidden > 0;
        let grey = |pixel: &Pixel| match (shows_alpha, pixel.is_visible) {
            (true, true) => u8::MAX,
            (true, false) => 0,
            (false, _) => pixel.value,
        };
        let grey = self.pixels.iter().map(grey).collect();
        GrayImage::from_raw(self.width as u32, self.height as u32, grey).unwrap_or_default()
    }
}

fn unreadable(error: DecodingError) -> PictureErrorKind {
    damaged(match error {
        DecodingError::Io(error) => ImageError::IoError(error),
        other => ImageError::Decoding(FormatError::new(ImageFormatHint::Exact(ImageFormat::Gif), other)),
    })
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use gif::{Encoder, Frame};
    use image::AnimationDecoder as _;
    use image::codecs::gif::GifDecoder;
    use proptest::prelude::*;

    use super::*;

    type Drawn = (u16, u16, u16, u16, u8, Option<u8>, Vec<u8>);

    fn encoded(frames: &[Drawn]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let palette: Vec<u8> = (0..12).map(|k| k * 20).collect();
        let mut encoder = Encoder::new(&mut bytes, 12, 9, &palette).expect("memory");
        for (left, top, width, height, dispose, transparent, indices) in frames {
            let frame = Frame {
                delay: 7,
                dispose: DisposalMethod::from_u8(*dispose).expect("0 to 3"),
                transparent: *transparent,
                left: *left,
                top: *top,
                width: *width,
                height: *height,
                buffer: indices.iter().copied().cycle().take(usize::from(*width * *height)).collect::<Vec<_>>().into(),
                ..Frame::default()
            };
            encoder.write_frame(&frame).expect("memory");
        }
        drop(encoder);
        bytes
    }

    fn pictures(bytes: Vec<u8>, channel: Channel) -> Vec<Arc<GrayImage>> {
        let mut animation = GifAnimation::open(Cursor::new(bytes), channel).expect("a GIF");
        std::iter::from_fn(|| animation.next().expect("a GIF")).map(|(picture, _)| picture).collect()
    }

    proptest! {
        #[test]
        fn frames_are_put_together_as_the_decoder_of_the_image_crate_does(
            frames in prop::collection::vec(
                (0..14_u16, 0..11_u16, 1..13_u16, 1..10_u16, 0..4_u8, prop::option::of(0..4_u8), prop::collection::vec(0..4_u8, 1..7)),
                1..9,
            ),
        ) {
            let bytes = encoded(&frames);
            let decoder = GifDecoder::new(Cursor::new(bytes.clone())).expect("a GIF");
            let expected = decoder.into_frames().collect_frames().expect("a GIF");
            for channel in [Channel::Luminance, Channel::Red, Channel::Saturation] {
                let found = pictures(bytes.clone(), channel);
                prop_assert_eq!(found.len(), expected.len());
                for (found, frame) in found.iter().zip(&expected) {
                    let wanted = channel.of(DynamicImage::ImageRgba8(frame.buffer().clone()));
                    prop_assert_eq!(&**found, &wanted);
                }
            }
        }
    }

    #[test]
    fn a_frame_that_shows_nothing_new_is_the_picture_before_it() {
        let dot = (3, 3, 1, 1, 1, None, vec![2]);
        let found =
            pictures(encoded(&[dot.clone(), dot.clone(), (0, 0, 12, 9, 1, Some(1), vec![1]), dot]), Channel::Red);
        assert_eq!(found.len(), 4);
        assert!(found.iter().all(|picture| Arc::ptr_eq(picture, &found[0])));
    }

    #[test]
    fn an_animation_that_unpacks_to_too_much_ends_with_a_word() {
        let frames: Vec<Drawn> = (0..4).map(|k| (0, 0, 12, 9, 1, None, vec![k])).collect();
        let mut animation = GifAnimation::open(Cursor::new(encoded(&frames)), Channel::Luminance).expect("a GIF");
        animation.work.limit = 5 * 12 * 9;
        assert!(animation.next().is_ok() && animation.next().is_ok());
        let error = animation.next().expect_err("more than five pictures of work");
        assert_eq!(
            error.to_string(),
            "the animation unpacks to more than 540 pixels, which is too much for its length"
        );
    }
}
