use std::cell::RefCell;
use std::fs;
use std::io::{self, Cursor, Write};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use image::codecs::gif::{GifEncoder, Repeat};
use image::{Delay, DynamicImage, Frame, ImageFormat, RgbImage};

use crate::failure::{Failure, plain};
use crate::output::WholeFile;

/// How finely the colours of a GIF are chosen, 1 to 30; larger is faster.
const GIF_SPEED: i32 = 10;

/// Milliseconds that a picture of an animation stands.
const GIF_DELAY: u32 = 70;

/// Where drawn pictures go.
pub(crate) enum Target {
    Folder(PathBuf),
    Gif(PathBuf, Box<GifEncoder<SharedFile>>, SharedFile),
}

impl Target {
    /// A GIF where the path ends so, else a folder, which is made where it does not exist.
    pub(crate) fn open(path: &Path) -> Result<Self, Failure> {
        let failed = |error: std::io::Error| Failure::unusable(format_args!("{}: {}", path.display(), plain(&error)));
        let is_gif = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gif"));
        if !is_gif {
            fs::create_dir_all(path).map_err(failed)?;
            return Ok(Self::Folder(path.to_owned()));
        }
        let file = SharedFile(Rc::new(RefCell::new(WholeFile::create(path)?)));
        let mut encoder = GifEncoder::new_with_speed(file.clone(), GIF_SPEED);
        encoder.set_repeat(Repeat::Infinite).map_err(|error| picture_failure(path, &error))?;
        Ok(Self::Gif(path.to_owned(), Box::new(encoder), file))
    }

    /// Writes the picture of a frame.
    pub(crate) fn write(&mut self, frame: u64, picture: RgbImage) -> Result<(), Failure> {
        match self {
            Self::Folder(folder) => {
                let path = folder.join(format!("{frame:06}.png"));
                let mut png = Cursor::new(Vec::new());
                picture.write_to(&mut png, ImageFormat::Png).map_err(|error| picture_failure(&path, &error))?;
                WholeFile::write_bytes(&path, png.get_ref())
            }
            Self::Gif(path, encoder, _) => {
                let picture = DynamicImage::ImageRgb8(picture).into_rgba8();
                let delay = Delay::from_numer_denom_ms(GIF_DELAY, 1);
                let written = encoder.encode_frame(Frame::from_parts(picture, 0, 0, delay));
                written.map_err(|error| picture_failure(path, &error))
            }
        }
    }

    /// Puts an animation in its place.
    pub(crate) fn finish(self) -> Result<(), Failure> {
        let Self::Gif(_, encoder, file) = self else { return Ok(()) };
        // Ends the animation.
        drop(encoder);
        Rc::into_inner(file.0).map_or(Ok(()), |file| file.into_inner().finish())
    }
}

/// A file that an encoder writes to which does not give it back.
#[derive(Clone)]
pub(crate) struct SharedFile(Rc<RefCell<WholeFile>>);

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
