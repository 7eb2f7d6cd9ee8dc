use std::ffi::{OsStr, OsString};
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, IntoInnerError, StdoutLock, Write};
use std::path::{Path, PathBuf};

use tempfile::{Builder, NamedTempFile};

use super::destination::{destination, folder_of};
use crate::failure::{Failure, plain};
use crate::interrupt::Unfinished;
use crate::progress::would_stand_in_output;

/// Bytes of a name that the name of the unfinished file repeats: with what is added these are less than the usual 255.
const LONGEST_PREFIX: usize = 200;

/// A file that appears whole or not at all: written beside its place and moved there in the end. A place that is no
/// regular file (a device, a pipe) is written to as it is.
#[derive(Debug)]
pub(crate) struct WholeFile {
    writer: BufWriter<Place>,
    /// Name as given, for messages.
    name: String,
}

/// Where a file is being written.
#[derive(Debug)]
enum Place {
    /// Beside the path that it is to go to; removed when it is dropped before.
    Beside(NamedTempFile, Unfinished, PathBuf),
    /// In place.
    Device(File),
}

impl WholeFile {
    /// Starts a file.
    pub(crate) fn create(path: &Path) -> Result<Self, Failure> {
        let name = path.display().to_string();
        match Place::open(path) {
            Ok(place) => Ok(Self { writer: BufWriter::new(place), name }),
            Err(error) => Err(Failure::unusable(format_args!("{name}: {}", plain(&error)))),
        }
    }

    /// Puts the file in its place.
    pub(crate) fn finish(self) -> Result<(), Failure> {
        let Self { writer, name } = self;
        let result = writer.into_inner().map_err(IntoInnerError::into_error).and_then(Place::settle);
        result.map_err(|error| Failure::unusable(format_args!("{name}: {}", plain(&error))))
    }

    /// An error in writing this file.
    pub(crate) fn failure(&self, error: &io::Error) -> Failure {
        Failure::unusable(format_args!("{}: {}", self.name, plain(error)))
    }

    /// Writes a whole file of text at once.
    pub(crate) fn write(path: &Path, content: &str) -> Result<(), Failure> {
        Self::write_bytes(path, content.as_bytes())
    }

    /// Writes a whole file at once.
    pub(crate) fn write_bytes(path: &Path, content: &[u8]) -> Result<(), Failure> {
        Self::create(path)?.finish_with(content)
    }

    /// Has a file that was started written, and puts it in its place.
    pub(crate) fn finish_by(mut self, write: impl FnOnce(&mut Self) -> io::Result<()>) -> Result<(), Failure> {
        match write(&mut self) {
            Ok(()) => self.finish(),
            Err(error) => Err(self.failure(&error)),
        }
    }

    /// Writes the content of a file that was started, and puts it in its place.
    pub(crate) fn finish_with(self, content: &[u8]) -> Result<(), Failure> {
        self.finish_by(|file| file.write_all(content))
    }
}

impl Place {
    fn open(path: &Path) -> io::Result<Self> {
        if path.as_os_str() == "-" {
            return Err(io::Error::new(
                io::ErrorKind::InvalidInput,
                "standard output is for the result; for a file of this name write ./-",
            ));
        }
        let old = fs::metadata(path).ok();
        if let Some(old) = &old {
            if !old.is_file() {
                return Ok(Self::Device(OpenOptions::new().write(true).open(path)?));
            }
            if old.permissions().readonly() {
                return Err(io::Error::new(io::ErrorKind::PermissionDenied, "the file is read-only"));
            }
        }
        let target = destination(path)?;
        let Some(file_name) = target.file_name() else {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "not the name of a file"));
        };
        let prefix = prefix_of(file_name);
        let folder = folder_of(&target);
        // A name of its own, whatever a run that was killed has left behind.
        let mut builder = Builder::new();
        builder.prefix(&prefix).suffix(".part");
        let create = || builder.make_in(folder, |path| OpenOptions::new().write(true).create_new(true).open(path));
        let (file, unfinished) = Unfinished::begin(create, NamedTempFile::path)?;
        if let Some(old) = old {
            // Where the file system has no permissions there are none to keep.
            let _ = file.as_file().set_permissions(old.permissions());
        }
        Ok(Self::Beside(file, unfinished, target))
    }

    fn settle(self) -> io::Result<()> {
        let Self::Beside(file, _unfinished, target) = self else { return Ok(()) };
        // Some file systems tell only now that they are full.
        file.as_file().sync_all()?;
        file.persist(target).map(drop).map_err(|error| error.error)
    }
}

/// What the name of an unfinished file begins with. Long names are cut, so that it is not longer than file systems allow.
fn prefix_of(file_name: &OsStr) -> OsString {
    let mut prefix = OsString::from(".");
    match file_name.to_str() {
        Some(text) if text.len() > LONGEST_PREFIX => {
            let ends = text.char_indices().map(|(start, _)| start);
            prefix.push(&text[..ends.take_while(|end| *end <= LONGEST_PREFIX).last().unwrap_or(0)]);
        }
        None if file_name.len() > LONGEST_PREFIX => prefix.push("unfinished"),
        _ => prefix.push(file_name),
    }
    prefix.push(".");
    prefix
}

impl Write for Place {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Beside(file, ..) => file.as_file_mut().write(bytes),
            Self::Device(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Write for WholeFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.writer.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}

/// Standard output or a file.
#[derive(Debug)]
pub(crate) enum Sink {
    Stdout(BufWriter<StdoutLock<'static>>),
    File(WholeFile),
}

impl Sink {
    /// Standard output where the path is `-`.
    pub(crate) fn open(path: &Path) -> Result<Self, Failure> {
        if path.as_os_str() == "-" {
            return Ok(Self::stdout());
        }
        WholeFile::create(path).map(Self::File)
    }

    /// Standard output.
    pub(crate) fn stdout() -> Self {
        Self::Stdout(BufWriter::new(io::stdout().lock()))
    }

    /// Whether a progress bar would stand in what is written here.
    pub(crate) fn is_disturbed_by_progress(&self) -> bool {
        matches!(self, Self::Stdout(_)) && would_stand_in_output()
    }

    /// Writes out what is buffered, puts a file in its place.
    pub(crate) fn finish(self) -> Result<(), Failure> {
        match self {
            Self::Stdout(mut stdout) => stdout.flush().map_err(|error| Failure::of_stdout(&error)),
            Self::File(file) => file.finish(),
        }
    }

    /// An error in writing here.
    pub(crate) fn failure(&self, error: &io::Error) -> Failure {
        match self {
            Self::Stdout(_) => Failure::of_stdout(error),
            Self::File(file) => file.failure(error),
        }
    }
}

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Stdout(stdout) => stdout.write(bytes),
            Self::File(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Stdout(stdout) => stdout.flush(),
            Self::File(file) => file.flush(),
        }
    }
}
