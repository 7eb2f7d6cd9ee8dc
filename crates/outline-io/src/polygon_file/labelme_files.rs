//! The files of labelme that paths stand for.
use std::fs;
use std::path::{Path, PathBuf};

use crate::picture_file::error::PictureError;
use crate::picture_file::files::picture_files;
use crate::picture_file::sequence::PictureSequence;

/// The files of labelme that paths stand for: several files, a pattern of them, or a folder without pictures; `None` where they stand for something
/// else.
///
/// # Errors
///
/// A pattern that no file matches.
pub fn labelme_files(paths: &[PathBuf]) -> Result<Option<Vec<PathBuf>>, PictureError> {
    let is_json = |path: &Path| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"));
    if let [folder] = paths
        && folder.is_dir()
        && picture_files(folder).is_err()
    {
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        let files: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(|path| is_json(path)).collect();
        return Ok(Some(files).filter(|files| !files.is_empty()));
    }
    let is_one_file = matches!(paths, [path] if path.exists() || !PictureSequence::is_named_by(path));
    if is_one_file || !paths.iter().all(|path| is_json(path)) {
        return Ok(None);
    }
    let files: Result<Vec<_>, _> = paths.iter().map(|path| picture_files(path)).collect();
    files.map(|files| Some(files.concat()))
}
