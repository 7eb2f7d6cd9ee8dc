//! Outlines one by one from CSV.
use std::fs::File;
use std::io::Read;
use std::path::Path;

use nalgebra::Point2;

use crate::csv_file::columns::{Columns, Role};
use crate::csv_file::field::{deviation, frame_number, number, seconds, text};
use crate::csv_file::rows::Rows;
use crate::error::{Place, ReadError, ReadErrorKind};
use crate::frame::{DEFAULT_OBJECT, OutlineFrame};
use crate::origin_warning::OriginWarnings;
use crate::table::column::Column;
use crate::table::latest_frames::LatestFrames;
use crate::table::outline_rows::OutlineRows;

/// Reads outlines one by one from CSV with the header `frame,time,x,y` and the optional columns `object`, `arc`, `contour`,
/// `deviation` and `warning`.
///
/// The columns may stand in any order; others are ignored. Lines that begin with `#` are comments. The last comment before the first row is the
/// header where that row has numbers in place of names, as `numpy.savetxt` writes it. Frame numbers may be written as floats, such as `2.0`. Fields
/// may be quoted, white space around them is ignored, numbers are finite and at most 1e100 in size. The rows of one outline
/// (same frame and object) follow each other in the order of the contour. The frames of each object have increasing
/// numbers, gaps allowed, and increasing times; objects may be mixed frame by frame or come one after the other.
///
/// - Without an `arc` value an outline is closed. A last point that repeats the first is dropped.
/// - With `arc` values it is open, every value one arc. An arc without two different points is dropped, unless nothing
///   remains.
/// - Points that repeat their neighbour are kept.
/// - `warning` values say how the outlines were found, see [`warnings`](Self::warnings).
/// - `deviation` values are the standard deviations of points along the normal of the contour, in the unit of x and y: those of all
///   points of an outline, or of none.
///
/// The reader is an iterator. An outline is returned as soon as the row after it has been read; no more than two rows,
/// the present outline, and the last frame number and time of every object are held (of more than 32768 objects those seen
/// last), so memory does not grow with the number of frames. After an error for which [`ReadError::is_recoverable`] is true the iterator continues
/// with the next outline, after any other it has ended. Outlines that are complete before the bad row are returned before the error;
/// the one that the bad row interrupts is not returned.
#[derive(Debug)]
pub struct OutlineReader<R> {
    rows: Rows<R>,
    columns: Columns,
    /// What each column is.
    roles: Vec<Role>,
    /// The outline whose rows are being read.
    present: Option<OutlineRows>,
    latest: LatestFrames,
    /// Of all rows read.
    warnings: OriginWarnings,
    /// Comes after the outline that was complete before it.
    failure: Option<ReadError>,
    ended: bool,
}

impl OutlineReader<File> {
    /// Opens a file and reads its header.
    ///
    /// # Errors
    /// The file cannot be opened or read, is empty, or its header lacks a column or has one twice.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, ReadError> {
        let name = path.as_ref().display().to_string();
        match File::open(path.as_ref()) {
            Ok(file) => Self::new(file, name),
            Err(error) => {
                Err(ReadError { place: Place { file: name, span: None, column: None }, kind: ReadErrorKind::Io(error) })
            }
        }
    }
}

impl<R: Read> OutlineReader<R> {
    /// Reads the header from a source; it need not be buffered. The name is used in error messages.
    ///
    /// # Errors
    /// The source cannot be read, is empty, or its header lacks a column or has one twice.
    pub fn new(source: R, name: impl Into<String>) -> Result<Self, ReadError> {
        let (rows, columns) = Rows::open(source, name.into(), Columns::find)?;
        Ok(Self::with_columns(rows, columns))
    }

    /// Goes on with a file whose header has been read.
    pub(crate) fn with_columns(rows: Rows<R>, columns: Columns) -> Self {
        let roles = (0..rows.field_count()).map(|index| columns.role(index)).collect();
        Self {
            rows,
            columns,
            roles,
            present: None,
            latest: LatestFrames::default(),
            warnings: OriginWarnings::default(),
            failure: None,
            ended: false,
        }
    }

    /// Whether the header has the column `deviation`.
    #[must_use]
    pub fn has_deviation_column(&self) -> bool {
        self.columns.deviation.is_some()
    }

    /// Whether the header has the column `warning`, and once.
    #[must_use]
    pub const fn has_warning_column(&self) -> bool {
        self.columns.warning.is_some()
    }

    /// What the rows read so far say of how their outlines were found, in the column `warning`.
    #[must_use]
    pub const fn warnings(&self) -> OriginWarnings {
        self.warnings
    }

    /// Reads one row; returns the outline that it completes, if any.
    fn step(&mut self) -> Result<Option<OutlineRows>, ReadError> {
        if let Some(point) = self.rows.next_point(&self.roles) {
            self.add(point, true, true)?;
            return Ok(None);
        }
        if !self.rows.advance()? {
            self.ended = true;
            return Ok(self.present.take());
        }
        let point = Point2::new(self.number(Column::X, self.columns.x)?, self.number(Column::Y, self.columns.y)?);
        let stated = match self.columns.deviation.map(|index| deviation(self.rows.field(index))) {
            Some(Err(kind)) => return Err(self.rows.error(Some(Column::Deviation), kind)),
            Some(Ok(stated)) => stated,
            None => None,
        };
        if let Some(index) = self.columns.warning.filter(|index| !self.rows.same_as_before(*index)) {
            let told = OriginWarnings::of_text(&String::from_utf8_lossy(self.rows.field(index)));
            self.warnings = self.warnings.and(told);
        }
        let continued = match &self.present {
            Some(present) => self.continues(present)?,
            None => false,
        };
        let finished = if continued { None } else { self.begin()? };
        let arc_continues = self.columns.arc.is_none_or(|index| self.rows.same_as_before(index));
        self.add((point, stated), arc_continues, false)?;
        Ok(finished)
    }

    /// Whether the present row belongs to the outline whose rows are being read.
    fn continues(&self, present: &OutlineRows) -> Result<bool, ReadError> {
        let Columns { frame, time, object, .. } = self.columns;
        let same_object = object.is_none_or(|index| self.rows.same_as_before(index));
        // The same text needs no second look, which is most of the speed of reading.
        if same_object && self.rows.same_as_before(frame) && self.rows.same_as_before(time) {
            return Ok(true);
        }
        let number = self.frame_number()?;
        let seconds = self.seconds(time)?;
        if number != present.frame || self.object()? != present.object {
            return Ok(false);
        }
        if seconds == present.time {
            return Ok(true);
        }
        let (object, frame, previous) = (present.object.clone(), present.frame, present.time);
        let kind = ReadErrorKind::TimeChanges { object, frame, previous, time: seconds };
        Err(self.rows.error(Some(Column::Time), kind))
    }

    /// Starts a new outline with the present row and hands out the one before.
    fn begin(&mut self) -> Result<Option<OutlineRows>, ReadError> {
        let frame = self.frame_number()?;
        let time = self.seconds(self.columns.time)?;
        let object = self.object()?.to_owned();
        let checked = self.latest.check(&object, (frame, time));
        checked.map_err(|(column, kind)| self.rows.error(Some(column), kind))?;
        self.latest.set(&object, (frame, time));
        let capacity = self.present.as_ref().map_or(0, OutlineRows::capacity_hint);
        Ok(self.present.replace(OutlineRows::new(frame, time, object, self.rows.line(), capacity)))
    }

    /// Adds the point of the present row to the present outline. `arc_continues` tells that the row has the arc value of
    /// the row before, `same_row` that it agrees with it in all but the point.
    fn add(
        &mut self,
        (point, deviation): (Point2<f64>, Option<f64>),
        arc_continues: bool,
        same_row: bool,
    ) -> Result<(), ReadError> {
        let Some(present) = &mut self.present else { return Ok(()) };
        let arc = self.columns.arc.map_or(&b""[..], |index| self.rows.field(index)).trim_ascii();
        if let Some(index) = self.columns.contour.filter(|_| arc.is_empty()) {
            let contour = self.rows.field(index).trim_ascii();
            // A row that was read as the one before has its contour.
            let continues = same_row || self.rows.same_as_before(index);
            if let Err(kind) = present.enter_contour(contour, continues) {
                return Err(self.rows.error(Some(Column::Contour), kind));
            }
        }
        match present.add(point, arc, arc_continues, self.rows.end_line()) {
            Ok(()) => {
                deviation.into_iter().for_each(|deviation| present.state_deviation(deviation));
                Ok(())
            }
            Err(kind) => Err(self.rows.error(kind.1, kind.0)),
        }
    }

    fn number(&self, column: Column, index: usize) -> Result<f64, ReadError> {
        number(self.rows.field(index)).map_err(|kind| self.rows.error(Some(column), kind))
    }

    fn seconds(&self, index: usize) -> Result<f64, ReadError> {
        seconds(self.rows.field(index)).map_err(|kind| self.rows.error(Some(Column::Time), kind))
    }

    fn frame_number(&self) -> Result<u64, ReadError> {
        frame_number(self.rows.field(self.columns.frame)).map_err(|kind| self.rows.error(Some(Column::Frame), kind))
    }

    fn object(&self) -> Result<&str, ReadError> {
        match self.columns.object {
            None => Ok(DEFAULT_OBJECT),
            Some(index) => text(self.rows.field(index)).map_err(|kind| self.rows.error(Some(Column::Object), kind)),
        }
    }

    /// Whether the row that could not be read certainly belongs to another outline than the present one, which then
    /// is complete.
    fn failed_row_is_another_outline(&self) -> bool {
        let Some(present) = &self.present else { return false };
        let frame = self.rows.whole_field(self.columns.frame).and_then(|field| frame_number(field).ok());
        let object = match self.columns.object {
            None => Some(DEFAULT_OBJECT),
            Some(index) => self.rows.whole_field(index).and_then(|field| text(field).ok()),
        };
        frame.is_some_and(|frame| frame != present.frame) || object.is_some_and(|object| object != present.object)
    }

    fn finish(&self, outline: OutlineRows) -> Result<OutlineFrame, ReadError> {
        let lines = Some((outline.first_line, outline.last_line));
        outline.into_frame().map_err(|kind| self.rows.error_at(lines, None, kind))
    }
}

impl<R: Read> Iterator for OutlineReader<R> {
    type Item = Result<OutlineFrame, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        while !self.ended {
            match self.step() {
                Ok(None) => {}
                Ok(Some(outline)) => return Some(self.finish(outline)),
                Err(error) => {
                    self.ended = true;
                    let complete = self.failed_row_is_another_outline();
                    let present = self.present.take().filter(|_| complete);
                    self.failure = Some(error);
                    if let Some(outline) = present {
                        return Some(self.finish(outline));
                    }
                }
            }
        }
        self.failure.take().map(Err)
    }
}
