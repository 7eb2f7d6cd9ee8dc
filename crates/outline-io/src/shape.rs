//! One closed outline from a file of any kind.
use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::path::Path;

use freeform_curve_fit::Outline;
use nalgebra::Point2;

use crate::csv_file::columns::{Columns, require};
use crate::csv_file::field::number;
use crate::csv_file::reader::OutlineReader;
use crate::csv_file::rows::Rows;
use crate::error::{Place, ReadError, ReadErrorKind, ReadShapeError};
use crate::frame::DEFAULT_OBJECT;
use crate::outline_file::TableFormat;
use crate::picture_file::picture::read_picture;
use crate::table::column::Column;
use crate::table::outline_rows::OutlineRows;
use crate::tracing::settings::TraceSettings;
use crate::tracing::trace::trace_mask;

/// Number of bytes at the beginning of a file that identify a picture format.
const MAGIC_LENGTH: u64 = 16;

/// Reads one closed outline to use as a shape: from a picture, the outer outline of its largest object with the default
/// [`TraceSettings`]; from Parquet, the first outline; from CSV as [`OutlineReader`] reads it, the first outline; from CSV with a header that has
/// `x` and `y` but neither `frame` nor `time`, all its rows as one outline. Content and extension tell a picture from CSV. The
/// outline returned is always closed.
///
/// # Errors
/// The file cannot be read, follows none of these formats, or holds no closed outline.
pub fn read_shape(path: impl AsRef<Path>) -> Result<Outline, ReadShapeError> {
    let path = path.as_ref();
    let file = path.display().to_string();
    let io = |error| {
        let place = Place { file: path.display().to_string(), span: None, column: None };
        ReadError { place, kind: ReadErrorKind::Io(error) }
    };
    let mut source = File::open(path).map_err(io)?;
    let mut magic = Vec::new();
    source.by_ref().take(MAGIC_LENGTH).read_to_end(&mut magic).map_err(io)?;
    // A damaged picture is to be told as such, not as CSV without a header.
    if image::guess_format(&magic).is_ok() || image::ImageFormat::from_path(path).is_ok() {
        let picture = read_picture(path)?;
        let traced = trace_mask(&picture, &TraceSettings::default());
        return traced.map(|traced| traced.outline).map_err(|source| ReadShapeError::Trace { file, source });
    }
    if TableFormat::is_parquet(&magic) || TableFormat::of(path) == TableFormat::Parquet {
        return closed(first_of_parquet(path)?, file);
    }
    source.rewind().map_err(io)?;
    read_shape_csv(BufReader::new(source), file)
}

/// The columns of a file that holds a shape.
enum ShapeColumns {
    Sequence(Columns),
    Points { x: usize, y: usize },
}

fn read_shape_csv(source: impl Read, file: String) -> Result<Outline, ReadShapeError> {
    let (rows, columns) = Rows::open(source, file.clone(), |header| {
        let names = |column: Column| header.iter().any(|name| name.trim_ascii() == column.name().as_bytes());
        if names(Column::Frame) || names(Column::Time) {
            return Columns::find(header).map(ShapeColumns::Sequence);
        }
        let [x, y] = require(header, [Column::X, Column::Y])?;
        Ok(ShapeColumns::Points { x, y })
    })?;
    let outline = match columns {
        ShapeColumns::Sequence(columns) => {
            let first = OutlineReader::with_columns(rows, columns).next();
            first.transpose()?.map(|frame| frame.outline)
        }
        ShapeColumns::Points { x, y } => read_points(rows, x, y)?,
    };
    closed(outline, file)
}

/// The outline, if it serves as a shape.
fn closed(outline: Option<Outline>, file: String) -> Result<Outline, ReadShapeError> {
    match outline {
        None => Err(ReadShapeError::NoOutline { file }),
        Some(Outline::Open(_)) => Err(ReadShapeError::Open { file }),
        Some(outline) => Ok(outline),
    }
}

/// The first outline of a Parquet file, which may lack frames.
#[cfg(feature = "parquet")]
fn first_of_parquet(path: &Path) -> Result<Option<Outline>, ReadError> {
    use crate::parquet_file::columns::Needed;
    use crate::parquet_file::reader::ParquetReader;
    let first = ParquetReader::open_needing(path, Needed::Shape)?.next();
    Ok(first.transpose()?.map(|frame| frame.outline))
}

#[cfg(not(feature = "parquet"))]
fn first_of_parquet(path: &Path) -> Result<Option<Outline>, ReadError> {
    let place = Place { file: path.display().to_string(), span: None, column: None };
    Err(ReadError { place, kind: ReadErrorKind::ParquetLeftOut })
}

/// All rows as one closed outline, none if there are no rows.
fn read_points<R: Read>(mut rows: Rows<R>, x: usize, y: usize) -> Result<Option<Outline>, ReadError> {
    let mut outline: Option<OutlineRows> = None;
    while rows.advance()? {
        let x = number(rows.field(x)).map_err(|kind| rows.error(Some(Column::X), kind))?;
        let y = number(rows.field(y)).map_err(|kind| rows.error(Some(Column::Y), kind))?;
        let points = outline.get_or_insert_with(|| OutlineRows::new(0, 0.0, DEFAULT_OBJECT.to_owned(), rows.line(), 0));
        points.add(Point2::new(x, y), b"", true, rows.end_line()).map_err(|(kind, column)| rows.error(column, kind))?;
    }
    let Some(outline) = outline else { return Ok(None) };
    let lines = Some((outline.first_line, outline.last_line));
    let (object, outline) = outline.into_outline();
    outline
        .map(Some)
        .map_err(|source| rows.error_at(lines, None, ReadErrorKind::Degenerate { object, frame: 0, source }))
}
