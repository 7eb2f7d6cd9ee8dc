//! Files of outlines in any of the formats of tables: the one place where the format is chosen.
use std::io::Write;
use std::path::Path;

use crate::csv_writer::{OutlineWriter, WriterOptions};
use crate::error::{ReadError, WriteError};
use crate::frame::OutlineFrame;

/// Formats in which outlines are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TableFormat {
    /// Text, one row per point.
    Csv,
    /// Binary, one row per outline; needs the feature `parquet`.
    Parquet,
}

impl TableFormat {
    /// By the extension: `.parquet` or `.pq` is Parquet, all else is CSV.
    #[must_use]
    pub fn of(path: &Path) -> Self {
        let extension = path.extension().unwrap_or_default();
        let is_parquet = ["parquet", "pq"].iter().any(|known| extension.eq_ignore_ascii_case(known));
        if is_parquet { Self::Parquet } else { Self::Csv }
    }

    /// Whether the beginning of a file is that of Parquet.
    #[must_use]
    pub fn is_parquet(start: &[u8]) -> bool {
        start.starts_with(b"PAR1")
    }
}

/// Writes outlines as CSV or Parquet.
#[derive(Debug)]
pub struct TableWriter<W: Write>(Kind<W>);

#[derive(Debug)]
enum Kind<W: Write> {
    Csv(Box<OutlineWriter<W>>),
    #[cfg(feature = "parquet")]
    Parquet(Box<crate::parquet_writer::ParquetWriter<W>>),
}

impl<W: Write> TableWriter<W> {
    /// Begins a file with comment lines, given without `#`.
    ///
    /// # Errors
    /// The sink fails; Parquet without the feature.
    pub fn new(
        mut sink: W,
        format: TableFormat,
        options: WriterOptions,
        comments: &[String],
    ) -> Result<Self, WriteError> {
        match format {
            TableFormat::Csv => {
                comments.iter().try_for_each(|comment| writeln!(sink, "# {comment}"))?;
                Ok(Self(Kind::Csv(Box::new(OutlineWriter::new(sink, options)?))))
            }
            #[cfg(feature = "parquet")]
            TableFormat::Parquet => {
                Ok(Self(Kind::Parquet(Box::new(crate::parquet_writer::ParquetWriter::new(sink, options, comments)?))))
            }
            #[cfg(not(feature = "parquet"))]
            TableFormat::Parquet => Err(WriteError::ParquetLeftOut),
        }
    }

    /// Writes one outline.
    ///
    /// # Errors
    /// As [`OutlineWriter::write`].
    pub fn write(&mut self, frame: &OutlineFrame) -> Result<(), WriteError> {
        match &mut self.0 {
            Kind::Csv(writer) => writer.write(frame),
            #[cfg(feature = "parquet")]
            Kind::Parquet(writer) => writer.write(frame),
        }
    }

    /// Writes what is left and hands the sink back.
    ///
    /// # Errors
    /// The sink fails.
    pub fn finish(self) -> Result<W, WriteError> {
        match self.0 {
            Kind::Csv(writer) => writer.finish(),
            #[cfg(feature = "parquet")]
            Kind::Parquet(writer) => writer.finish(),
        }
    }
}

/// The outlines of a file that is read whole or at random, and so is no stream.
pub struct OutlineFile {
    outlines: Box<dyn Iterator<Item = Result<OutlineFrame, ReadError>>>,
    comments: String,
}

impl std::fmt::Debug for OutlineFile {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("OutlineFile").field("comments", &self.comments).finish_non_exhaustive()
    }
}

impl OutlineFile {
    /// Opens a file of Parquet.
    ///
    /// # Errors
    /// As [`ParquetReader::open`](crate::ParquetReader::open); Parquet without the feature.
    pub fn open_parquet(path: &Path) -> Result<Self, ReadError> {
        #[cfg(feature = "parquet")]
        {
            let reader = crate::parquet_reader::ParquetReader::open(path)?;
            Ok(Self { comments: reader.comments().to_owned(), outlines: Box::new(reader) })
        }
        #[cfg(not(feature = "parquet"))]
        {
            let place = crate::error::Place { file: path.display().to_string(), lines: None, rows: None, column: None };
            Err(ReadError { place, kind: crate::error::ReadErrorKind::ParquetLeftOut })
        }
    }

    /// The comment lines of the file, without `#`.
    #[must_use]
    pub fn comments(&self) -> &str {
        &self.comments
    }
}

impl Iterator for OutlineFile {
    type Item = Result<OutlineFrame, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.outlines.next()
    }
}
