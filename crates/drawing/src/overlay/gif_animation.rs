use std::borrow::Cow;
use std::io::Write;

use gif::{DisposalMethod, Encoder, EncodingError, Frame, Repeat};
use image::RgbImage;

use super::palette::{Palette, TRANSPARENT};
use crate::error::DrawingError;

/// Levels of grey that a pixel may be off before it is drawn anew: noise of a camera that nobody sees is most of an animation otherwise.
const TOLERANCE: u8 = 2;

/// Hundredths of a second that a picture stands where the input does not tell.
const USUAL_DELAY: u16 = 7;

/// An animation of drawn pictures. Every picture is stored as what differs from the one before: the rectangle of what has changed, transparent
/// where it has not. It repeats for ever.
///
/// ```
/// use freeform_drawing::GifAnimation;
/// use image::RgbImage;
///
/// let mut animation = GifAnimation::new(Vec::new());
/// animation.write(&RgbImage::new(20, 10), Some(0.04))?;
/// animation.write(&RgbImage::new(20, 10), None)?;
/// let bytes = animation.finish()?.expect("there were pictures");
/// assert!(bytes.starts_with(b"GIF89a"));
/// # Ok::<(), freeform_drawing::DrawingError>(())
/// ```
pub struct GifAnimation<W: Write> {
    palette: Palette,
    state: State<W>,
}

enum State<W: Write> {
    /// No picture yet.
    Empty(W),
    Begun {
        encoder: Box<Encoder<W>>,
        shown: Shown,
    },
    /// An error ended it.
    Ended,
}

/// The picture as it is seen so far.
struct Shown {
    /// Columns and rows.
    size: [u16; 2],
    pixels: Vec<u8>,
}

/// A rectangle of pixels.
struct Changed {
    left: usize,
    top: usize,
    width: usize,
    pixels: Vec<u8>,
}

impl<W: Write> GifAnimation<W> {
    /// An animation without a picture.
    pub fn new(sink: W) -> Self {
        Self { palette: Palette::new(), state: State::Empty(sink) }
    }

    /// Adds a picture that stands for so many seconds; 0.07 where that is not known. All pictures have the size of the first. After an error of the
    /// sink no more pictures are taken.
    ///
    /// # Errors
    ///
    /// [`DrawingError::Io`] of the sink, [`DrawingError::PictureSize`] if the picture has not the size of the first one, or a side of 0 or of
    /// more than 65535 pixels.
    pub fn write(&mut self, picture: &RgbImage, seconds: Option<f64>) -> Result<(), DrawingError> {
        let size = self.checked_size(picture)?;
        let pixels: Vec<u8> = picture.pixels().map(|pixel| self.palette.nearest(*pixel)).collect();
        let (mut encoder, mut shown) = match std::mem::replace(&mut self.state, State::Ended) {
            State::Empty(sink) => {
                let encoder = self.begin(sink, size)?;
                (Box::new(encoder), Shown { size, pixels: vec![TRANSPARENT; pixels.len()] })
            }
            State::Begun { encoder, shown } => (encoder, shown),
            State::Ended => return Ok(()),
        };
        let Changed { left, top, width, pixels } = shown.change_to(&pixels);
        let hundredths = seconds.map_or(f64::from(USUAL_DELAY), |seconds| (100.0 * seconds).round());
        let frame = Frame {
            delay: hundredths.clamp(2.0, f64::from(u16::MAX)) as u16,
            dispose: DisposalMethod::Keep,
            transparent: Some(TRANSPARENT),
            left: left as u16,
            top: top as u16,
            width: width as u16,
            height: (pixels.len() / width) as u16,
            buffer: Cow::Owned(pixels),
            ..Frame::default()
        };
        encoder.write_frame(&frame)?;
        self.state = State::Begun { encoder, shown };
        Ok(())
    }

    /// Columns and rows, if the format holds them and they are those of the first picture.
    fn checked_size(&self, picture: &RgbImage) -> Result<[u16; 2], DrawingError> {
        let (width, height) = picture.dimensions();
        let sides = [width, height].map(|side| u16::try_from(side).unwrap_or(0));
        let is_other = matches!(&self.state, State::Begun { shown, .. } if shown.size != sides);
        if sides.contains(&0) || is_other { Err(DrawingError::PictureSize { width, height }) } else { Ok(sides) }
    }

    fn begin(&self, sink: W, [width, height]: [u16; 2]) -> Result<Encoder<W>, EncodingError> {
        let mut encoder = Encoder::new(sink, width, height, &self.palette.bytes())?;
        encoder.set_repeat(Repeat::Infinite)?;
        Ok(encoder)
    }

    /// Ends the animation and hands back the sink; `None` where no picture was written.
    ///
    /// # Errors
    ///
    /// [`DrawingError::Io`] of the sink.
    pub fn finish(self) -> Result<Option<W>, DrawingError> {
        match self.state {
            State::Begun { encoder, .. } => Ok(Some(encoder.into_inner()?)),
            State::Empty(_) | State::Ended => Ok(None),
        }
    }
}

impl Shown {
    /// Shows a picture, and gives what of it is to be drawn for that.
    fn change_to(&mut self, pixels: &[u8]) -> Changed {
        let is_changed =
            |old: u8, new: u8| old != new && Palette::levels_between(old, new).is_none_or(|levels| levels > TOLERANCE);
        let width = usize::from(self.size[0]);
        let (mut left, mut right, mut top, mut bottom) = (width, 0, usize::MAX, 0);
        for (row, (old, new)) in self.pixels.chunks(width).zip(pixels.chunks(width)).enumerate() {
            let mut changed = (0..width).filter(|x| is_changed(old[*x], new[*x]));
            if let Some(first) = changed.next() {
                let last = changed.next_back().unwrap_or(first);
                (left, right) = (left.min(first), right.max(last));
                (top, bottom) = (top.min(row), row);
            }
        }
        if top > bottom {
            // A picture that shows nothing new still stands for its time.
            return Changed { left: 0, top: 0, width: 1, pixels: vec![TRANSPARENT] };
        }
        let mut drawn = Vec::with_capacity((right - left + 1) * (bottom - top + 1));
        for row in top..=bottom {
            let places = row * width + left..row * width + right + 1;
            for (old, new) in self.pixels[places.clone()].iter_mut().zip(&pixels[places]) {
                let is_drawn = is_changed(*old, *new);
                drawn.push(if is_drawn { *new } else { TRANSPARENT });
                if is_drawn {
                    *old = *new;
                }
            }
        }
        Changed { left, top, width: right - left + 1, pixels: drawn }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_has_changed_is_drawn_and_small_changes_add_up_until_they_are() {
        let mut shown = Shown { size: [4, 3], pixels: vec![10; 12] };
        let mut picture = vec![10; 12];
        (picture[5], picture[6]) = (40, 12);
        let Changed { left, top, width, pixels } = shown.change_to(&picture);
        assert_eq!((left, top, width, pixels), (1, 1, 1, vec![40]));
        assert_eq!(shown.change_to(&picture).pixels, [TRANSPARENT]);
        picture[6] = 14;
        let Changed { left, top, width, pixels } = shown.change_to(&picture);
        assert_eq!((left, top, width, pixels), (2, 1, 1, vec![14]));
        (picture[0], picture[11]) = (200, 200);
        let all = shown.change_to(&picture);
        assert_eq!((all.width, all.pixels.len(), all.pixels[0], all.pixels[1]), (4, 12, 200, TRANSPARENT));
        assert_eq!(shown.pixels, [200, 10, 10, 10, 10, 40, 14, 10, 10, 10, 10, 200]);
    }
}
