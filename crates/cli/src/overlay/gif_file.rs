use std::borrow::Cow;
use std::path::{Path, PathBuf};

use gif::{DisposalMethod, Encoder, EncodingError, Frame, Repeat};
use image::RgbImage;

use super::palette::{Palette, TRANSPARENT};
use crate::failure::{Failure, plain};
use crate::output::WholeFile;

/// Levels of grey that a pixel may be off before it is drawn anew: noise of a camera that nobody sees is most of an animation otherwise.
const TOLERANCE: u8 = 2;

/// Hundredths of a second that a picture stands where the input does not tell.
const USUAL_DELAY: u16 = 7;

/// An animation, which is put in its place when it is whole. Every picture is what differs from the one before: the rectangle of what has
/// changed, transparent where it has not.
pub(super) struct GifFile {
    path: PathBuf,
    palette: Palette,
    state: State,
}

enum State {
    /// No picture yet.
    Empty(WholeFile),
    Begun {
        encoder: Box<Encoder<WholeFile>>,
        shown: Shown,
    },
    /// An error ended it.
    Ended,
}

/// The picture as it is seen so far.
struct Shown {
    width: usize,
    pixels: Vec<u8>,
}

/// A rectangle of pixels.
struct Changed {
    left: usize,
    top: usize,
    width: usize,
    pixels: Vec<u8>,
}

impl GifFile {
    pub(super) fn open(path: &Path) -> Result<Self, Failure> {
        let file = WholeFile::create(path)?;
        Ok(Self { path: path.to_owned(), palette: Palette::new(), state: State::Empty(file) })
    }

    /// Adds a picture that stands for so many seconds.
    pub(super) fn write(&mut self, picture: &RgbImage, seconds: Option<f64>) -> Result<(), Failure> {
        let pixels: Vec<u8> = picture.pixels().map(|pixel| self.palette.nearest(*pixel)).collect();
        let width = picture.width() as usize;
        let (mut encoder, mut shown) = match std::mem::replace(&mut self.state, State::Ended) {
            State::Empty(file) => {
                let encoder = self.begin(file, picture).map_err(|error| failure(&self.path, &error))?;
                (Box::new(encoder), Shown { width, pixels: vec![TRANSPARENT; pixels.len()] })
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
        encoder.write_frame(&frame).map_err(|error| failure(&self.path, &error))?;
        self.state = State::Begun { encoder, shown };
        Ok(())
    }

    fn begin(&self, file: WholeFile, picture: &RgbImage) -> Result<Encoder<WholeFile>, EncodingError> {
        // A side too long for the format is an error of the encoder, as 0 is.
        let [width, height] = [picture.width(), picture.height()].map(|side| u16::try_from(side).unwrap_or(0));
        let mut encoder = Encoder::new(file, width, height, &self.palette.bytes())?;
        encoder.set_repeat(Repeat::Infinite)?;
        Ok(encoder)
    }

    /// Nothing is left where there was no picture.
    pub(super) fn finish(self) -> Result<(), Failure> {
        match self.state {
            State::Begun { encoder, .. } => encoder.into_inner().map_err(|error| failure(&self.path, &error))?.finish(),
            State::Empty(_) | State::Ended => Ok(()),
        }
    }
}

impl Shown {
    /// Shows a picture, and gives what of it is to be drawn for that.
    fn change_to(&mut self, pixels: &[u8]) -> Changed {
        let is_changed =
            |old: u8, new: u8| old != new && Palette::levels_between(old, new).is_none_or(|levels| levels > TOLERANCE);
        let (mut left, mut right, mut top, mut bottom) = (self.width, 0, usize::MAX, 0);
        for (row, (old, new)) in self.pixels.chunks(self.width).zip(pixels.chunks(self.width)).enumerate() {
            let mut changed = (0..self.width).filter(|x| is_changed(old[*x], new[*x]));
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
            let places = row * self.width + left..row * self.width + right + 1;
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

fn failure(path: &Path, error: &EncodingError) -> Failure {
    match error {
        EncodingError::Io(error) => Failure::unusable(format_args!("{}: {}", path.display(), plain(error))),
        other => Failure::unusable(format_args!("{}: {other}", path.display())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_has_changed_is_drawn_and_small_changes_add_up_until_they_are() {
        let mut shown = Shown { width: 4, pixels: vec![10; 12] };
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
