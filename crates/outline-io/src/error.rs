//! Why outlines could not be read, and where in a file.
use std::fmt;
use std::io;

use freeform_curve_fit::OutlineError;
use thiserror::Error;

use crate::file_name::readable;
use crate::picture_file::error::{PictureError, TraceError};
use crate::polygon_file::error::PolygonError;
use crate::table::column::Column;
use crate::table::header_hint::header_hint;

/// Where in a file something is wrong. Displays as `name:12: column x`, `name:12-40`, `name: row 7: column x` or `name`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The file's name, or a stand-in such as `<stdin>`.
    pub file: String,
    /// First and last line, or row where the file has no lines.
    pub span: Option<Span>,
    /// The column.
    pub column: Option<Column>,
}

/// A stretch of a file, by its first and last part; equal for a single one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Span {
    /// Lines, counted from 1.
    Lines(u64, u64),
    /// Rows of a table, counted from 0.
    Rows(u64, u64),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", readable(&self.file))?;
        match self.span {
            Some(Span::Lines(first, last)) if first == last => write!(f, ":{first}")?,
            Some(Span::Lines(first, last)) => write!(f, ":{first}-{last}")?,
            Some(Span::Rows(first, last)) if first == last => write!(f, ": row {first}")?,
            Some(Span::Rows(first, last)) => write!(f, ": rows {first}-{last}")?,
            None => {}
        }
        match self.column {
            Some(column) => write!(f, ": column {column}"),
            None => Ok(()),
        }
    }
}

/// Outlines could not be read: where and why. Displays as one line.
#[derive(Debug, Error)]
#[error("{place}: {kind}")]
pub struct ReadError {
    /// File, line and column.
    pub place: Place,
    /// The reason.
    #[source]
    pub kind: ReadErrorKind,
}

impl ReadError {
    /// Whether reading can continue after this error. True for an outline that is no outline (one point, all points on one
    /// line): the next call returns the next outline. False for a file that does not follow the format or cannot be
    /// read: nothing after this place can be trusted, and the reader has ended.
    #[must_use]
    pub fn is_recoverable(&self) -> bool {
        matches!(self.kind, ReadErrorKind::Degenerate { .. })
    }
}

/// What Parquet is read with, in messages.
const READ_CODECS: &str = "snappy, zstd, gzip or no compression";

/// Why outlines could not be read.
#[derive(Debug, Error)]
pub enum ReadErrorKind {
    /// The file could not be opened or read.
    #[error("{0}")]
    Io(#[source] io::Error),
    /// A compressed file.
    #[error("compressed with {format}: unpack it, such as by a pipe: {unpack} FILE | ...")]
    Compressed {
        /// Name of the format.
        format: &'static str,
        /// The command that unpacks it.
        unpack: &'static str,
    },
    /// A file of another kind.
    #[error("{format}: {advice}")]
    ForeignFormat {
        /// What it is.
        format: &'static str,
        /// What to do.
        advice: &'static str,
    },
    /// Text in UTF-16, as spreadsheets save it.
    #[error("the text is UTF-16, expected UTF-8: save it as such, or use iconv -f UTF-16 -t UTF-8")]
    Utf16,
    /// Lines that end with a carriage return alone, as on very old systems.
    #[error("the lines end with carriage returns alone, expected line feeds: use tr '\\r' '\\n'")]
    LineEnds,
    /// Parquet in a stream, or taken for CSV.
    #[error(
        "this is Parquet, whose table of contents stands at its end: it is read from a file that is named, not from a stream"
    )]
    ParquetStream,
    /// Parquet, in a build that cannot read it.
    #[error("this build reads no Parquet: build it with the feature parquet")]
    ParquetLeftOut,
    /// A file that is no Parquet, though its name says so.
    #[error("not a Parquet file")]
    NotParquet,
    /// A Parquet file that contradicts itself, is cut short, or uses what is not read.
    #[error("the Parquet file cannot be read: {source}")]
    DamagedParquet {
        /// What the reader met.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// A compression of Parquet that is not read.
    #[error(
        "compressed with {codec}; Parquet is read with {READ_CODECS}, such as from write_parquet(..., compression=\"snappy\")"
    )]
    Codec {
        /// Name of the compression.
        codec: &'static str,
    },
    /// A column of a type that does not serve.
    #[error("the type is {found}, expected {expected}")]
    ColumnType {
        /// The type in the file.
        found: String,
        /// What is read.
        expected: &'static str,
    },
    /// Lists of one row that differ in length.
    #[error("{found} value(s), column x has {expected} in this row")]
    ListLength {
        /// Values in the list.
        found: usize,
        /// Values in the list of x.
        expected: usize,
    },
    /// A number that should be whole.
    #[error("{text:?} is not a whole number")]
    NotAWholeNumber {
        /// The number.
        text: String,
    },
    /// An object without a name.
    #[error("the name is missing")]
    NoName,
    /// A name that fills the memory.
    #[error("a name of {length} bytes, at most {limit} are read")]
    NameTooLong {
        /// Its length in bytes.
        length: usize,
        /// Longest name accepted, in bytes.
        limit: usize,
    },
    /// Polygons of an annotation program that could not be read.
    #[error(transparent)]
    Polygons(PolygonError),
    /// Rows in disorder that would fill the memory.
    #[error(
        "the rows are not in the order of the frames, and are too many to be ordered in memory: order the file by frame and object"
    )]
    TooManyToSort {
        /// Most points that are held.
        limit: usize,
    },
    /// Nearly all outlines of a file are copies of each other, and very many.
    #[error(
        "more than {outlines} outlines or {points} points, too many for a file of {length} bytes to be more than copies of a few; as CSV they are read"
    )]
    UnpacksToTooMuch {
        /// Most outlines that are read of a file of this length.
        outlines: u64,
        /// Most points.
        points: u64,
        /// Length of the file in bytes.
        length: u64,
    },
    /// Nothing in the file but comments and blank lines.
    #[error("the file is empty, expected a header such as frame,time,x,y")]
    Empty,
    /// The header lacks a column.
    #[error("missing column(s) {}, the header is {header:?}{}", comma_separated(missing), header_hint(missing, header))]
    MissingColumns {
        /// The columns that are not there.
        missing: Vec<Column>,
        /// The header as found, shortened.
        header: String,
    },
    /// The header names a column twice.
    #[error("the header names this column twice")]
    RepeatedColumn,
    /// A row has more or fewer fields than the header.
    #[error("{found} field(s), the header has {expected}")]
    FieldCount {
        /// Fields in the row.
        found: usize,
        /// Fields in the header.
        expected: usize,
    },
    /// The last line has fewer fields than the header and no line end.
    #[error("the last line is cut short: {found} field(s), the header has {expected}")]
    CutShort {
        /// Fields in the row.
        found: usize,
        /// Fields in the header.
        expected: usize,
    },
    /// No complete row in a very long stretch of the file: no line ends, or a quote that is never closed.
    #[error("no complete row within {limit} bytes")]
    RowTooLong {
        /// Longest stretch accepted, in bytes.
        limit: u64,
    },
    /// A field is not UTF-8.
    #[error("{text:?} is not valid UTF-8")]
    NotUtf8 {
        /// The field with replacement characters, shortened.
        text: String,
    },
    /// A number is missing.
    #[error("the field is empty, expected a number: fill it in, or leave out the point")]
    EmptyField,
    /// Text where a number should be.
    #[error("{text:?} is not a number")]
    NotANumber {
        /// The field, shortened.
        text: String,
    },
    /// A date or a time of day where seconds should be.
    #[error("{text:?} is a date or a time of day: give seconds, such as those since the first frame")]
    NotSeconds {
        /// The field, shortened.
        text: String,
    },
    /// NaN or an infinity, written as such or by a number too large for a float.
    #[error("{text:?} is not a finite number: leave out the point")]
    NotFinite {
        /// The field, shortened.
        text: String,
    },
    /// A number whose square would overflow.
    #[error("{value:e} is beyond {limit:e}")]
    TooLarge {
        /// The number.
        value: f64,
        /// Largest absolute value accepted.
        limit: f64,
    },
    /// A standard deviation of zero or less.
    #[error("{value} is not a standard deviation (a number above 0, or nothing)")]
    NotPositive {
        /// The number.
        value: f64,
    },
    /// A frame number that is not a whole number from 0.
    #[error("{text:?} is not a frame number (a whole number, 0 or more)")]
    NotAFrameNumber {
        /// The field, shortened.
        text: String,
    },
    /// The time changes between two rows of one outline.
    #[error("the time changes from {previous} to {time} within frame {frame} of object {object:?}")]
    TimeChanges {
        /// Object of the outline.
        object: String,
        /// Frame of the outline.
        frame: u64,
        /// Time of the outline so far, in seconds.
        previous: f64,
        /// Time in this row, in seconds.
        time: f64,
    },
    /// A later frame of an object does not have a later time.
    #[error("time {time} of frame {frame} of object {object:?} is not after {previous}, the time of its frame before")]
    TimeNotIncreasing {
        /// Object of the outline.
        object: String,
        /// Frame of the outline.
        frame: u64,
        /// Time of the object's frame before, in seconds.
        previous: f64,
        /// Time of this frame, in seconds.
        time: f64,
    },
    /// The frame numbers of an object run backwards.
    #[error("frame {frame} of object {object:?} comes after its frame {previous}: order the rows by frame")]
    FrameNotIncreasing {
        /// Object of the outline.
        object: String,
        /// Frame of the outline.
        frame: u64,
        /// The object's frame before.
        previous: u64,
    },
    /// Rows of one object and frame that do not follow each other.
    #[error("second outline of object {object:?} in frame {frame}: the rows of one outline must follow each other")]
    SecondOutline {
        /// Object of the outline.
        object: String,
        /// Frame of the outline.
        frame: u64,
    },
    /// Rows with and without an arc value in one outline.
    #[error(
        "some rows of frame {frame} of object {object:?} have an arc and some do not: an outline is made of open arcs, each with its name, or of \
         closed contours without one"
    )]
    MixedArcs {
        /// Object of the outline.
        object: String,
        /// Frame of the outline.
        frame: u64,
    },
    /// Rows of one arc that do not follow each other.
    #[error("arc {arc:?} comes a second time in frame {frame} of object {object:?}: its rows must follow each other")]
    SecondArc {
        /// Object of the outline.
        object: String,
        /// Frame of the outline.
        frame: u64,
        /// The arc value, shortened.
        arc: String,
    },
    /// Rows of one contour that do not follow each other.
    #[error(
        "contour {contour:?} comes a second time in frame {frame} of object {object:?}: its rows must follow each other"
    )]
    SecondContour {
        /// Object of the outline.
        object: String,
        /// Frame of the outline.
        frame: u64,
        /// The contour value, shortened.
        contour: String,
    },
    /// An outline larger than any real one; the limit keeps memory bounded.
    #[error("more than {limit} points in frame {frame} of object {object:?}")]
    TooManyPoints {
        /// Object of the outline.
        object: String,
        /// Frame of the outline.
        frame: u64,
        /// Largest number of points accepted.
        limit: usize,
    },
    /// The rows are well-formed but their points are no outline. The only recoverable error.
    #[error("frame {frame} of object {object:?}: {source}")]
    Degenerate {
        /// Object of the outline.
        object: String,
        /// Frame of the outline.
        frame: u64,
        /// Why the points are no outline.
        source: OutlineError,
    },
}

fn comma_separated(columns: &[Column]) -> String {
    columns.iter().map(Column::name).collect::<Vec<_>>().join(", ")
}

/// Why a file gave no shape.
#[derive(Debug, Error)]
pub enum ReadShapeError {
    /// The CSV file could not be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The picture could not be read.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// The picture shows no object.
    #[error("{file}: {source}")]
    Trace {
        /// The file's name.
        file: String,
        /// The reason.
        source: TraceError,
    },
    /// The CSV file has a header but no outline.
    #[error("{file}: no outline in the file")]
    NoOutline {
        /// The file's name.
        file: String,
    },
    /// The first outline of the CSV file is open.
    #[error("{file}: the first outline is made of open arcs, a shape needs a closed one")]
    Open {
        /// The file's name.
        file: String,
    },
}
