use std::cell::RefCell;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use image::codecs::gif::{GifEncoder, Repeat};
use image::{Delay, DynamicImage, Frame, RgbImage};

use super::folder::DrawingFolder;
use crate::failure::{Failure, plain};
use crate::output::WholeFile;

/// How finely the colours of a GIF are chosen, 1 to 30; larger is faster.
const GIF_SPEED: i32 = 10;

/// Milliseconds that a picture of an animation stands.
const GIF_DELAY: u32 = 70;

/// Where drawn pictures go.
pub(super) enum Target {
    Folder(DrawingFolder),
    Gif(GifFile),
}

/// An animation, which is put in its place when it is whole.
pub(super) struct GifFile {
    path: PathBuf,
    encoder: GifEncoder<SharedFile>,
    file: SharedFile,
    is_empty: bool,
}

impl Target {
    /// A GIF where the path ends so, else a folder.
    pub(super) fn open(path: &Path) -> Result<Self, Failure> {
        let is_gif = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gif"));
        if is_gif && !path.is_dir() {
            GifFile::open(path).map(Self::Gif)
        } else {
            DrawingFolder::open(path).map(Self::Folder)
        }
    }

    /// Writes the picture of a frame.
    pub(super) fn write(&mut self, frame: u64, picture: RgbImage) -> Result<(), Failure> {
        match self {
            Self::Folder(folder) => folder.write(frame, &picture),
            Self::Gif(gif) => gif.write(picture),
        }
    }

    /// Puts an animation in its place.
    pub(super) fn finish(self) -> Result<(), Failure> {
        match self {
            Self::Folder(_) => Ok(()),
            Self::Gif(gif) => gif.finish(),
        }
    }
}

impl GifFile {
    fn open(path: &Path) -> Result<Self, Failure> {
        let file = SharedFile(Rc::new(RefCell::new(WholeFile::create(path)?)));
        let mut encoder = GifEncoder::new_with_speed(file.clone(), GIF_SPEED);
        encoder.set_repeat(Repeat::Infinite).map_err(|error| picture_failure(path, &error))?;
        Ok(Self { path: path.to_owned(), encoder, file, is_empty: true })
    }

    fn write(&mut self, picture: RgbImage) -> Result<(), Failure> {
        self.is_empty = false;
        let picture = DynamicImage::ImageRgb8(picture).into_rgba8();
        let delay = Delay::from_numer_denom_ms(GIF_DELAY, 1);
        let written = self.encoder.encode_frame(Frame::from_parts(picture, 0, 0, delay));
        written.map_err(|error| picture_failure(&self.path, &error))
    }

    /// Nothing is left where there was no picture.
    fn finish(self) -> Result<(), Failure> {
        let Self { encoder, file, is_empty, .. } = self;
        // Ends the animation.
        drop(encoder);
        match Rc::into_inner(file.0) {
            Some(file) if !is_empty => file.into_inner().finish(),
            _ => Ok(()),
        }
    }
}

/// A file that an encoder writes to which does not give it back.
#[derive(Clone)]
struct SharedFile(Rc<RefCell<WholeFile>>);

impl Write for SharedFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.borrow_mut().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.borrow_mut().flush()
    }
}

fn picture_failure(path: &Path, error: &image::ImageError) -> Failure {
    match error {
        image::ImageError::IoError(error) => Failure::unusable(format_args!("{}: {}", path.display(), plain(error))),
        other => Failure::unusable(format_args!("{}: {other}", path.display())),
    }
}
