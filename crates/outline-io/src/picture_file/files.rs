//! The files of pictures that a path stands for.
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use crate::foreign_format::{foreign_format, is_heic};
use crate::picture_file::compressed_video::compressed_video;
use crate::picture_file::error::{PictureError, PictureErrorKind};
use crate::picture_file::file_pattern::{is_pattern, matching_files};
use crate::picture_file::natural_order::natural_order;

/// Number of bytes at the beginning of a file that identify its format.
pub(crate) const MAGIC_LENGTH: usize = 16;

/// Extensions of the files that a folder is searched for.
const EXTENSIONS: [&str; 14] =
    ["png", "jpg", "jpeg", "tif", "tiff", "bmp", "gif", "y4m", "jpe", "webp", "pgm", "ppm", "pbm", "pnm"];

/// The files that a path stands for: those of the pictures in a folder or that match a pattern, in natural order, or the path.
/// Those found may be links that lead nowhere, pipes, or folders with the name of a picture: without them the times of the others
/// would move. `**` in a pattern stands for folders within each other, but does not follow links.
///
/// # Errors
/// A folder that cannot be read; a folder or a pattern without pictures; a folder of nothing but compressed video, whose
/// first is named.
pub fn picture_files(path: &Path) -> Result<Vec<PathBuf>, PictureError> {
    let failed = |kind| PictureError::of_file(path.display().to_string(), kind);
    let mut found: Vec<PathBuf> = if path.is_dir() {
        let entries = fs::read_dir(path).map_err(|error| failed(error.into()))?;
        let entries = entries.collect::<Result<Vec<_>, _>>().map_err(|error| failed(error.into()))?;
        let is_hidden = |path: &Path| path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"."));
        let all = entries.into_iter().map(|entry| entry.path()).filter(|path| !is_hidden(path));
        let (pictures, others): (Vec<_>, Vec<_>) = all.partition(|path| has_picture_extension(path));
        if pictures.is_empty() {
            return Err(nothing_to_read(path, others.into_iter().filter(|path| path.is_file()).collect()));
        }
        pictures
    } else if is_pattern(path) {
        let matching = matching_files(&path.to_string_lossy()).map_err(|_| failed(PictureErrorKind::WrongPattern))?;
        matching.into_iter().filter(|path| has_picture_extension(path) || !path.is_dir()).collect()
    } else {
        return Ok(vec![path.to_owned()]);
    };
    if found.is_empty() {
        return Err(failed(PictureErrorKind::NoPictures));
    }
    found.sort_by(|a, b| natural_order(&a.to_string_lossy(), &b.to_string_lossy()));
    Ok(found)
}

/// Whether a file is taken for a picture where its folder is searched, by its extension.
#[must_use]
pub fn has_picture_extension(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str());
    extension.is_some_and(|extension| EXTENSIONS.iter().any(|known| known.eq_ignore_ascii_case(extension)))
}

/// What a file begins with, as far as it tells the format.
pub(crate) fn beginning(path: &Path) -> io::Result<Vec<u8>> {
    let mut start = Vec::new();
    File::open(path)?.take(MAGIC_LENGTH as u64).read_to_end(&mut start)?;
    Ok(start)
}

/// Why there are no pictures among files: video that is not decoded, or none at all.
fn nothing_to_read(path: &Path, mut files: Vec<PathBuf>) -> PictureError {
    files.sort_by(|a, b| natural_order(&a.to_string_lossy(), &b.to_string_lossy()));
    let kind = |file: &PathBuf| {
        let start = beginning(file).unwrap_or_default();
        let format = match foreign_format(&start, &file.to_string_lossy()) {
            Some((format, advice)) => return Some(PictureErrorKind::ForeignFormat { format, advice }),
            None if is_heic(&start) => return Some(PictureErrorKind::Unsupported { format: "image/heic" }),
            None => compressed_video(&start),
        };
        format.map(|format| PictureErrorKind::CompressedVideo { format })
    };
    match files.iter().find_map(|file| Some((file, kind(file)?))) {
        Some((file, kind)) => PictureError::of_file(file.display().to_string(), kind),
        None => PictureError::of_file(path.display().to_string(), PictureErrorKind::NoPictures),
    }
}
