use std::path::Path;

use image::RgbImage;

use super::folder::DrawingFolder;
use super::gif_file::GifFile;
use super::video_file::VideoFile;
use crate::failure::Failure;

/// Where drawn pictures go.
pub(super) enum Target {
    Folder(DrawingFolder),
    Gif(Box<GifFile>),
    Video(VideoFile),
}

impl Target {
    /// A GIF or a video where the path ends so, else a folder.
    pub(super) fn open(path: &Path) -> Result<Self, Failure> {
        let ends_with = |ending: &str| {
            !path.is_dir() && path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(ending))
        };
        if ends_with("gif") {
            Ok(Self::Gif(Box::new(GifFile::open(path)?)))
        } else if ends_with("y4m") {
            VideoFile::open(path).map(Self::Video)
        } else {
            DrawingFolder::open(path).map(Self::Folder)
        }
    }

    /// Writes the picture of a frame, which stands for so many seconds, if that is known.
    pub(super) fn write(&mut self, frame: u64, picture: &RgbImage, seconds: Option<f64>) -> Result<(), Failure> {
        match self {
            Self::Folder(folder) => folder.write(frame, picture),
            Self::Gif(gif) => gif.write(picture, seconds),
            Self::Video(video) => video.write(picture, seconds),
        }
    }

    /// Puts an animation or a video in its place.
    pub(super) fn finish(self) -> Result<(), Failure> {
        match self {
            Self::Folder(_) => Ok(()),
            Self::Gif(gif) => gif.finish(),
            Self::Video(video) => video.finish(),
        }
    }
}
