//! The rows of a Parquet file, in the order of the file.
use std::sync::Arc;

use parquet::basic::Compression;
use parquet::errors::ParquetError;
use parquet::file::metadata::{ParquetMetaData, ParquetMetaDataReader};
use parquet::file::reader::ChunkReader;

use crate::csv_file::columns::HeaderError;
use crate::error::{Place, ReadError, ReadErrorKind, Span};
use crate::parquet_file::batch::{
    BadRow, Batch, Marks, coordinates, deviations, frames, marks, names, numbers, warnings,
};
use crate::parquet_file::columns::{Arity, Found, Layout, Needed, TableColumns};
use crate::parquet_file::leaf::{Cells, Leaf};
use crate::parquet_file::pages::{Allowance, CheckedPages};
use crate::parquet_file::schema::check_depth;
use crate::parquet_file::source::Source;
use crate::table::column::Column;

/// What every Parquet file begins with.
pub(crate) const MAGIC: &[u8] = b"PAR1";

/// Rows read at once, where a row has the points of an outline.
const OUTLINES_AT_ONCE: usize = 32;

/// Rows read at once, where a row has a point, or the points are not read.
const ROWS_AT_ONCE: usize = 8192;

/// Key of the comments among the metadata of a file.
pub(crate) const COMMENTS: &str = "freeform.comments";

/// A file with what it says of itself.
#[derive(Debug, Clone)]
pub(crate) struct Table {
    pub(crate) file: String,
    source: Arc<Source>,
    metadata: Arc<ParquetMetaData>,
    pub(crate) columns: TableColumns,
}

/// Which columns are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Wanted {
    /// Those by which outlines are ordered.
    Keys,
    All,
}

impl Table {
    pub(crate) fn open(source: Source, file: String, needed: Needed) -> Result<Self, ReadError> {
        let failed = |column, kind| ReadError { place: Place { file: file.clone(), span: None, column }, kind };
        let metadata = metadata(&source).map_err(|kind| failed(None, kind))?;
        let schema = metadata.file_metadata().schema_descr();
        let columns = TableColumns::find(schema, needed).map_err(|(column, kind)| failed(column, kind))?;
        for group in metadata.row_groups() {
            if group.columns().len() != schema.num_columns() || group.num_rows() < 0 {
                return Err(failed(None, damaged("a row group that does not fit the schema")));
            }
            for found in columns.all() {
                if let Some(codec) = unread_codec(group.column(found.position).compression()) {
                    return Err(failed(None, ReadErrorKind::Codec { codec }));
                }
            }
        }
        Ok(Self { file, source: Arc::new(source), metadata: Arc::new(metadata), columns })
    }

    /// Length of the file in bytes.
    pub(crate) fn length(&self) -> u64 {
        parquet::file::reader::Length::len(self.source.as_ref())
    }

    /// The comment lines that the file was written with.
    pub(crate) fn comments(&self) -> Option<&str> {
        let all = self.metadata.file_metadata().key_value_metadata()?;
        all.iter().find(|entry| entry.key == COMMENTS)?.value.as_deref()
    }

    /// All rows, front to back.
    pub(crate) fn batches(&self, wanted: Wanted) -> Batches {
        Batches { table: self.clone(), wanted, next_group: 0, open: None, row: 0, ended: false }
    }

    pub(crate) fn error(&self, row: Option<u64>, bad: HeaderError) -> ReadError {
        let rows = row.map(|row| (row, row));
        ReadError {
            place: Place {
                file: self.file.clone(),
                span: rows.map(|(first, last)| Span::Rows(first, last)),
                column: bad.0,
            },
            kind: bad.1,
        }
    }
}

fn damaged(reason: &str) -> ReadErrorKind {
    ReadErrorKind::DamagedParquet { source: reason.into() }
}

fn metadata(source: &Source) -> Result<ParquetMetaData, ReadErrorKind> {
    let length = parquet::file::reader::Length::len(source);
    // Magic bytes at both ends, and the length of what stands before the last.
    let ends = if length < 12 { None } else { Some((0, length - 8)) };
    let (head, tail) = match ends {
        Some((head, tail)) => {
            (source.get_bytes(head, 4).map_err(unreadable)?, source.get_bytes(tail, 8).map_err(unreadable)?)
        }
        None => return Err(ReadErrorKind::NotParquet),
    };
    if &tail[4..] == b"PARE" {
        return Err(damaged("the file is encrypted"));
    }
    if head != MAGIC {
        return Err(ReadErrorKind::NotParquet);
    }
    if &tail[4..] != MAGIC {
        return Err(damaged("the file is cut short: its table of contents should stand at its end"));
    }
    let footer = u64::from(u32::from_le_bytes([tail[0], tail[1], tail[2], tail[3]]));
    let start = (length - 8).checked_sub(footer).ok_or_else(|| damaged("a table of contents longer than the file"))?;
    let bytes = source.get_bytes(start, footer as usize).map_err(unreadable)?;
    check_depth(&bytes).map_err(damaged)?;
    ParquetMetaDataReader::decode_metadata(&bytes).map_err(unreadable)
}

/// The name of a compression that is not read.
fn unread_codec(compression: Compression) -> Option<&'static str> {
    match compression {
        Compression::UNCOMPRESSED | Compression::SNAPPY | Compression::GZIP(_) | Compression::ZSTD(_) => None,
        Compression::LZO => Some("LZO"),
        Compression::BROTLI(_) => Some("Brotli"),
        Compression::LZ4 | Compression::LZ4_RAW => Some("LZ4"),
    }
}

/// The rows of a file, some at a time; ends after an error.
pub(crate) struct Batches {
    table: Table,
    wanted: Wanted,
    next_group: usize,
    open: Option<Group>,
    /// Rows before the next batch.
    row: u64,
    ended: bool,
}

/// A row group that is being read.
struct Group {
    left: usize,
    frame: Option<Leaf>,
    time: Option<Leaf>,
    object: Option<Leaf>,
    /// The coordinates, where they are wanted.
    points: Option<[Leaf; 2]>,
    arc: Option<Leaf>,
    contour: Option<Leaf>,
    /// Where the coordinates are wanted.
    deviation: Option<Leaf>,
    /// Where all is wanted.
    warning: Option<Leaf>,
}

/// Rows that could be read, and what is wrong with the row behind them.
pub(crate) type Read = (Batch, Option<ReadError>);

impl Batches {
    fn open_group(&self, index: usize) -> Result<Group, HeaderError> {
        let Table { source, metadata, columns, .. } = &self.table;
        let group = metadata.row_group(index);
        let rows = usize::try_from(group.num_rows()).map_err(|_| (None, damaged("too many rows")))?;
        let schema = metadata.file_metadata().schema_descr();
        let open = |found: &Found| {
            let (descriptor, allowance) = (schema.column(found.position), Allowance::default());
            let chunk = group.column(found.position);
            let pages = CheckedPages::open(source, chunk, &descriptor, rows, allowance.clone());
            let pages = pages.map_err(|error| of_library(found, error))?;
            Ok(Leaf::new(found.kind, descriptor, pages, allowance))
        };
        let optional = |found: &Option<Found>| found.as_ref().map(open).transpose();
        // Arcs and contours of whole rows are keys too.
        let is_wanted = |found: &&Found| self.wanted == Wanted::All || found.arity == Arity::One;
        let marks = |found: &Option<Found>| found.as_ref().filter(is_wanted).map(open).transpose();
        let (arc, contour) = (marks(&columns.arc)?, marks(&columns.contour)?);
        let (points, deviation, warning) = match self.wanted {
            Wanted::Keys => (None, None, None),
            Wanted::All => (
                Some([open(&columns.x)?, open(&columns.y)?]),
                optional(&columns.deviation)?,
                optional(&columns.warning)?,
            ),
        };
        let (frame, time, object) = (optional(&columns.frame)?, optional(&columns.time)?, optional(&columns.object)?);
        Ok(Group { left: rows, frame, time, object, points, arc, contour, deviation, warning })
    }

    fn read(&mut self) -> Result<Option<Read>, ReadError> {
        while self.open.as_ref().is_none_or(|group| group.left == 0) {
            if self.next_group == self.table.metadata.num_row_groups() {
                return Ok(None);
            }
            let group = self.open_group(self.next_group).map_err(|bad| self.table.error(Some(self.row), bad))?;
            self.open = Some(group);
            self.next_group += 1;
        }
        let Some(group) = &mut self.open else { return Ok(None) };
        let at_once = match (self.wanted, self.table.columns.layout()) {
            (Wanted::All, Layout::Pieces) => OUTLINES_AT_ONCE,
            _ => ROWS_AT_ONCE,
        };
        let rows = group.left.min(at_once);
        let read = group.read(&self.table.columns, rows).map_err(|bad| self.table.error(Some(self.row), bad))?;
        group.left -= rows;
        let (mut batch, bad) = read;
        batch.first_row = self.row;
        let error = bad.map(|BadRow { row, column, kind }| {
            batch.truncate(row);
            self.table.error(Some(self.row + row as u64), (Some(column), kind))
        });
        self.row += rows as u64;
        Ok(Some((batch, error)))
    }
}

impl Iterator for Batches {
    type Item = Result<Read, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        let read = self.read().transpose();
        self.ended = !matches!(read, Some(Ok((_, None))));
        read
    }
}

fn of_library(found: &Found, error: ParquetError) -> HeaderError {
    (Some(found.column), unreadable(error))
}

/// What the library says, without that it says so.
fn unreadable(error: ParquetError) -> ReadErrorKind {
    let source = match error {
        ParquetError::General(message) | ParquetError::EOF(message) | ParquetError::NYI(message) => message.into(),
        ParquetError::External(source) => source,
        other => other.into(),
    };
    ReadErrorKind::DamagedParquet { source }
}

/// So many cells of a column.
fn cells(leaf: &mut Leaf, found: &Found, rows: usize) -> Result<Cells, HeaderError> {
    leaf.read(rows).map_err(|error| of_library(found, error))
}

/// Those of a column that a file may have, and that may be wanted.
fn optional<'a>(
    leaf: &mut Option<Leaf>,
    found: &'a Option<Found>,
    rows: usize,
) -> Result<Option<(&'a Found, Cells)>, HeaderError> {
    match (leaf, found) {
        (Some(leaf), Some(found)) => Ok(Some((found, cells(leaf, found, rows)?))),
        _ => Ok(None),
    }
}

impl Group {
    /// The next rows, and the first that is bad among them.
    fn read(&mut self, columns: &TableColumns, rows: usize) -> Result<(Batch, Option<BadRow>), HeaderError> {
        let (mut batch, mut bad) = (Batch::default(), Vec::new());
        if let Some((_, cells)) = optional(&mut self.warning, &columns.warning, rows)? {
            batch.warnings = warnings(&cells);
        }
        let object = optional(&mut self.object, &columns.object, rows)?;
        let (names, bad_name) = names(columns.object.as_ref(), object.as_ref().map(|(_, cells)| cells), rows);
        batch.object = names;
        bad.extend(bad_name);
        match optional(&mut self.frame, &columns.frame, rows)? {
            Some((found, cells)) => {
                let (values, bad_frame) = frames(found, &cells, rows);
                batch.frame = values;
                bad.extend(bad_frame);
            }
            None => batch.frame = vec![0; rows],
        }
        match optional(&mut self.time, &columns.time, rows)? {
            Some((found, cells)) => {
                let (values, bad_time) = numbers(found, &cells, rows);
                batch.time = values;
                bad.extend(bad_time);
            }
            None => batch.time = vec![0.0; rows],
        }
        match &mut self.points {
            Some([x, y]) => {
                let (x, ends, bad_x) = coordinates(&columns.x, cells(x, &columns.x, rows)?, rows);
                let (y, y_ends, bad_y) = coordinates(&columns.y, cells(y, &columns.y, rows)?, rows);
                bad.extend(bad_x);
                bad.extend(bad_y);
                bad.extend(unequal(&ends, &y_ends));
                (batch.x, batch.y, batch.ends) = (x, y, ends);
            }
            None => batch.ends = vec![0; rows],
        }
        let mut marks_of = |leaf: &mut Option<Leaf>, found: &Option<Found>| {
            let Some((found, cells)) = optional(leaf, found, rows)? else { return Ok(Marks::None) };
            let (marks, bad_mark) = marks(found, &cells, &batch.ends);
            bad.extend(bad_mark);
            Ok(marks)
        };
        batch.arc = marks_of(&mut self.arc, &columns.arc)?;
        batch.contour = marks_of(&mut self.contour, &columns.contour)?;
        if let Some((found, cells)) = optional(&mut self.deviation, &columns.deviation, rows)? {
            let (stated, bad_deviation) = deviations(found, &cells, &batch.ends);
            batch.deviation = stated;
            bad.extend(bad_deviation);
        }
        let bad = bad.into_iter().min_by_key(|bad| bad.row);
        // Levels of damaged files may tell of other rows.
        let whole = bad.as_ref().map_or(rows, |bad| bad.row);
        if [batch.object.len(), batch.frame.len(), batch.time.len(), batch.ends.len()]
            .iter()
            .any(|found| *found < whole)
        {
            return Err((None, damaged("columns of different numbers of rows")));
        }
        Ok((batch, bad))
    }
}

/// The first row that has more values of one coordinate than of the other.
fn unequal(ends: &[usize], y_ends: &[usize]) -> Option<BadRow> {
    let row = ends.iter().zip(y_ends).position(|(end, y_end)| end != y_end)?;
    let start = row.checked_sub(1).map_or(0, |before| ends[before]);
    let kind = ReadErrorKind::ListLength { found: y_ends[row] - start, expected: ends[row] - start };
    Some(BadRow { row, column: Column::Y, kind })
}
