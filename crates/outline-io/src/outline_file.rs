//! Files of outlines in any of the formats of tables: the one place where the format is chosen.
use std::fs::File;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use crate::csv_file::writer::{OutlineWriter, WriterOptions};
use crate::error::{Place, ReadError, ReadErrorKind};
use crate::frame::OutlineFrame;
use crate::origin_warning::OriginWarnings;
use crate::polygon_file::error::PolygonError;
use crate::polygon_file::polygons::{
    FILE_LIMIT, PolygonOutlines, PolygonSettings, begins_like_polygons, failed, read_polygons,
};
use crate::write_error::WriteError;

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
    Parquet(Box<crate::parquet_file::writer::ParquetWriter<W>>),
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
            TableFormat::Parquet => Ok(Self(Kind::Parquet(Box::new(crate::parquet_file::writer::ParquetWriter::new(
                sink, options, comments,
            )?)))),
            #[cfg(not(feature = "parquet"))]
            TableFormat::Parquet => Err(WriteError::ParquetLeftOut),
        }
    }

    /// Writes these warnings too into the rows to come, as [`OutlineWriter::warn`] does.
    pub fn warn(&mut self, warnings: OriginWarnings) {
        match &mut self.0 {
            Kind::Csv(writer) => writer.warn(warnings),
            #[cfg(feature = "parquet")]
            Kind::Parquet(writer) => writer.warn(warnings),
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

/// What the points of the outlines in a file are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FilePoints {
    /// Places of the contour that have been measured.
    Measured,
    /// Corners of polygons, whose sides are the contour.
    Corners,
}

/// The outlines of a file that is read whole or at random, and so is no stream.
pub struct OutlineFile {
    outlines: Outlines,
    comments: String,
    is_rate_assumed: bool,
    has_deviation_column: bool,
    points: FilePoints,
}

enum Outlines {
    #[cfg(feature = "parquet")]
    Parquet(Box<crate::parquet_file::reader::ParquetReader>),
    Polygons(std::vec::IntoIter<Result<OutlineFrame, ReadError>>),
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
    /// The file cannot be read, is not Parquet, is damaged, or has no such columns; any file without the feature `parquet`.
    pub fn open_parquet(path: &Path) -> Result<Self, ReadError> {
        #[cfg(feature = "parquet")]
        {
            let reader = crate::parquet_file::reader::ParquetReader::open(path)?;
            let (comments, has_deviation_column) = (reader.comments().to_owned(), reader.has_deviation_column());
            let points = FilePoints::Measured;
            let outlines = Outlines::Parquet(Box::new(reader));
            Ok(Self { outlines, comments, is_rate_assumed: false, has_deviation_column, points })
        }
        #[cfg(not(feature = "parquet"))]
        {
            let place = Place { file: path.display().to_string(), span: None, column: None };
            Err(ReadError { place, kind: ReadErrorKind::ParquetLeftOut })
        }
    }

    /// Whether the beginning of a file is that of JSON or XML, of which polygons are read.
    #[must_use]
    pub fn begins_like_polygons(start: &[u8]) -> bool {
        begins_like_polygons(start)
    }

    /// The polygons of annotation programs: one file of COCO (JSON) or of TrackMate (XML), or files of labelme, one a picture.
    ///
    /// - COCO: the frames are the images, by `frame_id` where all have one, else by the names of their files in natural order. An object is
    ///   named by `track_id`, `instance_id` or `attributes.track_id`, else by its category. Several polygons are several contours.
    /// - labelme: the frames are the files, by the names of their pictures in natural order. An object is named by its label, followed by
    ///   `group_id` where it has one; polygons of one group are contours of one body. Other shapes are left out.
    /// - TrackMate: an object is a track, or a branch of it. Times are those of the spots where their unit is one of time.
    ///
    /// The boundary is the largest contour of a body. Outlines come frame by frame.
    ///
    /// # Errors
    /// A file that cannot be read, is larger than a gigabyte, is none of these, or has bodies that cannot be told apart.
    pub fn open_polygons(paths: &[PathBuf], settings: &PolygonSettings) -> Result<Self, ReadError> {
        let read = |path: &PathBuf| {
            let name = path.display().to_string();
            let bytes = File::open(path)
                .map_err(|error| ReadError {
                    place: Place { file: name.clone(), span: None, column: None },
                    kind: ReadErrorKind::Io(error),
                })
                .and_then(|file| read_whole(file, &name))?;
            Ok((name, bytes))
        };
        Self::of_polygons(&paths.iter().map(read).collect::<Result<Vec<_>, _>>()?, settings)
    }

    /// Reads polygons from a source to its end. The name is used in error messages.
    ///
    /// # Errors
    /// As [`Self::open_polygons`].
    pub fn polygons_from(source: impl Read, name: &str, settings: &PolygonSettings) -> Result<Self, ReadError> {
        Self::of_polygons(&[(name.to_owned(), read_whole(source, name)?)], settings)
    }

    fn of_polygons(files: &[(String, Vec<u8>)], settings: &PolygonSettings) -> Result<Self, ReadError> {
        let PolygonOutlines { outlines, is_rate_assumed } = read_polygons(files, settings)?;
        let outlines = Outlines::Polygons(outlines.into_iter());
        let points = FilePoints::Corners;
        Ok(Self { outlines, comments: String::new(), is_rate_assumed, has_deviation_column: false, points })
    }

    /// What the points of its outlines are.
    #[must_use]
    pub fn points(&self) -> FilePoints {
        self.points
    }

    /// Whether the file has a column of standard deviations.
    #[must_use]
    pub fn has_deviation_column(&self) -> bool {
        self.has_deviation_column
    }

    /// Whether the file has a column `warning`; polygons have none.
    #[must_use]
    pub const fn has_warning_column(&self) -> bool {
        match &self.outlines {
            #[cfg(feature = "parquet")]
            Outlines::Parquet(reader) => reader.has_warning_column(),
            Outlines::Polygons(_) => false,
        }
    }

    /// What the rows read so far say of how their outlines were found, in the column `warning`; polygons say nothing.
    #[must_use]
    pub const fn warnings(&self) -> OriginWarnings {
        match &self.outlines {
            #[cfg(feature = "parquet")]
            Outlines::Parquet(reader) => reader.warnings(),
            Outlines::Polygons(_) => OriginWarnings::NONE,
        }
    }

    /// Whether the rate of the frames is neither given nor in the file: 30 frames per second are assumed then.
    #[must_use]
    pub fn is_rate_assumed(&self) -> bool {
        self.is_rate_assumed
    }

    /// The comment lines of the file, without `#`.
    #[must_use]
    pub fn comments(&self) -> &str {
        &self.comments
    }
}

/// All bytes of a source of bounded length.
fn read_whole(source: impl Read, name: &str) -> Result<Vec<u8>, ReadError> {
    let place = || Place { file: name.to_owned(), span: None, column: None };
    let mut bytes = Vec::new();
    let read = source.take(FILE_LIMIT + 1).read_to_end(&mut bytes);
    read.map_err(|error| ReadError { place: place(), kind: ReadErrorKind::Io(error) })?;
    if bytes.len() as u64 > FILE_LIMIT {
        return Err(failed(name, PolygonError::TooLarge { limit: FILE_LIMIT }));
    }
    Ok(bytes)
}

impl Iterator for OutlineFile {
    type Item = Result<OutlineFrame, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        match &mut self.outlines {
            #[cfg(feature = "parquet")]
            Outlines::Parquet(reader) => reader.next(),
            Outlines::Polygons(outlines) => outlines.next(),
        }
    }
}
