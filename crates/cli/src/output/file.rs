use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, StdoutLock, Write};
use std::path::{Path, PathBuf};

use crate::failure::{Failure, plain};

/// A file that appears whole or not at all: written beside its place and moved there in the end. A place that is no
/// regular file (a device, a pipe) is written to as it is.
#[derive(Debug)]
pub(crate) struct WholeFile {
    writer: BufWriter<File>,
    /// Name as given, for messages.
    name: String,
    /// Where it is being written and where it is to go; `None` once it is there.
    pending: Option<(PathBuf, PathBuf)>,
}

impl WholeFile {
    /// Starts a file.
    pub(crate) fn create(path: &Path) -> Result<Self, Failure> {
        let name = path.display().to_string();
        Self::begin(path, name.clone()).map_err(|error| Failure::unusable(format_args!("{name}: {}", plain(&error))))
    }

    fn begin(path: &Path, name: String) -> io::Result<Self> {
        // Through links, so that what they point to is replaced and not they.
        let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        if let Ok(metadata) = fs::metadata(&target) {
            if !metadata.is_file() {
                let writer = BufWriter::new(OpenOptions::new().write(true).open(&target)?);
                return Ok(Self { writer, name, pending: None });
            }
            if metadata.permissions().readonly() {
                return Err(io::Error::new(io::ErrorKind::PermissionDenied, "the file is read-only"));
            }
        }
        let Some(file_name) = target.file_name() else {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "not the name of a file"));
        };
        let mut hidden = std::ffi::OsString::from(".");
        hidden.push(file_name);
        hidden.push(format!(".{}.part", std::process::id()));
        let temporary = target.with_file_name(hidden);
        let file = OpenOptions::new().write(true).create_new(true).open(&temporary)?;
        Ok(Self { writer: BufWriter::new(file), name, pending: Some((temporary, target)) })
    }

    /// Puts the file in its place.
    pub(crate) fn finish(mut self) -> Result<(), Failure> {
        let result = self.writer.flush().and_then(|()| match &self.pending {
            Some((temporary, target)) => fs::rename(temporary, target),
            None => Ok(()),
        });
        match result {
            Ok(()) => {
                self.pending = None;
                Ok(())
            }
            Err(error) => Err(self.failure(&error)),
        }
    }

    /// An error in writing this file.
    pub(crate) fn failure(&self, error: &io::Error) -> Failure {
        Failure::unusable(format_args!("{}: {}", self.name, plain(error)))
    }

    /// Writes a whole file at once.
    pub(crate) fn write(path: &Path, content: &str) -> Result<(), Failure> {
        let mut file = Self::create(path)?;
        match file.write_all(content.as_bytes()) {
            Ok(()) => file.finish(),
            Err(error) => Err(file.failure(&error)),
        }
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

impl Drop for WholeFile {
    fn drop(&mut self) {
        if let Some((temporary, _)) = &self.pending {
            let _ = fs::remove_file(temporary);
        }
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

/// Refuses output files that are the input, or one another.
pub(crate) fn refuse_overwriting(input: &Path, outputs: &[&Path]) -> Result<(), Failure> {
    let place = |path: &Path| fs::canonicalize(path).ok().filter(|place| place.is_file());
    for (index, output) in outputs.iter().enumerate() {
        if input.as_os_str() != "-" && place(input).is_some_and(|input| place(output) == Some(input)) {
            return Err(Failure::unusable(format_args!("{}: this is the input", output.display())));
        }
        let is_device = output.exists() && !output.is_file();
        if outputs[..index].contains(output) && !is_device {
            return Err(Failure::unusable(format_args!("{}: named for two outputs", output.display())));
        }
    }
    Ok(())
}
