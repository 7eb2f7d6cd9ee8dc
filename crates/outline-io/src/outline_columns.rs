use freeform_curve_fit::OutlineError;
use nalgebra::Point2;

use crate::column::Column;
use crate::error::{Place, ReadError, ReadErrorKind, Span};
use crate::frame::{DEFAULT_OBJECT, OutlineFrame};
use crate::outline_rows::{closed_outline, open_outline};

/// Name of a table in messages.
const TABLE: &str = "<table>";

/// Largest absolute number accepted, as in files.
const NUMBER_LIMIT: f64 = 1e100;

/// A table of outlines in memory: one entry per point in every column, as the columns of a CSV file. The rows of one outline (same frame
/// and object) follow each other in the order of the contour.
#[derive(Debug, Clone, Copy)]
pub struct OutlineColumns<'a> {
    /// Names of the objects.
    pub names: &'a [String],
    /// Position of the object in `names`; `None` where all rows are of one object, which is named [`DEFAULT_OBJECT`].
    pub object: Option<&'a [u32]>,
    /// Frame number.
    pub frame: &'a [u64],
    /// Time in seconds.
    pub time: &'a [f64],
    /// First coordinate.
    pub x: &'a [f64],
    /// Second coordinate.
    pub y: &'a [f64],
    /// Number of the arc, negative for none; `None` where all outlines are closed.
    pub arc: Option<&'a [i64]>,
}

/// Why columns do not form a table.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ColumnsError {
    /// A column has another length than the column `frame`.
    #[error("column {column} has {found} rows, column frame has {expected}")]
    Length {
        /// The column.
        column: Column,
        /// Its rows.
        found: usize,
        /// Rows of the column `frame`.
        expected: usize,
    },
    /// An object without a name.
    #[error("row {row} is of object {position}, there are {names} names")]
    NoName {
        /// The row, counted from 0.
        row: usize,
        /// Position of the object.
        position: u32,
        /// Number of names.
        names: usize,
    },
}

impl<'a> OutlineColumns<'a> {
    /// The outlines one after the other, by the rules of [`OutlineReader`](crate::OutlineReader). Rows in the places of errors are counted
    /// from 0.
    ///
    /// ```
    /// use freeform_outline_io::OutlineColumns;
    ///
    /// let (names, object) = (["left".to_owned(), "right".to_owned()], [0, 0, 0, 1, 1, 1]);
    /// let (x, y) = ([0.0, 2.0, 0.0, 5.0, 7.0, 5.0], [0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    /// let columns = OutlineColumns { names: &names, object: Some(&object), frame: &[0; 6], time: &[0.0; 6], x: &x, y: &y, arc: None };
    /// let outlines = columns.outlines()?.collect::<Result<Vec<_>, _>>()?;
    /// assert_eq!(outlines[1].object, "right");
    /// assert_eq!(outlines[1].outline.centroid().x, 17.0 / 3.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Columns of different lengths; an object without a name.
    pub fn outlines(&self) -> Result<ColumnOutlines<'a>, ColumnsError> {
        let expected = self.frame.len();
        let lengths = [
            (Column::Time, self.time.len()),
            (Column::X, self.x.len()),
            (Column::Y, self.y.len()),
            (Column::Object, self.object.map_or(expected, <[_]>::len)),
            (Column::Arc, self.arc.map_or(expected, <[_]>::len)),
        ];
        if let Some(&(column, found)) = lengths.iter().find(|(_, found)| *found != expected) {
            return Err(ColumnsError::Length { column, found, expected });
        }
        let names = self.names.len();
        let objects = self.object.unwrap_or_default().iter().enumerate();
        if let Some((row, &position)) = objects.clone().find(|(_, position)| **position as usize >= names) {
            return Err(ColumnsError::NoName { row, position, names });
        }
        let objects = self.object.map_or(1, |_| names);
        Ok(ColumnOutlines { columns: *self, row: 0, latest: vec![None; objects], ended: false })
    }

    fn name(&self, object: usize) -> &str {
        self.object.and_then(|_| self.names.get(object)).map_or(DEFAULT_OBJECT, String::as_str)
    }

    fn object(&self, row: usize) -> usize {
        self.object.map_or(0, |column| column[row] as usize)
    }
}

/// The outlines of a table. Ends after an error that is not [recoverable](ReadError::is_recoverable).
#[derive(Debug, Clone)]
pub struct ColumnOutlines<'a> {
    columns: OutlineColumns<'a>,
    row: usize,
    /// Frame number and time of the latest outline of every object.
    latest: Vec<Option<(u64, f64)>>,
    ended: bool,
}

impl ColumnOutlines<'_> {
    /// Rows that have been read.
    #[must_use]
    pub fn rows_read(&self) -> usize {
        self.row
    }

    fn outline(&mut self) -> Result<OutlineFrame, ReadError> {
        let (columns, first) = (self.columns, self.row);
        let (frame, time, object) = (columns.frame[first], columns.time[first], columns.object(first));
        let name = columns.name(object);
        check_number(time, Column::Time, first)?;
        self.check_order(first, frame, time, object)?;
        let same = |row: &usize| columns.frame[*row] == frame && columns.object(*row) == object;
        let last = (first..columns.frame.len()).take_while(same).last().unwrap_or(first);
        let rows = first..last + 1;
        if let Some(row) = rows.clone().find(|row| columns.time[*row] != time) {
            check_number(columns.time[row], Column::Time, row)?;
            let (object, time, previous) = (name.to_owned(), columns.time[row], time);
            return Err(at(Column::Time, row, ReadErrorKind::TimeChanges { object, frame, previous, time }));
        }
        let pieces = self.pieces(rows.clone(), frame, name)?;
        self.row = rows.end;
        self.latest[object] = Some((frame, time));
        let is_open = columns.arc.is_some_and(|arc| arc[first] >= 0);
        let outline = if is_open { open_outline(pieces) } else { closed_outline(pieces) };
        let object = name.to_owned();
        outline.map(|outline| OutlineFrame { frame, time, object: object.clone(), outline }).map_err(
            |source: OutlineError| {
                let span = Some(Span::Rows(first as u64, last as u64));
                let place = Place { file: TABLE.to_owned(), span, column: None };
                ReadError { place, kind: ReadErrorKind::Degenerate { object, frame, source } }
            },
        )
    }

    /// Frames and times of an object increase.
    fn check_order(&self, row: usize, frame: u64, time: f64, object: usize) -> Result<(), ReadError> {
        let Some((previous_frame, previous)) = self.latest[object] else { return Ok(()) };
        let object = self.columns.name(object).to_owned();
        if frame == previous_frame {
            return Err(at(Column::Frame, row, ReadErrorKind::SecondOutline { object, frame }));
        }
        if frame < previous_frame {
            let kind = ReadErrorKind::FrameNotIncreasing { object, frame, previous: previous_frame };
            return Err(at(Column::Frame, row, kind));
        }
        if time <= previous {
            return Err(at(Column::Time, row, ReadErrorKind::TimeNotIncreasing { object, frame, previous, time }));
        }
        Ok(())
    }

    /// The points of each arc, or of the one contour.
    fn pieces(
        &self,
        rows: std::ops::Range<usize>,
        frame: u64,
        object: &str,
    ) -> Result<Vec<Vec<Point2<f64>>>, ReadError> {
        let OutlineColumns { x, y, arc, .. } = self.columns;
        let object = || object.to_owned();
        let mut pieces: Vec<Vec<Point2<f64>>> = vec![Vec::with_capacity(rows.len())];
        let mut seen: Vec<i64> = Vec::new();
        for row in rows.clone() {
            check_number(x[row], Column::X, row)?;
            check_number(y[row], Column::Y, row)?;
            if let Some(arc) = arc
                && (row == rows.start || arc[row] != arc[row - 1])
            {
                let (value, before) = (arc[row], row.checked_sub(1).filter(|before| *before >= rows.start));
                if before.is_some_and(|before| (arc[before] < 0) != (value < 0)) {
                    return Err(at(Column::Arc, row, ReadErrorKind::MixedArcs { object: object(), frame }));
                }
                if value >= 0 && seen.contains(&value) {
                    let kind = ReadErrorKind::SecondArc { object: object(), frame, arc: value.to_string() };
                    return Err(at(Column::Arc, row, kind));
                }
                if value >= 0 {
                    seen.push(value);
                }
                if value >= 0 && before.is_some() {
                    pieces.push(Vec::new());
                }
            }
            if let Some(piece) = pieces.last_mut() {
                piece.push(Point2::new(x[row], y[row]));
            }
        }
        Ok(pieces)
    }
}

impl Iterator for ColumnOutlines<'_> {
    type Item = Result<OutlineFrame, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended || self.row == self.columns.frame.len() {
            return None;
        }
        let outline = self.outline();
        self.ended = outline.as_ref().is_err_and(|error| !error.is_recoverable());
        Some(outline)
    }
}

/// Refuses what a file may not hold either.
fn check_number(value: f64, column: Column, row: usize) -> Result<(), ReadError> {
    if !value.is_finite() {
        return Err(at(column, row, ReadErrorKind::NotFinite { text: value.to_string() }));
    }
    if value.abs() > NUMBER_LIMIT {
        return Err(at(column, row, ReadErrorKind::TooLarge { value, limit: NUMBER_LIMIT }));
    }
    Ok(())
}

fn at(column: Column, row: usize, kind: ReadErrorKind) -> ReadError {
    let span = Some(Span::Rows(row as u64, row as u64));
    ReadError { place: Place { file: TABLE.to_owned(), span, column: Some(column) }, kind }
}
