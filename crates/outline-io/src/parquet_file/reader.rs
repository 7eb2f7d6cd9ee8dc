//! Outlines one by one from Parquet.
use std::fs::File;
use std::path::Path;

use bytes::Bytes;
use nalgebra::Point2;

use crate::error::{Place, ReadError, ReadErrorKind, Span};
use crate::frame::OutlineFrame;
use crate::origin_warning::OriginWarnings;
use crate::parquet_file::batch::{Batch, Marks, NO_MARK};
use crate::parquet_file::columns::{Layout, Needed};
use crate::parquet_file::limit::Unpacked;
use crate::parquet_file::source::Source;
use crate::parquet_file::table::{Batches, Table, Wanted};
use crate::picture_file::natural_order::natural_order;
use crate::table::column::Column;
use crate::table::latest_frames::LatestFrames;
use crate::table::outline_rows::OutlineRows;

/// Most points that are held to bring the rows of a file into order; a row counts as some.
const SORT_LIMIT: usize = 1 << 26;

/// What a row counts as beside its points.
const ROW_COST: usize = 8;

/// Reads outlines one by one from Parquet: one row per outline with the columns `frame`, `time`, `x` and `y`, the last two lists of
/// numbers in the order of the contour, and the optional columns `object`, `arc`, `contour`, `deviation`
/// and `warning`.
///
/// The columns may stand in any order; others are not read. Numbers may be of any type, and `object` text or whole numbers.
///
/// - `arc` and `contour` are lists with a whole number for every point; null, or a negative number, is none. They mean what they mean in CSV,
///   see [`OutlineReader`](crate::OutlineReader).
/// - Or they are one whole number: then a row is one arc or contour of its outline.
/// - `deviation` is a list with the standard deviation of every point, see [`OutlineReader`](crate::OutlineReader); null or an empty list
///   for an outline without.
/// - The rows may be in any order. Where the frames of an object do not increase from row to row, all rows are read and ordered by
///   frame and object, which files of more than 64 million points refuse.
/// - Where `x` and `y` are numbers and no lists, a row is one point as in CSV, and the order of the rows is that of the contours.
///
/// The reader is an iterator. Unless the rows have to be ordered, 32 of them are held. Errors name the row, counted from 0, and
/// the column; see [`OutlineReader`](crate::OutlineReader) for which of them end the reading. Compressed with Snappy, zstd and gzip it is
/// read; other compressions, and values encoded as differences (`DELTA_...`), are refused.
pub struct ParquetReader {
    table: Table,
    batches: Batches,
    /// The rows at hand, those that have been taken, and their order if it is not theirs.
    batch: Batch,
    taken: usize,
    order: Option<Vec<usize>>,
    present: Option<OutlineRows>,
    /// Arc and contour of the latest point.
    mark: (i64, i64),
    latest: LatestFrames,
    /// Of all rows at hand so far.
    warnings: OriginWarnings,
    unpacked: Unpacked,
    /// Comes after the outline that was complete before it.
    failure: Option<ReadError>,
    ended: bool,
}

impl std::fmt::Debug for ParquetReader {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ParquetReader").field("file", &self.table.file).finish_non_exhaustive()
    }
}

impl ParquetReader {
    /// Opens a file and reads its table of contents, and the columns by which outlines are ordered.
    ///
    /// # Errors
    /// The file cannot be read, is not Parquet, is damaged, or has no such columns.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, ReadError> {
        Self::open_needing(path.as_ref(), Needed::Sequence)
    }

    /// Reads a file that is in memory. The name is used in error messages.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn from_bytes(bytes: Vec<u8>, name: impl Into<String>) -> Result<Self, ReadError> {
        Self::of(Table::open(Source::Memory(Bytes::from(bytes)), name.into(), Needed::Sequence)?)
    }

    /// Also a file without frames, whose first row, or all of whose points, are a shape.
    pub(crate) fn open_needing(path: &Path, needed: Needed) -> Result<Self, ReadError> {
        let name = path.display().to_string();
        let source = File::open(path).and_then(Source::of_file).map_err(|error| ReadError {
            place: Place { file: name.clone(), span: None, column: None },
            kind: ReadErrorKind::Io(error),
        })?;
        Self::of(Table::open(source, name, needed)?)
    }

    /// The comment lines that [`ParquetWriter`](crate::ParquetWriter) was given, without `#`; empty in files of others.
    #[must_use]
    pub fn comments(&self) -> &str {
        self.table.comments().unwrap_or_default()
    }

    /// Whether the file has the column `deviation`.
    #[must_use]
    pub fn has_deviation_column(&self) -> bool {
        self.table.columns.deviation.is_some()
    }

    /// Whether the file has the column `warning`, with one value in a row.
    #[must_use]
    pub const fn has_warning_column(&self) -> bool {
        self.table.columns.warning.is_some()
    }

    /// What the rows read so far say of how their outlines were found, in the column `warning`: text, one for each row.
    #[must_use]
    pub const fn warnings(&self) -> OriginWarnings {
        self.warnings
    }

    fn of(table: Table) -> Result<Self, ReadError> {
        let batches = table.batches(Wanted::All);
        let (batch, latest) = (Batch::default(), LatestFrames::default());
        let unpacked = Unpacked::of_file(table.length());
        let mut reader = Self {
            table,
            batches,
            batch,
            taken: 0,
            order: None,
            present: None,
            mark: (NO_MARK, NO_MARK),
            latest,
            warnings: OriginWarnings::default(),
            unpacked,
            failure: None,
            ended: false,
        };
        if !reader.is_in_order() {
            reader.sort()?;
        }
        Ok(reader)
    }

    /// Whether the frames of each object increase from row to row, as far as the file can be read.
    fn is_in_order(&self) -> bool {
        if self.table.columns.layout() == Layout::Points || self.table.columns.frame.is_none() {
            return true;
        }
        let mut latest = LatestFrames::default();
        let mut before = None;
        for read in self.table.batches(Wanted::Keys) {
            // What is wrong is told when the reading has come there.
            let Ok((batch, _)) = read else { return true };
            for (row, (object, frame)) in batch.object.iter().zip(&batch.frame).enumerate() {
                let piece = (row_mark(&batch.contour, row), row_mark(&batch.arc, row));
                let latest_frame = latest.of(object).map(|(frame, _)| frame);
                let goes_on = matches!(&before, Some((name, piece_before)) if name == object && *piece_before < piece);
                match latest_frame {
                    Some(latest) if latest == *frame && goes_on => {}
                    Some(latest) if latest >= *frame => return false,
                    _ => latest.set(object, (*frame, 0.0)),
                }
                before = Some((std::sync::Arc::clone(object), piece));
            }
        }
        true
    }

    /// Reads all rows and finds their order.
    fn sort(&mut self) -> Result<(), ReadError> {
        for read in self.batches.by_ref() {
            let (batch, error) = read?;
            if let Some(error) = error {
                return Err(error);
            }
            self.warnings = self.warnings.and(batch.warnings);
            self.batch.append(batch);
            if self.batch.x.len() + ROW_COST * self.batch.rows() > SORT_LIMIT {
                return Err(self
                    .table
                    .error(None, (Some(Column::Frame), ReadErrorKind::TooManyToSort { limit: SORT_LIMIT })));
            }
        }
        let Batch { object, frame, arc, contour, .. } = &self.batch;
        let mut order: Vec<usize> = (0..self.batch.rows()).collect();
        order.sort_by(|&a, &b| {
            let by_name = || {
                if object[a] == object[b] { std::cmp::Ordering::Equal } else { natural_order(&object[a], &object[b]) }
            };
            frame[a]
                .cmp(&frame[b])
                .then_with(by_name)
                .then_with(|| row_mark(contour, a).cmp(&row_mark(contour, b)))
                .then_with(|| row_mark(arc, a).cmp(&row_mark(arc, b)))
        });
        self.order = Some(order);
        Ok(())
    }

    /// The next row: its place in what is at hand.
    fn next_row(&mut self) -> Result<Option<usize>, ReadError> {
        while self.taken == self.batch.rows() {
            if let Some(failure) = self.failure.take() {
                return Err(failure);
            }
            let Some(read) = self.batches.next().transpose()? else { return Ok(None) };
            (self.batch, self.failure) = read;
            self.warnings = self.warnings.and(self.batch.warnings);
            self.taken = 0;
        }
        let row = self.order.as_ref().map_or(self.taken, |order| order[self.taken]);
        self.taken += 1;
        Ok(Some(row))
    }

    /// Reads one row; returns the outline that it completes, if any.
    fn step(&mut self) -> Result<Option<OutlineRows>, ReadError> {
        let Some(row) = self.next_row()? else {
            self.ended = true;
            return Ok(self.present.take());
        };
        let continued = self.continues(row)?;
        let finished = if continued { None } else { self.begin(row)? };
        match self.add(row, continued) {
            Ok(()) => Ok(finished),
            Err((column, kind)) => {
                // The outline before is whole.
                let error = self.error(row, column, kind);
                self.ended = true;
                self.present = None;
                self.failure = Some(error);
                match finished {
                    Some(finished) => Ok(Some(finished)),
                    None => self.failure.take().map_or(Ok(None), Err),
                }
            }
        }
    }

    /// Whether a row belongs to the outline at hand.
    fn continues(&self, row: usize) -> Result<bool, ReadError> {
        let Some(present) = &self.present else { return Ok(false) };
        let (frame, time) = (self.batch.frame[row], self.batch.time[row]);
        if frame != present.frame || *self.batch.object[row] != *present.object {
            return Ok(false);
        }
        let object = present.object.clone();
        if time != present.time {
            let kind = ReadErrorKind::TimeChanges { object, frame, previous: present.time, time };
            return Err(self.error(row, Some(Column::Time), kind));
        }
        let is_piece = [&self.batch.arc, &self.batch.contour]
            .into_iter()
            .any(|marks| matches!(marks, Marks::OfRows(marks) if marks[row] != NO_MARK));
        if self.table.columns.layout() == Layout::Pieces && !is_piece {
            return Err(self.error(row, Some(Column::Frame), ReadErrorKind::SecondOutline { object, frame }));
        }
        Ok(true)
    }

    /// Starts a new outline with a row and hands out the one before.
    fn begin(&mut self, row: usize) -> Result<Option<OutlineRows>, ReadError> {
        let (frame, time) = (self.batch.frame[row], self.batch.time[row]);
        let object = self.batch.object[row].to_string();
        let checked = self.latest.check(&object, (frame, time));
        checked.map_err(|(column, kind)| self.error(row, Some(column), kind))?;
        self.unpacked.add_outline().map_err(|kind| self.error(row, None, kind))?;
        self.latest.set(&object, (frame, time));
        let number = self.number(row);
        Ok(self.present.replace(OutlineRows::new(frame, time, object, number, self.batch.points(row).len())))
    }

    /// Adds the points of a row to the outline at hand.
    fn add(&mut self, row: usize, continued: bool) -> Result<(), (Option<Column>, ReadErrorKind)> {
        let number = self.number(row);
        let Some(present) = &mut self.present else { return Ok(()) };
        let points = self.batch.points(row);
        self.unpacked.add_points(points.len()).map_err(|kind| (None, kind))?;
        let mark = |marks: &Marks, point: usize| match marks {
            Marks::None => NO_MARK,
            Marks::OfRows(marks) => marks[row],
            Marks::OfPoints(marks) => marks[point],
        };
        let text = |mark: i64| if mark == NO_MARK { String::new() } else { mark.to_string() };
        let is_by_point = self.table.columns.layout() == Layout::Points;
        let first = points.start;
        let (mut arc_text, mut is_known) = (String::new(), false);
        for point in points {
            let (arc, contour) = (mark(&self.batch.arc, point), mark(&self.batch.contour, point));
            // A row that is a piece begins a new one.
            let follows = point > first || continued && is_by_point;
            let (arc_continues, contour_continues) = (follows && arc == self.mark.0, follows && contour == self.mark.1);
            if !arc_continues || !is_known {
                (arc_text, is_known) = (text(arc), true);
            }
            if arc == NO_MARK && !matches!(self.batch.contour, Marks::None) && !contour_continues {
                let entered = present.enter_contour(text(contour).as_bytes(), contour_continues);
                entered.map_err(|kind| (Some(Column::Contour), kind))?;
            }
            self.mark = (arc, contour);
            let place = Point2::new(self.batch.x[point], self.batch.y[point]);
            present.add(place, arc_text.as_bytes(), arc_continues, number).map_err(|(kind, column)| (column, kind))?;
            if let Some(deviation) = self.batch.deviation.get(point).filter(|deviation| !deviation.is_nan()) {
                present.state_deviation(*deviation);
            }
        }
        Ok(())
    }

    /// Number of a row in the file.
    fn number(&self, row: usize) -> u64 {
        self.batch.first_row + row as u64
    }

    fn error(&self, row: usize, column: Option<Column>, kind: ReadErrorKind) -> ReadError {
        self.table.error(Some(self.number(row)), (column, kind))
    }

    fn finish(&self, outline: OutlineRows) -> Result<OutlineFrame, ReadError> {
        let OutlineRows { first_line, last_line, .. } = outline;
        let span = Some(Span::Rows(first_line.min(last_line), last_line.max(first_line)));
        let place = || Place { file: self.table.file.clone(), span, column: None };
        outline.into_frame().map_err(|kind| ReadError { place: place(), kind })
    }
}

/// The arc or contour that a whole row is.
fn row_mark(marks: &Marks, row: usize) -> i64 {
    match marks {
        Marks::OfRows(marks) => marks[row],
        Marks::OfPoints(_) | Marks::None => NO_MARK,
    }
}

impl Iterator for ParquetReader {
    type Item = Result<OutlineFrame, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        while !self.ended {
            match self.step() {
                Ok(None) => {}
                Ok(Some(outline)) => return Some(self.finish(outline)),
                Err(error) => {
                    self.ended = true;
                    let kept = self.present.take().filter(|_| self.is_whole(&error));
                    self.failure = Some(error);
                    if let Some(outline) = kept {
                        return Some(self.finish(outline));
                    }
                }
            }
        }
        self.failure.take().map(Err)
    }
}

impl ParquetReader {
    /// Whether an outline is complete though what follows it cannot be read: where a row is a whole outline, and is not the bad one.
    fn is_whole(&self, error: &ReadError) -> bool {
        let is_of_it = matches!(error.kind, ReadErrorKind::TimeChanges { .. } | ReadErrorKind::SecondOutline { .. });
        let has_pieces =
            [&self.batch.arc, &self.batch.contour].into_iter().any(|marks| matches!(marks, Marks::OfRows(_)));
        self.table.columns.layout() == Layout::Pieces && !has_pieces && !is_of_it
    }
}
