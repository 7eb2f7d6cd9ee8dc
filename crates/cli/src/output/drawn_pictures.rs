use std::path::{Path, PathBuf};

use freeform_drawing::{DrawingError, DrawnPicture, GifAnimation, Y4mVideo};

use super::drawing_folder::DrawingFolder;
use super::file::WholeFile;
use super::refusal::refuse_drawing_beside;
use crate::failure::{Failure, plain};

/// Where drawn pictures go. An animation or a video is put in its place when it is whole.
pub(crate) struct DrawnPictures {
    path: PathBuf,
    target: Target,
}

enum Target {
    Folder(DrawingFolder),
    Gif(Box<GifAnimation<WholeFile>>),
    Video(Y4mVideo<WholeFile>),
}

impl DrawnPictures {
    /// A GIF or a video where the path ends so, else a folder. A folder that pictures of the input stand in is refused.
    pub(crate) fn open(path: &Path, inputs: &[PathBuf]) -> Result<Self, Failure> {
        refuse_drawing_beside(inputs, path)?;
        let ends_with = |ending: &str| {
            !path.is_dir() && path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(ending))
        };
        let target = if ends_with("gif") {
            Target::Gif(Box::new(GifAnimation::new(WholeFile::create(path)?)))
        } else if ends_with("y4m") {
            Target::Video(Y4mVideo::new(WholeFile::create(path)?))
        } else {
            Target::Folder(DrawingFolder::open(path)?)
        };
        Ok(Self { path: path.to_owned(), target })
    }

    /// Writes a picture, if one is done.
    pub(crate) fn take(&mut self, done: Option<DrawnPicture>) -> Result<(), Failure> {
        let Some(DrawnPicture { frame, picture, seconds }) = done else { return Ok(()) };
        match &mut self.target {
            Target::Folder(folder) => folder.write(frame, &picture),
            Target::Gif(gif) => gif.write(&picture, seconds).map_err(|error| failure(&self.path, &error)),
            Target::Video(video) => video.write(&picture, seconds).map_err(|error| failure(&self.path, &error)),
        }
    }

    /// Writes the last picture, and puts an animation or a video in its place; nothing is left where there was no picture.
    pub(crate) fn finish(mut self, last: Option<DrawnPicture>) -> Result<(), Failure> {
        self.take(last)?;
        let file = match self.target {
            Target::Folder(_) => None,
            Target::Gif(gif) => gif.finish().map_err(|error| failure(&self.path, &error))?,
            Target::Video(video) => video.finish(),
        };
        file.map_or(Ok(()), WholeFile::finish)
    }
}

fn failure(path: &Path, error: &DrawingError) -> Failure {
    Failure::unusable(format_args!("{}: {}", path.display(), plain(error)))
}
