//! Outlines one by one to Parquet.
use std::fmt;
use std::io::{self, Write};
use std::sync::Arc;

use freeform_curve_fit::Outline;
use parquet::basic::Compression;
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, Int32Type, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::parser::parse_message_type;

use crate::csv_file::writer::WriterOptions;
use crate::frame::OutlineFrame;
use crate::origin_warning::OriginWarnings;
use crate::parquet_file::table::COMMENTS;
use crate::table::rounding::Rounding;
use crate::write_error::WriteError;

/// Points after which a row group is written; it holds 16 MB of coordinates.
const GROUP_POINTS: usize = 1 << 20;

/// Outlines after which a row group is written, however small they are.
const GROUP_ROWS: usize = 1 << 16;

/// Writes outlines one by one as Parquet with one row per outline: `object`, `frame`, `time`, `x` and `y`, and where the options ask for them `arc`,
/// `contour`, `deviation` and `warning`. `x` and `y` are lists of floats, `arc` and `contour` lists of whole numbers as long, or null, and
/// `deviation` lists of floats as long, or null. [`ParquetReader`](crate::ParquetReader) reads the file back to the last bit, as it does CSV. The
/// column `object` is always there.
///
/// Rows are gathered until they have a million points. Nothing can be read before [`Self::finish`] has written the table of contents.
pub struct ParquetWriter<W> {
    sink: W,
    /// Writes to memory, from where whole row groups go to the sink.
    file: SerializedFileWriter<Vec<u8>>,
    options: WriterOptions,
    rounding: Rounding,
    /// Those known so far as text.
    warnings: ByteArray,
    rows: Rows,
}

impl<W> fmt::Debug for ParquetWriter<W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ParquetWriter").field("options", &self.options).finish_non_exhaustive()
    }
}

/// What waits for the end of a row group.
#[derive(Debug, Default)]
struct Rows {
    object: Vec<ByteArray>,
    frame: Vec<i64>,
    time: Vec<f64>,
    x: Vec<f64>,
    y: Vec<f64>,
    /// Whether a point is the first of its row.
    is_first: Vec<bool>,
    arc: OptionalLists<i32>,
    contour: OptionalLists<i32>,
    deviation: OptionalLists<f64>,
    warning: Vec<ByteArray>,
}

/// A value for every point, such as the piece that it belongs to: a list per row, or null.
#[derive(Debug, Default)]
struct OptionalLists<T> {
    values: Vec<T>,
    definition: Vec<i16>,
    repetition: Vec<i16>,
}

/// Definition level of the elements of lists that may be null.
const IN_OPTIONAL_LIST: i16 = 2;

impl<T> OptionalLists<T> {
    /// Adds a row. The list is not empty.
    fn push(&mut self, list: Option<impl Iterator<Item = T>>) {
        let Some(list) = list else {
            self.definition.push(0);
            self.repetition.push(0);
            return;
        };
        let mut repetition = 0;
        for value in list {
            self.values.push(value);
            self.definition.push(IN_OPTIONAL_LIST);
            self.repetition.push(repetition);
            repetition = 1;
        }
    }
}

impl<W: Write> ParquetWriter<W> {
    /// Begins a file. The comments are lines for people, and for [`ParquetReader::comments`](crate::ParquetReader::comments).
    ///
    /// # Errors
    /// The sink fails.
    pub fn new(sink: W, options: WriterOptions, comments: &[String]) -> Result<Self, WriteError> {
        let list = |name: &str, repetition: &str, kind: &str| {
            format!("{repetition} GROUP {name} (LIST) {{ REPEATED GROUP list {{ REQUIRED {kind} element; }} }}")
        };
        let mut columns = vec![
            "REQUIRED BYTE_ARRAY object (STRING);".to_owned(),
            "REQUIRED INT64 frame;".to_owned(),
            "REQUIRED DOUBLE time;".to_owned(),
            list("x", "REQUIRED", "DOUBLE"),
            list("y", "REQUIRED", "DOUBLE"),
        ];
        columns.extend(options.arc_column.then(|| list("arc", "OPTIONAL", "INT32")));
        columns.extend(options.contour_column.then(|| list("contour", "OPTIONAL", "INT32")));
        columns.extend(options.deviation_column.then(|| list("deviation", "OPTIONAL", "DOUBLE")));
        columns.extend(options.has_warning_column().then(|| "REQUIRED BYTE_ARRAY warning (STRING);".to_owned()));
        let schema = parse_message_type(&format!("message outlines {{ {} }}", columns.join(" "))).map_err(failed)?;
        let comments = KeyValue::new(COMMENTS.to_owned(), comments.join("\n"));
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            // Coordinates and standard deviations hardly repeat.
            .set_column_dictionary_enabled(list_path("x"), false)
            .set_column_dictionary_enabled(list_path("y"), false)
            .set_column_dictionary_enabled(list_path("deviation"), false)
            .set_statistics_enabled(EnabledStatistics::Chunk)
            .set_column_statistics_enabled(list_path("x"), EnabledStatistics::None)
            .set_column_statistics_enabled(list_path("y"), EnabledStatistics::None)
            .set_column_statistics_enabled(list_path("deviation"), EnabledStatistics::None)
            .set_created_by(format!("freeform version {}", env!("CARGO_PKG_VERSION")))
            .set_key_value_metadata(Some(vec![comments]))
            .build();
        let file = SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::new(properties)).map_err(failed)?;
        let rounding = Rounding::to_share(options.resolution);
        let warnings = options.warnings.to_string().as_str().into();
        Ok(Self { sink, file, options, rounding, warnings, rows: Rows::default() })
    }

    /// Writes these warnings too into the rows to come, as [`OutlineWriter::warn`](crate::OutlineWriter::warn) does.
    pub fn warn(&mut self, warnings: OriginWarnings) {
        if self.options.add_warnings(warnings) {
            self.warnings = self.options.warnings.to_string().as_str().into();
        }
    }

    /// Writes one outline.
    ///
    /// # Errors
    /// As [`OutlineWriter::write`](crate::OutlineWriter::write); also a frame number beyond those of a signed 64-bit number. Nothing of the outline
    /// has been written then, unless the sink failed.
    pub fn write(&mut self, frame: &OutlineFrame) -> Result<(), WriteError> {
        WriterOptions { object_column: true, ..self.options }.check(frame)?;
        let number = i64::try_from(frame.frame)
            .map_err(|_| WriteError::FrameNumber { object: frame.object.clone(), frame: frame.frame })?;
        self.rounding.take(&frame.outline);
        let rows = &mut self.rows;
        rows.object.push(frame.object.as_str().into());
        rows.frame.push(number);
        rows.time.push(self.rounding.time(frame.time));
        let mut is_first = true;
        for point in frame.outline.pieces().flat_map(|piece| piece.points) {
            rows.x.push(self.rounding.coordinate(point.x));
            rows.y.push(self.rounding.coordinate(point.y));
            rows.is_first.push(is_first);
            is_first = false;
        }
        let open = matches!(frame.outline, Outline::Open(_));
        let pieces =
            || (0..).zip(frame.outline.pieces()).flat_map(|(number, piece)| piece.points.iter().map(move |_| number));
        if self.options.arc_column {
            rows.arc.push(open.then(pieces));
        }
        if self.options.contour_column {
            rows.contour.push((!open).then(pieces));
        }
        if self.options.deviation_column {
            rows.deviation.push(frame.outline.deviations());
        }
        if self.options.has_warning_column() {
            rows.warning.push(self.warnings.clone());
        }
        if rows.x.len() >= GROUP_POINTS || rows.frame.len() >= GROUP_ROWS {
            self.write_group()?;
        }
        Ok(())
    }

    /// Writes what is left and the table of contents, and hands the sink back.
    ///
    /// # Errors
    /// The sink fails.
    pub fn finish(mut self) -> Result<W, WriteError> {
        if !self.rows.frame.is_empty() {
            self.write_group()?;
        }
        self.file.finish().map_err(failed)?;
        self.pass_on()?;
        self.sink.flush()?;
        Ok(self.sink)
    }

    fn write_group(&mut self) -> Result<(), WriteError> {
        let rows = std::mem::take(&mut self.rows);
        let mut group = self.file.next_row_group().map_err(failed)?;
        column::<ByteArrayType>(&mut group, &rows.object, None)?;
        column::<Int64Type>(&mut group, &rows.frame, None)?;
        column::<DoubleType>(&mut group, &rows.time, None)?;
        let repetition: Vec<i16> = rows.is_first.iter().map(|first| i16::from(!first)).collect();
        let definition = vec![1; repetition.len()];
        column::<DoubleType>(&mut group, &rows.x, Some((&definition, &repetition)))?;
        column::<DoubleType>(&mut group, &rows.y, Some((&definition, &repetition)))?;
        let asked = [(self.options.arc_column, &rows.arc), (self.options.contour_column, &rows.contour)];
        for (_, pieces) in asked.into_iter().filter(|(is_asked, _)| *is_asked) {
            column::<Int32Type>(&mut group, &pieces.values, Some((&pieces.definition, &pieces.repetition)))?;
        }
        if self.options.deviation_column {
            let OptionalLists { values, definition, repetition } = &rows.deviation;
            column::<DoubleType>(&mut group, values, Some((definition, repetition)))?;
        }
        if self.options.has_warning_column() {
            column::<ByteArrayType>(&mut group, &rows.warning, None)?;
        }
        group.close().map_err(failed)?;
        self.pass_on()
    }

    /// Hands what is in memory on to the sink.
    fn pass_on(&mut self) -> Result<(), WriteError> {
        self.file.flush()?;
        let written = self.file.inner_mut();
        self.sink.write_all(written)?;
        written.clear();
        Ok(())
    }
}

fn list_path(name: &str) -> parquet::schema::types::ColumnPath {
    parquet::schema::types::ColumnPath::new(vec![name.to_owned(), "list".to_owned(), "element".to_owned()])
}

/// Writes the next column of a row group, with definition and repetition levels where it is a list.
fn column<T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, Vec<u8>>,
    values: &[T::T],
    levels: Option<(&[i16], &[i16])>,
) -> Result<(), WriteError> {
    let Some(mut column) = group.next_column().map_err(failed)? else { return Ok(()) };
    let (definition, repetition) = levels.unzip();
    column.typed::<T>().write_batch(values, definition, repetition).map_err(failed)?;
    column.close().map_err(failed)
}

/// Writing goes to memory, so what fails is a contradiction of what is written.
fn failed(error: ParquetError) -> WriteError {
    WriteError::Io(io::Error::other(error))
}
