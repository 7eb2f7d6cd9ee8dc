use std::fs::{self, File};
use std::io::{self, BufReader};
use std::path::{Path, PathBuf};

use freeform_drawing::{is_marked_png, marked_png};
use freeform_motion::outline_io::has_picture_extension;
use image::RgbImage;

use super::file::WholeFile;
use crate::failure::{Failure, plain};

/// Extensions of files that are no pictures which can be read, but that drawings may be asked to go into.
const OTHER_FILES: [&str; 11] = ["mp4", "m4v", "mov", "mkv", "webm", "avi", "webp", "apng", "svg", "html", "pdf"];

/// A folder of drawings, one for each picture. It is made, and cleared of the drawings of an earlier run, when the first is
/// written.
pub(super) struct DrawingFolder {
    path: PathBuf,
    is_begun: bool,
}

impl DrawingFolder {
    /// Refuses the name of a file, and a folder where drawings would overwrite other pictures.
    pub(super) fn open(path: &Path) -> Result<Self, Failure> {
        if path.as_os_str() == "-" {
            return Err(Failure::unusable(
                "-: drawings do not go to standard output; for a folder of this name write ./-",
            ));
        }
        let within = path.ancestors().find(|place| place.exists());
        if within.is_some_and(|place| !place.is_dir()) || (is_named_as_file(path) && !path.is_dir()) {
            let reason = format_args!(
                "{}: drawings go into a folder, or into one animation FILE.gif or FILE.y4m",
                path.display()
            );
            return Err(Failure::unusable(reason));
        }
        let earlier = numbered(path).map_err(|error| failure(path, &error))?;
        if let Some(other) = earlier.iter().find(|picture| !is_drawing(picture)) {
            let reason = "this picture is none that freeform has drawn, draw into another folder";
            return Err(Failure::unusable(format_args!("{}: {reason}", other.display())));
        }
        Ok(Self { path: path.to_owned(), is_begun: false })
    }

    /// Writes the picture of a frame.
    pub(super) fn write(&mut self, frame: u64, picture: &RgbImage) -> Result<(), Failure> {
        if !self.is_begun {
            self.begin().map_err(|error| failure(&self.path, &error))?;
            self.is_begun = true;
        }
        let path = self.path.join(format!("{frame:06}.png"));
        let png =
            marked_png(picture).map_err(|error| Failure::unusable(format_args!("{}: {error}", path.display())))?;
        WholeFile::write_bytes(&path, &png)
    }

    fn begin(&self) -> io::Result<()> {
        fs::create_dir_all(&self.path)?;
        numbered(&self.path)?.iter().filter(|picture| is_drawing(picture)).try_for_each(fs::remove_file)
    }
}

/// The files of a folder that have the names of drawings; none where there is no folder.
fn numbered(folder: &Path) -> io::Result<Vec<PathBuf>> {
    if !folder.is_dir() {
        return Ok(Vec::new());
    }
    let is_numbered = |path: &PathBuf| {
        let name = path.file_name().and_then(|name| name.to_str()).and_then(|name| name.strip_suffix(".png"));
        name.is_some_and(|name| name.len() >= 6 && name.bytes().all(|byte| byte.is_ascii_digit()))
    };
    let paths = fs::read_dir(folder)?.map(|entry| entry.map(|entry| entry.path()));
    paths.filter(|path| path.as_ref().map_or(true, is_numbered)).collect()
}

fn is_named_as_file(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str());
    let is_other = |extension: &str| OTHER_FILES.iter().any(|known| known.eq_ignore_ascii_case(extension));
    has_picture_extension(path) || extension.is_some_and(is_other)
}

/// Whether a picture bears the mark of a drawing.
fn is_drawing(path: &Path) -> bool {
    File::open(path).is_ok_and(|file| is_marked_png(BufReader::new(file)))
}

fn failure(path: &Path, error: &io::Error) -> Failure {
    Failure::unusable(format_args!("{}: {}", path.display(), plain(error)))
}
